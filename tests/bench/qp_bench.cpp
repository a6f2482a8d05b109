// The time of a warm solve, for every solver on the same sequences of quadratic programs.
//     qp_bench [RUNS]
//
// The sequences are the programs of the cart's predictive controllers along closed loops with
// noise, active constraints and a disturbance in the second half. Infeasible programs, which the
// controller softens, are left out. A sequence has the name of its variables and one-sided
// constraints.
//
// A run replays each sequence many times and alternates the solvers. The time of a step is its
// median over the replays, against other load. The output has the median and the largest time over
// the steps, without the clock's own time, and the ratio to the first solver. Each is the median of
// the runs. A solver replays a sequence once before the measurement, so that the data are in the
// cache. The first step does not count, since it starts from the last one.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/control/lmpc.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_model.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/world/noise.h>
#ifdef BREAKWATER_DAQP
#include "daqp.h"
#endif

using namespace breakwater;

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kTurns = 7;    // repetitions of each solver in a run
constexpr int kReplays = 5;  // replays in a repetition, after one for warming up
constexpr int kSweeps = 40;  // Hildreth's limit in the cart's cases

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

struct QpSequence {
  QpModel model;
  std::vector<QpInput> inputs;
};

QpSequence record(const Loop& loop) {
  const StateSpace plant = zero_order_hold(damped_inertia(0.625, 0.78), loop.period_s);
  Lmpc lmpc(design_of(loop, plant));
  for (int i = 0; i < loop.prediction_steps; ++i) lmpc.reference()(3 * i) = loop.reference_m;
  QpSequence sequence{lmpc.qp_model(), {}};

  const Noise noise(1, "position");
  const Noise speed_noise(1, "velocity");
  Eigen::VectorXd x = loop.start;
  double d_hat = 0.0;
  for (int k = 0; k < loop.samples; ++k) {
    const double d = k >= loop.samples / 2 ? loop.disturbance_N : 0.0;
    d_hat += 0.1 * (d - d_hat);  // an estimator that needs some samples
    const auto sample = static_cast<std::uint64_t>(k);
    const Eigen::Vector3d estimate(x(0) + loop.noise_m * noise(sample),
                                   x(1) + loop.noise_m * speed_noise(sample), d_hat);
    const std::int64_t unsolved = lmpc.statistics().unsolved;
    lmpc.optimise(estimate);
    // Not every solver can soften rows.
    if (lmpc.statistics().unsolved == unsolved) {
      sequence.inputs.push_back(lmpc.qp_input());
      sequence.inputs.back().softness.setZero();
    }
    x = plant.A * x + plant.B * (lmpc.u().array() - d).matrix();
  }
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

// A solver with its state from the last program.
struct Contender {
  std::string name;
  std::function<void(const QpInput&)> prepare;  // its data are then in the cache
  std::function<void()> solve;                  // this alone is measured
  std::function<const QpSolution&()> solution;
};

Contender own(const char* name, QpSolverKind kind, const QpModel& model) {
  const std::shared_ptr<QpSolver> solver = make_qp_solver(kind, model, kSweeps);
  const auto input = std::make_shared<QpInput>(model.H.rows(), model.Omega.rows());
  const auto solution = std::make_shared<QpSolution>(model.H.rows(), model.Omega.rows());
  return {name, [=](const QpInput& next) { *input = next; },
          [=] { solver->solve(*input, *solution); },
          [=]() -> const QpSolution& { return *solution; }};
}

std::vector<Contender> contenders(const QpModel& model) {
  std::vector<Contender> all = {own("active_set", QpSolverKind::active_set, model),
                                own("hildreth, 40 sweeps", QpSolverKind::hildreth, model)};
#ifdef BREAKWATER_DAQP
  const auto daqp = [&](const char* name, int simple) {
    const auto solver = std::make_shared<Daqp>(model, simple);
    all.push_back({name, [=](const QpInput& next) { solver->prepare(next); },
                   [=] { solver->solve(); },
                   [=]() -> const QpSolution& { return solver->solution(); }});
  };
  daqp("DAQP", 0);
  if (const int simple = leading_unit_rows(model); simple > 0) daqp("DAQP, simple bounds", simple);
#endif
  return all;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
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

// The times of one solver over the steps of a sequence.
struct Account {
  std::vector<double> median_us, largest_us;        // one per run
  std::vector<double> median_ratio, largest_ratio;  // relative to the first solver
  double changes = 0.0;
  long unsolved = 0;
  double residual = 0.0;  // largest residual of a reported solution
};

double residual_of(const QpSequence& sequence, const QpInput& input, const QpSolution& solution) {
  Eigen::VectorXd gradient(sequence.model.H.rows());
  const Eigen::VectorXd values = sequence.model.Omega * solution.z;
  return kkt_residual(sequence.model, input, solution, values, gradient);
}

// Solves each program once and collects status and residual.
void examine(const QpSequence& sequence, const Contender& solver, Account& account) {
  for (const QpInput& input : sequence.inputs) {
    solver.prepare(input);
    solver.solve();
    const QpSolution& solution = solver.solution();
    account.changes += solution.iterations / static_cast<double>(sequence.inputs.size());
    if (solution.status == QpStatus::solved) {
      account.residual = std::max(account.residual, residual_of(sequence, input, solution));
    } else {
      ++account.unsolved;
    }
  }
}

// One run with all solvers in turn.
void measure(const std::vector<QpInput>& inputs, const std::vector<Contender>& solvers,
             std::vector<Account>& accounts) {
  const double clock_s = clock_cost_s();
  std::vector<std::vector<std::vector<double>>> times(
      solvers.size(), std::vector<std::vector<double>>(inputs.size()));
  for (int turn = 0; turn < kTurns; ++turn) {
    for (std::size_t s = 0; s < solvers.size(); ++s) {
      for (int replay = 0; replay <= kReplays; ++replay) {
        for (std::size_t k = 0; k < inputs.size(); ++k) {
          solvers[s].prepare(inputs[k]);
          const auto start = Clock::now();
          solvers[s].solve();
          const double time_s = seconds_between(start, Clock::now()) - clock_s;
          if (replay > 0 && k > 0) times[s][k].push_back(time_s);
        }
      }
    }
  }
  for (std::size_t s = 0; s < solvers.size(); ++s) {
    std::vector<double> per_step;
    for (std::size_t k = 1; k < inputs.size(); ++k) per_step.push_back(1e6 * median(times[s][k]));
    Account& account = accounts[s];
    account.median_us.push_back(median(per_step));
    account.largest_us.push_back(*std::max_element(per_step.begin(), per_step.end()));
    account.median_ratio.push_back(accounts[0].median_us.back() / account.median_us.back());
    account.largest_ratio.push_back(accounts[0].largest_us.back() / account.largest_us.back());
  }
}

void report(const std::string& name, const std::vector<Contender>& all,
            const std::vector<Account>& accounts) {
  for (std::size_t c = 0; c < all.size(); ++c) {
    const Account& account = accounts[c];
    std::printf("| %s | %s | %.3g | %.3g | %.2f | %ld | %.0e | %.2f | %.2f |\n", name.c_str(),
                all[c].name.c_str(), median(account.median_us), median(account.largest_us),
                account.changes, account.unsolved, account.residual, median(account.median_ratio),
                median(account.largest_ratio));
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::atoi(argv[1]) : 5;
  if (runs < 1) {
    std::fprintf(stderr, "usage: qp_bench [RUNS]\n");
    return 2;
  }
  std::printf(
      "us per warm solve, median of %d runs; changes of the working set (Hildreth: sweeps, "
      "DAQP: iterations)\n\n",
      runs);
  std::printf(
      "| variables/rows | solver | median | largest | changes | unsolved | residual | "
      "active_set over it: median | largest |\n|---|---|---|---|---|---|---|---|---|\n");
  try {
    for (const Loop& loop : loops()) {
      const QpSequence sequence = record(loop);
      const std::vector<QpInput>& inputs = sequence.inputs;
      const std::vector<Contender> all = contenders(sequence.model);
      std::vector<Account> accounts(all.size());
      for (std::size_t s = 0; s < all.size(); ++s) examine(sequence, all[s], accounts[s]);
      for (int run = 0; run < runs; ++run) measure(inputs, all, accounts);
      report(loop.name, all, accounts);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "qp_bench: %s\n", error.what());
    return 2;
  }
  return 0;
}
