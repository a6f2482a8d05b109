// --video: makes the video of a run that has just ended.
#pragma once

#include <filesystem>
#include <string>

namespace breakwater {

/// Calls `program` to make the video of a run in `file` or, if empty, in FOLDER/video.mp4. A
/// separate process protects the run, and simulations need no OpenGL and no encoder. Prints one
/// line if it fails. Returns the exit status of the process.
int make_video(const std::string& program, const std::filesystem::path& folder,
               const std::string& file, bool quiet);

}  // namespace breakwater
