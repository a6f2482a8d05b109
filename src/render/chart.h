// A strip chart, drawn up to the present time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <breakwater/math/table_function.h>
#include <breakwater/render/canvas.h>
#include <breakwater/render/line_style.h>

namespace breakwater {

struct ChartLine {
  std::string label;
  Series series;
  LineStyle style = 0;
};

/// The ranges of time and values in a chart.
struct ChartRange {
  double from_s = 0.0;
  double to_s = 1.0;
  double lowest = 0.0;
  double highest = 1.0;
};

/// The part of a series from `from_s` to `to_s`, both included.
Series cut(const Series& series, double from_s, double to_s);

/// Reduces a series for drawing. Each of `buckets` equal parts keeps its smallest and largest value
/// with their times, so no peak moves or disappears. The first and last sample stay. A constant
/// stretch keeps only its ends.
Series decimate(const Series& series, std::size_t buckets);

/// The range of all values of the lines in this time, with 0 and a margin.
ChartRange chart_range(const std::vector<ChartLine>& lines, double from_s, double to_s);

/// A chart of fixed size. Its constant parts are drawn once.
class Chart {
 public:
  /// `unit_px` scales text and line widths. It is 1/720 of the height of a usual picture.
  Chart(const std::string& title, std::vector<ChartLine> lines, const ChartRange& range, int width,
        int height, double unit_px);

  /// Draws it with its corner at (left, top): the axes, the lines up to `now_s`, and a dot at the
  /// end of the first one.
  void draw(Canvas& canvas, int left, int top, double now_s);

  /// Adds a vertical mark with a caption: a moment of a strip.
  void mark(double time_s, const std::string& caption);

  /// The place of a point, from the top left corner of the chart.
  Point place(double time_s, double value) const;

 private:
  void draw_frame(const std::string& title);
  double legend_width(double text_size) const;
  void draw_legend(double baseline);

  std::vector<ChartLine> lines_;
  std::vector<Series> drawn_;  // as many points of each line as can be seen
  ChartRange range_;
  double unit_px_;
  std::unique_ptr<Canvas> frame_;
  Rectangle plot_;
};

}  // namespace breakwater
