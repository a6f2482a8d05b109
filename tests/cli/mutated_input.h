// The folder of mutants, and the program's response to one of them.
#pragma once

#include "cli/mutants.h"
#include "cli/program.h"
#include "support.h"

namespace breakwater::testing {

constexpr double kAtOnce_s = 1.5 * kSlowness;

class MutatedInput : public ::testing::Test {
 protected:
  MutatedInput() { std::filesystem::create_directories(folder_); }

  std::string write(const Mutant& mutant, std::size_t number = 0) const {
    const std::filesystem::path path = folder_ / (std::to_string(number) + mutant.file);
    std::ofstream(path, std::ios::binary) << mutant.text;
    return path.string();
  }

  // Invalid: one line and exit 2, at once, nothing left behind. Legal: prints the configuration.
  void run_program_on(const Mutant& mutant, std::size_t number = 0) const {
    const std::filesystem::path folder = folder_ / ("cwd" + std::to_string(number));
    std::filesystem::create_directory(folder);
    const std::string path = write(mutant, number);
    std::vector<std::string> arguments = {"breakwater", "run", mutant.scenario};
    if (mutant.option == "--config") {
      arguments.insert(arguments.end(), {"--config", path, "--print-config"});
    } else {
      arguments.insert(arguments.end(), {"--print-config", "--set", mutant.option + "=" + path});
    }
    const ProgramResult result = run_program(arguments, folder);
    const bool is_legal = find_legal(mutant) != nullptr;
    EXPECT_TRUE(result.status == 2 || (is_legal && result.status == 0))
        << mutant.name() << ": " << result.status << ": " << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), result.status == 2 ? 1 : 0)
        << mutant.name() << ": " << result.err;
    EXPECT_EQ(result.out.empty(), result.status == 2) << mutant.name();
    EXPECT_LT(result.seconds, kAtOnce_s) << mutant.name();
    EXPECT_TRUE(std::filesystem::is_empty(folder)) << mutant.name() << ": left something behind";
    std::filesystem::remove_all(folder);
    std::filesystem::remove(path);
  }

  const TemporaryPath folder_{"mutants"};
};

}  // namespace breakwater::testing
