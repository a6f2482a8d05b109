#include "quadrotor_waves/quadrotor_waves.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include <breakwater/control/backstepping.h>
#include <breakwater/experiment/run_loop.h>
#include <breakwater/math/float_environment.h>
#include <breakwater/record/held_reference.h>
#include <breakwater/record/window_metrics.h>
#include <breakwater/signals/thread_time.h>

namespace breakwater {
namespace {

// Bounds in the window for a converged run: RMS of each axis, and largest distance.
constexpr double kConvergedRmse_m = 0.5;
constexpr double kConvergedPeak_m = 2.0;

double wrapped(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * std::numbers::pi);
}

// Root mean square per axis of a vector: √(mean |e|²/axes).
class VectorStatistics {
 public:
  VectorStatistics(const TimeWindow& window, double axes) : squares_(window), axes_(axes) {}
  template <typename Vector>
  void add(double time_s, const Vector& e) {
    squares_.add(time_s, e.squaredNorm() / axes_);
  }
  std::optional<double> rms() const {
    const auto mean = squares_.mean();
    if (!mean) return std::nullopt;
    return std::sqrt(*mean);
  }

 private:
  WindowStatistics squares_;
  double axes_;
};

class StationMetrics {
 public:
  explicit StationMetrics(const TimeWindow& window)
      : tracking_(window, 3.0),
        axes_{WindowStatistics(window), WindowStatistics(window), WindowStatistics(window)},
        error_(window),
        position_(window, 3.0),
        attitude_(window, 3.0),
        measured_position_(window, 3.0),
        roll_rate_(window),
        roll_rate_of_zero_(window),
        vertical_(window),
        vertical_of_zero_(window),
        horizontal_(window, 2.0),
        horizontal_of_zero_(window, 2.0),
        thrust_(window, 4.0),
        saturated_(window),
        nees_(window) {}

  void after_sample(double t, const QuadrotorTruth& truth, const Simulation& sim) {
    tracking_.add(t, truth.error);
    for (int i = 0; i < 3; ++i) axes_[static_cast<std::size_t>(i)].add(t, truth.error(i));
    error_.add(t, truth.error.norm());
    measured_position_.add(t, sim.sample().y.head<3>() - truth.motion.head<3>());
    roll_rate_of_zero_.add(t, truth.motion(9));
    const Eigen::Vector3d& force = truth.wave_force;
    vertical_of_zero_.add(t, force.z());
    horizontal_of_zero_.add(t, force.head<2>());
    thrust_.add(t, sim.actuation());
    saturated_.add(t, truth.saturated);
  }

  void after_estimate(double t, const QuadrotorTruth& truth, const QuadrotorEstimator& estimator) {
    Eigen::Matrix<double, 12, 1> off = estimator.motion() - truth.motion;
    for (int i = 3; i < 6; ++i) off(i) = wrapped(off(i));
    position_.add(t, off.head<3>());
    attitude_.add(t, off.segment<3>(3));
    roll_rate_.add(t, off(9));
    const Eigen::Vector3d force_off = estimator.force() - truth.wave_force;
    vertical_.add(t, force_off.z());
    horizontal_.add(t, force_off.head<2>());
    nees_.add(t, off.dot(estimator.motion_covariance().llt().solve(off)));
  }

  std::vector<Metric> metrics(bool models_disturbance) const {
    std::vector<Metric> list;
    add(list, "tracking_rmse_m", "m", tracking_.rms());
    add(list, "max_error_m", "m", error_.largest());
    if (error_.largest()) {
      const bool converged = *error_.largest() < kConvergedPeak_m &&
                             std::all_of(axes_.begin(), axes_.end(), [](const auto& axis) {
                               return *axis.rms() < kConvergedRmse_m;
                             });
      list.push_back({"converged", "1", converged ? 1.0 : 0.0});
    }
    add(list, "position_estimate_rmse_m", "m", position_.rms());
    add(list, "position_measurement_rmse_m", "m", measured_position_.rms());
    add(list, "attitude_estimate_rmse_rad", "rad", attitude_.rms());
    add(list, "roll_rate_rmse_rad_s", "rad/s", roll_rate_.rms());
    add(list, "roll_rate_rmse_of_zero_rad_s", "rad/s", roll_rate_of_zero_.rms());
    if (models_disturbance) {
      add(list, "vertical_force_rmse_N", "N", vertical_.rms());
      add(list, "horizontal_force_rmse_N", "N", horizontal_.rms());
    }
    add(list, "vertical_force_rmse_of_zero_N", "N", vertical_of_zero_.rms());
    add(list, "horizontal_force_rmse_of_zero_N", "N", horizontal_of_zero_.rms());
    add(list, "thrust_rms_N", "N", thrust_.rms());
    add(list, "saturated_fraction", "1", saturated_.mean());
    add(list, "nees_mean", "1", nees_.mean());
    return list;
  }

