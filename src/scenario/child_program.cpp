#include <breakwater/scenario/child_program.h>

#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>

#include <breakwater/scenario/process.h>

namespace breakwater {

std::string own_program() {
  return std::filesystem::read_symlink("/proc/self/exe").string();
}

std::string own_program_name() {
  return std::filesystem::path(own_program()).filename().string();
}

std::string neighbour_program(const std::string& name) {
  return (std::filesystem::path(own_program()).parent_path() / name).string();
}

int call_program(const std::string& what, std::vector<std::string> words) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  std::fflush(nullptr);
  pid_t child = 0;
  const int error = posix_spawnp(&child, argv[0], nullptr, nullptr, argv.data(), environ);
  if (error != 0) {
    fmt::print(stderr, "{}: {} cannot be called ({})\n", what, words[0], std::strerror(error));
    return kLaterOutputFailed;
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    if (interrupted()) kill(child, SIGTERM);
  }
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  fmt::print(stderr, "{}: {} ended by signal {}\n", what, words[0], WTERMSIG(status));
  return kLaterOutputFailed;
}

}  // namespace breakwater
