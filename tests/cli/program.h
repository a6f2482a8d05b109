// Runs one of our binaries like a user and collects its results.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <utility>

#include "support.h"

namespace breakwater::testing {

/// A build without optimisation may take longer.
#ifdef NDEBUG
constexpr double kSlowness = 1.0;
#else
constexpr double kSlowness = 5.0;
#endif

struct ProgramResult {
  int status = -1;  ///< exit status, or 128 + the signal that ended it
  std::string out;
  std::string err;
  double seconds = 0.0;  ///< processor time, which other load hardly changes
};

/// Runs `arguments` in `folder`. The first one names a binary of build/bin or build/tests. If
/// `kill_after_s` is positive, sends `signal` after this time.
ProgramResult run_program(const std::vector<std::string>& arguments,
                          const std::filesystem::path& folder, double kill_after_s = 0.0,
                          int signal = 0);

/// The result of a program that must succeed. Throws std::runtime_error if it fails.
ProgramResult done(ProgramResult result);

/// Runs programs in a temporary folder.
class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest() { std::filesystem::create_directories(folder_); }

  /// Runs a command. Blanks separate the words, except between '…'.
  ProgramResult run(const std::string& command, double kill_after_s = 0.0, int signal = 0) const;
  /// The same, but it must succeed.
  ProgramResult ran(const std::string& command) const { return done(run(command)); }

  /// Expects that a command ends at once with status 2, prints only `line` and leaves nothing. In
  /// the line HERE stands for the test's folder and PROJECT for the project's. A final … allows
  /// more text.
  void expect_refused(const std::string& command, const std::string& line) const;
  /// The same for many commands with a common beginning.
  using Refusals = std::vector<std::pair<std::string, std::string>>;
  void expect_refusals(const std::string& beginning, const Refusals& commands_and_lines) const;

  void write(const std::filesystem::path& file, const std::string& text) const;
  std::string read(const std::filesystem::path& file) const { return text_of(folder_ / file); }
  nlohmann::json json(const std::filesystem::path& file) const;
  /// The state hash of a run in the folder.
  std::string state_hash(const std::filesystem::path& run) const;
  std::vector<std::string> lines(const std::filesystem::path& file) const;
  /// All entries of a folder, including hidden and nested ones, in order.
  std::vector<std::string> entries(const std::filesystem::path& folder = "") const;

  const TemporaryPath folder_{"programs"};
};

}  // namespace breakwater::testing
