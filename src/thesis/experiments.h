// data/experiments.toml: what is run, tabulated and drawn for each section of the thesis.
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/thesis/printed_results.h>

namespace breakwater {

/// How much trouble is taken over what is random.
enum class Effort { quick, full };

/// A run, or several of the same settings but for a seed or an encoder's phase.
struct RunSpec {
  std::string name;  ///< also of its folder
  std::string scenario;
  std::string case_name;
  std::vector<std::string> sets;                      ///< key=value
  std::vector<std::vector<std::string>> repetitions;  ///< further sets of each; at least one
  std::size_t line = 0;                               ///< of the file, here and below
};

/// A metric of a run.
struct Quantity {
  std::string run;
  std::string metric;  ///< NAME; |NAME|; or "max SIGNAL", the signal's largest value

  /// The name of what is measured, without the bars of a magnitude.
  std::string name() const;
  bool is_magnitude() const { return metric.starts_with('|') && metric.ends_with('|'); }
};

/// One measured number, and what the thesis has instead of it.
struct CellSpec {
  Quantity quantity;
  /// What it is divided by: each run's by its own if it is the same run, else all by the median.
  std::optional<Quantity> over;
  double divisor = 1.0;
  /// The value of a run that failed; none, so that nothing holds, unless given.
  double if_failed = std::numeric_limits<double>::quiet_NaN();
  bool absent_is_never = false;  ///< a run without the metric counts as infinite; else not measured
  bool is_share = false;         ///< the mean of ones and zeros is judged, not their median
  std::string printed;           ///< a path into printed-results.toml; empty if `says` is not
  std::string says;              ///< a statement of the text, which `holds` judges
  std::string shows;  ///< what stands beside the others and is neither judged nor counted
  std::string why;    ///< why it is not reproduced, if it is not
  /// Why it holds by construction, if it does: it is then no success, and counted apart.
  std::string vacuous;
  /// The assumption against print, or against the section's reading: judged, and counted apart.
  std::string hypothesis;
  Band holds;
  std::size_t line = 0;

  /// All that it is made of.
  std::vector<Quantity> quantities() const;
};

struct TableSpec {
  std::string title;
  std::string unit;  ///< of all cells; may be empty
  std::string note;  ///< below it; may be empty
  std::vector<std::string> rows;
  std::vector<std::string> columns;
  std::vector<std::vector<std::optional<CellSpec>>> cells;  ///< rows × columns
};

struct PanelSpec {
  std::string title;
  std::vector<std::string> signals;  ///< of each of the figure's runs
  std::vector<std::string> once;     ///< of the first run alone
  std::vector<double> lines;         ///< horizontal, dashed
  std::optional<double> from_s;
  std::optional<double> to_s;
};

struct FigureRun {
  std::string run;
  std::string label;  ///< may be empty if it is alone
};

struct FigureSpec {
  std::string number;  ///< the thesis': "2.31"
  std::string title;
  std::vector<FigureRun> runs;
  std::vector<std::string> off;  ///< labels of runs that are not drawn at first
  std::vector<PanelSpec> panels;
  std::string note;
  std::size_t line = 0;
};

/// What is not shown, and why.
struct MissingSpec {
  std::string what;
  std::string why;
};

/// Why a printed result, or all whose path matches a pattern, does not come out.
struct ReasonSpec {
  std::string of;
  std::string why;
};

struct SectionSpec {
  std::string id;     ///< the thesis': "2.4.3.2"
  std::string group;  ///< what --only may name beside the id: "arm"
  std::string title;
  std::string text;
  std::string docs;   ///< a page of docs/
  std::string video;  ///< the run whose video is shown; empty: none
  std::string strip;  ///< the run whose strip of pictures is shown; empty: none
  std::string strip_number;
  std::vector<TableSpec> tables;
  std::vector<ReasonSpec> reasons;
  std::vector<FigureSpec> figures;
  std::vector<MissingSpec> missing;
  std::size_t line = 0;

  /// The runs that its tables and figures refer to.
  std::vector<std::string> runs() const;
  /// Those whose logs its figures, video and strip need.
  std::vector<std::string> logged_runs() const;
};

/// A picture of the first screen: one panel of a figure.
struct HeroSpec {
  std::string figure;
  std::size_t panel = 0;
  std::string caption;
  std::size_t line = 0;
};

struct Experiments {
  std::string file;
  /// Somebody's own list. Its statements hold or do not: "reproduced" is a word for what the thesis
  /// prints and says.
  bool is_own = false;
  std::string title;  ///< of the page; empty: that of the thesis' reproduction
  std::map<std::string, RunSpec> runs;
  std::vector<SectionSpec> sections;
  std::vector<HeroSpec> heroes;
  std::string video;  ///< of the first screen: a section's id
};

/// Reads a file of experiments. Throws std::invalid_argument `FILE[:LINE]: reason`.
Experiments read_experiments(const std::string& file, Effort effort);

}  // namespace breakwater
