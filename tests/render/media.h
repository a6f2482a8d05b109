// Properties of pictures and videos from external programs and libraries.
#pragma once

#include <cairo.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "shell.h"
#include "support.h"

namespace breakwater::testing {

/// Runs programs in a temporary folder.
class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest() { std::filesystem::create_directories(folder_); }

  /// The output of a command of ours, as a shell reads it.
  std::string ran(const std::string& command) const {
    return output_of("cd " + folder_.string() + " && " + (bin_folder() / command).string());
  }
  void write(const std::string& file, const std::string& text) const {
    std::ofstream(folder_ / file) << text;
  }
  std::string read(const std::string& file) const { return text_of(folder_ / file); }

  const TemporaryPath folder_{"programs"};
};

/// One property of a video's stream, by ffprobe.
inline std::string probe(const std::filesystem::path& video, const std::string& property) {
  std::string text = output_of(
      "ffprobe -v error -count_frames -select_streams v:0 -of csv=p=0 "
      "-show_entries stream=" +
      property + " " + video.string());
  while (!text.empty() && (text.back() == '\n' || text.back() == ',')) text.pop_back();
  return text;
}

/// A PNG file's pixels: blue, green, red, unused.
struct Png {
  int width = 0;
  int height = 0;
  std::vector<unsigned char> pixels;

  explicit Png(const std::filesystem::path& file) {
    cairo_surface_t* image = cairo_image_surface_create_from_png(file.c_str());
    if (cairo_surface_status(image) != CAIRO_STATUS_SUCCESS) {
      cairo_surface_destroy(image);
      throw std::runtime_error(file.string() + " is no PNG");
    }
    width = cairo_image_surface_get_width(image);
    height = cairo_image_surface_get_height(image);
    const unsigned char* data = cairo_image_surface_get_data(image);
    const int stride = cairo_image_surface_get_stride(image);
    for (int y = 0; y < height; ++y) {
      pixels.insert(pixels.end(), data + y * stride, data + y * stride + 4 * width);
    }
    cairo_surface_destroy(image);
  }
};

/// Mean absolute difference of the colours of two pictures, out of 255.
inline double mean_difference(const Png& a, const Png& b) {
  if (a.width != b.width || a.height != b.height) return 255.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    if (i % 4 != 3) sum += std::abs(a.pixels[i] - b.pixels[i]);
  }
  return sum / (0.75 * static_cast<double>(a.pixels.size()));
}

}  // namespace breakwater::testing
