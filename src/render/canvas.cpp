#include <breakwater/render/canvas.h>

#include <cairo.h>

#include <cmath>
#include <numbers>

#include <breakwater/record/loaded_library.h>
#include <breakwater/render/render_error.h>

namespace breakwater {
namespace {

struct NoCairo : RenderError {
  explicit NoCairo(const std::string& reason) : RenderError("pictures need Cairo: " + reason) {}
};

const LoadedLibrary& cairo() {
  static const LoadedLibrary library("libcairo.so.2", "libcairo2");
  return library;
}

#define X(name) BREAKWATER_LOADED(cairo, NoCairo, name)
// clang-format off
X(cairo_arc) X(cairo_clip) X(cairo_close_path) X(cairo_create) X(cairo_destroy) X(cairo_fill)
X(cairo_image_surface_create_for_data) X(cairo_line_to) X(cairo_move_to) X(cairo_new_path)
X(cairo_paint) X(cairo_rectangle) X(cairo_restore) X(cairo_save)
X(cairo_select_font_face) X(cairo_set_dash) X(cairo_set_font_size) X(cairo_set_line_join)
X(cairo_set_line_width) X(cairo_set_source_rgba) X(cairo_set_source_surface) X(cairo_show_text)
X(cairo_status) X(cairo_status_to_string) X(cairo_stroke) X(cairo_surface_destroy)
X(cairo_surface_mark_dirty) X(cairo_surface_write_to_png_stream) X(cairo_text_extents)
X(cairo_text_path)
// clang-format on
#undef X

                                    constexpr const char* kFont = "DejaVu Sans";
constexpr Colour kHalo{1.0, 1.0, 1.0, 0.8};

cairo_status_t append(void* text, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

struct Canvas::Drawing {
  Drawing(std::uint8_t* pixels, int width, int height)
      : surface(cairo_image_surface_create_for_data(pixels, CAIRO_FORMAT_RGB24, width, height,
                                                    4 * width)),
        context(cairo_create(surface)) {}
  Drawing(const Drawing&) = delete;
  Drawing& operator=(const Drawing&) = delete;
  ~Drawing() {
    cairo_destroy(context);
    cairo_surface_destroy(surface);
  }

  cairo_surface_t* surface;
  cairo_t* context;
};

Canvas::Canvas(int width, int height)
    : own_(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 255),
      pixels_(own_.data()),
      width_(width),
      height_(height),
      drawing_(std::make_unique<Drawing>(pixels_, width, height)) {}

Canvas::Canvas(std::uint8_t* pixels, int width, int height)
    : pixels_(pixels),
      width_(width),
      height_(height),
      drawing_(std::make_unique<Drawing>(pixels, width, height)) {}

Canvas::~Canvas() = default;

void Canvas::set(const Colour& c) {
  cairo_set_source_rgba(drawing_->context, c.red, c.green, c.blue, c.alpha);
}

void Canvas::fill(const Rectangle& area, const Colour& colour, double corner_radius) {
  cairo_t* const c = drawing_->context;
  const double r = corner_radius;
  const double quarter = std::numbers::pi / 2.0;
  cairo_new_path(c);
  if (r > 0.0) {
    cairo_arc(c, area.right() - r, area.top + r, r, -quarter, 0.0);
    cairo_arc(c, area.right() - r, area.bottom() - r, r, 0.0, quarter);
    cairo_arc(c, area.left + r, area.bottom() - r, r, quarter, 2.0 * quarter);
    cairo_arc(c, area.left + r, area.top + r, r, 2.0 * quarter, 3.0 * quarter);
    cairo_close_path(c);
  } else {
    cairo_rectangle(c, area.left, area.top, area.width, area.height);
  }
  set(colour);
  cairo_fill(c);
}

void Canvas::line(const std::vector<Point>& points, const Colour& colour, double width,
                  const std::vector<double>& dashes) {
  cairo_t* const c = drawing_->context;
  cairo_new_path(c);
  for (const Point& p : points) cairo_line_to(c, p.x, p.y);
  set(colour);
  cairo_set_line_width(c, width);
  cairo_set_line_join(c, CAIRO_LINE_JOIN_BEVEL);
  cairo_set_dash(c, dashes.data(), static_cast<int>(dashes.size()), 0.0);
  cairo_stroke(c);
}

void Canvas::dot(const Point& center, double radius, const Colour& colour) {
  cairo_new_path(drawing_->context);
  cairo_arc(drawing_->context, center.x, center.y, radius, 0.0, 2.0 * std::numbers::pi);
  set(colour);
  cairo_fill(drawing_->context);
}

void Canvas::use_font(double size, bool bold) {
  cairo_select_font_face(drawing_->context, kFont, CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(drawing_->context, size);
}

double Canvas::text_width(const std::string& text, double size, bool bold) {
  use_font(size, bold);
  cairo_text_extents_t extents;
  cairo_text_extents(drawing_->context, text.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::text(const Point& at, const std::string& text, double size, const Colour& colour,
                  Align align, bool bold, bool halo) {
  cairo_t* const c = drawing_->context;
  use_font(size, bold);
  double x = at.x;
  if (align != Align::left) {
    x -= text_width(text, size, bold) * (align == Align::center ? 0.5 : 1.0);
  }
  cairo_new_path(c);
  // Round to whole pixels, so that moving digits do not flicker.
  cairo_move_to(c, std::round(x), std::round(at.y));
  if (halo) {
    cairo_text_path(c, text.c_str());
    set(kHalo);
    cairo_set_line_width(c, 0.25 * size);
    cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
    cairo_set_dash(c, nullptr, 0, 0.0);
    cairo_stroke(c);
    cairo_move_to(c, std::round(x), std::round(at.y));
  }
  set(colour);
  cairo_show_text(c, text.c_str());
  if (cairo_status(c) != CAIRO_STATUS_SUCCESS) {
    throw RenderError(std::string("text cannot be drawn (") +
                      cairo_status_to_string(cairo_status(c)) + ")");
  }
}

void Canvas::clip(const Rectangle& area) {
  cairo_save(drawing_->context);
  cairo_new_path(drawing_->context);
  cairo_rectangle(drawing_->context, area.left, area.top, area.width, area.height);
  cairo_clip(drawing_->context);
}

void Canvas::unclip() {
  cairo_restore(drawing_->context);
}

void Canvas::paste(const Canvas& other, int left, int top) {
  cairo_surface_mark_dirty(other.drawing_->surface);
  cairo_set_source_surface(drawing_->context, other.drawing_->surface, left, top);
  cairo_paint(drawing_->context);
}

std::string Canvas::png() const {
  std::string file;
  cairo_surface_mark_dirty(drawing_->surface);
  cairo_surface_write_to_png_stream(drawing_->surface, append, &file);
  return file;
}

}  // namespace breakwater
