// Runs one of our binaries like a user and collects its results.
#pragma once

#include <nlohmann/json_fwd.hpp>

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

/// A moment in the life of a program: asked while it runs, with its process, until it is true.
using Moment = std::function<bool(int process)>;

/// When a program has used this processor time.
Moment worked_for(double seconds);

/// Runs `arguments` in `folder`. The first one names a binary of build/bin or build/tests. If there
/// is a moment `when`, sends `signal` then.
ProgramResult run_program(const std::vector<std::string>& arguments,
                          const std::filesystem::path& folder, const Moment& when = nullptr,
                          int signal = 0);

/// The result of a program that must succeed. Throws std::runtime_error if it fails.
ProgramResult done(ProgramResult result);

/// Runs programs in a temporary folder.
class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest() { std::filesystem::create_directories(folder_); }

  /// Runs a command. Blanks separate the words, except between '…'.
  ProgramResult run(const std::string& command, const Moment& when = nullptr, int signal = 0) const;
  /// The same, but it must succeed.
  ProgramResult ran(const std::string& command) const { return done(run(command)); }

  /// Expects that a command ends at once with `status`, prints only `line` and leaves nothing. In
  /// the line HERE stands for the test's folder and PROJECT for the project's. A final … allows
  /// more text.
  void expect_refused(const std::string& command, const std::string& line, int status = 2) const;
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
  /// The results in a study's shards, one line each.
  std::vector<std::string> results_in_shards(const std::filesystem::path& study) const;
  /// When a study has at least `count` results.
  Moment has_results(const std::filesystem::path& study, std::size_t count = 1) const;
  /// When a program has made a file or folder.
  Moment has_made_something() const;

  const TemporaryPath folder_{"programs"};
};

}  // namespace breakwater::testing
