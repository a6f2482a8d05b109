// What all our programs do alike: exit statuses, interruption, errors in one line.
#pragma once

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>

#include "record/output_error.h"
#include "scenario/scenario.h"

namespace breakwater {

enum Status {
  kSuccess = 0,
  kDefect = 1,
  kUsage = 2,
  kRunFailed = 3,
  kLaterOutputFailed = 4,
  kInterrupted = 130
};

/// From now on SIGINT and SIGTERM set interrupted(); a second one ends the process at once.
void stop_on_signals();
const std::atomic<bool>& interrupted();

/// Returns the status to exit with, or nothing if the arguments were taken.
std::optional<int> parse(CLI::App& app, int argc, const char* const* argv);

/// Calls `body`, which returns a status. Everything that can go wrong becomes one line and a
/// status.
template <typename Body>
int guarded(const std::string& program, Body&& body) {
  try {
    return body();
  } catch (const std::invalid_argument& error) {
    fmt::print(stderr, "{}\n", error.what());
    return kUsage;
  } catch (const OutputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return kUsage;
  } catch (const Interrupted&) {
    fmt::print(stderr, "{}: interrupted; nothing is left behind\n", program);
    return kInterrupted;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: this is a defect of Breakwater: {}\n", program, error.what());
    return kDefect;
  }
}

}  // namespace breakwater
