// Metrics of a case from other sources, such as a publication.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// Whether a measured number agrees with a reference value, in words.
struct Agreement {
  bool is_met;
  std::string text;  ///< "reproduced", "near"
  std::string rule;  ///< which numbers agree, for a tooltip
  std::string tone;  ///< style of the text on a page: good, near, off or unknown
};

/// A metric's value from another source.
struct PublishedValue {
  std::string metric;
  double number;
  std::string text;                                  ///< as the source writes it
  bool is_near_zero;                                 ///< a relative deviation is meaningless
  std::function<Agreement(double measured)> agrees;  ///< how a measured number agrees with it

  /// "+1.2 %": how far a measured number is from it.
  std::string deviation(double measured) const;
};

/// A source of reference values: a kind of the catalogue.
struct ReferenceKind {
  static constexpr const char* kWhat = "source of reference values";

  std::string name;
  std::string legend;  ///< the meaning of "*" beside a number that does not agree, one line
  /// The values of one case of a scenario; empty if there are none.
  std::vector<PublishedValue> (*of_case)(const std::string& scenario, const std::string& case_name);
};

/// The reference values of all sources for one case of a scenario, by metric.
std::map<std::string, PublishedValue> published_values(const Catalogue& catalogue,
                                                       const std::string& scenario,
                                                       const std::string& case_name);

}  // namespace breakwater
