// The scenario plant: shipped scenarios written as a plant's file, its metrics, and its refusals.
#include <breakwater/analysis/loop_analysis.h>
#include <breakwater/record/recording.h>

#include <cmath>
#include <map>

#include "catalogue.h"
#include "plant/declared_metrics.h"

namespace breakwater {
namespace {

constexpr const char* kMotor = R"(
scenario = "plant"
default_case = "own"
[model]
mjcf = "models/motor.xml"
[physics]
timestep_s = 1e-3
integrator = "rk4"
[control]
period_s = 1e-3
[run]
duration_s = 10.0
seed = 1
[axis.angle]
joint = "shaft"
encoder.bits = 12
encoder.rounding = "truncate"
disturbance.kind = "step"
disturbance.amplitude_Nm = 10.0
disturbance.start_s = 1.0
controller.name = "pd"
controller.kp = 10.0
controller.kd = 5.0
observer.name = "vfakfd"
observer.disturbance_order = 0
observer.process_noise_on = "input"
observer.process_noise = 0.0
observer.initial_covariance = [1e-8, 1e-8, 1e-8]
observer.alpha = 0.0
observer.lambda_min = 0.8
observer.lambda_max = 1.0
metric.rmse_velocity = { of = "angle_velocity_hat_rad_s", minus = "angle_velocity_true_rad_s", kind = "rmse", from_s = 5.0, to_s = 10.0 }
metric.rmse_position = { of = "angle_position_hat_rad", minus = "angle_position_true_rad", kind = "rmse", from_s = 5.0, to_s = 10.0 }
metric.rmse_disturbance = { of = "angle_d_hat_Nm", minus = "angle_d_true_Nm", kind = "rmse", from_s = 5.0, to_s = 10.0 }
metric.peak_position = { of = "angle_position_true_rad", kind = "peak" }
metric.rms_position = { of = "angle_position_true_rad", kind = "rms", from_s = 1.0 }
metric.rms_torque = { of = "angle_applied_Nm", kind = "rms", from_s = 1.0 }
metric.disturbance_settling_time = { of = "angle_d_hat_Nm", minus = "angle_d_true_Nm", kind = "settling", level = 0.5, from_s = 1.0, to_s = 10.0 }
metric.transient_rmse_disturbance = { of = "angle_d_hat_Nm", minus = "angle_d_true_Nm", kind = "rmse", from_s = 1.0, to_s = 5.0 }
metric.lambda_mean = { of = "angle_lambda", kind = "mean", from_s = 5.0, to_s = 10.0 }
metric.lambda_min = { of = "angle_lambda", kind = "min" }
[case.own]
[case.noisy]
axis.angle.noise.std_rad = 0.01
)";

constexpr const char* kCart = R"(
scenario = "plant"
default_case = "own"
[model]
mjcf = "models/cart.xml"
[physics]
timestep_s = 1e-3
integrator = "rk4"
[control]
period_s = 1e-3
[run]
duration_s = 10.0
seed = 1
[axis.cart]
joint = "rail"
plant.coulomb_friction_N = 0.3
drive.limit_N = 10.0
drive.resolution_N = 0.0390625
encoder.resolution_m = 2e-5
reference.kind = "step"
reference.value_m = 0.1
controller.name = "pd"
controller.kp = 10.0
controller.kd = 7.0710678118654755
observer.name = "fakfd"
observer.disturbance_order = 0
observer.process_noise_on = "input"
observer.process_noise = 1e-2
observer.observation_noise = 1e-4
observer.initial_covariance = [1e-2, 1e-4, 1e-2]
observer.gamma_d = 1.05
metric.steady_state_error = { of = "cart_reference_m", minus = "cart_position_true_m", kind = "mean", from_s = 5.0, to_s = 10.0 }
metric.settling_time = { of = "cart_reference_m", minus = "cart_position_true_m", kind = "settling", level = 0.005, to_s = 10.0 }
metric.estimate_rise_time = { of = "cart_d_hat_N", kind = "reach", level = 0.18963616764856731 }
metric.rms_input_step = { of = "cart_applied_N", kind = "rms_change", from_s = 5.0, to_s = 10.0 }
metric.max_position = { of = "cart_position_true_m", kind = "max" }
[case.own]
)";

// The tables of `text` are keys with dots after the tables of TOML, so they stand at the root.
std::string as_file(std::string text) {
  std::string metrics, rest;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    (line.starts_with("metric.") ? metrics : rest) += line + "\n";
  }
  return metrics + rest;
}

