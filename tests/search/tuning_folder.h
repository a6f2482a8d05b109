// Tunings of the Ishigami function in a temporary folder.
#pragma once

#include "study/sweep_folder.h"

namespace breakwater::testing {

/// Two cases with equal budgets, a constraint on one objective, and a validation.
inline const std::string kTuning = text_of(source_file("tests/search/tuning.toml"));

/// Two generations of one case.
inline const std::string kSmall = text_of(source_file("tests/search/small.toml"));

class TuningFolder : public SweepFolder {
 protected:
  ProgramResult tune(const std::string& words, const Moment& when = nullptr,
                     int signal = SIGKILL) const {
    return run("ishigami_lab tune " + words, when, signal);
  }
  ProgramResult tuned(const std::string& words) const { return done(tune(words)); }
  void expect_same(const std::string& one, const std::string& other) {
    for (const char* file :
         {"results.csv", "front.csv", "hypervolume.csv", "report.html", "front/1.toml"}) {
      EXPECT_NE(read(one + "/" + file), "") << file;
      EXPECT_EQ(read(one + "/" + file), read(other + "/" + file)) << file;
    }
  }
};

}  // namespace breakwater::testing
