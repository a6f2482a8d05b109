// Runs one of our binaries as a user would, and sees what it does.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <utility>

#include "support.h"

namespace breakwater::testing {

/// What is not optimised may take longer.
#ifdef NDEBUG
constexpr double kSlowness = 1.0;
#else
constexpr double kSlowness = 5.0;
#endif

struct ProgramResult {
  int status = -1;  ///< exit status, or 128 + the signal that ended it
  std::string out;
  std::string err;
  double seconds = 0.0;  ///< of processor time: a loaded machine changes it little
};

/// Runs `arguments` (the first names a binary of build/bin, or else of build/tests) in `folder`.
/// After `kill_after_s`, if positive, sends it `signal`.
ProgramResult run_program(const std::vector<std::string>& arguments,
                          const std::filesystem::path& folder, double kill_after_s = 0.0,
                          int signal = 0);

/// The result of a program that must succeed. Throws std::runtime_error if it has not.
ProgramResult done(ProgramResult result);

/// Programs in a folder of the test's own.
class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest() { std::filesystem::create_directories(folder_); }

  /// Runs the words of a command, which blanks part but between '…'.
  ProgramResult run(const std::string& command, double kill_after_s = 0.0, int signal = 0) const;
  /// The same where it must succeed.
  ProgramResult ran(const std::string& command) const { return done(run(command)); }

  /// A command must end at once with status 2 and `line` alone, and leave nothing. The line says
  /// HERE for the test's folder and PROJECT for the project's; where it ends with … more follows.
  void expect_refused(const std::string& command, const std::string& line) const;
  /// The same of many, behind what all begin with.
  using Refusals = std::vector<std::pair<std::string, std::string>>;
  void expect_refusals(const std::string& beginning, const Refusals& commands_and_lines) const;

  void write(const std::filesystem::path& file, const std::string& text) const;
  std::string read(const std::filesystem::path& file) const { return text_of(folder_ / file); }
  nlohmann::json json(const std::filesystem::path& file) const;
  /// The state hash of a run in it.
  std::string state_hash(const std::filesystem::path& run) const;
  std::vector<std::string> lines(const std::filesystem::path& file) const;
  /// All that is in a folder of it, hidden files and what folders hold too, in order.
  std::vector<std::string> entries(const std::filesystem::path& folder = "") const;

  const TemporaryPath folder_{"programs"};
};

}  // namespace breakwater::testing
