// Exit statuses, interruption and one-line errors, shared by all programs.
#pragma once

#include <fmt/format.h>

#include <atomic>
#include <cstdio>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/record/interrupted.h>
#include <breakwater/record/output_error.h>

namespace CLI {
class App;
}

namespace breakwater {

enum Status {
  kSuccess = 0,
  kDefect = 1,
  kUsage = 2,
  kRunFailed = 3,
  kLaterOutputFailed = 4,
  kInterrupted = 130
};

/// After this call SIGINT, SIGTERM, SIGHUP and `more` set interrupted(). A second one ends the
/// process, also while a model is compiled, which takes no notice of the first.
void stop_on_signals(std::initializer_list<int> more = {});
const std::atomic<bool>& interrupted();
/// After this call a lack of memory gives one line and a status even where no exception may pass,
/// or outside guarded().
void say_lack_of_memory();

/// Returns the exit status, or nothing if the arguments are correct.
std::optional<int> parse(CLI::App& app, int argc, const char* const* argv);

/// The text with control characters spelt out, since users may give any text.
std::string one_line(const std::string& text);

/// Prints each warning on standard error: `PROGRAM: warning: …`.
void warn(const std::string& program, const std::vector<std::string>& warnings);

/// Calls `body` and returns its status. Every error becomes one line and a status, also a standard
/// output that cannot be written.
int guarded(const std::string& program, const std::function<int()>& body);

}  // namespace breakwater
