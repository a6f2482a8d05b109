// The charts of a study: SVG drawings that need no script.
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

// Classes of colours: c0, c1, … for the identities' (svg_plot.h), h0 … h23 for values from small to
// large (data/report/study.css). The attribute data-r lists the runs of a mark: indices into the
// page's list, separated by commas.

inline constexpr std::size_t kHeatLevels = 24;

/// A mark of a line, for one group of runs.
struct LineMark {
  double x = 0.0;
  double y = std::numeric_limits<double>::quiet_NaN();  ///< NaN: no value
  double lower = y, upper = y;
  bool has_failures = false;
  std::string text;               ///< tip with all values in words
  std::vector<std::size_t> runs;  ///< indices into the page's list
};

struct LineChart {
  std::string x_title;
  std::string y_title;
  bool is_log_x = false;
  std::vector<double> x;                     ///< one per group
  std::vector<std::string> x_labels;         ///< labels of the groups; empty: a numeric axis
  bool is_share = false;                     ///< the y axis is from 0 to 1
  std::vector<std::vector<LineMark>> lines;  ///< for each candidate a mark per group
  std::vector<Identity> looks;               ///< one for each line
};

/// Draws lines through medians, with bands. Crosses at the bottom mark failed runs.
std::string draw(const LineChart& chart);

struct HeatCell {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::size_t runs = 0;
  std::size_t failed = 0;
  std::size_t measured = 0;        ///< number of runs behind the value
  std::optional<std::size_t> run;  ///< index into the page's list
};

struct HeatMap {
  std::string x_title, y_title;
  std::vector<std::string> x_labels, y_labels;
  std::vector<HeatCell> cells;  ///< x within y
  double low = 0.0, high = 1.0;
  std::string about;  ///< alternative text
};

/// Draws cells coloured by value. A dash below: some runs lack the value but did not fail. A cross:
/// all runs failed. A corner: some runs failed. If there are few cells, they show numbers.
std::string draw(const HeatMap& map);

/// The colours of heat maps and lines with their values.
std::string draw_colour_bar(double low, double high);

struct ParallelAxis {
  std::string title;
  bool is_log = false;
  double low = 0.0, high = 1.0;
  std::vector<std::string> texts;  ///< labels of 0, 1, …; empty: numbers
};

struct ParallelLine {
  std::vector<double> values;  ///< one per axis; NaN on the last: failed or not measured
  bool failed = false;
  std::size_t run = 0;
};

struct ParallelChart {
  std::vector<ParallelAxis> axes;
  std::vector<ParallelLine> lines;
};

/// Draws a line per run over one axis per quantity. The last quantity gives the colour.
std::string draw(const ParallelChart& chart);

/// Draws 10 to 90 % as a line, the quartiles as a box, and the median, on an axis common to all
/// rows.
std::string draw_box(const QuantileBand& band, Identity look, double low, double high);

/// Draws a first-order and a total index with their intervals, on an axis from 0 to 1.
std::string draw_indices(const SensitivityIndex& first_order, const SensitivityIndex& total,
                         Identity look);

}  // namespace breakwater
