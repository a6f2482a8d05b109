// Scenario quadrotor_waves: a quadrotor holds station under waves (thesis 3.4).
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <breakwater/control/backstepping.h>
#include <breakwater/experiment/run_loop.h>
#include <breakwater/math/float_environment.h>
#include <breakwater/record/held_reference.h>
#include <breakwater/record/window_metrics.h>
#include <breakwater/rigs/quadrotor_rig.h>
#include <breakwater/signals/thread_time.h>

#include "beyond_axes.h"

namespace breakwater {
namespace {

// Bounds in the window for a converged run: RMS of each axis, and largest distance.
constexpr double kConvergedRmse_m = 0.5;
constexpr double kConvergedPeak_m = 2.0;

double wrapped(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * std::numbers::pi);
}

// 1 if the error stays small in the window, else 0.
class Converged final : public Reduction {
 public:
  explicit Converged(const ReductionSetup& /*setup*/) {}
  void add(const AddedValues& added) override {
    const Eigen::Map<const Eigen::Vector3d> error(added.all.data());
    distance_.add(added.time_s, error.norm());
    for (std::size_t i = 0; i < axes_.size(); ++i) axes_[i].add(added.time_s, added.all[i]);
  }
  std::optional<double> value() const override {
    const bool is_small = *distance_.largest() < kConvergedPeak_m &&
                          std::all_of(axes_.begin(), axes_.end(), [](const auto& axis) {
                            return *axis.rms() < kConvergedRmse_m;
                          });
    return is_small ? 1.0 : 0.0;
  }

 private:
  static constexpr double kBegin_s = -std::numeric_limits<double>::infinity();

  WindowStatistics distance_{TimeWindow{kBegin_s}};
  std::array<WindowStatistics, 3> axes_{WindowStatistics(TimeWindow{kBegin_s}),
                                        WindowStatistics(TimeWindow{kBegin_s}),
                                        WindowStatistics(TimeWindow{kBegin_s})};
};

MetricKind converged() {
  return {.name = "converged",
          .meaning =
              "1 if its norm stays below 2 m and the root mean square of each value below "
              "0.5 m, else 0",
          .unit = ReducedUnit::one,
          .make = make_reduction<Converged>,
          .takes_all = true};
}

// The errors of measurements and estimates, and further signals for metrics.
struct StationErrors {
  Eigen::Vector3d measured_m = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 12, 1> motion = Eigen::Matrix<double, 12, 1>::Zero();
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
  double nees = 0.0;

  void observe(const QuadrotorTruth& truth, const Simulation& sim) {
    measured_m = sim.sample().y.head<3>() - truth.motion.head<3>();
  }
  void observe(const QuadrotorTruth& truth, const QuadrotorEstimator& estimator) {
    motion = estimator.motion() - truth.motion;
    for (int i = 3; i < 6; ++i) motion(i) = wrapped(motion(i));
    force_N = estimator.force() - truth.wave_force;
    nees = motion.dot(estimator.motion_covariance().llt().solve(motion));
  }

  std::vector<Signal> signals(const QuadrotorTruth& truth, const QuadrotorLoop& loop) const {
    std::vector<Signal> all = {
        {"position_measured_error_m", "m", "", view(measured_m)},
        {"horizontal_wave_force_N", "N", "", view(truth.wave_force).first(2)}};
    if (!loop.estimates()) return all;
    all.push_back({"position_hat_error_m", "m", "", view(motion).first(3)});
    all.push_back({"attitude_hat_error_rad", "rad", "", view(motion).subspan(3, 3)});
    all.push_back({"roll_rate_hat_error_rad_s", "rad/s", "", view(motion[9])});
    all.push_back({"nees", "1", "", view(nees)});
    if (!loop.estimator->models_disturbance()) return all;
    all.push_back({"horizontal_force_hat_error_N", "N", "", view(force_N).first(2)});
    all.push_back({"vertical_force_hat_error_N", "N", "", view(force_N[2])});
    return all;
  }
};

// Measures the time of an update of the filter on the run's first samples, after the run. The run
// itself thus depends on no clock.
class FilterTime {
 public:
  explicit FilterTime(bool is_measured) : room_(is_measured ? kSamples : 0) {
    poses_.reserve(room_);
    thrusts_.reserve(room_);
  }

  void add(const Simulation& sim) {
    if (poses_.size() == room_) return;
    poses_.emplace_back(sim.sample().y);
    thrusts_.emplace_back(sim.actuation());
  }

