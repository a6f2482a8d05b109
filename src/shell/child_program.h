// Another program, called and waited for.
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <functional>
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
  /// Whether next() has something to give, within so many seconds.
  bool has_news(double seconds) const;
  /// Waits for its end. Returns its status as waitpid() gives it.
  int wait();
  /// Once: a second signal would end it within a run.
  void interrupt();
  pid_t process() const { return process_; }

 private:
  pid_t process_ = 0;
  bool is_interrupted_ = false;
  std::optional<int> status_;
  std::unique_ptr<FILE, int (*)(FILE*)> said_{nullptr, std::fclose};
};

/// How a program ended: its status as waitpid() gives it, and its lines.
struct EndedProgram {
  int status = 0;
  std::vector<std::string> said;  ///< on stdout and stderr

  std::optional<int> exit_status() const;  ///< nothing if a signal ended it
  /// "signal 9 (Killed)", "status 1"
  std::string end() const;
  /// Whether it brought its end upon itself by a signal. Any other signal comes from outside: of
  /// the system that has no memory left, of a scheduler, of somebody.
  bool has_crashed() const;
  /// The last line, which tells why it did not succeed, and is then none of `said`.
  std::string take_reason();
  /// On stderr, as if it had not been read.
  void repeat_said() const;
};

/// Runs a program to its end; `look` is called several times a second.
EndedProgram run_beside(std::vector<std::string> words,
                        const std::function<void(ReadProgram&)>& look);

}  // namespace breakwater
