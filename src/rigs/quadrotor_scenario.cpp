// A quadrotor under waves: the keys of its scenarios, its simulation, the true values.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include <breakwater/control/backstepping.h>
#include <breakwater/control/quadrotor_process.h>
#include <breakwater/experiment/run_loop.h>
#include <breakwater/math/float_environment.h>
#include <breakwater/record/held_reference.h>
#include <breakwater/rigs/quadrotor_parts.h>
#include <breakwater/sim/simulation.h>

namespace breakwater {
namespace {

constexpr const char* kVehicle = "quadrotor";

// Bounds in the window for a converged run: RMS of each axis, and largest distance.
constexpr double kConvergedRmse_m = 0.5;
constexpr double kConvergedPeak_m = 2.0;

// 1 if the error stays small in the window, else 0.
class Converged final : public Reduction {
 public:
  using Reduction::Reduction;
  void add(const AddedValues& added) override {
    const Eigen::Map<const Eigen::Vector3d> error(added.all.data());
    farthest_m_ = std::max(farthest_m_, error.norm());
    squares_ += error.array().square();
    count_ += 1.0;
  }
  std::optional<double> value() const override {
    const bool is_small = farthest_m_ < kConvergedPeak_m &&
                          (squares_ < kConvergedRmse_m * kConvergedRmse_m * count_).all();
    return is_small ? 1.0 : 0.0;
  }

 private:
  double farthest_m_ = 0.0;
  Eigen::Array3d squares_ = Eigen::Array3d::Zero();  // sums, one for each axis
  double count_ = 0.0;
};

// The values of a flight at a sample, for log and metrics.
struct Flight {
  using Motion = QuadrotorEstimator::Motion;  // the pose and its rate

  const Simulation& simulation;
  const UnderwaterForce& waves;
  const QuadrotorLoop& loop;
  Eigen::Vector3d reference;
  Motion motion = Motion::Zero();
  Eigen::Vector3d error = Eigen::Vector3d::Zero();  // reference minus position [m]
  Vector6d wave_load = Vector6d::Zero();            // force [N] and torque [N m] in the world
  double elevation_m = 0.0;                         // elevation of the surface above it
  double saturated = 0.0;                           // 1 if a thrust is at its limit
  // The errors of measurements and estimates.
  Eigen::Vector3d measured_error = Eigen::Vector3d::Zero();
  Motion motion_error = Motion::Zero();
  Eigen::Vector3d force_error = Eigen::Vector3d::Zero();
  double nees = 0.0;

  // Updates the values from the last step.
  void observe(double time_s) {
    const FreeMotion free(simulation.qpos().data(), simulation.qvel().data());
    motion << free.position, free.euler, free.velocity,
        attitude_rates(AttitudeTrig(free.euler), free.body_rates);
    error = reference - free.position;
    wave_load = waves.wave_load(time_s, free);
    elevation_m = waves.elevation(time_s, free.position.x(), free.position.y());
    saturated = simulation.saturated() ? 1.0 : 0.0;
    measured_error = simulation.sample().y.head<3>() - motion.head<3>();
    if (!loop.estimates()) return;
    const QuadrotorEstimator& estimator = *loop.estimator;
    motion_error = estimator.motion() - motion;
    for (double& angle : motion_error.segment<3>(3)) {
      angle = std::remainder(angle, 2.0 * std::numbers::pi);
    }
    force_error = estimator.force() - wave_load.head<3>();
    nees = motion_error.dot(estimator.motion_covariance().llt().solve(motion_error));
  }

  // The signals of the log at the control rate: true, measured, estimated and commanded.
  std::vector<Signal> signals() const {
    const Simulation& sim = simulation;
    std::vector<Signal> signals = {
        {"qpos", "m, m, m, 1, 1, 1, 1", "the engine's generalised positions", sim.qpos()},
        {"motion_true", kMotionUnits, "true zeta and its rate", view(motion)},
        {"pose_measured", kPoseUnits, "sampled x, y, z, roll, pitch, yaw", view(sim.sample().y)},
        {"thrust_command_N", "N", "commanded thrusts", view(sim.command())},
        {"thrust_applied_N", "N", "thrusts after saturation", view(sim.actuation())},
        {"saturated", "1", "1 where any thrust is at its limit", view(saturated)},
        {"error_m", "m", "reference minus true position", view(error)},
        {"wave_force_N", "N", "true force of the waves, in the world", view(wave_load).first(3)},
        {"wave_torque_Nm", "N m", "true torque of the waves, in the world",
         view(wave_load).subspan(3)},
        {"surface_elevation_m", "m", "elevation of the surface above the vehicle",
         view(elevation_m)}};
    for (const Signal& signal : loop.controller->signals()) signals.push_back(signal);
    return signals;
  }

