// QBANK against all other estimators, over encoders, periods and disturbances: on the 70 rows that
// its constants were chosen with, and on 40 other rows. Results are medians over phases (or seeds,
// with noise). IDOB, DKF and FAKFD have one parameter tuned for each row and its phases; QBANK has
// not. Each row is run with an encoder that rounds and one that truncates. Prints the tables of
// docs/explanation/methods/multiple-model-estimator.md.
#include <breakwater/observers/multiple_model_estimator.h>

#include <cstdio>

#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/stf.h>
#include <breakwater/observers/vfakfd.h>
#include <breakwater/shell/all_cores.h>
#include "observers/motor_loop.h"
#include "support.h"

namespace breakwater::multiple_model_estimator_study {

using testing::MotorLoop;

constexpr int kPhases = 12;
constexpr double kRounding = 1e-12;  // smaller velocities are rounding errors
constexpr double kLost = 1e9;        // the loop is unstable

struct Behind {
  std::string name;
  double pulses;  // per revolution
  double noise_std = 0.0;
};
Behind bits(int count) {
  return {std::to_string(count) + " bits", std::exp2(count)};
}

struct Acting {
  const char* name;
  Disturbance disturbance;
  double inertia = 1.0;
  double coulomb = 0.0;
};
constexpr Disturbance kStepOf10{DisturbanceKind::step, 10.0, 0.0, 1.0};
constexpr Disturbance kSineOf10{DisturbanceKind::sine, 10.0, 1.0, 1.0};

// One row: the common data of all its estimators.
class Row {
 public:
  Row(double period_s, const Behind& behind, const Acting& acting, EncoderRounding rounding)
      : period_s_(period_s), behind_(behind), acting_(acting), rounding_(rounding) {}

  double quantum() const { return 2.0 * std::numbers::pi / behind_.pulses; }
  SensorError sensor() const {
    return {Eigen::VectorXd::Constant(1, quantum()),
            Eigen::VectorXd::Constant(1, behind_.noise_std), rounding_};
  }
  StateSpace plant() const { return damped_inertia(1.0, 0.0); }
  ExtendedPlant extended() const {
    return extend_by_disturbance_model(zero_order_hold(plant(), period_s_), 0, period_s_);
  }
  double period_s() const { return period_s_; }

  /// The median RMSE of v̂ over phases and seeds.
  double error(DisturbanceEstimator& estimator) const {
    std::vector<double> errors;
    for (int i = 0; i < kPhases; ++i) {
      MotorLoop loop;
      loop.period_s = period_s_;
      loop.inertia = acting_.inertia;
      loop.coulomb = acting_.coulomb;
      loop.encoder = {.quantum = quantum(),
                      .phase = quantum() * ((i + 0.5) / kPhases - 0.5 + 0.013),
                      .rounding = rounding_};
      loop.noise_std = behind_.noise_std;
      loop.seed = static_cast<std::uint64_t>(101 + i);
      loop.disturbance = acting_.disturbance;
      const double velocity = testing::run_motor(loop, estimator).velocity;
      errors.push_back(std::isfinite(velocity) ? velocity : kLost);
    }
    return testing::median(errors);
  }

  struct Best {
    double error = kLost;
    const char* name = "";
  };
  /// IDOB (poles p, 2p, 3p), DKF (Q_d/R) and FAKFD (λ).
  Best best_rival() const {
    Best best;
    const auto take = [&](const char* name, DisturbanceEstimator& estimator) {
      const double found = error(estimator);
      if (found < best.error) best = {found, name};
    };
    for (double p = 1.0; p < std::min(300.0, 1.0 / period_s_); p *= 1.5) {
      Idob idob(plant(), {{-p, -2.0 * p, -3.0 * p}}, period_s_);
      take("IDOB", idob);
    }
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(1, 1);
    const Eigen::MatrixXd P0 = Eigen::MatrixXd::Identity(3, 3);
    const ExtendedPlant model = extended();
    for (double ratio = 1.0; ratio < 1e15; ratio *= 10.0) {
      Kfd dkf({model, disturbance_noise(model, ratio), one, P0});
      take("DKF", dkf);
    }
    for (const double forgotten : {1e-4, 3e-4, 1e-3, 3e-3, .01, .03, .1, .2, .3}) {
      Fakfd fakfd({model, input_noise(model, 0.0), one, P0},
                  scalar_gamma(model, 1.0 / (1.0 - forgotten)));
      take("FAKFD", fakfd);
    }
    return best;
  }

