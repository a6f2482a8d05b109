#include "cli/program.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <csignal>

#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

namespace breakwater::testing {
namespace {
namespace fs = std::filesystem;

std::vector<std::string> words_of(const std::string& command) {
  std::vector<std::string> words;
  bool is_quoted = false, is_begun = false;
  for (const char c : command) {
    if (c == ' ' && !is_quoted) {
      is_begun = false;
      continue;
    }
    if (!is_begun) words.emplace_back();
    is_begun = true;
    if (c == '\'') {
      is_quoted = !is_quoted;
    } else {
      words.back() += c;
    }
  }
  return words;
}

}  // namespace

ProgramResult run_program(const std::vector<std::string>& arguments, const fs::path& folder,
                          const Moment& when, int signal) {
  static std::atomic<int> calls = 0;  // used by several threads
  const std::string call = std::to_string(++calls);
  const TemporaryPath out("stdout" + call);
  const TemporaryPath err("stderr" + call);
  const pid_t child = fork();
  if (child == 0) {
    if (chdir(folder.c_str()) != 0) _exit(126);
    dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
    dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
    dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
    std::vector<char*> argv;
    for (const std::string& argument : arguments)
      argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    execv((bin_folder() / arguments[0]).c_str(), argv.data());
    execv((bin_folder() / "../tests" / arguments[0]).c_str(), argv.data());
    _exit(127);
  }
  if (when) {
    siginfo_t ended = {};
    while (waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           ended.si_pid == 0 && !when(child)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    kill(child, signal);
  }
  int status = 0;
  rusage used = {};
  wait4(child, &status, 0, &used);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  ProgramResult result;
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.seconds = seconds(used.ru_utime) + seconds(used.ru_stime);
  result.out = text_of(out);
  result.err = text_of(err);
  return result;
}

ProgramResult done(ProgramResult result) {
  if (result.status == 0) return result;
  throw std::runtime_error("status " + std::to_string(result.status) + ": " + result.err);
}

Moment worked_for(double seconds) {
  return [seconds](int process) {
    clockid_t clock = 0;
    timespec used = {};
    return clock_getcpuclockid(process, &clock) == 0 && clock_gettime(clock, &used) == 0 &&
           static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec) > seconds;
  };
}

ProgramResult ProgramTest::run(const std::string& command, const Moment& when, int signal) const {
  return run_program(words_of(command), folder_, when, signal);
}

void ProgramTest::expect_refused(const std::string& command, const std::string& line,
                                 int status) const {
  const std::vector<std::string> before = entries();
  ProgramResult result = run(command);
  for (const auto& [path, name] :
       {std::pair{folder_.string(), "HERE"}, {source_file(""), "PROJECT/"}}) {
    for (auto at = result.err.find(path); at != std::string::npos; at = result.err.find(path)) {
      result.err.replace(at, path.size(), name);
    }
  }
  const std::string which = command.substr(0, 300);
  EXPECT_EQ(result.status, status) << which;
  if (const std::string more = "…"; line.ends_with(more)) {
    EXPECT_TRUE(result.err.starts_with(line.substr(0, line.size() - more.size()))) << result.err;
    EXPECT_EQ(lines_of(result.err).size(), 1U) << result.err;
  } else {
    EXPECT_EQ(result.err, line + "\n") << which;
  }
  EXPECT_EQ(result.out, "") << which;
  EXPECT_LT(result.seconds, 1.0 * kSlowness) << which;
  EXPECT_EQ(entries(), before) << which << ": something was left behind";
}

void ProgramTest::expect_refusals(const std::string& beginning,
                                  const Refusals& commands_and_lines) const {
  for (const auto& [command, line] : commands_and_lines) expect_refused(beginning + command, line);
}

void ProgramTest::write(const fs::path& file, const std::string& text) const {
  fs::create_directories((folder_ / file).parent_path());
  std::ofstream(folder_ / file, std::ios::binary) << text;
}

nlohmann::json ProgramTest::json(const fs::path& file) const {
  return nlohmann::json::parse(read(file));
}

std::string ProgramTest::state_hash(const fs::path& run) const {
  return json(run / "manifest.json").at("state_hash");
}

std::vector<std::string> ProgramTest::lines(const fs::path& file) const {
  return lines_of(read(file));
}

std::vector<std::string> ProgramTest::entries(const fs::path& folder) const {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / folder)) {
    names.push_back(entry.path().lexically_relative(folder_ / folder).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> ProgramTest::results_in_shards(const fs::path& study) const {
  std::vector<std::string> results;
  const fs::path shards = folder_ / study / "shards";
  if (!fs::exists(shards)) return results;
  for (const auto& entry : fs::directory_iterator(shards)) {
    for (const std::string& line : lines_of(text_of(entry.path()))) {
      const bool is_result = line.find("\tasked\t") != std::string::npos ||
                             line.find("\tpoint\t") != std::string::npos;
      if (is_result) results.push_back(line);
    }
  }
  return results;
}

Moment ProgramTest::has_results(const fs::path& study, std::size_t count) const {
  return [=, this](int /*process*/) { return results_in_shards(study).size() >= count; };
}

Moment ProgramTest::has_made_something() const {
  return [this, before = entries()](int /*process*/) { return entries() != before; };
}

}  // namespace breakwater::testing
