// What all our programs do alike: exit statuses, interruption, errors in one line.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <breakwater/record/output_error.h>
#include <breakwater/scenario/scenario.h>

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

/// Returns the status to exit with, or nothing if the arguments were taken.
std::optional<int> parse(CLI::App& app, int argc, const char* const* argv);

/// The text with control characters spelt out: what a user gave may hold any.
std::string one_line(const std::string& text);

/// A line each on standard error: `PROGRAM: warning: …`.
void warn(const std::string& program, const std::vector<std::string>& warnings);

/// Says that the log is longer than memory can hold.
int out_of_memory();

/// Calls `body`, which returns a status. Everything that can go wrong becomes one line and a
/// status.
template <typename Body>
int guarded(const std::string& program, Body&& body) {
  try {
    return body();
  } catch (const std::invalid_argument& error) {
    fmt::print(stderr, "{}\n", one_line(error.what()));
    return kUsage;
  } catch (const OutputError& error) {
    fmt::print(stderr, "{}\n", one_line(error.what()));
    return kUsage;
  } catch (const std::filesystem::filesystem_error& error) {
    fmt::print(stderr, "{}: {}\n", one_line(error.path1().string()), error.code().message());
    return kUsage;
  } catch (const std::length_error&) {
    return out_of_memory();
  } catch (const std::bad_alloc&) {
    return out_of_memory();
  } catch (const Interrupted& stop) {
    const std::size_t kept = stop.finished_runs();
    fmt::print(stderr, "{}: interrupted; {}\n", program,
               kept == 0
                   ? "nothing is left behind"
                   : fmt::format("{} finished run{} kept", kept, kept == 1 ? " is" : "s are"));
    return kInterrupted;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: this is a defect of Breakwater, or of a part of your own: {}\n",
               program, one_line(error.what()));
    return kDefect;
  }
}

}  // namespace breakwater