 private:
  double period_s_;
  Behind behind_;
  Acting acting_;
  EncoderRounding rounding_;
};

struct Result {
  double bank;
  Row::Best best;
  double vfakfd;
  double qvff;
  double stf;
};

Result compare(double period_s, const Behind& behind, const Acting& acting,
               EncoderRounding rounding) {
  const Row row(period_s, behind, acting, rounding);
  MultipleModelEstimator bank({row.plant(), period_s, row.sensor(), 10.0});
  VfakfdDesign variable;
  variable.alpha = Eigen::VectorXd::Constant(
      1, behind.noise_std > 0.0 ? 100.0 : vfakfd_alpha(behind.pulses, period_s));
  variable.dead_zone = Eigen::VectorXd::Zero(1);
  Vfakfd vfakfd(variable_forgetting_design(row.extended(), 1e-8), variable);
  Vfakfd qvff(variable_forgetting_design(row.extended(), kQvffInitialCovariance),
              qvff_design(row.sensor()));
  Stf stf(stf_design(row.extended(), row.sensor(), period_s), row.sensor());
  return {row.error(bank), row.best_rival(), row.error(vfakfd), row.error(qvff), row.error(stf)};
}

struct Summary {
  int rows = 0;
  int within = 0;  // within 10 % of the best tuned one
  int better = 0;  // better by 20 %
  int below_vfakfd = 0;
  int below_qvff = 0;
  int below_stf = 0;
};

// Prints the table of all rows, at 10 and 1 ms.
Summary compare_all(const std::vector<Behind>& encoders, const std::vector<Acting>& disturbances,
                    EncoderRounding rounding) {
  struct Cell {
    double period_s;
    const Behind* behind;
    const Acting* acting;
    Result result;
  };
  std::vector<Cell> cells;
  for (const double period_s : {1e-2, 1e-3}) {
    for (const Behind& behind : encoders) {
      for (const Acting& acting : disturbances) cells.push_back({period_s, &behind, &acting, {}});
    }
  }
  on_all_cores(cells.size(), [&cells, rounding](std::size_t i) {
    Cell& cell = cells[cells.size() - 1 - i];  // the longest first
    cell.result = compare(cell.period_s, *cell.behind, *cell.acting, rounding);
  });
  Summary sum;
  std::puts(
      "| T_s | encoder | disturbance | qbank | best of three, tuned | | VFAKFD | QVFF | STF |");
  std::puts("|---|---|---|---|---|---|---|---|---|");
  for (const Cell& cell : cells) {
    const auto& [bank, best, vfakfd, qvff, stf] = cell.result;
    ++sum.rows;
    const bool is_rounding = bank < kRounding && best.error < kRounding;
    sum.within += is_rounding || bank <= 1.1 * best.error ? 1 : 0;
    sum.better += !is_rounding && bank <= 0.8 * best.error ? 1 : 0;
    sum.below_vfakfd += bank < vfakfd ? 1 : 0;
    sum.below_qvff += bank < qvff ? 1 : 0;
    sum.below_stf += bank < stf ? 1 : 0;
    std::printf("| %g ms | %s | %s | %.2g | %.2g %s | %.2f | %.2g | %.2g | %.2g |\n",
                1e3 * cell.period_s, cell.behind->name.c_str(), cell.acting->name, bank, best.error,
                best.name, bank / best.error, vfakfd, qvff, stf);
  }
  std::printf(
      "of %d rows: within 10 %% of the best tuned %d, 20 %% below %d; below VFAKFD %d, QVFF "
      "%d, STF %d\n",
      sum.rows, sum.within, sum.better, sum.below_vfakfd, sum.below_qvff, sum.below_stf);
  return sum;
}

class MultipleModelStudy : public ::testing::TestWithParam<EncoderRounding> {
 protected:
  bool truncates() const { return GetParam() == EncoderRounding::truncate; }
};

TEST_P(MultipleModelStudy, IsComparedWithFiltersTunedForEachOfSeventyRows) {
  const std::vector<Behind> encoders = {
      bits(4), bits(8), bits(12), bits(48), {"48 bits, σ = .01", std::exp2(48), 0.01}};
  const std::vector<Acting> disturbances = {{"step 10", kStepOf10},
                                            {"step .1", {DisturbanceKind::step, 0.1, 0.0, 1.0}},
                                            {"ramp 1/s", {DisturbanceKind::ramp, 1.0, 0.0, 1.0}},
                                            {"10 sin t", kSineOf10},
                                            {"2 sin 5t", {DisturbanceKind::sine, 2.0, 5.0, 1.0}},
                                            {"J .5", kStepOf10, 0.5},
                                            {"J 1.5", kStepOf10, 1.5}};
  const Summary sum = compare_all(encoders, disturbances, GetParam());
  EXPECT_EQ(sum.rows, 70);
  EXPECT_GE(sum.within, 62);
  EXPECT_GE(sum.below_vfakfd, 64);
}

// Encoders and disturbances that differ from those of the chosen constants. With dry friction,
// which jumps when the shaft turns back, a tuned DKF is better in 9 of 10 rows.
TEST_P(MultipleModelStudy, IsTestedOnFortyUnseenRows) {
  const std::vector<Behind> encoders = {
      bits(5), bits(6), bits(10), bits(16), {"6 bits, gear 25", 25.0 * std::exp2(6)}};
  const std::vector<Acting> disturbances = {
      {"6 sin 2t + 2 sin 7t", {DisturbanceKind::two_sines, 6.0, 2.0, 1.0, 2.0, 7.0}},
      {"chirp 5, 1 to 10/s", {DisturbanceKind::chirp, 5.0, 1.0, 1.0, 0.0, 0.0, 10.0, 9.0}},
      {"10 sin t, F_C 1", kSineOf10, 1.0, 1.0},
      {"J .7", kStepOf10, 0.7}};
  const Summary sum = compare_all(encoders, disturbances, GetParam());
  EXPECT_EQ(sum.rows, 40);
  EXPECT_GE(sum.within, 26);
  EXPECT_GE(sum.below_vfakfd, 37);
  EXPECT_GE(sum.below_stf, 36);
}

INSTANTIATE_TEST_SUITE_P(Encoder, MultipleModelStudy,
                         ::testing::Values(EncoderRounding::nearest, EncoderRounding::truncate),
                         [](const auto& rounding) {
                           return rounding.param == EncoderRounding::truncate ? "truncates"
                                                                              : "rounds";
                         });

}  // namespace breakwater::multiple_model_estimator_study
