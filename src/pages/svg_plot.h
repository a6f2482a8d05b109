// Drawings with axes as SVG without scripts, for the charts of pages.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/pages/chart_scale.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/render/identity.h>

namespace breakwater {

// Colours and font sizes are in data/report/page.css and drawn.css. The classes c0, c1, … are those
// identities'. the series. The unit of length is a pixel on a phone.

inline constexpr double kLetterWidth = 6.2;

/// Escapes a text for XML text or an attribute.
std::string xml_text(const std::string& text);

/// A length, with at most one decimal.
std::string px(double value);

/// Cuts a text to at most `most` letters.
std::string shortened(const std::string& text, std::size_t most);

/// SVG elements: a text, with a class unless `name` is empty; a dot.
std::string svg_text(double x, double y, const char* anchor, const std::string& text,
                     const std::string& name = "");
std::string svg_dot(double x, double y);

/// SVG paths: an oblique cross; a spot in an identity's shape.
std::string cross_path(double x, double y, double half);
std::string spot_path(double x, double y, Identity identity);

using PlotPoint = std::pair<double, double>;
/// A line through the finite points, with gaps at the others.
std::string line_path(const std::vector<PlotPoint>& points);
/// The outline of the band between upper and lower points, for stretches of two or more points.
std::string band_path(const std::vector<PlotPoint>& upper, const std::vector<PlotPoint>& lower);

/// The smallest and largest of the finite values.
struct PlotRange {
  double low, high;

  PlotRange();
  void add(double value);
  bool is_empty() const { return !(low <= high); }
};

/// A part of a drawing that has its own axes.
struct PlotArea {
  double left, right, top, bottom;
};

class SvgPlot {
 public:
  /// `kind` is the class in the page's style. `about` describes the drawing for screen readers; if
  /// it is empty, they skip the drawing. `more` has further attributes.
  SvgPlot(const std::string& kind, double width, double height, const std::string& about,
          const std::string& more = "");

  /// Adds SVG elements.
  void add(const std::string& svg) { svg_ += svg; }
  /// Adds a path. An empty path adds nothing.
  void path(const std::string& name, const std::string& path, const std::string& more = "");
  void text(double x, double y, const char* anchor, const std::string& text,
            const std::string& name = "") {
    svg_ += svg_text(x, y, anchor, text, name);
  }

  /// Draws the left and the lower axis.
  void frame(const PlotArea& area);
  /// Grid lines at round values of y, with the values on the left.
  void y_grid(const PlotArea& area, const ChartScale& y, int count = 5);
  /// Grid lines at round values of x, without the values.
  void x_grid(const PlotArea& area, const ChartScale& x, int count = 5);
  /// Ticks and values below the area at round values of x.
  void x_ticks(const PlotArea& area, const ChartScale& x, int count = 5);
  void x_ticks(const PlotArea& area, const std::vector<double>& places,
               const std::vector<std::string>& texts);
  /// Texts side by side, cut to `most` letters. Texts without enough room are left out.
  void texts_below(double y, const std::vector<double>& places,
                   const std::vector<std::string>& texts, std::size_t most);
  void x_title(const PlotArea& area, const std::string& title);
  /// Left of the area, rotated upwards.
  void y_title(const PlotArea& area, const std::string& title);

  std::string svg() const { return svg_ + "</svg>"; }

 private:
  double width_, height_;
  std::string svg_;
};

}  // namespace breakwater
