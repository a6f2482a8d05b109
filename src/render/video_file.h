// An MP4 file, written frame by frame.
#pragma once

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

}  // namespace breakwater
