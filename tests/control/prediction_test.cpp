#include <breakwater/control/lmpc.h>

#include "support.h"

namespace breakwater {
namespace {

TEST(Prediction, EqualsSteppingThePlant) {
  testing::Random random;
  for (int k = 0; k < 30; ++k) {
    const Eigen::Index n = 1 + k % 4;
    const Eigen::Index m = 1 + k % 2;
    const int N_p = 1 + k % 12;
    const int N_u = 1 + (k * 7) % N_p;
    const Eigen::MatrixXd A = random.matrix(n, n);
    const Eigen::MatrixXd B = random.matrix(n, m);
    const Eigen::VectorXd x = random.vector(n);
    const Eigen::VectorXd last_input = random.vector(m);
    const Eigen::VectorXd changes = random.vector(N_u * m);
    const Prediction p = predict(A, B, N_p, N_u);
    const Eigen::VectorXd predicted = p.Psi * x + p.Gamma * last_input + p.Theta * changes;

    Eigen::VectorXd state = x;
    Eigen::VectorXd input = last_input;
    for (int i = 0; i < N_p; ++i) {
      if (i < N_u) input += changes.segment(i * m, m);
      state = A * state + B * input;
      EXPECT_LT((predicted.segment(i * n, n) - state).norm(), 1e-10 * (1.0 + state.norm()));
    }
  }
}

TEST(Prediction, RefusesAnEmptyHorizon) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  EXPECT_THROW(predict(one, one, 0, 1), std::invalid_argument);
  EXPECT_THROW(predict(one, one, 1, 0), std::invalid_argument);
  EXPECT_THROW(predict(one, one, 2, 3), std::invalid_argument);
  EXPECT_THROW(predict(Eigen::MatrixXd::Ones(2, 1), one, 2, 2), std::invalid_argument);
  EXPECT_NO_THROW(predict(one, one, 2, 2));
}

}  // namespace
}  // namespace breakwater