  std::vector<Signal> signals_of_metrics() const {
    std::vector<Signal> all = {{"position_measured_error_m", "m", "", view(measured_error)},
                               {"horizontal_wave_force_N", "N", "", view(wave_load).first(2)}};
    if (!loop.estimates()) return all;
    all.push_back({"position_hat_error_m", "m", "", view(motion_error).first(3)});
    all.push_back({"attitude_hat_error_rad", "rad", "", view(motion_error).subspan(3, 3)});
    all.push_back({"roll_rate_hat_error_rad_s", "rad/s", "", view(motion_error[9])});
    all.push_back({"nees", "1", "", view(nees)});
    if (!loop.estimator->models_disturbance()) return all;
    all.push_back({"horizontal_force_hat_error_N", "N", "", view(force_error).first(2)});
    all.push_back({"vertical_force_hat_error_N", "N", "", view(force_error[2])});
    return all;
  }
};

class QuadrotorScenario final : public Scenario {
 public:
  QuadrotorScenario(const Catalogue& catalogue, const std::string& name, std::string summary)
      : Scenario(MetricRows(
            catalogue, name,
            {{.name = "converged",
              .meaning = "1 if its norm stays below 2 m and the root mean square of each value "
                         "below 0.5 m, else 0",
              .unit = "1",
              .make = make_reduction<Converged>,
              .takes_all = true}})),
        name_(name),
        summary_(std::move(summary)),
        parts_(catalogue, "backstepping", "kalman") {}

  std::string name() const override { return name_; }
  std::string summary() const override { return summary_; }
  Fields fields() override;
  void check(const Config& config, const Fields& fields) override;
  const RunSettings& run_settings() const override { return run_; }
  std::vector<std::string> warnings() const override;
  std::vector<WavingSurface> waving_surfaces(const Model& model) const override {
    if (model.geoms_named("surface").empty()) return {};  // a user's own model
    return {{"surface", wave_setup().water()}};
  }
  Recording run(const RunControl& control) const override;

 private:
  // The standard deviation that V means.
  double deviation(double V) const { return is_variance_ ? std::sqrt(V) : V; }
  // C_m = 1 + C_a on the physical plant: only then a neutral vehicle without drag follows the
  // water.
  std::optional<double> consistent_inertia_coefficient() const {
    if (physics_kind_ == QuadrotorPhysics::thesis || !added_mass_coefficient_) return std::nullopt;
    return 1.0 + *added_mass_coefficient_;
  }
  QuadrotorModel plant() const {
    QuadrotorParameters vehicle = parameters_;
    if (physics_kind_ == QuadrotorPhysics::physical) {
      vehicle.added_mass_coefficient = added_mass_coefficient_.value_or(0.0);
    }
    return {vehicle, physics_kind_};
  }
  WaveLoadSetup wave_setup() const {
    WaveLoadSetup setup = waves_;
    setup.inertia_coefficient = inertia_coefficient_.value_or(
        consistent_inertia_coefficient().value_or(setup.inertia_coefficient));
    setup.sea.seed = run_.seed;
    setup.sea.gravity_m_s2 = parameters_.gravity_m_s2;
    setup.current_m_s = Eigen::Vector3d(current_m_s_.data());
    return setup;
  }
  QuadrotorTask task() const {
    return {.plant = plant(),
            .period_s = physics_.control_period_s,
            .reference_m = Eigen::Vector3d(reference_m_.data()),
            .position_std_m = deviation(V_m_),
            .angle_std_rad = deviation(V_p_),
            .position_noise = V_m_,
            .angle_noise = V_p_,
            .waves = wave_setup()};
  }
  UnderwaterForce water(const Model& model) const {
    return {model, plant().parameters(), physics_kind_, wave_setup(),
            Eigen::Vector3d(start_m_.data())};
  }
  SensingSetup sensing() const {
    SensingSetup setup;
    for (int i = 0; const char* name : {"x", "y", "z"}) {
      setup.channels.push_back(
          {.name = name, .sensor = "position", .component = i++, .noise_std = deviation(V_m_)});
    }
    for (const auto& [name, angle] :
         {std::pair("roll", Reading::roll), {"pitch", Reading::pitch}, {"yaw", Reading::yaw}}) {
      setup.channels.push_back(
          {.name = name, .sensor = "attitude", .reading = angle, .noise_std = deviation(V_p_)});
    }
    faults_.apply(setup);
    setup.seed = run_.seed;
    return setup;
  }
  void add_mass_of_water(Model& model) const {
    const double added_kg = plant().parameters().added_mass_kg();
    if (added_kg > 0.0) model.add_mass(model.id(mjOBJ_BODY, kVehicle), added_kg);
  }