 private:
  VectorStatistics tracking_;
  std::array<WindowStatistics, 3> axes_;
  WindowStatistics error_;
  VectorStatistics position_;
  VectorStatistics attitude_;
  VectorStatistics measured_position_;
  WindowStatistics roll_rate_;
  WindowStatistics roll_rate_of_zero_;
  WindowStatistics vertical_;
  WindowStatistics vertical_of_zero_;
  VectorStatistics horizontal_;
  VectorStatistics horizontal_of_zero_;
  VectorStatistics thrust_;
  WindowStatistics saturated_;
  WindowStatistics nees_;
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

}  // namespace

std::vector<MetricDefinition> QuadrotorWaves::metric_definitions() const {
  return {
      {"tracking_rmse_m", "m",
       "root mean square of the position error, per axis, in the last metrics.window_s of the run"},
      {"max_error_m", "m", "largest distance from the reference, in the same window"},
      {"converged", "1",
       "1 if that distance stays below 2 m and the root mean square error of each axis below 0.5 "
       "m, else 0"},
      {"position_estimate_rmse_m", "m",
       "root mean square error of the estimated position, per axis"},
      {"position_measurement_rmse_m", "m",
       "root mean square error of the measured position, per axis"},
      {"attitude_estimate_rmse_rad", "rad",
       "root mean square error of the estimated attitude, per angle"},
      {"roll_rate_rmse_rad_s", "rad/s", "root mean square error of the estimated roll rate"},
      {"roll_rate_rmse_of_zero_rad_s", "rad/s",
       "root mean square of the true roll rate: the error of an estimate that is always 0"},
      {"vertical_force_rmse_N", "N",
       "root mean square error of the estimated vertical wave force; only where the estimator "
       "models it"},
      {"horizontal_force_rmse_N", "N",
       "root mean square error of the estimated horizontal wave force, per axis; only where the "
       "estimator models it"},
      {"vertical_force_rmse_of_zero_N", "N",
       "root mean square of the true vertical wave force: the error of an estimate that is always "
       "0"},
      {"horizontal_force_rmse_of_zero_N", "N",
       "root mean square of the true horizontal wave force, per axis: the error of an estimate "
       "that is always 0"},
      {"thrust_rms_N", "N", "root mean square of the applied thrust, per thruster"},
      {"saturated_fraction", "1", "share of the samples at which a thruster is at its limit"},
      {"nees_mean", "1",
       "mean of the normalised estimation error squared of the twelve motion states"},
      {"filter_time_us", "us",
       "cost, in manifest.json: processor time of one update of the estimator, the mean of up to "
       "2000 samples"}};
}

Fields QuadrotorWaves::fields() {
  Fields fields;
  quadrotor_.bind(fields);
  fields.number("metrics.window_s", window_s_, positive(),
                "length of the metrics' window, which ends with the run [s]");
  return fields;
}

void QuadrotorWaves::check(const Config& config) {
  check_quadrotor(quadrotor_, config);
}

std::vector<std::string> QuadrotorWaves::warnings() const {
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

std::vector<WavingSurface> QuadrotorWaves::waving_surfaces(const Model& model) const {
  if (model.geoms_named("surface").empty()) return {};  // a user's own model
  return {{"surface", quadrotor_.water(model).surface_waves()}};
}

Recording QuadrotorWaves::run(const RunControl& control) const {
  const math::FloatEnvironment floats;
  QuadrotorRig rig(quadrotor_);
  const QuadrotorTruth& truth = rig.truth();
  const QuadrotorLoop& loop = rig.loop();
  const double end_s = quadrotor_.run.duration_s;
  StationMetrics metrics(TimeWindow{end_s - window_s_, end_s}.within(end_s));
  HeldReference held({0.0, end_s >= window_s_ ? end_s : 0.0}, "the position", "m");
  held.ask(rig.distance_to_go_m());

  FilterTime filter_time(loop.estimates() && control.logs);

  const auto sample = [&](double time_s) {
    rig.observe();
    filter_time.add(rig.simulation());
    metrics.after_sample(time_s, truth, rig.simulation());
    held.add(time_s, truth.error.norm());
    if (loop.estimates()) metrics.after_estimate(time_s, truth, *loop.estimator);
  };
  const auto measured = [&] {
    return metrics.metrics(loop.estimates() && loop.estimator->models_disturbance());
  };
  Recording recording = record_run(
      rig.simulation(), quadrotor_.physics, quadrotor_.physics.step_at(end_s), rig.signals(),
      control, [&](std::int64_t) { rig.step(); }, sample, measured);
  if (!recording.failure) held.warn(recording.warnings);
  if (!recording.failure && loop.estimates() && control.logs) {
    const auto estimator = quadrotor_.parts.make_estimator(quadrotor_.task());
    add(recording.costs, "filter_time_us", "us", filter_time.time_us(*estimator));
  }
  return recording;
}

}  // namespace breakwater
