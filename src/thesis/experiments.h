// data/experiments.toml, which explains its keys: the runs, tables and figures for each section of
// the thesis.
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/thesis/printed_results.h>

namespace breakwater {

/// The number of repetitions of random runs.
enum class Effort { quick, full };

/// One run, or several that differ only in a random seed or an encoder phase.
struct RunSpec {
  std::string name;  ///< also of its folder
  std::string scenario;
  std::string case_name;
  std::vector<std::string> sets;                      ///< key=value
  std::vector<std::vector<std::string>> repetitions;  ///< further sets of each; at least one
  std::size_t line = 0;                               ///< line of the file, here and below

  /// All sets of a repetition.
  std::vector<std::string> sets_of(std::size_t repetition) const;
};

/// A metric of a run.
struct Quantity {
  std::string run;
  std::string metric;  ///< NAME, or |NAME|

  /// The name of the metric, without the bars of a magnitude.
  std::string name() const;
  bool is_magnitude() const { return metric.starts_with('|') && metric.ends_with('|'); }
};

/// One measured number and the printed result or statement to compare it with.
struct CellSpec {
  std::string row, column;  ///< its place in the table
  Quantity quantity;
  std::optional<Quantity> over;  ///< by repetition for the same run; otherwise its median
  double divisor = 1.0;
  /// The value of a failed run; by default none, so that no band holds.
  double if_failed = std::numeric_limits<double>::quiet_NaN();
  bool absent_is_never = false;  ///< a run without the metric is infinite, else not measured
  bool is_share = false;         ///< judges the mean of ones and zeros, not their median
  std::string printed;           ///< a path into printed-results.toml; empty if `says` is set
  std::string says;              ///< a statement of the text; `holds` is its criterion
  std::string shows;             ///< text of a cell that is not judged or counted
  std::string why, cause;        ///< the reason if it is not reproduced, and its kind
  std::string vacuous;           ///< why it holds by construction: then it is no success
  std::string without;           ///< vacuous only if it holds for this run too
  std::string reading;           ///< an assumption: the cell is judged, and not counted
  Band holds;
  std::size_t line = 0;

  /// All quantities of the cell.
  std::vector<Quantity> quantities() const;
};

struct TableSpec {
  std::string title;
  std::string unit;  ///< unit of all cells; may be empty
  std::string note;  ///< text below the table; may be empty
  std::vector<std::string> rows;
  std::vector<std::string> columns;
  std::vector<CellSpec> cells;  ///< one at most for each row and column
};

struct PanelSpec {
  std::string title;
  std::vector<std::string> signals;  ///< drawn for each run of the figure
  std::vector<std::string> once;     ///< drawn for the first run only
  std::vector<double> lines;         ///< horizontal, dashed
  std::optional<double> from_s;
  std::optional<double> to_s;
};

struct FigureRun {
  std::string run;
  std::string label;  ///< may be empty for a single run
};

struct FigureSpec {
  std::string number;  ///< number in the thesis: "2.31"
  std::string title;
  std::vector<FigureRun> runs;
  std::vector<PanelSpec> panels;
  std::string note;
  std::size_t line = 0;
};

struct SectionSpec {
  std::string id;     ///< number in the thesis: "2.4.3.2"
  std::string group;  ///< another name for --only: "arm"
  std::string title;
  std::string text;
  std::string docs;  ///< a page of docs/
  std::vector<TableSpec> tables;
  std::vector<FigureSpec> figures;

  /// All runs of its tables and figures.
  std::vector<std::string> runs() const;
  /// The runs whose logs its figures need.
  std::vector<std::string> logged_runs() const;
};

/// Another reading of the text: settings for all runs whose names match a pattern, in which *
/// stands for any characters. A reading may have several.
struct ReadingSpec {
  std::string name;
  std::string runs;
  std::vector<std::string> sets;
  std::string why;
  bool is_chosen = false;
};

struct Experiments {
  std::string file;
  bool is_own = false;  ///< a user's own list: its statements hold or do not hold
  std::string title;    ///< title of the page; default: that of the thesis' reproduction
  std::map<std::string, RunSpec> runs;
  std::vector<SectionSpec> sections;
  std::vector<ReadingSpec> readings;
};

/// Reads a file of experiments, with the readings of these names. Throws std::invalid_argument
/// `FILE[:LINE]: reason`.
Experiments read_experiments(const std::string& file, Effort effort,
                             const std::vector<std::string>& readings = {});

}  // namespace breakwater
