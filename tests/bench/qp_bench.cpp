// What a warm solve costs on closed-loop sequences of the cart's predictive controllers.
//
// Each sequence is recorded from a closed loop with noise, then replayed many times; a step's time
// is its median over the replays, so that other load on the machine does not show. Printed: the
// median and the largest over the steps, without what the clock itself takes.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include <breakwater/control/lmpc.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_model.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/world/noise.h>

using namespace breakwater;

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kReplays = 25;

struct Sequence {
  std::string name;
  QpModel model;
  std::vector<QpInput> inputs;
};

struct Loop {
  std::string name;
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
  double disturbance_N;  // from the middle on
  int samples;
};

Sequence record(const Loop& loop) {
  const StateSpace plant = zero_order_hold(damped_inertia(0.625, 0.78), loop.period_s);
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
  Lmpc lmpc(design);

  Sequence sequence{loop.name, lmpc.qp_model(), {}};
  const Noise noise(1, "position");
  const Noise speed_noise(1, "velocity");
  Eigen::VectorXd x = loop.start;
  Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
  Eigen::VectorXd trajectory = Eigen::VectorXd::Zero(3 * loop.prediction_steps);
  for (int i = 0; i < loop.prediction_steps; ++i) trajectory(3 * i) = loop.reference_m;
  double d_hat = 0.0;
  for (int k = 0; k < loop.samples; ++k) {
    const double d = k >= loop.samples / 2 ? loop.disturbance_N : 0.0;
    d_hat += 0.1 * (d - d_hat);  // an estimator that takes some samples
    const auto sample = static_cast<std::uint64_t>(k);
    const Eigen::Vector3d estimate(x(0) + loop.noise_m * noise(sample),
                                   x(1) + loop.noise_m * speed_noise(sample), d_hat);
    u += lmpc.optimise(estimate, u, trajectory, Eigen::VectorXd::Zero(1));
    sequence.inputs.push_back(lmpc.qp_input());
    x = plant.A * x + plant.B * (u.array() - d).matrix();
  }
  return sequence;
}

double median(std::vector<double>& values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

double seconds_between(Clock::time_point a, Clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

double clock_cost_s() {
  std::vector<double> costs;
  for (int i = 0; i < 10001; ++i) {
    const auto start = Clock::now();
    costs.push_back(seconds_between(start, Clock::now()));
  }
  return median(costs);
}

void measure(const Sequence& sequence, QpSolverKind kind, double clock_s) {
  const std::size_t steps = sequence.inputs.size();
  std::vector<std::vector<double>> times(steps);
  long iterations = 0;
  long unsolved = 0;
  for (int replay = 0; replay < kReplays; ++replay) {
    const auto solver = make_qp_solver(kind, sequence.model, 40);
    QpSolution solution(sequence.model.H.rows(), sequence.model.Omega.rows());
    for (std::size_t k = 0; k < steps; ++k) {
      const auto start = Clock::now();
      solver->solve(sequence.inputs[k], solution);
      times[k].push_back(seconds_between(start, Clock::now()) - clock_s);
      if (replay > 0) continue;
      iterations += solution.iterations;
      unsolved += solution.status == QpStatus::solved ? 0 : 1;
    }
  }
  std::vector<double> per_step;
  for (auto& of_step : times) per_step.push_back(median(of_step));
  const double largest = *std::max_element(per_step.begin(), per_step.end());
  std::printf("%-9s  %-10s  %8.2f  %8.1f  %10.2f  %8ld\n", sequence.name.c_str(),
              kind == QpSolverKind::hildreth ? "hildreth" : "active_set", 1e6 * median(per_step),
              1e6 * largest, static_cast<double>(iterations) / static_cast<double>(steps),
              unsolved);
}

}  // namespace

int main() {
  const Eigen::Matrix2d fast = Eigen::Vector2d(2e3, 1e2).asDiagonal();
  const Eigen::Matrix2d position = Eigen::Vector2d(1e2, 1.0).asDiagonal();
  const Eigen::Matrix2d even = Eigen::Matrix2d::Identity();
  const Eigen::Vector2d rest = Eigen::Vector2d::Zero();
  const std::vector<Loop> loops = {
      {"5/60", 0.1, 20, 5, fast, 3.0, 0.1, 40.0, 2.074, 0.5, 0.0, 20, rest, 1.0, 3e-3, 0.5, 2000},
      {"3/52", 1e-3, 30, 3, position, 1.0, 1.0, 40.0, 2.0, 0.05, 1.0, 10, rest, 0.1, 1e-5, 0.3,
       4000},
      {"3/212", 1e-3, 100, 3, position, 1.0, 1.0, 40.0, 2.0, 0.05, 1.0, 50, rest, 0.1, 1e-5, 0.3,
       4000},
      {"114/456",
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
  std::printf("variables/rows; us per solve; iterations: sweeps or changes of the working set\n");
  std::printf("size       solver        median   largest  iterations  unsolved\n");
  const double clock_s = clock_cost_s();
  for (const Loop& loop : loops) {
    const Sequence sequence = record(loop);
    for (const QpSolverKind kind : {QpSolverKind::active_set, QpSolverKind::hildreth}) {
      measure(sequence, kind, clock_s);
    }
  }
  return 0;
}
