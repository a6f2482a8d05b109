// The page that compares the thesis' results with ours.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/thesis/printed_results.h>
#include <breakwater/thesis/reproduction.h>

namespace breakwater {

/// The verdict on a cell.
struct Judged {
  double median = 0.0;
  double smallest = 0.0;
  double largest = 0.0;
  std::size_t values = 0;
  std::size_t numbers = 0;               ///< measured ones among `values`
  std::string measured;                  ///< the median, behind its word if words are printed
  std::string printed;                   ///< as in the thesis
  std::optional<double> deviation = {};  ///< relative to a printed number
  std::string class_text;                ///< the criterion of "reproduced"
  Verdict verdict = Verdict::not_measured;
};
Judged judge_cell(const CellSpec& cell, const Measured& measured, const PrintedResults& printed);

/// The reason why a cell is vacuous, its reading, or why it is not reproduced. Empty if there is
/// no reason or nothing is judged.
std::string reason_of(const Judged& judged, const CellSpec& cell);

/// A judged cell and its place.
struct JudgedCell {
  std::string section, table;
  CellSpec cell;
  Judged judged;
  bool is_own = false;  ///< in a user's own list

  /// "reproduced", "within the class", … In a user's own list a statement "holds" or "does not
  /// hold". A cell that is not judged is "shown". "vacuous" or "other reading: " stand first.
  std::string word() const;
  /// A cell that only shows, or is of another reading, counts nowhere.
  bool is_counted() const { return cell.shows.empty() && cell.reading.empty(); }
};

/// The number of cells with each verdict, in the order of the text. One that cannot occur in the
/// list is left out, and so are vacuous cells.
struct Tally {
  int count;
  std::string word;
  Verdict verdict;
};
std::vector<Tally> tallies(const std::vector<JudgedCell>& cells);
/// A text such as "3 reproduced, 1 within the class, 0 not reproduced; beside them 2 vacuous".
std::string score_text(const std::vector<JudgedCell>& cells);
/// Lines about printed results, numbers, different statements, and causes.
std::vector<std::string> headline(const std::vector<JudgedCell>& cells);

/// Exit status: 0 success, 1 an internal error, 2 usage or input, 130 interrupted.
CommandKind reproduce_command();

}  // namespace breakwater
