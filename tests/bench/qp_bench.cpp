// The time of a warm solve, for every solver on the same recorded sequences.
//     qp_bench [RUNS] [SEQUENCES]
//
// A run replays each sequence many times and alternates the solvers. The time of a step is its
// median over the replays, against other load. The output has the median and the largest time over
// the steps, without the clock's own time, and the ratio to the first solver. Each is the median of
// the runs. A solver replays a sequence once before the measurement, so that the data are in the
// cache. The first step does not count, since it starts from the last one.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "qp_contender.h"
#include "qp_sequence.h"

using namespace breakwater;

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kTurns = 7;    // repetitions of each solver in a run
constexpr int kReplays = 5;  // replays in a repetition, after one for warming up
constexpr int kSweeps = 40;  // Hildreth's limit in the cart's cases

struct Contestant {
  std::string name;
  std::function<std::unique_ptr<QpContender>()> make;
};

std::vector<Contestant> contestants(const QpSequence& sequence) {
  const auto own = [&](QpSolverKind kind) {
    return [&sequence, kind] {
      return std::make_unique<OwnQpContender>(make_qp_solver(kind, sequence.model, kSweeps));
    };
  };
  std::vector<Contestant> all = {{"active_set", own(QpSolverKind::active_set)},
                                 {"hildreth, 40 sweeps", own(QpSolverKind::hildreth)}};
  for (const bool simple : {false, true}) {
    if (make_daqp(sequence, simple) == nullptr) continue;
    all.push_back({simple ? "DAQP, simple bounds" : "DAQP",
                   [&sequence, simple] { return make_daqp(sequence, simple); }});
  }
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
void examine(const QpSequence& sequence, const std::vector<QpInput>& inputs, QpContender& solver,
             Account& account) {
  for (const QpInput& input : inputs) {
    solver.prepare(input);
    solver.solve();
    const QpSolution& solution = solver.solution();
    account.changes += solution.iterations / static_cast<double>(inputs.size());
    if (solution.status == QpStatus::solved) {
      account.residual = std::max(account.residual, residual_of(sequence, input, solution));
    } else {
      ++account.unsolved;
    }
  }
}

// One run with all solvers in turn.
void measure(const std::vector<QpInput>& inputs,
             const std::vector<std::unique_ptr<QpContender>>& solvers,
             std::vector<Account>& accounts) {
  const double clock_s = clock_cost_s();
  std::vector<std::vector<std::vector<double>>> times(
      solvers.size(), std::vector<std::vector<double>>(inputs.size()));
  for (int turn = 0; turn < kTurns; ++turn) {
    for (std::size_t s = 0; s < solvers.size(); ++s) {
      for (int replay = 0; replay <= kReplays; ++replay) {
        for (std::size_t k = 0; k < inputs.size(); ++k) {
          solvers[s]->prepare(inputs[k]);
          const auto start = Clock::now();
          solvers[s]->solve();
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

void report(const std::string& name, const std::vector<Contestant>& all,
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
  const std::string folder = argc > 2 ? argv[2] : BREAKWATER_QP_SEQUENCES;
  if (runs < 1) {
    std::fprintf(stderr, "usage: qp_bench [RUNS] [SEQUENCES]\n");
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
    for (const char* name : {"5x60", "3x52", "3x212", "114x456"}) {
      const QpSequence sequence = read_qp_sequence(folder + "/" + name + ".h5");
      std::vector<QpInput> inputs;
      for (std::size_t k = 0; k < sequence.size(); ++k) inputs.push_back(sequence.input(k));
      const std::vector<Contestant> all = contestants(sequence);
      std::vector<Account> accounts(all.size());
      std::vector<std::unique_ptr<QpContender>> solvers;
      for (std::size_t s = 0; s < all.size(); ++s) {
        solvers.push_back(all[s].make());
        examine(sequence, inputs, *solvers[s], accounts[s]);
      }
      for (int run = 0; run < runs; ++run) measure(inputs, solvers, accounts);
      report(name, all, accounts);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "qp_bench: %s\n", error.what());
    return 2;
  }
  return 0;
}
