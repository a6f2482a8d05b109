// The loop of an axis: its frequency response and its margins.
#include <fmt/format.h>
#include <Eigen/Dense>

#include <breakwater/analysis/analysis_outputs.h>
#include <breakwater/analysis/loop_analysis.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/observers/kalman_estimator.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/rigs/loop_response.h>
#include "catalogue.h"

namespace breakwater::loop_analysis_test {

using Complex = std::complex<double>;

struct Prepared {
  Prepared(const std::string& scenario, const std::string& case_name,
           const std::vector<std::string>& sets)
      : run(testing::prepare(scenario, case_name, sets)),
        axis(dynamic_cast<const AxisScenario*>(run.scenario.get())) {}

  LoopAnalysis analyse(const AnalysisOptions& options) const {
    return breakwater::analyse({{{"it"}, axis->loops().front()}}, options).front();
  }

  PreparedRun run;
  const AxisScenario* axis;
};

// The loop of plant, stationary disturbance Kalman filter and PD control as one system: x is the
// plant's state, z⁻ = [x̂; d̂] the predicted one.
struct KalmanLoop {
  Eigen::MatrixXd A, from_force, from_noise;
  Eigen::MatrixXd d_hat, command;  // rows to multiply with the state
  double d_hat_of_noise, command_of_noise;

  KalmanLoop(double q, double k_p, double k_d, double period_s) {
    const StateSpace plant = zero_order_hold(damped_inertia(1.0, 0.0), period_s);
    const ExtendedPlant extended = extend_by_disturbance_model(plant, 0, period_s);
    const Eigen::MatrixXd &Ae = extended.sampled.A, &Be = extended.sampled.B,
                          &Ce = extended.sampled.C;
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(1, 1);
    const Eigen::MatrixXd P =
        solve_dare(Ae.transpose(), Ce.transpose(), disturbance_noise(extended, q), one);
    const Eigen::MatrixXd K = P * Ce.transpose() / ((Ce * P * Ce.transpose())(0) + 1.0);
    // z = (I − K C) z⁻ + K y, u = F z, z⁻(k+1) = A z + B u; y = C x + n.
    const Eigen::MatrixXd M = Eigen::MatrixXd::Identity(3, 3) - K * Ce;
    Eigen::RowVector3d F(-k_p, -k_d, 1.0);
    Eigen::MatrixXd z(3, 5);
    z << K * plant.C, M;
    command = F * z;
    d_hat = z.row(2);
    d_hat_of_noise = K(2);
    command_of_noise = (F * K)(0);
    A = Eigen::MatrixXd::Zero(5, 5);
    A.topLeftCorner(2, 2) = plant.A;
    A.topRows(2) += plant.B * command;
    A.bottomRows(3) = Ae * z + Be * command;
    from_force = Eigen::MatrixXd::Zero(5, 1);
    from_force.topRows(2) = plant.B;
    from_noise = Eigen::MatrixXd::Zero(5, 1);
    from_noise.topRows(2) = plant.B * command_of_noise;
    from_noise.bottomRows(3) = Ae * K + Be * command_of_noise;
  }

  // The largest eigenvalue with `delay` > 0 samples between the command and the plant, which are
  // states.
  double spectral_radius(Eigen::Index delay) const {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(5 + delay, 5 + delay);
    all.topLeftCorner(5, 5) = A - from_force * command;
    all.bottomLeftCorner(delay, 5).row(0) = command;
    all.block(6, 5, delay - 1, delay - 1).setIdentity();
    all.col(4 + delay).head(5) = from_force;
    return all.eigenvalues().cwiseAbs().maxCoeff();
  }

