// Studies as users make them, in a folder of the test's own.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "cli/program.h"
#include "support.h"

namespace breakwater::testing {

class SweepFolder : public ::testing::Test {
 protected:
  SweepFolder() { std::filesystem::create_directories(folder_); }

  /// `sweep` of the Ishigami function's program.
  ProgramResult sweep(std::vector<std::string> arguments, double kill_after_s = 0.0,
                      int signal = 0) {
    arguments.insert(arguments.begin(), {ISHIGAMI_LAB, "sweep"});
    return run_program(arguments, folder_, kill_after_s, signal);
  }
  /// A program of build/bin, or the Ishigami function's.
  ProgramResult run(const std::vector<std::string>& arguments) {
    return run_program(arguments, folder_);
  }
  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
  }
  std::string read(const std::string& name) const { return text_of(folder_ / name); }
  std::vector<std::string> lines(const std::string& name) const {
    std::istringstream stream(read(name));
    std::vector<std::string> all;
    for (std::string line; std::getline(stream, line);) all.push_back(line);
    return all;
  }
  /// The cells of a table in a study's folder, cut at every comma.
  std::vector<std::vector<std::string>> results(const std::string& study,
                                                const std::string& table = "results.csv") const {
    std::vector<std::vector<std::string>> rows;
    for (const std::string& line : lines(study + "/" + table)) {
      std::vector<std::string> cells(1);
      for (const char c : line) {
        if (c == ',') {
          cells.emplace_back();
        } else {
          cells.back() += c;
        }
      }
      rows.push_back(cells);
    }
    return rows;
  }

  /// Runs a study, kills it `kills` times at random moments, and goes on each time; then to its
  /// end.
  void run_and_kill(const std::vector<std::string>& arguments, int kills, double longest_s,
                    unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> moment(0.0, longest_s);
    for (int i = 0; i < kills; ++i) sweep(arguments, 0.001 + moment(random), SIGKILL);
    const ProgramResult last = sweep(arguments);
    ASSERT_EQ(last.status, 0) << last.err;
  }

  std::filesystem::path folder_ = temporary_path("sweep");
  Removed removed_{folder_};
};

}  // namespace breakwater::testing
