#include <breakwater/pictures/video_later.h>

#include <fmt/core.h>

#include <breakwater/scenario/child_program.h>

namespace breakwater {

int make_video(const std::string& program, const std::filesystem::path& folder,
               const std::string& file, bool quiet) {
  std::vector<std::string> words = {program, "video", folder.string()};
  if (!file.empty()) words.insert(words.end(), {"--out", file});
  if (quiet) words.emplace_back("--quiet");
  return call_program(fmt::format("video of the run in {}", folder.string()), words);
}

}  // namespace breakwater
