// Calls other programs and waits for them.
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace breakwater {

/// Starts a copy of this process that calls its program with other words, and returns the copy, or
/// -1 with errno. `output` becomes its stderr. A process whose file is not its program sets it:
/// Python.
inline pid_t (*start_copy)(const std::vector<std::string>& words, int output) = nullptr;

/// The running program, and its name ("breakwater", or a user's).
std::string own_program();
std::string own_program_name();

/// A word that a shell takes literally, with quotes if they are necessary: "/tmp/x", "'/tmp/my
/// study'".
std::string shell_word(const std::string& word);

/// Calls a program. words[0] is its path, or a name to search for. Returns its exit status. If it
/// cannot be called or is ended by a signal, prints `WHAT: …` on stderr and returns 4. An
/// interruption of this process is passed on to it.
int call_program(const std::string& what, std::vector<std::string> words);

/// The words that call a script of the folder scripts/, with the Python BREAKWATER_PYTHON, or with
/// Debian's own, which finds Debian's packages.
std::vector<std::string> script_words(const std::string& script, std::vector<std::string> words);
/// Calls it as call_program() does.
int call_script(const std::string& what, const std::string& script, std::vector<std::string> words);

/// The end of a program: its status from waitpid(), and its lines.
struct EndedProgram {
  int status = 0;
  std::vector<std::string> said;  ///< on stdout and stderr

  std::optional<int> exit_status() const;  ///< nothing if a signal ended it
  /// "signal 9 (Killed)", "status 1"
  std::string end() const;
  /// Whether it caused the signal that ended it. Other signals come from outside: from the system
  /// without memory, a scheduler or a user.
  bool has_crashed() const;
  /// Removes the last line that is not empty, which has the reason of the failure, and returns it.
  std::string take_reason();
  /// Prints the lines on stderr.
  void repeat_said() const;
};

/// Runs a program to its end. words[0] is as above. `look` is called several times a second with
/// its process. When it first returns true, the program is interrupted, only once: a second signal
/// would end it during a run. Throws std::invalid_argument `PROGRAM: cannot be called (…)`.
EndedProgram run_beside(std::vector<std::string> words,
                        const std::function<bool(pid_t process)>& look = nullptr);

}  // namespace breakwater
