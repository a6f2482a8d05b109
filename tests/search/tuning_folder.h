// Tunings of the Ishigami function in a temporary folder.
#pragma once

#include "study/sweep_folder.h"

namespace breakwater::testing {

/// Two cases with equal budgets, a constraint on one objective, and a validation.
inline constexpr const char* kTuning = R"(
scenario = "ishigami"
budget = 64
population = 8
seeds = { first = 1, count = 2 }
[for_each.plain]
[for_each.noisy]
"x.third" = { uniform = [0, 1] }
[search]
"x.first" = { uniform = [-3, 3] }
"x.second" = { uniform = [-1, 3] }
[objective]
y_1 = { goal = "min", over = "worst", reference = 20 }
positive_x_second_1 = { goal = "max", reference = 0 }
[constraint]
y_1 = { max = 8 }
[validate]
seeds = { first = 101, count = 6 }
points = 3
)";

/// Two generations of one case.
inline constexpr const char* kSmall = R"(
scenario = "ishigami"
budget = 16
population = 8
[search]
"x.first" = { uniform = [-3, 3] }
"x.second" = { uniform = [-1, 3] }
[objective]
y_1 = { goal = "min" }
positive_x_second_1 = { goal = "max" }
)";

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
