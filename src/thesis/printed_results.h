// The results that the thesis prints, and what counts as having reproduced them.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace breakwater {

enum class Verdict { reproduced, within_class, not_reproduced, not_measured };

/// Where a measured number must lie. All that is given must hold; nothing given: anywhere.
struct Band {
  std::optional<double> relative;  ///< |measured − printed| ≤ relative·|printed|
  std::optional<double> absolute;  ///< |measured − printed| ≤ absolute
  std::optional<double> above;     ///< measured ≥ above
  std::optional<double> below;     ///< measured < below

  bool contains(double measured, double printed = 0.0) const;
  /// Whether it lies about the printed number.
  bool is_around() const { return relative || absolute; }
  /// "±5 %", "below 0.05".
  std::string text() const;
};

/// The class of a printed result. A number has two bands. A word has one for each word that might
/// have been printed: the measured number is in the one that it deserves.
struct Standard {
  Band reproduced;
  Band within;
  std::vector<std::pair<std::string, Band>> words;
};

/// A number or a word (P, N, "large delay"; true and false are words too).
struct PrintedResult {
  std::optional<double> number;
  std::string word;        ///< as it is printed: a number's digits too
  double half_unit = 0.0;  ///< of a number's last digit

  std::string text() const;
};

/// A number that rounds to the printed digits is reproduced, whatever its class, unless that has
/// but one bound: "461 s at least". What never settles is infinitely large. NaN is nothing that was
/// measured.
Verdict judge(double measured, const PrintedResult& printed, const Standard& standard);

/// "reproduced", "within the class", "not reproduced", "not measured".
std::string text(Verdict verdict);

/// Its colour on a page: good, near, off or unknown.
std::string css_class(Verdict verdict);

/// printed-results.toml and reproduced.toml.
class PrintedResults {
 public:
  /// Reads them from `folder`. Throws std::invalid_argument `FILE[:LINE]: reason` if they are
  /// damaged.
  explicit PrintedResults(const std::filesystem::path& folder);

  /// What is printed at a path such as "SCENARIO.force_2N.hpfc.peak_force_N" or
  /// "SCENARIO.table_4_8.n12[2]"; nothing if nothing is.
  std::optional<PrintedResult> find(const std::string& path) const;
  /// The class of the first pattern that matches a path. Throws std::runtime_error if none does.
  const Standard& standard(const std::string& path) const;

  struct Case {
    std::string printed;                         ///< the path of its numbers
    std::map<std::string, std::string> metrics;  ///< our name: theirs
  };
  /// Where a case's numbers are printed; nothing if the thesis prints none.
  std::optional<Case> of_case(const std::string& scenario, const std::string& case_name) const;

 private:
  std::map<std::string, PrintedResult> results_;
  std::vector<std::pair<std::string, Standard>> standards_;
  std::map<std::string, Case> cases_;
};

/// Whether a path matches a pattern in which * stands for any characters.
bool matches_pattern(const std::string& pattern, const std::string& path);

/// Those of the project's own data/.
const PrintedResults& printed_results();

/// One printed number of a case, and what counts as having reproduced it.
struct PrintedValue {
  std::string metric;  ///< our name for it
  PrintedResult result;
  Standard standard;

  double number() const { return result.number.value(); }
  Verdict verdict(double measured) const { return judge(measured, result, standard); }
};

/// The printed numbers of one case of a scenario. Empty if the thesis prints none. Throws
/// std::runtime_error if the files are damaged.
std::vector<PrintedValue> printed_values(const std::string& scenario, const std::string& case_name);

}  // namespace breakwater
