// An MP4 file, written frame by frame.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <breakwater/record/partial_file.h>

namespace breakwater {

struct VideoFormat {
  int width = 1280;  ///< even
  int height = 720;  ///< even
  int fps = 30;
};

/// Writes H.264 in MP4, by the program ffmpeg. Browsers can play it before it is fully loaded
/// (faststart). Frame k is shown at k/fps. The colours R'G'B' of eight bits become Y'CbCr of Rec.
/// ITU-R BT.709-6, limited range, 4:2:0. It is written under a temporary name until finish().
/// Otherwise nothing is left.
class VideoFile {
 public:
  /// From now on this process ignores SIGPIPE. Throws RenderError if there is no ffmpeg, or
  /// OutputError.
  VideoFile(const std::filesystem::path& file, const VideoFormat& format);
  ~VideoFile();
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  /// Appends a picture of 4 bytes per pixel (blue, green, red, unused). A forked process may do it.
  /// Throws OutputError if ffmpeg has ended; end() then throws its reason.
  void append(const std::uint8_t* pixels);
  /// Waits for ffmpeg. Throws OutputError, such as for a full disk.
  void end();
  /// The same, and gives the file its name.
  void finish();

 private:
  int wait();

  PartialFile partial_;
  std::size_t frame_bytes_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> said_;  // by ffmpeg, if something is wrong
  pid_t ffmpeg_ = 0;
  int input_ = -1;  // ffmpeg's stdin
};

}  // namespace breakwater
