// The charts of pages.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/pages/html_page.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/render/chart.h>

namespace breakwater {

struct ChartSeries {
  std::string label;
  std::string unit;
  std::string description;
  Series values;
  bool is_off = false;                      ///< hidden at first
  std::optional<LineStyle> style;           ///< its look, if it is the first here with that
  bool has_line = true;                     ///< between the values
  std::string marks;                        ///< at the values: "", "dot" or "cross"
  std::vector<std::string> names = {};      ///< one for each mark, or none
  std::vector<double> low = {}, high = {};  ///< a band around the values, or none
  std::string signal = {};                  ///< its name in a run, or none
};

/// Series over one axis: time, or another quantity.
struct PageChart {
  std::string id;
  std::string group;  ///< charts of one group mark the same moment
  std::string axis;   ///< charts of one axis show the same time window
  std::string title;
  std::vector<ChartSeries> series;
  std::vector<double> lines;     ///< horizontal, dashed
  std::optional<Window> window;  ///< first time window of its axis; default: all
  std::string x_title;           ///< for a quantity that is not time; then all values are in sight
  bool is_log_x = false, is_log_y = false;  ///< the series have decimal logarithms of x, of y
  std::vector<std::pair<double, std::string>> x_labels;  ///< instead of round numbers

  /// The same over logarithmic axes, where positive values extend over decades or is_log_x is set.
  /// A chart with `lines` has a linear y.
  PageChart scaled() const;
  /// "title [unit]", if all series have one.
  std::string axis_title() const;
  /// A description in words.
  std::string alternative_text() const;
  /// The chart for the templates, and in "data" for the script
  /// (docs/explanation/decisions/0023-a-page-is-data.md).
  PageData json() const;
};

/// The smallest and the largest of the numbers; NaN if there is none.
std::pair<double, double> range_of(const std::vector<double>& values);

/// A figure with one chart.
inline PageData figure_of(const PageChart& chart, const std::string& caption = "",
                          const std::string& note = "") {
  PageData figure = {{"charts", PageData::array({chart.json()})}};
  if (!caption.empty()) figure["caption"] = caption;
  if (!note.empty()) figure["note"] = note;
  return figure;
}

}  // namespace breakwater
