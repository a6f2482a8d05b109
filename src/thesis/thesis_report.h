// The page that puts the thesis' results beside ours.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <breakwater/experiment/saved_run.h>
#include <breakwater/thesis/printed_results.h>
#include <breakwater/thesis/reproduction.h>

namespace breakwater {

/// How many results came out how.
struct Score {
  int reproduced = 0;
  int within_class = 0;
  int not_reproduced = 0;
  int not_measured = 0;
  int holds = 0;  ///< statements of somebody's own list, which are not the thesis'
  int does_not_hold = 0;
  int vacuous = 0;  ///< hold by construction; neither these nor hypotheses are results
  int hypotheses = 0;
  int hypotheses_hold = 0;

  Score& operator+=(const Score& other);
  /// What there may be, in the order in which it is said: what does not occur in a list is left
  /// out.
  struct Tally {
    int count;
    std::string word;
    Verdict verdict;
  };
  std::vector<Tally> tallies() const;
  /// "2 vacuous, 3 of 5 hypotheses hold"; empty if there are neither.
  std::string beside() const;
  /// "3 reproduced, 1 within the class, 0 not reproduced; beside them 2 vacuous".
  std::string text() const;
};

/// A cell, judged.
struct Judged {
  double median = 0.0;
  double smallest = 0.0;
  double largest = 0.0;
  std::size_t values = 0;
  std::size_t numbers = 0;  ///< of these; the others were not measured
  std::string measured;  ///< the median; before it the word that it deserves, if words are printed
  std::string printed;   ///< as the thesis has it
  std::string class_text;                   ///< what would count as reproduced
  Verdict verdict = Verdict::not_measured;  ///< means nothing where a cell only `shows`
};
Judged judge_cell(const CellSpec& cell, const Measured& measured, const PrintedResults& printed);

/// "reproduced", "within the class", …; "holds" or "does not hold" for a statement of somebody's
/// own list; "shown" where nothing is judged, "vacuous", or "hypothesis: " before any of these.
std::string verdict_word(const Judged& judged, const CellSpec& cell, bool is_own);

/// Why a cell is vacuous, or what its hypothesis is; else why it does not come out, as it or its
/// section says; empty if neither does, if it comes out, or if nothing is judged.
std::string reason_of(const Judged& judged, const CellSpec& cell, const SectionSpec& section);

/// The command that makes one repetition of a run, with its log in a folder of the run's name.
std::string command_of(const RunSpec& run, std::size_t repetition = 0);

struct ThesisReport {
  std::string html;
  Score score;
  std::size_t figures = 0;
  std::vector<std::string> notes;  ///< what of a replay could not be shown, one line each
};

/// Everything that the reproduction measured, as one page. Logs, videos and strips of pictures are
/// read from OUT/runs.
ThesisReport thesis_report(const Reproduction& reproduction, const Measured& measured,
                           Effort effort);

}  // namespace breakwater
