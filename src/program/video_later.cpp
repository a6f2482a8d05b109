#include <breakwater/program/video_later.h>

#include <fmt/core.h>

#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>

namespace breakwater {

int make_video(const std::string& program, const std::filesystem::path& folder,
               const std::string& file, bool quiet) {
  if (!std::filesystem::exists(program)) {
    fmt::print(
        stderr,
        "video of the run in {0}: {1}, which draws it, is not there (`./dev build` makes it); "
        "the run is whole, `breakwater video {0}` draws it later\n",
        folder.string(), program);
    return kLaterOutputFailed;
  }
  std::vector<std::string> words = {program, "video", folder.string()};
  if (!file.empty()) words.insert(words.end(), {"--out", file});
  if (quiet) words.emplace_back("--quiet");
  return call_program(fmt::format("video of the run in {}", folder.string()), words);
}

}  // namespace breakwater
