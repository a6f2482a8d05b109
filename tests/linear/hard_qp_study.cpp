// 1e5 ill-conditioned quadratic programs with dependent constraints.
#include "linear/hard_qp.h"

namespace breakwater::testing {

TEST(HardQpStudy, FeasibleProblemsAreSolved) {
  expect_hard_feasible_qps_are_solved(100000);
}

TEST(HardQpStudy, InfeasibleProblemsAreProven) {
  expect_hard_infeasible_qps_are_proven(100000);
}

}  // namespace breakwater::testing
