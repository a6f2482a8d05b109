// --video: the video of a run that has just been made.
#pragma once

#include <filesystem>
#include <string>

namespace breakwater {

/// Calls `program`, which has the command `video`, to make a run's video, `file` or, if that is
/// empty, FOLDER/video.mp4. In a process of its own: whatever happens there, the run is whole, and
/// programs that only simulate load no OpenGL and no encoder. Prints one line if it fails. Returns
/// its exit status.
int make_video(const std::string& program, const std::filesystem::path& folder,
               const std::string& file, bool quiet);

}  // namespace breakwater