PreparedRun prepare_text(const std::string& text, const std::string& case_name,
                         const std::vector<std::string>& sets = {}) {
  const testing::TemporaryPath file("plant.toml", as_file(text));
  return prepare_run(testing::catalogue(), "plant", ScenarioFile(file, "plant"), case_name, sets);
}

std::map<std::string, double> metrics_of(const PreparedRun& run) {
  std::map<std::string, double> all;
  for (const Metric& metric : run.scenario->run({}).metrics) all[metric.name] = metric.value;
  return all;
}

void expect_same(const std::map<std::string, double>& own,
                 const std::map<std::string, double>& shipped) {
  for (const auto& [name, value] : own) {
    ASSERT_TRUE(shipped.contains(name)) << name;
    EXPECT_NEAR(value, shipped.at(name), 1e-9 * std::max(1.0, std::abs(value))) << name;
  }
}

// The axis has the name of the motor's sensor channel, and so its noise.
TEST(PlantTest, MotorEstimationAsAPlant) {
  const auto own = metrics_of(prepare_text(kMotor, "own"));
  EXPECT_EQ(own.size(), 10U);
  expect_same(own, metrics_of(testing::prepare("motor_estimation", "vfakfd")));
  expect_same(metrics_of(prepare_text(kMotor, "noisy")),
              metrics_of(testing::prepare("motor_estimation", "vfakfd", {"noise.std_rad=0.01"})));
}

TEST(PlantTest, CartPositionAsAPlant) {
  const auto own = metrics_of(prepare_text(kCart, "own"));
  EXPECT_EQ(own.size(), 5U);
  expect_same(own, metrics_of(testing::prepare("cart_position", "gamma-1.05")));
}

LoopAnalysis analysed(const PreparedRun& run) {
  const auto& scenario = dynamic_cast<const LoopScenario&>(*run.scenario);
  return analyse({{"it", scenario.loops().front()}},
                 {.from_rad_s = 0.5, .points = 3, .settle_s = 1.0})
      .front();
}

TEST(PlantTest, MotorEstimationAsAPlantHasTheSameLoop) {
  const std::vector<std::string> idob = {"observer.poles_rad_s=[-10,-20,-30]"};
  const LoopAnalysis one = analysed(prepare_text(
      kMotor, "own", {"axis.angle.observer.name=\"idob\"", "axis.angle." + idob.front()}));
  const LoopAnalysis other = analysed(testing::prepare("motor_estimation", "idob", idob));
  const LoopCurve &own = one.designed, &shipped = other.designed;
  ASSERT_FALSE(shipped.points.empty()) << shipped.reason;
  const auto near = [](double a, double b) { EXPECT_NEAR(a, b, 1e-9 * std::abs(b)); };
  near(own.margins.crossover_rad_s, shipped.margins.crossover_rad_s);
  near(own.margins.phase_margin_rad, shipped.margins.phase_margin_rad);
  near(own.margins.gain_reduction_margin, shipped.margins.gain_reduction_margin);
  near(own.margins.delay_margin_s, shipped.margins.delay_margin_s);
  near(own.margins.sensitivity_peak, shipped.margins.sensitivity_peak);
  near(own.bandwidth_rad_s, shipped.bandwidth_rad_s);
  ASSERT_EQ(one.measured.points.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    near(std::abs(one.measured.points[i].loop_gain), std::abs(other.measured.points[i].loop_gain));
  }
}

// The effective configuration of a run is a scenario file that gives the same run.
TEST(PlantTest, ItsConfigurationRunsAgain) {
  const PreparedRun run = prepare_text(kCart, "own");
  const PreparedRun again = prepare_text(run.config_text, "own");
  EXPECT_EQ(again.config_text, run.config_text);
  EXPECT_EQ(again.scenario->run({}).state_hash, run.scenario->run({}).state_hash);
}

// Another case may have an estimator that publishes it.
TEST(PlantTest, WarnsOfASignalThatIsNotThere) {
  const PreparedRun run =
      prepare_text(kCart, "own", {"metric.max_position.of=\"cart_position_tru_m\""});
  EXPECT_EQ(run.scenario->warnings(),
            std::vector<std::string>{"metric.max_position.of: the log has no signal "
                                     "\"cart_position_tru_m\" (did you mean "
                                     "cart_position_true_m?): the metric is absent"});
  EXPECT_FALSE(metrics_of(run).contains("max_position_m"));
}

