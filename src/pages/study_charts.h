// A study's charts: drawings as SVG that need no script.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/pages/quantile_bands.h>
#include <breakwater/render/identity.h>
#include <breakwater/statistics/sensitivity.h>

namespace breakwater {

// Colours: c0, c1, … are the identities' (svg_plot.h), h0 … h23 those of values from small to large
// (data/report/study.css). data-r holds the numbers of runs in the page's list
// of runs that a mark is about, with commas between.

inline constexpr std::size_t kHeatLevels = 24;

/// What a mark of a line stands for.
struct LineMark {
  double x = 0.0;
  double y = std::numeric_limits<double>::quiet_NaN();  ///< NaN: there is none
  double lower = y, upper = y;
  bool has_failures = false;
  std::string text;               ///< all that is known of it, in words
  std::vector<std::size_t> runs;  ///< in the page's list
};

struct LineChart {
  std::string x_title;
  std::string y_title;
  bool is_log_x = false;
  std::vector<double> x;                     ///< of the groups
  std::vector<std::string> x_labels;         ///< written below them; empty: an axis of numbers
  bool is_share = false;                     ///< y from 0 to 1
  std::vector<std::vector<LineMark>> lines;  ///< of each candidate, a mark a group
  std::vector<Identity> looks;               ///< of the lines
};

/// Lines through medians, with bands; crosses below where runs failed.
std::string draw(const LineChart& chart);

struct HeatCell {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::size_t runs = 0;
  std::size_t failed = 0;
  std::size_t measured = 0;        ///< that the value is made of
  std::optional<std::size_t> run;  ///< in the page's list
};

struct HeatMap {
  std::string x_title, y_title;
  std::vector<std::string> x_labels, y_labels;
  std::vector<HeatCell> cells;  ///< x within y
  double low = 0.0, high = 1.0;
  std::string about;  ///< in words, for who does not see it
};

/// Cells coloured by value; a dash below: of runs that did not fail some lack it; a cell of which
/// all runs failed is crossed out, one of which some did has a corner. Where they are few, numbers
/// are in them.
std::string draw(const HeatMap& map);

/// The colours of heat maps and lines with their values.
std::string draw_colour_bar(double low, double high);

struct ParallelAxis {
  std::string title;
  bool is_log = false;
  double low = 0.0, high = 1.0;
  std::vector<std::string> texts;  ///< of 0, 1, …; empty: numbers
};

struct ParallelLine {
  std::vector<double> values;  ///< of each axis; NaN on the last: it failed, or was not measured
  bool failed = false;
  std::size_t run = 0;
};

struct ParallelChart {
  std::vector<ParallelAxis> axes;
  std::vector<ParallelLine> lines;
};

/// A line a run over one axis for each quantity, coloured by the last.
std::string draw(const ParallelChart& chart);

/// 10 to 90 % as a line, the quartiles as a box, the median, in a range that rows share.
std::string draw_box(const QuantileBand& band, Identity look, double low, double high);

/// A first-order and a total index with their intervals, from 0 to 1.
std::string draw_indices(const SensitivityIndex& first_order, const SensitivityIndex& total,
                         Identity look);

}  // namespace breakwater
