#include "scenario/video_later.h"

#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <vector>

#include "scenario/program.h"

namespace breakwater {

int make_video(const std::filesystem::path& folder, const std::string& file, bool quiet) {
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "breakwater";
  std::vector<std::string> words = {program.string(), "video", folder.string()};
  if (!file.empty()) words.insert(words.end(), {"--out", file});
  if (quiet) words.emplace_back("--quiet");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  std::fflush(nullptr);
  pid_t child = 0;
  const int error = posix_spawn(&child, program.c_str(), nullptr, nullptr, argv.data(), environ);
  if (error != 0) {
    fmt::print(stderr, "video: {} cannot be called ({})\n", program.string(), std::strerror(error));
    return kLaterOutputFailed;
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    if (interrupted()) kill(child, SIGTERM);
  }
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  fmt::print(stderr, "video: the program that draws it ended by signal {}; the run is in {}\n",
             WTERMSIG(status), folder.string());
  return kLaterOutputFailed;
}

}  // namespace breakwater
