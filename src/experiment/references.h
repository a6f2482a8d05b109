// Numbers that somebody else has for a case's metrics: those that a publication prints, say.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// Whether a measured number agrees with another's, in words for people.
struct Agreement {
  bool is_met;
  std::string text;  ///< "reproduced"
  std::string tone;  ///< of the text on a page: good, near, off or unknown
};

/// A number that somebody else has for a metric.
struct ReferenceValue {
  std::string metric;
  double number;
  std::string text;                                  ///< as it is written there
  bool is_near_zero;                                 ///< a part of it says nothing
  std::function<Agreement(double measured)> agrees;  ///< how a measured number agrees with it
};

/// A source of such numbers: a kind of the catalogue.
struct ReferenceKind {
  static constexpr const char* kWhat = "source of reference values";

  std::string name;
  std::string legend;  ///< the meaning of "*" beside a number that does not agree: a whole line
  /// The values of one case of a scenario; empty: there are none.
  std::vector<ReferenceValue> (*of_case)(const std::string& scenario, const std::string& case_name);
};

/// The values that the catalogue's sources have for one case of a scenario.
std::vector<ReferenceValue> reference_values(const Catalogue& catalogue,
                                             const std::string& scenario,
                                             const std::string& case_name);

/// The legends of all sources.
std::string reference_legend(const Catalogue& catalogue);

}  // namespace breakwater
