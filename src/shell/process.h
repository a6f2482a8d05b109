// All our programs share this: exit statuses, interruption, errors in one line.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/record/interrupted.h>
#include <breakwater/record/output_error.h>

namespace breakwater {

enum Status {
  kSuccess = 0,
  kDefect = 1,
  kUsage = 2,
  kRunFailed = 3,
  kLaterOutputFailed = 4,
  kInterrupted = 130
};

/// From now on SIGINT, SIGTERM and `more` set interrupted(); a second one ends the process at once.
void stop_on_signals(std::initializer_list<int> more = {});
const std::atomic<bool>& interrupted();
/// The engine's compiler looks for no signal. Once a signal has come, the process ends within two
/// seconds of this saying that the compiler is at work, whichever was first. main() calls this
/// once, at its beginning.
void end_soon_while(bool (*model_is_compiled)());

/// Returns the status to exit with, or nothing if the arguments were taken.
std::optional<int> parse(CLI::App& app, int argc, const char* const* argv);

/// The text with control characters spelt out: what a user gave may hold any.
std::string one_line(const std::string& text);

/// A line each on standard error: `PROGRAM: warning: …`.
void warn(const std::string& program, const std::vector<std::string>& warnings);

/// Calls `body`, which returns a status. Everything that can go wrong becomes one line and a
/// status, standard output that cannot be written too.
int guarded(const std::string& program, const std::function<int()>& body);

}  // namespace breakwater
