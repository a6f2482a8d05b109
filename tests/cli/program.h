// Runs one of our binaries as a user would, and sees what it does.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

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

/// Runs `arguments` (the first names a binary of build/bin) in `folder`. After `kill_after_s`, if
/// positive, sends it `signal`.
ProgramResult run_program(const std::vector<std::string>& arguments,
                          const std::filesystem::path& folder, double kill_after_s = 0.0,
                          int signal = 0);

}  // namespace breakwater::testing