  double time_us(QuadrotorEstimator& estimator) const {
    const double begin = thread_time_s();
    estimator.reset(poses_.front());
    for (std::size_t k = 0; k < poses_.size(); ++k) {
      estimator.update(thrusts_[k > 0 ? k - 1 : 0], poses_[k]);
    }
    return 1e6 * (thread_time_s() - begin) / static_cast<double>(poses_.size());
  }

 private:
  static constexpr std::size_t kSamples = 2000;

  std::size_t room_;
  std::vector<Vector6d> poses_;
  std::vector<Eigen::Vector4d> thrusts_;
};

// A buoyant quadrotor goes to a point 10 m under waves and stays there. Its backstepping control
// uses the state of one of several nonlinear estimators.
class QuadrotorWaves final : public Scenario {
 public:
  explicit QuadrotorWaves(const Catalogue& catalogue)
      : Scenario(MetricRows(catalogue, "quadrotor_waves", {converged()})), quadrotor_(catalogue) {}

  std::string name() const override { return "quadrotor_waves"; }
  std::string summary() const override {
    return "underwater quadrotor under JONSWAP waves: nonlinear estimators, backstepping";
  }
  std::vector<MetricDefinition> metric_definitions() const override {
    std::vector<MetricDefinition> definitions = rows_.definitions();
    definitions.push_back({"filter_time_us", "us",
                           "cost, in manifest.json: processor time of one update of the estimator, "
                           "the mean of up to 2000 samples"});
    return definitions;
  }
  Fields fields() override {
    Fields fields;
    quadrotor_.bind(fields);
    fields.number("metrics.window_s", window_s_, positive(),
                  "length of the metrics' window, which ends with the run [s]");
    rows_.bind(fields);
    return fields;
  }
  void check(const Config& config) override {
    check_quadrotor(quadrotor_, config);
    rows_.check(
        config, [this] { return fields(); }, quadrotor_.physics);
  }
  const RunSettings& run_settings() const override { return quadrotor_.run; }
  std::vector<std::string> warnings() const override {
    const QuadrotorLoop loop = quadrotor_.parts.make(quadrotor_.task());
    const auto* controller = dynamic_cast<const BacksteppingController*>(loop.controller.get());
    const double pole =
        controller != nullptr ? slowest_pole(controller->law(), quadrotor_.plant()) : 0.0;
    std::vector<std::string> warnings = quadrotor_.warnings();
    if (pole > 0.0) {
      warnings.push_back(fmt::format(
          "controller.gains are unstable on this plant.model (a pole at {:+.3f}/s)", pole));
    }
    return warnings;
  }
  std::vector<WavingSurface> waving_surfaces(const Model& model) const override {
    if (model.geoms_named("surface").empty()) return {};  // a user's own model
    return {{"surface", quadrotor_.water(model).surface_waves()}};
  }
  Recording run(const RunControl& control) const override {
    const math::FloatEnvironment floats;
    QuadrotorRig rig(quadrotor_);
    const QuadrotorTruth& truth = rig.truth();
    const QuadrotorLoop& loop = rig.loop();
    const double end_s = quadrotor_.run.duration_s;
    StationErrors errors;
    std::vector<Signal> of_metrics = errors.signals(truth, loop);
    for (const Signal& signal : rig.signals()) of_metrics.push_back(signal);
    MetricValues values(rows_, of_metrics, end_s);
    HeldReference held({0.0, end_s >= window_s_ ? end_s : 0.0}, "the position", "m");
    held.ask(rig.distance_to_go_m());

    FilterTime filter_time(loop.estimates() && control.logs);

    const auto sample = [&](double time_s) {
      rig.observe();
      filter_time.add(rig.simulation());
      errors.observe(truth, rig.simulation());
      held.add(time_s, truth.error.norm());
      if (loop.estimates()) errors.observe(truth, *loop.estimator);
    };
    Recording recording = record_run(
        rig.simulation(), quadrotor_.physics, quadrotor_.physics.step_at(end_s), rig.signals(),
        control, [&](std::int64_t) { rig.step(); }, sample, &values);
    if (!recording.failure) held.warn(recording.warnings);
    if (!recording.failure && loop.estimates() && control.logs) {
      const auto estimator = quadrotor_.parts.make_estimator(quadrotor_.task());
      add(recording.costs, "filter_time_us", "us", filter_time.time_us(*estimator));
    }
    return recording;
  }

 private:
  QuadrotorSettings quadrotor_;
  double window_s_ = 0.0;
};

}  // namespace

ScenarioKind quadrotor_waves() {
  return scenario_kind<QuadrotorWaves>("quadrotor_waves", true);
}

}  // namespace breakwater
