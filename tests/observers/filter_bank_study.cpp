// The bank against every other estimator on 70 rows: encoders × periods × disturbances, medians
// over phases (seeds, where there is noise) that nobody tuned on. IDOB, DKF and FAKFD are tuned for
// each row by their one parameter, on the row's own phases, which the bank is not. Prints the table
// of docs/methods/filter-bank.md.
#include <breakwater/observers/filter_bank.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>

#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/idob_estimator.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/qvff.h>
#include <breakwater/observers/stf.h>
#include "observers/motor_loop.h"
#include "support.h"

namespace breakwater::filter_bank_study {
namespace {

using testing::MotorLoop;

constexpr int kPhases = 12;
constexpr double kRounding = 1e-12;  // below it velocities are the arithmetic's
constexpr double kLost = 1e9;        // a loop that ran away

struct Behind {
  int bits;
  double noise_std;
};
struct Acting {
  const char* name;
  Disturbance disturbance;
  double inertia;
};

const Acting kActing[] = {{"step 10", {DisturbanceKind::step, 10.0, 0.0, 1.0}, 1.0},
                          {"step .1", {DisturbanceKind::step, 0.1, 0.0, 1.0}, 1.0},
                          {"ramp 1/s", {DisturbanceKind::ramp, 1.0, 0.0, 1.0}, 1.0},
                          {"10 sin t", {DisturbanceKind::sine, 10.0, 1.0, 1.0}, 1.0},
                          {"2 sin 5t", {DisturbanceKind::sine, 2.0, 5.0, 1.0}, 1.0},
                          {"J .5", {DisturbanceKind::step, 10.0, 0.0, 1.0}, 0.5},
                          {"J 1.5", {DisturbanceKind::step, 10.0, 0.0, 1.0}, 1.5}};

// One row: what all estimators of it have in common.
class Row {
 public:
  Row(double period_s, const Behind& behind, const Acting& acting)
      : period_s_(period_s), behind_(behind), acting_(acting) {}

  double quantum() const { return 2.0 * std::numbers::pi / std::exp2(behind_.bits); }
  SensorError sensor() const {
    return {Eigen::VectorXd::Constant(1, quantum()),
            Eigen::VectorXd::Constant(1, behind_.noise_std)};
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
      loop.encoder = {.quantum = quantum(),
                      .phase = quantum() * ((i + 0.5) / kPhases - 0.5 + 0.013)};
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
  /// Of IDOB (poles p, 2p, 3p), DKF (Q_d/R) and FAKFD (λ).
  Best best_rival() const {
    Best best;
    const auto take = [&](const char* name, DisturbanceEstimator& estimator) {
      const double found = error(estimator);
      if (found < best.error) best = {found, name};
    };
    for (double p = 1.0; p < std::min(300.0, 1.0 / period_s_); p *= 1.5) {
      IdobEstimator idob(plant(), {{-p, -2.0 * p, -3.0 * p}}, period_s_);
      take("IDOB", idob);
    }
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(1, 1);
    const Eigen::MatrixXd P0 = Eigen::MatrixXd::Identity(3, 3);
    const ExtendedPlant model = extended();
    for (double ratio = 1.0; ratio < 1e15; ratio *= 10.0) {
      Kfd<3, 1, 1> dkf({model, disturbance_noise(model, ratio), one, P0});
      take("DKF", dkf);
    }
    for (const double forgotten : {1e-4, 3e-4, 1e-3, 3e-3, .01, .03, .1, .2, .3}) {
      Fakfd<3, 1, 1> fakfd({model, input_noise(model, 0.0), one, P0},
                           scalar_gamma(model, 1.0 / (1.0 - forgotten)));
      take("FAKFD", fakfd);
    }
    return best;
  }

 private:
  double period_s_;
  Behind behind_;
  Acting acting_;
};

TEST(FilterBankStudy, AgainstRivalsTunedForEachOfSeventyRows) {
  int rows = 0, within = 0, better = 0, below_vfakfd = 0, below_qvff = 0, below_stf = 0;
  std::puts(
      "| T_s | encoder | disturbance | qbank | best of three, tuned | | VFAKFD | QVFF | STF |");
  std::puts("|---|---|---|---|---|---|---|---|---|");
  for (const double period_s : {1e-2, 1e-3}) {
    for (const Behind& behind :
         {Behind{4, 0.0}, Behind{8, 0.0}, Behind{12, 0.0}, Behind{48, 0.0}, Behind{48, 0.01}}) {
      for (const Acting& acting : kActing) {
        const Row row(period_s, behind, acting);
        FilterBank bank({row.plant(), period_s, row.sensor(), 10.0});
        VfakfdDesign variable;
        variable.alpha = Eigen::VectorXd::Constant(
            1, behind.noise_std > 0.0 ? 100.0 : vfakfd_alpha(std::exp2(behind.bits), period_s));
        variable.dead_zone = Eigen::VectorXd::Zero(1);
        Vfakfd<3, 1, 1> vfakfd(variable_forgetting_design(row.extended(), 1e-8), variable);
        Vfakfd<3, 1, 1> qvff(variable_forgetting_design(row.extended(), kQvffInitialCovariance),
                             qvff_design(row.sensor()));
        Stf<3, 1, 1> stf(stf_design(row.extended(), row.sensor(), period_s), row.sensor());
        const double found = row.error(bank);
        const Row::Best best = row.best_rival();
        const double of_vfakfd = row.error(vfakfd), of_qvff = row.error(qvff),
                     of_stf = row.error(stf);
        ++rows;
        const bool is_rounding = found < kRounding && best.error < kRounding;
        within += is_rounding || found <= 1.1 * best.error ? 1 : 0;
        better += !is_rounding && found <= 0.8 * best.error ? 1 : 0;
        below_vfakfd += found < of_vfakfd ? 1 : 0;
        below_qvff += found < of_qvff ? 1 : 0;
        below_stf += found < of_stf ? 1 : 0;
        std::printf("| %g ms | %d bits%s | %s | %.2g | %.2g %s | %.2f | %.2g | %.2g | %.2g |\n",
                    1e3 * period_s, behind.bits, behind.noise_std > 0.0 ? ", σ = .01" : "",
                    acting.name, found, best.error, best.name, found / best.error, of_vfakfd,
                    of_qvff, of_stf);
      }
    }
  }
  std::printf(
      "of %d rows: within 10 %% of the best tuned %d, 20 %% below %d; below VFAKFD %d, QVFF "
      "%d, STF %d\n",
      rows, within, better, below_vfakfd, below_qvff, below_stf);
  EXPECT_EQ(rows, 70);
  EXPECT_GE(within, 62);
  EXPECT_GE(below_vfakfd, 64);
}

}  // namespace
}  // namespace breakwater::filter_bank_study
