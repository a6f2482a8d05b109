// Records the sequences of quadratic programs for qp_bench: closed loops of the cart's predictive
// controllers with noise, active constraints and a disturbance.
//     record_qp_sequences FOLDER
#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <breakwater/control/lmpc.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_model.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/world/noise.h>
#include "qp_sequence.h"

using namespace breakwater;

namespace {

struct Loop {
  std::string name;  // variables x one-sided constraints
  double period_s;
  int prediction_steps;
  int control_steps;
  Eigen::Matrix2d Q;
  double last_factor;  // 0: the regulator's P
  double r;
  double change_N;  // 0: no bound
  double input_N;
  double position_m;  // 0: no bound
  double velocity_m_s;
  int state_steps;
  Eigen::Vector2d start;
  double reference_m;
  double noise_m;
  double disturbance_N;  // begins in the middle
  int samples;
};

LmpcDesign design_of(const Loop& loop, const StateSpace& plant) {
  const StateSpace extended = extend_by_disturbance_model(plant, 0, loop.period_s).sampled;
  LmpcDesign design;
  design.A = extended.A;
  design.B = extended.B;
  design.prediction_steps = loop.prediction_steps;
  design.control_steps = loop.control_steps;
  const Eigen::MatrixXd R = Eigen::MatrixXd::Constant(1, 1, loop.r);
  design.Q = design.Q_last = Eigen::MatrixXd::Zero(3, 3);
  design.Q.topLeftCorner(2, 2) = loop.Q;
  design.Q_last.topLeftCorner(2, 2) = loop.last_factor > 0.0
                                          ? Eigen::MatrixXd(loop.last_factor * loop.Q)
                                          : dlqr(plant.A, plant.B, loop.Q, R).P;
  design.R = R;
  const std::vector<int> moves = first_steps(loop.control_steps);
  const std::vector<int> states = spread_steps(loop.state_steps, loop.prediction_steps);
  if (loop.change_N > 0.0) design.change_bounds = {{0, -loop.change_N, loop.change_N, moves}};
  design.input_bounds = {{0, -loop.input_N, loop.input_N, moves}};
  if (loop.position_m > 0.0) {
    design.state_bounds.push_back({0, -10.0, loop.position_m, states});
  }
  if (loop.velocity_m_s > 0.0) {
    design.state_bounds.push_back({1, -loop.velocity_m_s, loop.velocity_m_s, states});
  }
  design.max_iterations = 40;
  design.softness = 1e-6;
  return design;
}

// The programs as functions of p = [x; u(k−1)], from the prediction Z = Ψ x + Γ u + Θ ΔU.
QpSequence programs(const Lmpc& lmpc, const LmpcDesign& design, const Eigen::VectorXd& reference) {
  const Prediction& prediction = lmpc.prediction();
  const Eigen::Index n = lmpc.states();
  QpSequence sequence;
  sequence.model = lmpc.qp_model();
  sequence.A = design.A;
  sequence.B = design.B;
  sequence.Q = design.Q;
  sequence.Q_last = design.Q_last;
  sequence.R = design.R;
  sequence.prediction_steps = design.prediction_steps;
  Eigen::MatrixXd free(prediction.Psi.rows(), n + 1);
  free << prediction.Psi, prediction.Gamma;
  Eigen::MatrixXd weighted = prediction.Theta.transpose();
  for (int i = 0; i < design.prediction_steps; ++i) {
    weighted.middleCols(i * n, n) *= i + 1 < design.prediction_steps ? design.Q : design.Q_last;
  }
  sequence.g0 = -weighted * reference;
  sequence.G = weighted * free;

  const Eigen::Index m = sequence.model.Omega.rows();
  sequence.lower0.resize(m);
  sequence.upper0.resize(m);
  sequence.E.setZero(m, n + 1);
  sequence.rows.resize(m, 3);
  Eigen::Index row = 0;
  const auto add = [&](int kind, const std::vector<PredictedBound>& bounds) {
    for (const PredictedBound& bound : bounds) {
      for (const int step : bound.steps) {
        sequence.rows.row(row) << kind, step, static_cast<int>(bound.component);
        if (kind == 1) sequence.E(row, n) = -1.0;
        if (kind == 2) sequence.E.row(row) = -free.row((step - 1) * n + bound.component);
        sequence.lower0(row) = bound.lower;
        sequence.upper0(row) = bound.upper;
        ++row;
      }
    }
  };
  add(0, design.change_bounds);
  add(1, design.input_bounds);
  add(2, design.state_bounds);
  return sequence;
}

QpSequence record(const Loop& loop) {
  const StateSpace plant = zero_order_hold(damped_inertia(0.625, 0.78), loop.period_s);
  const LmpcDesign design = design_of(loop, plant);
  Lmpc lmpc(design);
  Eigen::VectorXd reference = Eigen::VectorXd::Zero(3 * loop.prediction_steps);
  for (int i = 0; i < loop.prediction_steps; ++i) reference(3 * i) = loop.reference_m;
  QpSequence sequence = programs(lmpc, design, reference);
  sequence.parameters.resize(4, loop.samples);
  Eigen::Index programs_kept = 0;

  const Noise noise(1, "position");
  const Noise speed_noise(1, "velocity");
  Eigen::VectorXd x = loop.start;
  Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
  double d_hat = 0.0;
  for (int k = 0; k < loop.samples; ++k) {
    const double d = k >= loop.samples / 2 ? loop.disturbance_N : 0.0;
    d_hat += 0.1 * (d - d_hat);  // an estimator that needs some samples
    const auto sample = static_cast<std::uint64_t>(k);
    const Eigen::Vector3d estimate(x(0) + loop.noise_m * noise(sample),
                                   x(1) + loop.noise_m * speed_noise(sample), d_hat);
    sequence.parameters.col(programs_kept) << estimate, u;
    const std::int64_t unsolved = lmpc.statistics().unsolved;
    u += lmpc.optimise(estimate, u, reference, Eigen::VectorXd::Zero(1));
    // Infeasible programs were softened, which not every solver can do. They are left out.
    if (lmpc.statistics().unsolved == unsolved) ++programs_kept;
    x = plant.A * x + plant.B * (u.array() - d).matrix();
  }
  sequence.parameters.conservativeResize(Eigen::NoChange, programs_kept);
  std::printf("%-8s %ld programs of %d samples\n", loop.name.c_str(),
              static_cast<long>(programs_kept), loop.samples);
  return sequence;
}

std::vector<Loop> loops() {
  const Eigen::Matrix2d fast = Eigen::Vector2d(2e3, 1e2).asDiagonal();
  const Eigen::Matrix2d position = Eigen::Vector2d(1e2, 1.0).asDiagonal();
  const Eigen::Matrix2d even = Eigen::Matrix2d::Identity();
  const Eigen::Vector2d rest = Eigen::Vector2d::Zero();
  return {
      {"5x60", 0.1, 20, 5, fast, 3.0, 0.1, 40.0, 2.074, 0.5, 0.0, 20, rest, 1.0, 3e-3, 0.5, 2000},
      {"3x52", 1e-3, 30, 3, position, 1.0, 1.0, 40.0, 2.0, 0.05, 1.0, 10, rest, 0.1, 1e-5, 0.3,
       4000},
      {"3x212", 1e-3, 100, 3, position, 1.0, 1.0, 40.0, 2.0, 0.05, 1.0, 50, rest, 0.1, 1e-5, 0.3,
       4000},
      {"114x456",
       1e-2,
       114,
       114,
       even,
       0.0,
       1.0,
       0.0,
       2.0,
       0.0,
       1.0,
       114,
       {1.5, 0.9},
       0.0,
       1e-3,
       2.0,
       1200}};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: record_qp_sequences FOLDER\n");
    return 2;
  }
  try {
    for (const Loop& loop : loops()) {
      write(record(loop), std::string(argv[1]) + "/" + loop.name + ".h5");
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "record_qp_sequences: %s\n", error.what());
    return 4;
  }
  return 0;
}
