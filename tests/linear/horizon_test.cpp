#include <breakwater/linear/active_set.h>
#include <breakwater/linear/horizon.h>
#include "support.h"

namespace breakwater::horizon_test {

using testing::Random;

// A stable plant with weights and constraints of every kind.
Horizon random_horizon(Random& random, Eigen::Index n, int prediction_steps, int control_steps) {
  Horizon horizon;
  horizon.A = random.matrix(n, n);
  horizon.A *= 0.95 / horizon.A.norm();
  horizon.B = random.matrix(n, 1);
  horizon.prediction_steps = prediction_steps;
  horizon.control_steps = control_steps;
  const Eigen::MatrixXd root = random.matrix(n, n);
  horizon.Q = root * root.transpose();
  horizon.Q_last = 3.0 * horizon.Q;
  horizon.R = Eigen::MatrixXd::Constant(1, 1, random.uniform(0.1, 1.0));
  horizon.S = Eigen::MatrixXd::Constant(1, 1, random.uniform(0.1, 1.0));
  for (int i = 0; i < control_steps; ++i) {
    horizon.rows.push_back({Horizon::RowKind::change, i, 0});
    horizon.rows.push_back({Horizon::RowKind::input, i, 0});
  }
  for (int i = 1; i <= prediction_steps; i += 2) {
    horizon.rows.push_back({Horizon::RowKind::state, i, i % n});
  }
  return horizon;
}

struct Trajectory {
  Eigen::VectorXd inputs;  // control steps
  Eigen::MatrixXd states;  // x_1, …, one per column
};

// Simulates the plant step by step.
Trajectory simulate(const Horizon& horizon, Eigen::VectorXd x, double u,
                    const Eigen::VectorXd& changes) {
  Trajectory trajectory{Eigen::VectorXd(horizon.control_steps),
                        Eigen::MatrixXd(horizon.A.rows(), horizon.prediction_steps)};
  for (int i = 0; i < horizon.prediction_steps; ++i) {
    if (i < horizon.control_steps) trajectory.inputs(i) = u += changes(i);
    trajectory.states.col(i) = x = horizon.A * x + horizon.B * u;
  }
  return trajectory;
}

// H and Ω from trajectories of unit changes.
QpModel dense_model(const Horizon& horizon) {
  const Eigen::Index N = horizon.control_steps;
  QpModel model{Eigen::MatrixXd::Identity(N, N) * horizon.R(0, 0),
                QpModel::RowMajor(static_cast<Eigen::Index>(horizon.rows.size()), N)};
  std::vector<Trajectory> units;
  for (Eigen::Index j = 0; j < N; ++j) {
    units.push_back(simulate(horizon, Eigen::VectorXd::Zero(horizon.A.rows()), 0.0,
                             Eigen::VectorXd::Unit(N, j)));
  }
  for (Eigen::Index j = 0; j < N; ++j) {
    const Trajectory& a = units[static_cast<std::size_t>(j)];
    for (Eigen::Index k = 0; k < N; ++k) {
      const Trajectory& b = units[static_cast<std::size_t>(k)];
      model.H(j, k) += horizon.S(0, 0) * a.inputs.dot(b.inputs);
      for (int i = 0; i < horizon.prediction_steps; ++i) {
        const Eigen::MatrixXd& Q = i + 1 < horizon.prediction_steps ? horizon.Q : horizon.Q_last;
        model.H(j, k) += a.states.col(i).dot(Q * b.states.col(i));
      }
    }
    for (std::size_t i = 0; i < horizon.rows.size(); ++i) {
      const Horizon::Row& row = horizon.rows[i];
      double& entry = model.Omega(static_cast<Eigen::Index>(i), j);
      switch (row.kind) {
        case Horizon::RowKind::change:
          entry = row.step == j ? 1.0 : 0.0;
          break;
        case Horizon::RowKind::input:
          entry = a.inputs(row.step);
          break;
        case Horizon::RowKind::state:
          entry = a.states(row.component, row.step - 1);
          break;
      }
    }
  }
  model.H = 0.5 * (model.H + model.H.transpose()).eval();
  return model;
}

// The solver with sweeps along the horizon and the one without.
TEST(ActiveSet, TheSparseHorizonGivesTheSameSolution) {
  Random random;
  int changes = 0;
  constexpr std::pair<int, int> kSteps[] = {{60, 60}, {60, 30}, {114, 114}, {31, 31}, {20, 5},
                                            {5, 3},   {2, 2},   {2, 1},     {1, 1}};
  for (int k = 0; k < 18; ++k) {
    const auto [prediction_steps, control_steps] = kSteps[k % 9];
    const Horizon horizon = random_horizon(random, 1 + k % 4, prediction_steps, control_steps);
    QpModel model = dense_model(horizon);
    const Eigen::Index n = model.H.rows();
    const Eigen::Index m = model.Omega.rows();
    ActiveSetQp dense(model, 10000);
    model.sweeps = make_horizon_sweeps(horizon);
    ActiveSetQp structured(model, 10000);
    QpInput input(n, m);
    input.lower.setConstant(-0.5);
    input.upper.setConstant(0.3);
    QpSolution a(n, m), b(n, m);
    Eigen::VectorXd gradient(n);
    for (int i = 0; i < 40; ++i) {
      input.g = random.vector(n, 20.0 + i);
      if (i == 20) input.softness.tail(m / 4).setConstant(1e-3);
      dense.solve(input, a);
      structured.solve(input, b);
      ASSERT_EQ(a.status, QpStatus::solved) << k << " " << i;
      ASSERT_EQ(b.status, QpStatus::solved) << k << " " << i;
      EXPECT_LT((a.z - b.z).norm(), 1e-8 * (1.0 + a.z.norm())) << k << " " << i;
      EXPECT_LE(kkt_residual(model, input, b, model.Omega * b.z, gradient), 1e-8) << k << " " << i;
      changes += b.iterations;
    }
  }
  EXPECT_GT(changes, 1000) << "the constraints hardly mattered";
}

TEST(Horizon, RefusesInvalidSizes) {
  Random random;
  const Horizon good = random_horizon(random, 2, 5, 3);
  const auto expect_refused = [&](auto&& spoil) {
    Horizon bad = good;
    spoil(bad);
    EXPECT_REFUSED(make_horizon_sweeps(bad));
  };
  expect_refused([](Horizon& h) { h.A = Eigen::MatrixXd::Identity(3, 3); });
  expect_refused([](Horizon& h) { h.S = Eigen::MatrixXd(); });
  expect_refused([](Horizon& h) { h.Q = h.Q.leftCols(1).eval(); });
  expect_refused([](Horizon& h) { h.control_steps = 0; });
  expect_refused([](Horizon& h) { h.control_steps = 6; });
  expect_refused([](Horizon& h) { h.rows.push_back({Horizon::RowKind::change, 3, 0}); });
  expect_refused([](Horizon& h) { h.rows.push_back({Horizon::RowKind::input, -1, 0}); });
  expect_refused([](Horizon& h) { h.rows.push_back({Horizon::RowKind::state, 0, 0}); });
  expect_refused([](Horizon& h) { h.rows.push_back({Horizon::RowKind::state, 6, 0}); });
  expect_refused([](Horizon& h) { h.rows.push_back({Horizon::RowKind::state, 1, 2}); });
}

TEST(Horizon, LargerPlantsHaveNoSweeps) {
  Random random;
  EXPECT_EQ(make_horizon_sweeps(random_horizon(random, 5, 6, 4)), nullptr);
}

}  // namespace breakwater::horizon_test
