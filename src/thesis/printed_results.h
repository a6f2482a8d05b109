// The printed results of the thesis and the criteria of their reproduction.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/experiment/references.h>

namespace breakwater {

/// A result that holds by construction is vacuous, and one that is not judged is shown.
enum class Verdict { reproduced, within_class, not_reproduced, not_measured, vacuous, shown };

/// A band for a measured number. All given bounds must hold; without bounds it is unlimited.
struct Band {
  std::optional<double> relative;  ///< |measured − printed| ≤ relative·|printed|
  std::optional<double> absolute;  ///< |measured − printed| ≤ absolute
  std::optional<double> above;     ///< measured ≥ above
  std::optional<double> below;     ///< measured < below

  bool contains(double measured, double printed = 0.0) const;
  /// Whether the band lies around the printed number.
  bool is_around() const { return relative || absolute; }
  /// A text such as "±5 %" or "below 0.05".
  std::string text() const;
};

/// The criteria for a printed result. A number has two bands. A word has one band for each possible
/// word; the measured number gets the word of its band.
struct Standard {
  Band reproduced;
  Band within;
  std::vector<std::pair<std::string, Band>> words;
};

/// A printed number or word (P, N, "large delay", true, false).
struct PrintedResult {
  std::optional<double> number;
  std::string word;        ///< as printed, also the digits of a number
  double half_unit = 0.0;  ///< half a unit of the last digit

  std::string text() const;
};

/// A number that rounds to the printed digits is reproduced in any class, except one with a single
/// bound such as "461 s at least". A motion that never settles is infinite. NaN means not measured.
Verdict judge(double measured, const PrintedResult& printed, const Standard& standard);

/// The name: "reproduced", "within the class", "not reproduced", "not measured", …
std::string text(Verdict verdict);

/// The rule for a printed number: "reproduced: ±10 % or what rounds to it; class: ±35 %".
std::string rule_text(const Standard& standard);

/// The colour on a page: good, near, off or unknown.
std::string css_class(Verdict verdict);

/// The contents of printed-results.toml and reproduced.toml.
class PrintedResults {
 public:
  /// Reads both files from `folder`. Throws std::invalid_argument (`FILE[:LINE]: reason`) if they
  /// are damaged.
  explicit PrintedResults(const std::filesystem::path& folder);

  /// The result with a path such as "SCENARIO.force_2N.hpfc.peak_force_N" or
  /// "SCENARIO.table_4_8.n12[2]", if there is one.
  std::optional<PrintedResult> find(const std::string& path) const;
  /// The criteria of the first matching pattern. Throws std::runtime_error if none matches.
  const Standard& standard(const std::string& path) const;

  /// The printed numbers of a case, by our metric; none if the thesis prints none. Throws
  /// std::runtime_error if the files are damaged.
  std::vector<PublishedValue> of_case(const std::string& scenario,
                                      const std::string& case_name) const;

 private:
  std::map<std::string, PrintedResult> results_;
  std::vector<std::pair<std::string, Standard>> standards_;
  std::map<std::string, std::map<std::string, std::string>> cases_;
};

/// Whether a text matches a pattern, in which * stands for any characters.
bool matches_pattern(const std::string& pattern, const std::string& text);

/// The results in the project's own data/.
const PrintedResults& printed_results();

/// The printed numbers of cases, for the catalogue: tables and pages show them beside the numbers
/// of a run.
ReferenceKind printed_references();

}  // namespace breakwater
