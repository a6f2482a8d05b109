// A few thousand ill-conditioned quadratic programs with dependent constraints.
#include "linear/hard_qp.h"

namespace breakwater::testing {

TEST(HardQp, FeasibleProblemsAreSolved) {
  expect_hard_feasible_qps_are_solved(4000);
}

TEST(HardQp, InfeasibleProblemsAreProven) {
  expect_hard_infeasible_qps_are_proven(4000);
}

}  // namespace breakwater::testing