  std::string name_;
  std::string summary_;
  ModelFile mjcf_;
  QuadrotorParameters parameters_;  // Table 3.4, without added mass
  QuadrotorPhysics physics_kind_ = QuadrotorPhysics::physical;
  PhysicsSettings physics_;
  RunSettings run_;
  std::optional<double> added_mass_coefficient_;  // none in runs of earlier versions: 0
  std::vector<double> start_m_;
  std::vector<double> reference_m_;
  WaveLoadSetup waves_;
  std::optional<double> inertia_coefficient_;
  std::vector<double> current_m_s_;
  double V_m_ = 0.0;
  double V_p_ = 0.0;
  bool is_variance_ = false;  // the meaning of V_m and V_p; else standard deviations
  FaultSettings faults_;
  QuadrotorParts parts_;
  double window_s_ = 0.0;
};

Fields QuadrotorScenario::fields() {
  Fields fields;
  bind_model(fields, mjcf_);
  fields.choice(
      "plant.model", physics_kind_,
      {{"physical", QuadrotorPhysics::physical}, {"thesis", QuadrotorPhysics::thesis}},
      "physics of plant, estimator and controller: physical, or thesis (with G and C as printed)");
  fields.number("plant.added_mass_coefficient", added_mass_coefficient_, not_negative(),
                "C_a: mass of water that moves with the vehicle, over that of the displaced water. "
                "Without this key: 0, as in earlier versions");
  physics_.bind(fields);
  run_.bind(fields);
  fields.numbers("task.start_m", start_m_, any(), "start position x, y, z, at rest");
  fields.numbers("task.reference_m", reference_m_, any(), "reference position x, y, z");

  fields.choice("wave.mode", waves_.mode,
                {{"physical", WaveMode::physical}, {"thesis", WaveMode::thesis}},
                "model of the waves' force: physical (Morison's force), or thesis (one force "
                "through E, torques by atan2)");
  fields.number("wave.significant_height_m", waves_.sea.significant_height_m, not_negative(),
                "H_s: significant wave height; 0: still water");
  fields.number("wave.peak_period_s", waves_.sea.peak_period_s, positive(),
                "T_p: peak period of the waves");
  fields.number("wave.gamma", waves_.sea.gamma, between(1, 20),
                "peak enhancement factor of the JONSWAP spectrum");
  fields.number("wave.heading_rad", waves_.sea.heading_rad, any(),
                "direction of the waves, from x towards y");
  fields.number("wave.water_depth_m", waves_.sea.water_depth_m, not_negative(),
                "depth of the bottom; 0: deep water");
  fields.count("wave.components", waves_.sea.components, between(1, 1000),
               "number of the sea's wave components");
  fields.numbers("wave.current_m_s", current_m_s_, any(), "steady current along x, y, z");
  fields.number(
      "wave.inertia_coefficient", inertia_coefficient_, not_negative(),
      "C_m: inertia coefficient. Without this key: 1 + plant.added_mass_coefficient, or 1.5 "
      "for plant.model = \"thesis\"");
  fields.number("wave.buoyancy_arm_m", waves_.buoyancy_arm_m, any(),
                "for physical: z_B, height above the centre of mass at which the pressure acts");
  fields.number("wave.torque_low_pass_s", waves_.low_pass_s, positive(),
                "time constant of the filter of the slope (physical) or of the angle (thesis)");
  fields.number("wave.torque_per_angle_Nm_rad", waves_.torque_per_angle_Nm_rad, any(),
                "for thesis: torque for each radian of atan2");
  fields.number("wave.change_at_s", waves_.change_at_s, not_negative(),
                "time at which T_p begins to change, over 10 s; 0: never");
  fields.number("wave.change_to_period_s", waves_.change_to_period_s, positive(),
                "T_p after the change");

  fields.number("noise.position", V_m_, positive(),
                "V_m: noise of the measured position [m or m^2]");
  fields.number("noise.angle", V_p_, positive(),
                "V_p: noise of the measured angles [rad or rad^2]");
  fields.choice("noise.interpretation", is_variance_,
                {{"variance", true}, {"standard_deviation", false}}, "meaning of V_m and V_p");
  faults_.bind(fields, "x, y, z, roll, pitch, yaw", run_.duration_s);

  parts_.bind(fields);
  fields.only_for({"plant.added_mass_coefficient"}, "plant.model", {"physical"});
  fields.only_for({"wave.current_m_s", "wave.buoyancy_arm_m"}, "wave.mode", {"physical"});
  fields.only_for({"wave.torque_per_angle_Nm_rad"}, "wave.mode", {"thesis"});
  fields.only_with({"wave.change_to_period_s"}, "wave.change_at_s");
  fields.number("metrics.window_s", window_s_, positive(),
                "length of the metrics' window, which ends with the run");
  rows_.bind(fields);
  return fields;
}

std::vector<std::string> QuadrotorScenario::warnings() const {
  std::vector<std::string> warnings;
  const Model model = Model::load_physics(mjcf_);
  const double mass_kg = model->body_subtreemass[model.id(mjOBJ_BODY, kVehicle)];
  if (std::abs(mass_kg - parameters_.mass_kg) > 1e-9 * parameters_.mass_kg) {
    warnings.push_back(fmt::format(
        "model.mjcf: the vehicle has {:.6g} kg; estimator and controller assume {:.6g} kg", mass_kg,
        parameters_.mass_kg));
  }
  const QuadrotorLoop loop = parts_.make(task());
  const auto* controller = dynamic_cast<const BacksteppingController*>(loop.controller.get());
  const double pole = controller != nullptr ? slowest_pole(controller->law(), plant()) : 0.0;
  if (pole > 0.0) {
    warnings.push_back(fmt::format(
        "controller.gains are unstable on this plant.model (a pole at {:+.3f}/s)", pole));
  }
  return warnings;
}

void QuadrotorScenario::check(const Config& config, const Fields& fields) {
  physics_.check(config, run_);
  const auto is_point = [&](const char* key, const std::vector<double>& point) {
    if (point.size() != 3) config.fail(key, "must have 3 numbers: x, y and z");
  };
  const auto is_under_water = [&](const char* key, double z) {
    if (z > 0.0) config.fail(key, "z must not be above the surface, z = 0");
    const double depth_m = waves_.sea.water_depth_m;
    if (depth_m > 0.0 && z <= -depth_m) config.fail(key, "z must be above the water's bottom");
  };
  const std::optional<double> C_m = consistent_inertia_coefficient();
  const double given = inertia_coefficient_.value_or(C_m.value_or(0.0));
  if (C_m && std::abs(given - *C_m) > 1e-9 * *C_m) {
    config.fail("wave.inertia_coefficient",
                fmt::format("must be 1 + plant.added_mass_coefficient = {}, is {}; leave it out",
                            *C_m, given));
  }
  is_point("task.start_m", start_m_);
  is_point("task.reference_m", reference_m_);
  is_point("wave.current_m_s", current_m_s_);
  is_under_water("task.start_m", start_m_[2]);
  is_under_water("task.reference_m", reference_m_[2]);
  Model model = Model::load_physics(mjcf_);
  if (model->nu != 4) throw std::invalid_argument(mjcf_.path + ": needs 4 thrusters");
  for (int i = 1; i <= 4; ++i) site_id(model, "t" + std::to_string(i));
  water(model);
  config.blame("plant.added_mass_coefficient", [&] { add_mass_of_water(model); });
  parts_.check(config, task());
  const SensingSetup sensing = this->sensing();
  faults_.check(config, sensing.channels);
  const Sensing check_only(model, sensing);
  rows_.check(config, fields, physics_);
}

Recording QuadrotorScenario::run(const RunControl& control) const {
  const math::FloatEnvironment floats;
  Model model = Model::load_physics(mjcf_);
  model.set_physics(physics_.timestep_s, physics_.integrator);
  add_mass_of_water(model);
  UnderwaterForce waves = water(model);
  const QuadrotorLoop loop = parts_.make(task());
  Simulation sim(std::move(model), *loop.controller, sensing(), physics_.steps_per_sample());
  sim.add(waves);
  const Eigen::Vector3d start = Eigen::Vector3d(start_m_.data());
  sim.set_position(std::vector<double>{start.x(), start.y(), start.z(), 1, 0, 0, 0});
  Flight flight{sim, waves, loop, Eigen::Vector3d(reference_m_.data())};
  const double end_s = run_.duration_s;
  std::vector<Signal> of_metrics = flight.signals_of_metrics();
  for (const Signal& signal : flight.signals()) of_metrics.push_back(signal);
  MetricValues values(rows_, of_metrics, end_s);
  HeldReference held({0.0, end_s >= window_s_ ? end_s : 0.0}, "the position", "m");
  held.ask((flight.reference - start).norm());
  const auto step = [&](std::int64_t k) {
    // With the states of the waves at its beginning.
    if (k > 0) waves.advance(sim.time_of(k), FreeMotion(sim.data().qpos, sim.data().qvel));
    sim.step();
  };
  const auto sample = [&](double time_s) {
    flight.observe(time_s);
    held.add(time_s, flight.error.norm());
  };
  Recording recording = record_run(sim, physics_, physics_.step_at(end_s), flight.signals(),
                                   control, step, sample, &values);
  if (!recording.failure) held.warn(recording.warnings);
  return recording;
}

}  // namespace

ScenarioKind quadrotor_kind(const std::string& name, const std::string& summary) {
  return scenario_kind<QuadrotorScenario>(name, true, name, summary);
}

}  // namespace breakwater
