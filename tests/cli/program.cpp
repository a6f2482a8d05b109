#include "cli/program.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <atomic>
#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "support.h"

namespace breakwater::testing {
ProgramResult run_program(const std::vector<std::string>& arguments,
                          const std::filesystem::path& folder, double kill_after_s, int signal) {
  static std::atomic<int> calls = 0;  // on several threads at once
  const std::string call = std::to_string(++calls);
  const std::filesystem::path out = temporary_path("stdout" + call);
  const std::filesystem::path err = temporary_path("stderr" + call);
  const Removed removed_out(out);
  const Removed removed_err(err);
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
    _exit(127);
  }
  if (kill_after_s > 0.0) {
    std::this_thread::sleep_for(std::chrono::duration<double>(kill_after_s));
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

}  // namespace breakwater::testing
