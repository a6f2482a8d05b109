// The page that compares the thesis' results with ours.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/thesis/printed_results.h>
#include <breakwater/thesis/reproduction.h>

namespace breakwater {

/// The number of results with each verdict. Other readings are not counted.
struct Score {
  int reproduced = 0;
  int within_class = 0;
  int not_reproduced = 0;
  int not_measured = 0;
  int holds = 0;  ///< statements of a user's own list
  int does_not_hold = 0;
  int vacuous = 0;  ///< hold by construction, and are no results

  struct Share {
    int reproduced = 0;
    int within_class = 0;
    int vacuous = 0;
    int all = 0;
  };
  Share printed;                            ///< printed numbers and words
  std::map<std::string, Share> statements;  ///< cells of each statement of each section
  int numbers = 0;                          ///< printed numbers, also the vacuous ones
  int numbers_near = 0;                     ///< within 5 %
  int numbers_off = 0;                      ///< not within 25 %
  std::map<std::string, int> causes;        ///< number of cells not reproduced by cause

  /// The counts in the order of the text. A count that cannot occur in the list is left out.
  struct Tally {
    int count;
    std::string word;
    Verdict verdict;
  };
  std::vector<Tally> tallies() const;
  /// A text such as "3 reproduced, 1 within the class, 0 not reproduced; beside them 2 vacuous".
  std::string text() const;
  /// Lines about printed results, numbers, different statements, and causes.
  std::vector<std::string> headline() const;
};

/// The verdict on a cell.
struct Judged {
  double median = 0.0;
  double smallest = 0.0;
  double largest = 0.0;
  std::size_t values = 0;
  std::size_t numbers = 0;                  ///< measured ones among `values`
  std::string measured;                     ///< the median, behind its word if words are printed
  std::string printed;                      ///< as in the thesis
  std::string class_text;                   ///< the criterion of "reproduced"
  Verdict verdict = Verdict::not_measured;  ///< unused if the cell only `shows`
  bool is_vacuous = false;                  ///< reproduced, but by construction
};
Judged judge_cell(const CellSpec& cell, const Measured& measured, const PrintedResults& printed);

/// The verdict in words: "reproduced", "within the class", … In a user's own list a statement
/// "holds" or "does not hold". A cell that is not judged is "shown". "vacuous" or "other
/// reading: " stand first.
std::string verdict_word(const Judged& judged, const CellSpec& cell, bool is_own);

/// The reason why a cell is vacuous, its reading, or why it is not reproduced. Empty if there is
/// no reason or nothing is judged.
std::string reason_of(const Judged& judged, const CellSpec& cell);

struct ThesisReport {
  std::string html;
  /// verdicts.csv: a line for each entry of the page's tables, in their order. Columns: the place;
  /// the measured median or share over `runs`; the smallest and largest value (all digits, or
  /// empty); the printed result or statement. The verdict (or "shown") and the reason for a result
  /// that is not reproduced follow.
  std::string verdicts;
  /// The entries that are not reproduced, for a terminal: each if they are few, else their number
  /// by section. Empty if there are none.
  std::string failures;
  Score score;
  std::size_t figures = 0;
  std::vector<std::string> notes;  ///< missing parts of a replay, one line each
};

/// The page with all results of the reproduction. Reads logs, videos and strips of pictures from
/// OUT/runs.
ThesisReport thesis_report(const Reproduction& reproduction, const Measured& measured,
                           Effort effort);

/// Exit status: 0 success, 1 an internal error, 2 usage or input, 4 a picture or video could not be
/// made, 130 interrupted.
CommandKind reproduce_command();

}  // namespace breakwater
