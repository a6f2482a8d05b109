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
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <breakwater/shell/paths.h>
#include <breakwater/shell/process.h>
#include <breakwater/signals/environment.h>

namespace breakwater {

std::string own_program() {
  return std::filesystem::read_symlink("/proc/self/exe").string();
}

std::string own_program_name() {
  if (start_copy != nullptr) return "breakwater";
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

std::vector<std::string> script_words(const std::string& script, std::vector<std::string> words) {
  words.insert(words.begin(), {environment("BREAKWATER_PYTHON").value_or("/usr/bin/python3"),
                               data_file("scripts/" + script).string()});
  return words;
}

int call_script(const std::string& what, const std::string& script,
                std::vector<std::string> words) {
  return call_program(what, script_words(script, std::move(words)));
}

ReadProgram::ReadProgram(std::vector<std::string> words, bool with_stderr) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  int ends[2];
  int error = pipe2(ends, O_CLOEXEC) == 0 ? 0 : errno;
  if (error == 0 && start_copy != nullptr && words[0] == own_program()) {
    std::fflush(nullptr);
    process_ = start_copy(words, ends[1]);
    if (process_ < 0) error = errno;
    close(ends[1]);
    said_.reset(fdopen(ends[0], "r"));
  } else if (error == 0) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    if (with_stderr) posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    std::fflush(nullptr);
    error = posix_spawnp(&process_, argv[0], &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    said_.reset(fdopen(ends[0], "r"));
  }
  if (error != 0) {
    status_ = 0;
    throw std::invalid_argument(
        fmt::format("{}: cannot be called ({})", words[0], std::strerror(error)));
  }
}

ReadProgram::~ReadProgram() {
  wait();
}

std::optional<std::string> ReadProgram::next() {
  char* line = nullptr;
  std::size_t size = 0;
  errno = 0;
  const ssize_t length = getline(&line, &size, said_.get());
  const std::unique_ptr<char, void (*)(void*)> owner(line, std::free);
  if (length < 0 && errno == EINTR) {
    std::clearerr(said_.get());
    return "";
  }
  if (length <= 0) return std::nullopt;
  const bool has_end = line[length - 1] == '\n';
  return std::string(line, static_cast<std::size_t>(has_end ? length - 1 : length));
}

bool ReadProgram::has_news(double seconds) const {
  pollfd said = {fileno(said_.get()), POLLIN, 0};
  return poll(&said, 1, static_cast<int>(1000.0 * seconds)) > 0;
}

int ReadProgram::wait() {
  if (status_) return *status_;
  said_.reset();
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) continue;
  status_ = status;
  return status;
}

void ReadProgram::interrupt() {
  if (!std::exchange(is_interrupted_, true)) kill(process_, SIGTERM);
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
  return WIFSIGNALED(status) &&
         std::find(kCrashes.begin(), kCrashes.end(), WTERMSIG(status)) != kCrashes.end();
}

std::string EndedProgram::take_reason() {
  if (said.empty()) return end();
  std::string reason = std::move(said.back());
  said.pop_back();
  return reason;
}

void EndedProgram::repeat_said() const {
  for (const std::string& line : said) fmt::print(stderr, "{}\n", line);
}

EndedProgram run_beside(std::vector<std::string> words,
                        const std::function<void(ReadProgram&)>& look) {
  constexpr double kLooks_s = 0.1;
  ReadProgram program(std::move(words), true);
  EndedProgram ended;
  for (bool goes_on = true; goes_on;) {
    if (program.has_news(kLooks_s)) {
      const auto line = program.next();
      goes_on = line.has_value();
      if (line && !line->empty()) ended.said.push_back(*line);
    }
    look(program);
  }
  ended.status = program.wait();
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
