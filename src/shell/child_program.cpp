#include <breakwater/shell/child_program.h>

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <breakwater/shell/paths.h>
#include <breakwater/shell/process.h>
#include <breakwater/signals/environment.h>

namespace breakwater {
namespace {

// Starts a program, and returns its process. `output` becomes the end of a pipe with its stdout and
// stderr.
pid_t start(std::vector<std::string> words, int& output) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t process = 0;
  int ends[2];
  int error = pipe2(ends, O_CLOEXEC) == 0 ? 0 : errno;
  if (error == 0) {
    std::fflush(nullptr);
    if (start_copy != nullptr && words[0] == own_program()) {
      process = start_copy(words, ends[1]);
      if (process < 0) error = errno;
    } else {
      posix_spawn_file_actions_t actions;
      posix_spawn_file_actions_init(&actions);
      posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
      posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
      error = posix_spawnp(&process, argv[0], &actions, nullptr, argv.data(), environ);
      posix_spawn_file_actions_destroy(&actions);
    }
    close(ends[1]);
    if (error != 0) close(ends[0]);
  }
  if (error != 0) {
    throw std::invalid_argument(
        fmt::format("{}: cannot be called ({})", words[0], std::strerror(error)));
  }
  output = ends[0];
  return process;
}

}  // namespace

std::string own_program() {
  return std::filesystem::read_symlink("/proc/self/exe").string();
}

std::string own_program_name() {
  if (start_copy != nullptr) return "breakwater";
  return std::filesystem::path(own_program()).filename().string();
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

std::vector<std::string> script_words(const std::string& script, std::vector<std::string> words) {
  words.insert(words.begin(), {environment("BREAKWATER_PYTHON").value_or("/usr/bin/python3"),
                               data_file("scripts/" + script).string()});
  return words;
}

int call_script(const std::string& what, const std::string& script,
                std::vector<std::string> words) {
  return call_program(what, script_words(script, std::move(words)));
}

std::optional<int> EndedProgram::exit_status() const {
  return WIFEXITED(status) ? std::optional(WEXITSTATUS(status)) : std::nullopt;
}

std::string EndedProgram::end() const {
  if (const auto exited = exit_status()) return fmt::format("status {}", *exited);
  return fmt::format("signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
}

bool EndedProgram::has_crashed() const {
  constexpr std::array kCrashes = {SIGSEGV, SIGABRT, SIGFPE, SIGILL, SIGBUS, SIGTRAP, SIGSYS};
  return WIFSIGNALED(status) && std::ranges::find(kCrashes, WTERMSIG(status)) != kCrashes.end();
}

std::string EndedProgram::take_reason() {
  while (!said.empty() && said.back().empty()) said.pop_back();
  if (said.empty()) return end();
  std::string reason = std::move(said.back());
  said.pop_back();
  return reason;
}

void EndedProgram::repeat_said() const {
  for (const std::string& line : said) fmt::print(stderr, "{}\n", line);
}

EndedProgram run_beside(std::vector<std::string> words,
                        const std::function<bool(pid_t process)>& look) {
  constexpr int kLooks_ms = 100;
  int output = -1;
  const pid_t process = start(std::move(words), output);
  EndedProgram ended;
  const auto wait = [&] {
    close(output);
    while (waitpid(process, &ended.status, 0) < 0 && errno == EINTR) continue;
  };
  bool is_interrupted = false;
  std::string text;
  try {
    for (bool goes_on = true; goes_on;) {
      pollfd news = {output, POLLIN, 0};
      if (poll(&news, 1, kLooks_ms) > 0) {
        char part[4096];
        const ssize_t length = read(output, part, sizeof part);
        goes_on = length > 0 || (length < 0 && errno == EINTR);
        if (length > 0) text.append(part, static_cast<std::size_t>(length));
      }
      if (look && look(process) && !std::exchange(is_interrupted, true)) kill(process, SIGTERM);
    }
  } catch (...) {
    wait();
    throw;
  }
  wait();
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) ended.said.push_back(line);
  return ended;
}

std::string shell_word(const std::string& word) {
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::strchr("/._-+:@%,=", c) != nullptr;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace breakwater
