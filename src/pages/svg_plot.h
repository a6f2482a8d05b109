// Drawings with axes, as SVG that needs no script: what all charts of pages are drawn by.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/pages/chart_scale.h>
#include <breakwater/render/identity.h>

namespace breakwater {

// Colours and sizes of text are the page's (data/report/page.css, drawn.css): c0, c1, … are the
// identities'. Lengths are in units of the drawing, which are pixels on a phone.

inline constexpr double kLetterWidth = 6.2;

/// Text as XML text or an attribute's value.
std::string xml_text(const std::string& text);

/// A length, with at most one decimal.
std::string px(double value);

/// At most `most` letters, so that it stays in its place.
std::string shortened(const std::string& text, std::size_t most);

/// The classes of an identity's colour and dash.
std::string series_class(Identity identity);

/// Elements: words, in a class of the page's style unless it is empty; a dot.
std::string svg_text(double x, double y, const char* anchor, const std::string& text,
                     const std::string& name = "");
std::string svg_dot(double x, double y);

/// Paths: an oblique cross, and a spot in an identity's shape.
std::string cross_path(double x, double y, double half);
std::string spot_path(double x, double y, Identity identity);

using PlotPoint = std::pair<double, double>;
/// Through points, but for those that are not finite: there it breaks.
std::string line_path(const std::vector<PlotPoint>& points);
/// Around bands from the upper points to the lower ones, where two or more stand side by side.
std::string band_path(const std::vector<PlotPoint>& upper, const std::vector<PlotPoint>& lower);

/// The smallest and largest of values; what is not finite counts for nothing.
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
  /// `kind` is the class that the page's style has for it; `about` says in words what it shows, for
  /// those who do not see it (empty: it is left out for them); `more` are further attributes.
  SvgPlot(const std::string& kind, double width, double height, const std::string& about,
          const std::string& more = "");

  /// Elements that are SVG already.
  void add(const std::string& svg) { svg_ += svg; }
  /// Nothing for an empty path.
  void path(const std::string& name, const std::string& path, const std::string& more = "");
  void text(double x, double y, const char* anchor, const std::string& text,
            const std::string& name = "") {
    svg_ += svg_text(x, y, anchor, text, name);
  }

  /// The left and the lower axis.
  void frame(const PlotArea& area);
  /// Grid lines at round values of y, with the values left of them.
  void y_grid(const PlotArea& area, const ChartScale& y, int count = 5);
  /// The same of x, without the values.
  void x_grid(const PlotArea& area, const ChartScale& x, int count = 5);
  /// Ticks below the area at round values of x, with the values.
  void x_ticks(const PlotArea& area, const ChartScale& x, int count = 5);
  void x_ticks(const PlotArea& area, const std::vector<double>& places,
               const std::vector<std::string>& texts);
  /// Texts side by side, of at most `most` letters; those for which there is no room are left out.
  void texts_below(double y, const std::vector<double>& places,
                   const std::vector<std::string>& texts, std::size_t most);
  void x_title(const PlotArea& area, const std::string& title);
  /// Left of the area, upwards.
  void y_title(const PlotArea& area, const std::string& title);

  std::string svg() const { return svg_ + "</svg>"; }

 private:
  double width_, height_;
  std::string svg_;
};

}  // namespace breakwater
