// Text and lines on top of a picture.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace breakwater {

struct Colour {
  double red = 0.0;
  double green = 0.0;
  double blue = 0.0;
  double alpha = 1.0;
};

/// A point in pixels from the left and the top.
struct Point {
  double x = 0.0;
  double y = 0.0;
};

struct Rectangle {
  double left = 0.0;
  double top = 0.0;
  double width = 0.0;
  double height = 0.0;

  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

enum class Align { left, center, right };

/// Draws with Cairo on a picture of 4 bytes per pixel (blue, green, red, unused).
class Canvas {
 public:
  /// Makes a white picture of its own. Both constructors throw RenderError if there is no Cairo.
  Canvas(int width, int height);
  /// Draws on a picture that must outlive it.
  Canvas(std::uint8_t* pixels, int width, int height);
  ~Canvas();

  int width() const { return width_; }
  int height() const { return height_; }
  std::uint8_t* pixels() { return pixels_; }

  void fill(const Rectangle& area, const Colour& colour, double corner_radius = 0.0);
  void line(const std::vector<Point>& points, const Colour& colour, double width,
            const std::vector<double>& dashes = {});
  void dot(const Point& center, double radius, const Colour& colour);

  /// Draws text with its baseline at `at.y`. `halo` adds a light rim, for text on a picture.
  /// Throws RenderError if the font cannot be read.
  void text(const Point& at, const std::string& text, double size, const Colour& colour,
            Align align = Align::left, bool bold = false, bool halo = false);
  double text_width(const std::string& text, double size, bool bold = false);

  /// Limits drawing to `area` until unclip().
  void clip(const Rectangle& area);
  void unclip();

  /// Copies the picture of another canvas, with its top left corner at a whole pixel.
  void paste(const Canvas& other, int left, int top);

  /// The bytes of a PNG file.
  std::string png() const;

 private:
  struct Drawing;  // Cairo draws with it. The first canvas loads Cairo.

  void use_font(double size, bool bold);
  void set(const Colour& colour);

  std::vector<std::uint8_t> own_;
  std::uint8_t* pixels_;
  int width_;
  int height_;
  std::unique_ptr<Drawing> drawing_;
};

}  // namespace breakwater