struct Refused {
  const char* set;
  const char* message;  // its end
  const char* also = nullptr;
};

TEST(PlantTest, Refuses) {
  const Refused rows[] = {
      {"axis.cart.joint=\"rial\"", "axis.cart.joint: "},
      {"axis.cart.actuator=\"engine\"", "axis.cart.actuator: "},
      {"axis.cart.position_sensor=\"eye\"", "axis.cart.position_sensor: "},
      {"axis.other.joint=\"rail\"", "axis.other.joint: has another axis: each joint may have one"},
      {"axis.cart.controller.name=\"pid\"", "axis.cart.controller.name: must be one of "},
      {"axis.cart.observer.initial_covariance=[1.0]",
       "axis.cart.observer.initial_covariance: needs one initial covariance for each of the 3 "
       "extended states"},
      {"axis.cart.observer.lambda=0.9",
       "axis.cart.observer.lambda: must be 1 if observer.gamma is not 1",
       "axis.cart.observer.gamma=1.1"},
      {"axis.cart.reference.kind=\"csv\"", "axis.cart.reference.file: is missing"},
      {"metric.max_position.of=\"qpos[2]\"", "metric.max_position.of: qpos[2]: the signal has 1"},
      {"metric.steady_state_error.to_s=4.0",
       "metric.steady_state_error.to_s: must be later than from_s"},
      {"metric.max_position.kind=\"most\"", "metric.max_position.kind: must be one of "},
      {"start.keyframe=\"away\"", "start.keyframe: "},
      {"axis.cart.encoder.side=\"motor\"", "axis.cart.encoder.side: motor needs a transmission",
       "axis.cart.transmission.ratio=3.0"},
      {"axis.cart.transmission.stiffness_N_m=1e3",
       "axis.cart.transmission.motor_joint: a transmission with a stiffness needs"},
      {"push.hand.body=\"hand\"", "push.hand."},
      {"axis.a-b.joint=\"rail\"", "axis.a-b: a name here is made of A-Z, a-z, 0-9 and '_'"},
      {"controller.name=\"lqr\"", "controller.q_position: is missing"}};
  for (const Refused& row : rows) {
    std::vector<std::string> sets = {row.set};
    if (row.also != nullptr) sets.emplace_back(row.also);
    try {
      prepare_text(kCart, "own", sets);
      ADD_FAILURE() << row.set << " was not refused";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(row.message), std::string::npos)
          << row.set << ": " << error.what();
    }
  }
}

// In the step response of ω² / (s² + 2 ζ ω s + ω²) the overshoot is exp(−π ζ/√(1 − ζ²)). The error
// last leaves ±5 % where its sampled magnitude does.
TEST(DeclaredMetricTest, SecondOrderResponse) {
  constexpr double kZeta = 0.3, kOmega = 5.0, kStep = 1e-4;
  const double damped = kOmega * std::sqrt(1.0 - kZeta * kZeta);
  double error = 0.0;
  const std::vector<Signal> signals = {{"error_m", "m", "", view(error)}};
  DeclaredMetric settling{"s", "error_m", "none", DeclaredKind::settling, 0.0, 0.0, 0.05};
  DeclaredMetric overshoot{"o", "error_m", "none", DeclaredKind::overshoot, 0.0, 0.0, 0.0};
  DeclaredValue settles(settling, signals, 10.0), shoots(overshoot, signals, 10.0);
  double last_outside_s = 0.0;
  for (int k = 0; k <= 100000; ++k) {
    const double t = k * kStep;
    error = -std::exp(-kZeta * kOmega * t) *
            (std::cos(damped * t) + kZeta * kOmega / damped * std::sin(damped * t));
    if (std::abs(error) > 0.05) last_outside_s = t;
    settles.add(t, kStep);
    shoots.add(t, kStep);
  }
  EXPECT_NEAR(shoots.value().value(), std::exp(-M_PI * kZeta / std::sqrt(1.0 - kZeta * kZeta)),
              1e-6);
  EXPECT_NEAR(settles.value().value(), last_outside_s + kStep, 1e-9);
  EXPECT_EQ(settling.definition().name, "s_s");
  EXPECT_EQ(overshoot.definition().unit, "1");
}

}  // namespace
}  // namespace breakwater
