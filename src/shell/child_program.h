// Another program, called and waited for.
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace breakwater {

/// The running program, its name ("breakwater", or a user's "door_lab"), and one that stands beside
/// it.
std::string own_program();
std::string own_program_name();
std::string neighbour_program(const std::string& name);

/// A word that a shell takes as it is, whatever is in it.
std::string shell_quoted(const std::string& word);
/// The same, quoted only if it must be: "/tmp/x", "'/tmp/my study'".
std::string shell_word(const std::string& word);

/// Calls a program, words[0] being its path or a name to be found. Returns its exit status. If it
/// cannot be called or a signal ends it, says so on stderr as `WHAT: …` and returns 4. An
/// interruption of ours is passed on to it.
int call_program(const std::string& what, std::vector<std::string> words);

/// A program that runs beside this one, and what it writes to its stdout; words[0] as above.
class ReadProgram {
 public:
  /// With its stderr too, or that is ours; without variables of the environment that `leave_out`
  /// picks by their names. Throws std::invalid_argument `PROGRAM: cannot be called (…)`.
  explicit ReadProgram(std::vector<std::string> words, bool with_stderr = false,
                       bool (*leave_out)(std::string_view name) = nullptr);
  /// Waits for it.
  ~ReadProgram();
  ReadProgram(const ReadProgram&) = delete;
  ReadProgram& operator=(const ReadProgram&) = delete;

  /// The next line without its end; empty if a signal came meanwhile; nothing when it has ended.
  std::optional<std::string> next();
  /// Waits for its end. Returns its status as waitpid() gives it.
  int wait();
  void interrupt() const;

 private:
  pid_t process_ = 0;
  std::optional<int> status_;
  std::unique_ptr<FILE, int (*)(FILE*)> said_{nullptr, std::fclose};
};

}  // namespace breakwater
