// An MP4 file, written frame by frame, and the conversion of a picture's colours for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/record/partial_file.h>

namespace breakwater {

struct VideoFormat {
  int width = 1280;  ///< even
  int height = 720;  ///< even
  int fps = 30;
  std::string encoder = "libx264";
};

/// Writes H.264 in MP4. Browsers can play it before it is fully loaded (faststart). Frame k is
/// shown at k/fps. It is written under a temporary name until finish(). Otherwise nothing is left.
class VideoFile {
 public:
  /// Throws RenderError if FFmpeg's libraries lack the encoder, or OutputError.
  VideoFile(const std::filesystem::path& file, const VideoFormat& format);
  ~VideoFile();
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  /// Appends a frame of a ColourConverter. Throws OutputError if the disk is full.
  void append(const std::uint8_t* frame);
  /// Sets the comment of the file, such as the renderer's name.
  void note(const std::string& comment);
  void finish();

 private:
  struct Streams;

  void encode(const void* frame);
  void check(int status) const;

  PartialFile partial_;
  VideoFormat format_;
  std::int64_t frames_ = 0;
  std::unique_ptr<Streams> streams_;
};

/// The bytes of one frame: planes Y', Cb, Cr. Cb and Cr have half the width and half the height.
std::size_t yuv420p_bytes(int width, int height);

/// Converts R'G'B' of eight bits to Y'CbCr by Rec. ITU-R BT.709-6, limited range. Y' = 0.2126 R' +
/// 0.7152 G' + 0.0722 B' is on 16 … 235. Cb = (B' − Y')/1.8556 and Cr = (R' − Y')/1.5748 are on 16
/// … 240, for the mean of two by two pixels, centred between them. Uses integers of 1/256: Y' is
/// exact to ±1, Cb and Cr to ±2.
class ColourConverter {
 public:
  /// Both must be even.
  ColourConverter(int width, int height);

  /// Converts 4 bytes per pixel (blue, green, red, unused) to yuv420p_bytes(). Allocates nothing.
  void convert(const std::uint8_t* pixels, std::uint8_t* frame);

 private:
  // The colours of a row, one array each.
  struct Row {
    explicit Row(std::size_t width) : blue(width), green(width), red(width) {}
    std::vector<std::uint16_t> blue, green, red;
  };

  std::size_t width_;
  std::size_t height_;
  Row upper_, lower_;
  Row means_;  // for blocks of two by two pixels
};

}  // namespace breakwater
