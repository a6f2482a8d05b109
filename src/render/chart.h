// A strip chart that is drawn up to the present.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <breakwater/record/series.h>
#include <breakwater/render/canvas.h>
#include <breakwater/render/identity.h>

namespace breakwater {

struct ChartLine {
  std::string label;
  Series series;
  Identity identity = 0;
};

/// What of time and values a chart shows.
struct ChartRange {
  double from_s = 0.0;
  double to_s = 1.0;
  double lowest = 0.0;
  double highest = 1.0;
};

/// The range that holds all of the lines' values of that time, 0 included, and some room.
ChartRange chart_range(const std::vector<ChartLine>& lines, double from_s, double to_s);

/// One chart of one size. What does not change is drawn once.
class Chart {
 public:
  /// `unit_px`: the height that text and line widths follow, 1/720 of a picture of usual size.
  Chart(const std::string& title, std::vector<ChartLine> lines, const ChartRange& range, int width,
        int height, double unit_px);

  /// Draws it at a corner: all axes, the lines up to `now_s`, a dot on the first line's end.
  void draw(Canvas& canvas, int left, int top, double now_s);

  /// Vertical marks with captions: the moments of a strip.
  void mark(double time_s, const std::string& caption);

  /// Where a point is, from the chart's own top left corner.
  Point place(double time_s, double value) const;

 private:
  void draw_frame(const std::string& title);
  double legend_width(double text_size) const;
  void draw_legend(double baseline);
  std::vector<Point> trace(const ChartLine& line, double now_s) const;

  std::vector<ChartLine> lines_;
  ChartRange range_;
  double unit_px_;
  std::unique_ptr<Canvas> frame_;
  Rectangle plot_;
};

}  // namespace breakwater
