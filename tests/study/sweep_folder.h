// Studies in a temporary folder.
#pragma once

#include <csignal>

#include "cli/program.h"

namespace breakwater::testing {

class SweepFolder : public ProgramTest {
 protected:
  /// `sweep` of the Ishigami function's program.
  ProgramResult sweep(const std::string& words, const Moment& when = nullptr,
                      int signal = 0) const {
    return run("ishigami_lab sweep " + words, when, signal);
  }
  /// The same, but it must succeed.
  ProgramResult swept(const std::string& words) const { return done(sweep(words)); }

  /// The cells of a table in a study's folder, split at every comma.
  std::vector<std::vector<std::string>> results(const std::string& study,
                                                const std::string& table = "results.csv") const {
    std::vector<std::vector<std::string>> rows;
    for (const std::string& line : lines(study + "/" + table)) {
      rows.emplace_back(1);
      for (const char c : line) {
        if (c == ',') {
          rows.back().emplace_back();
        } else {
          rows.back().back() += c;
        }
      }
    }
    return rows;
  }

  /// Runs a study and kills it `kills` times at random moments, then completes it.
  void run_and_kill(const std::string& words, int kills, double longest_s, unsigned seed) const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> moment(0.0, longest_s);
    for (int i = 0; i < kills; ++i) sweep(words, worked_for(moment(random)), SIGKILL);
    swept(words);
  }
};

}  // namespace breakwater::testing