  Complex response(const Eigen::MatrixXd& row, const Eigen::MatrixXd& from, double direct,
                   Complex z) const {
    const Eigen::MatrixXcd inverse =
        (z * Eigen::MatrixXcd::Identity(5, 5) - A.cast<Complex>()).inverse();
    return (row.cast<Complex>() * inverse * from.cast<Complex>())(0) + direct;
  }
};

void expect_near(Complex a, Complex b, double share, double omega) {
  EXPECT_NEAR(std::abs(a - b), 0.0, share * std::abs(b)) << a << " and " << b << " at " << omega;
}

TEST(LoopAnalysis, ForAStationaryKalmanFilterMatchesItsMatrices) {
  const Prepared prepared("motor_estimation", "dkf", {"encoder.bits=0"});
  const LoopAnalysis analysis = prepared.analyse({.points = 0});
  ASSERT_EQ(analysis.designed.reason, "");
  ASSERT_TRUE(analysis.estimates);
  const KalmanLoop loop(1.5e4, 10.0, 5.0, 1e-3);
  for (const LoopPoint& point : analysis.designed.points) {
    const double omega = point.omega_rad_s;
    const Complex z = std::polar(1.0, omega * 1e-3);
    const Complex command = loop.response(loop.command, loop.from_force, 0.0, z);
    expect_near(point.complementary, -command, 1e-6, omega);
    expect_near(point.sensitivity, 1.0 + command, 1e-5, omega);
    expect_near(point.d_hat_over_d, -loop.response(loop.d_hat, loop.from_force, 0.0, z), 1e-6,
                omega);
    expect_near(point.noise_to_d_hat,
                loop.response(loop.d_hat, loop.from_noise, loop.d_hat_of_noise, z), 1e-5, omega);
  }
}

TEST(LoopAnalysis, MeasuredMatchesTheDesignWithoutAnEncoder) {
  for (const std::string name : {"idob", "mdob", "dkf"}) {
    const Prepared prepared("motor_estimation", name, {"encoder.bits=0"});
    const LoopAnalysis analysis =
        prepared.analyse({.from_rad_s = 3.0, .to_rad_s = 300.0, .points = 4, .settle_s = 20.0});
    ASSERT_EQ(analysis.measured.points.size(), 4U);
    const AxisTask task = prepared.axis->task();
    for (const LoopPoint& point : analysis.measured.points) {
      // The designed points are dense, so the curve is almost straight between two of them.
      const auto& designed = analysis.designed.points;
      auto next = std::find_if(designed.begin(), designed.end(), [&](const LoopPoint& other) {
        return other.omega_rad_s >= point.omega_rad_s;
      });
      if (next == designed.end()) --next;
      const LoopPoint& before = next == designed.begin() ? *next : *(next - 1);
      const double width = next->omega_rad_s - before.omega_rad_s;
      const double share = width > 0.0 ? (point.omega_rad_s - before.omega_rad_s) / width : 0.0;
      const auto between = [&](Complex LoopPoint::*value) {
        return before.*value + share * ((*next).*value - before.*value);
      };
      for (const auto value :
           {&LoopPoint::complementary, &LoopPoint::sensitivity, &LoopPoint::d_hat_over_d,
            &LoopPoint::noise_to_d_hat, &LoopPoint::noise_to_v_hat}) {
        expect_near(point.*value, between(value), 5e-3, point.omega_rad_s);
      }
      EXPECT_EQ(point.saturated, 0.0);
    }
  }
}

// A delay of 1 s lowers the phase by ω rad. The marks are more than half a turn apart.
TEST(BodeChart, MarksAreOnTheTurnOfTheLine) {
  LoopAnalysis loop;
  const auto add = [](LoopCurve& curve, double omega) {
    LoopPoint& point = curve.points.emplace_back();
    point.omega_rad_s = omega;
    point.sensitivity = point.complementary = std::polar(1.0, -omega);
  };
  for (double omega = 0.1; omega < 20.0; omega += 0.1) add(loop.designed, omega);
  for (const double omega : {0.5, 4.0, 15.0}) add(loop.measured, omega);
  const BodeResponse response{"it", &LoopPoint::sensitivity, false, "", "", ""};
  const PageData marks = bode_charts(response, {loop}, {0}).at(1).at("data").at("series").at(1);
  double phase_deg = marks.at("from");
  for (std::size_t k = 0; k < loop.measured.points.size(); ++k) {
    phase_deg += marks.at("v").at(k).get<double>() * marks.at("step").get<double>();
    const double omega = loop.measured.points[k].omega_rad_s;
    EXPECT_NEAR(phase_deg, -omega * 180.0 / std::numbers::pi, 0.1);
  }
}

TEST(LoopAnalysis, AdaptiveFiltersAreOnlyMeasured) {
  const Prepared prepared("motor_estimation", "vfakfd", {});
  const LoopAnalysis analysis = prepared.analyse({.points = 0});
  EXPECT_NE(analysis.designed.reason, "");
  EXPECT_TRUE(analysis.designed.points.empty());
}

TEST(LoopAnalysis, ADelayReducesTheMargin) {
  const LoopAnalysis prompt =
      Prepared("motor_estimation", "idob", {"encoder.bits=0"}).analyse({.points = 0});
  const LoopAnalysis late =
      Prepared("motor_estimation", "idob", {"encoder.bits=0", "sensor.delay_samples=20"})
          .analyse({.points = 0});
  EXPECT_NEAR(prompt.designed.margins.delay_margin_s - late.designed.margins.delay_margin_s, 0.02,
              2e-5);
}

TEST(LoopAnalysis, TheDesignHasTheLinearPartsOfTheDrive) {
  const auto delay = [](double seconds) {
    return [seconds](Complex s) { return std::exp(-seconds * s); };
  };
  struct Row {
    std::vector<std::string> sets;
    std::function<Complex(Complex)> drive;
  };
  const std::vector<Row> rows = {
      {{"control.delay_s=0.02"}, delay(0.02)},
      {{"control.delay_s=0.0204"}, delay(0.0204)},
      {{"control.delay_s=4e-4", "sensor.delay_samples=3"}, delay(0.0034)},
      {{"control.jitter_s=0.01"}, delay(0.005)},
      {{"drive.current_bandwidth_rad_s=200"}, [](Complex s) { return 200.0 / (s + 200.0); }},
      {{"drive.current_bandwidth_rad_s=200", "drive.current_damping_ratio=0.3"},
       [](Complex s) { return 4e4 / (s * s + 120.0 * s + 4e4); }}};
  const AnalysisOptions options{.from_rad_s = 3.0, .to_rad_s = 30.0, .points = 0};
  const auto points = [&](std::vector<std::string> sets) {
    sets.emplace_back("encoder.bits=0");
    return Prepared("motor_estimation", "idob", sets).analyse(options).designed.points;
  };
  const std::vector<LoopPoint> ideal = points({});
  for (const Row& row : rows) {
    const std::vector<LoopPoint> real = points(row.sets);
    ASSERT_EQ(real.size(), ideal.size()) << row.sets.front();
    for (std::size_t i = 0; i < real.size(); ++i) {
      expect_near(real[i].loop_gain,
                  ideal[i].loop_gain * row.drive(Complex(0.0, real[i].omega_rad_s)), 1e-4,
                  real[i].omega_rad_s);
    }
  }
}

TEST(LoopAnalysis, EigenvaluesDecideWhetherALoopIsStable) {
  const KalmanLoop loop(1.5e4, 10.0, 5.0, 1e-3);
  int first_unstable = 1;
  while (loop.spectral_radius(first_unstable) <= 1.0) ++first_unstable;
  for (const int samples : {first_unstable - 1, first_unstable}) {
    for (const std::string& delay : {fmt::format("control.delay_s={}e-3", samples),
                                     fmt::format("sensor.delay_samples={}", samples)}) {
      const Prepared prepared("motor_estimation", "dkf", {delay});
      const AxisOfPlant axis = prepared.axis->loops().front();
      EXPECT_EQ(is_unstable(axis_loop_design(*axis.parts, axis.task, axis.plant)),
                samples == first_unstable)
          << delay;
    }
  }
}

// The run says the same as the analysis.
TEST(LoopAnalysis, ARunSaysWhetherItsLoopIsStable) {
  for (const std::string delay : {"control.delay_s=0.095", "sensor.delay_samples=96"}) {
    const Prepared prepared("motor_estimation", "idob", {delay, "run.duration_s=60"});
    EXPECT_TRUE(prepared.analyse({.points = 0}).designed.is_unstable) << delay;
    const std::vector<std::string> warnings = prepared.run.scenario->run({}).warnings;
    ASSERT_FALSE(warnings.empty()) << delay;
    EXPECT_TRUE(has(warnings.front(), "; the loop is not stable, even without"))
        << warnings.front();
  }
}

TEST(LoopAnalysis, AnUnstableLoopHasNoResponse) {
  const LoopAnalysis analysis =
      Prepared("motor_estimation", "idob", {"encoder.bits=0", "sensor.delay_samples=200"})
          .analyse({.points = 0});
  EXPECT_TRUE(analysis.designed.is_unstable);
  EXPECT_EQ(analysis.designed.reason, "its response to a pulse grows without bound");
}

constexpr double kDegrees = 180.0 / std::numbers::pi;

LoopMargins margins_of(const std::function<std::complex<double>(std::complex<double>)>& L) {
  std::vector<double> omega;
  std::vector<std::complex<double>> gain;
  for (int i = 0; i <= 4000; ++i) {
    omega.push_back(std::pow(10.0, -3.0 + 6.0 * i / 4000.0));
    gain.push_back(L({0.0, omega.back()}));
  }
  return loop_margins(omega, gain);
}

TEST(LoopMargins, AreRightForAnIntegratorAndALag) {
  // L = K/(s(s + 1)): ω_c⁴ + ω_c² = K², phase margin 90° − atan ω_c, no gain margin.
  const double K = 3.0;
  const LoopMargins margins = margins_of([&](auto s) { return K / (s * (s + 1.0)); });
  const double crossover = std::sqrt(0.5 * (std::sqrt(1.0 + 4.0 * K * K) - 1.0));
  EXPECT_NEAR(margins.crossover_rad_s, crossover, 1e-4 * crossover);
  EXPECT_NEAR(margins.phase_margin_rad * kDegrees, 90.0 - std::atan(crossover) * kDegrees, 1e-3);
  EXPECT_NEAR(margins.delay_margin_s, margins.phase_margin_rad / crossover, 1e-5);
  EXPECT_TRUE(std::isnan(margins.gain_margin));
  EXPECT_TRUE(std::isnan(margins.gain_reduction_margin));
  // M_t = 1/(2ζ√(1 − ζ²)) of s² + s + K, ζ = 1/(2√K).
  const double damping = 0.5 / std::sqrt(K);
  EXPECT_NEAR(margins.complementary_peak, 0.5 / (damping * std::sqrt(1.0 - damping * damping)),
              1e-4);
}

TEST(LoopMargins, AreRightForThreeLags) {
  // K/(s + 1)³ crosses −180° at √3, where it is K/8.
  const LoopMargins margins = margins_of([](auto s) { return 2.0 / std::pow(s + 1.0, 3); });
  EXPECT_NEAR(margins.gain_margin, 4.0, 1e-3);
  EXPECT_TRUE(std::isnan(margins.gain_reduction_margin));
}

TEST(LoopMargins, AreRightForAConditionallyStableLoop) {
  // K (s + 1)²/s³, closed s³ + K s² + 2 K s + K: stable for K > 1/2 (Routh).
  const LoopMargins margins =
      margins_of([](auto s) { return 2.0 * std::pow(s + 1.0, 2) / std::pow(s, 3); });
  EXPECT_NEAR(margins.gain_reduction_margin, 0.25, 1e-4);
  EXPECT_TRUE(std::isnan(margins.gain_margin));
}

TEST(LoopMargins, AreRightForADelay) {
  // e^{−s}/s: the phase margin is 90° − 1 rad, the delay margin 0.571 s; −180° at π/2.
  const LoopMargins margins = margins_of([](auto s) { return std::exp(-s) / s; });
  EXPECT_NEAR(margins.delay_margin_s, 0.5 * std::numbers::pi - 1.0, 1e-4);
  EXPECT_NEAR(margins.gain_margin, 0.5 * std::numbers::pi, 1e-3);
}

TEST(LoopMargins, NeedTwoFrequencies) {
  EXPECT_THROW(loop_margins({1.0}, {{1.0, 0.0}}), std::invalid_argument);
  EXPECT_THROW(loop_margins({1.0, 2.0}, {{1.0, 0.0}}), std::invalid_argument);
}

}  // namespace breakwater::loop_analysis_test
