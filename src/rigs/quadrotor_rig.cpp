#include <breakwater/rigs/quadrotor_rig.h>

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include <breakwater/control/quadrotor_process.h>
#include <breakwater/sim/model.h>

namespace breakwater {
namespace {

constexpr const char* kChannels[] = {"x", "y", "z", "roll", "pitch", "yaw"};

Eigen::Vector3d vector3(const std::vector<double>& values) {
  return {values[0], values[1], values[2]};
}

// The standard deviation that V means.
double deviation(const QuadrotorSettings& settings, double V) {
  using Interpretation = QuadrotorSettings::NoiseInterpretation;
  return settings.interpretation == Interpretation::variance ? std::sqrt(V) : V;
}

// C_m = 1 + C_a on the physical plant: only then a neutral vehicle without drag follows the water.
std::optional<double> consistent_inertia_coefficient(const QuadrotorSettings& settings) {
  if (settings.physics_kind == QuadrotorPhysics::thesis || !settings.added_mass_coefficient) {
    return std::nullopt;
  }
  return 1.0 + *settings.added_mass_coefficient;
}

WaveLoadSetup wave_setup(const QuadrotorSettings& settings) {
  WaveLoadSetup setup = settings.waves;
  setup.inertia_coefficient = settings.inertia_coefficient.value_or(
      consistent_inertia_coefficient(settings).value_or(setup.inertia_coefficient));
  setup.sea.seed = settings.run.seed;
  setup.sea.gravity_m_s2 = settings.parameters.gravity_m_s2;
  setup.current_m_s = vector3(settings.current_m_s);
  return setup;
}

SensingSetup sensing_setup(const QuadrotorSettings& settings) {
  SensingSetup setup;
  for (int i = 0; i < 3; ++i) {
    setup.channels.push_back({.name = kChannels[i],
                              .sensor = "position",
                              .component = i,
                              .noise_std = deviation(settings, settings.V_m)});
  }
  constexpr Reading kAngles[] = {Reading::roll, Reading::pitch, Reading::yaw};
  for (int i = 0; i < 3; ++i) {
    setup.channels.push_back({.name = kChannels[3 + i],
                              .sensor = "attitude",
                              .reading = kAngles[i],
                              .noise_std = deviation(settings, settings.V_p)});
  }
  settings.faults.apply(setup);
  setup.seed = settings.run.seed;
  return setup;
}

void add_mass_of_water(const QuadrotorSettings& settings, Model& model) {
  const double added_kg = settings.vehicle().added_mass_kg();
  if (added_kg > 0.0) model.add_mass("quadrotor", added_kg);
}

Model load_model(const QuadrotorSettings& settings) {
  Model model = Model::load_physics(settings.mjcf);
  model.set_physics(settings.physics.timestep_s, settings.physics.integrator);
  add_mass_of_water(settings, model);
  return model;
}

}  // namespace

void QuadrotorSettings::bind(Fields& fields) {
  bind_model(fields, mjcf);
  fields.choice(
      "plant.model", physics_kind,
      {{"physical", QuadrotorPhysics::physical}, {"thesis", QuadrotorPhysics::thesis}},
      "physics of plant, estimator and controller: physical, or thesis (with G and C as printed)");
  fields.number("plant.added_mass_coefficient", added_mass_coefficient, not_negative(),
                "C_a: mass of water that moves with the vehicle, over that of the displaced water. "
                "Without this key: 0, as in earlier versions");
  physics.bind(fields);
  run.bind(fields);
  fields.numbers("task.start_m", start_m, any(), "start position x, y, z, at rest [m]");
  fields.numbers("task.reference_m", reference_m, any(), "reference position x, y, z [m]");

  fields.choice("wave.mode", waves.mode,
                {{"physical", WaveMode::physical}, {"thesis", WaveMode::thesis}},
                "model of the waves' force: physical (Morison's force), or thesis (one force "
                "through E, torques by atan2)");
  fields.number("wave.significant_height_m", waves.sea.significant_height_m, not_negative(),
                "H_s: significant wave height; 0: still water [m]");
  fields.number("wave.peak_period_s", waves.sea.peak_period_s, positive(),
                "T_p: peak period of the waves [s]");
  fields.number("wave.gamma", waves.sea.gamma, between(1, 20),
                "peak enhancement factor of the JONSWAP spectrum");
  fields.number("wave.heading_rad", waves.sea.heading_rad, any(),
                "direction of the waves, from x towards y [rad]");
  fields.number("wave.water_depth_m", waves.sea.water_depth_m, not_negative(),
                "depth of the bottom; 0: deep water [m]");
  fields.count("wave.components", waves.sea.components, between(1, 1000),
               "number of the sea's wave components");
  fields.numbers("wave.current_m_s", current_m_s, any(), "steady current along x, y, z [m/s]");
  fields.number(
      "wave.inertia_coefficient", inertia_coefficient, not_negative(),
      "C_m: inertia coefficient. Without this key: 1 + plant.added_mass_coefficient, or 1.5 "
      "for plant.model = \"thesis\"");
  fields.number(
      "wave.buoyancy_arm_m", waves.buoyancy_arm_m, any(),
      "for physical: z_B, height above the centre of mass at which the pressure acts [m]");
  fields.number("wave.torque_low_pass_s", waves.low_pass_s, positive(),
                "time constant of the filter of the slope (physical) or of the angle (thesis) [s]");
  fields.number("wave.torque_per_angle_Nm_rad", waves.torque_per_angle_Nm_rad, any(),
                "for thesis: torque for each radian of atan2 [N m/rad]");
  fields.number("wave.change_at_s", waves.change_at_s, not_negative(),
                "time at which T_p begins to change, over 10 s; 0: never [s]");
  fields.number("wave.change_to_period_s", waves.change_to_period_s, positive(),
                "T_p after the change [s]");

  fields.number("noise.position", V_m, positive(),
                "V_m: noise of the measured position [m or m^2]");
  fields.number("noise.angle", V_p, positive(), "V_p: noise of the measured angles [rad or rad^2]");
  fields.choice("noise.interpretation", interpretation,
                {{"variance", NoiseInterpretation::variance},
                 {"standard_deviation", NoiseInterpretation::standard_deviation}},
                "meaning of V_m and V_p");
  faults.bind(fields, "x, y, z, roll, pitch, yaw", run.duration_s);

  parts.bind(fields);
  fields.only_for({"plant.added_mass_coefficient"}, "plant.model", {"physical"});
  fields.only_for({"wave.current_m_s", "wave.buoyancy_arm_m"}, "wave.mode", {"physical"});
  fields.only_for({"wave.torque_per_angle_Nm_rad"}, "wave.mode", {"thesis"});
  fields.only_where({"wave.change_to_period_s"}, "wave.change_at_s is not 0",
                    [this] { return waves.change_at_s > 0.0; });
}

QuadrotorParameters QuadrotorSettings::vehicle() const {
  QuadrotorParameters vehicle = parameters;
  if (physics_kind == QuadrotorPhysics::physical) {
    vehicle.added_mass_coefficient = added_mass_coefficient.value_or(0.0);
  }
  return vehicle;
}

QuadrotorTask QuadrotorSettings::task() const {
  return {.plant = plant(),
          .period_s = physics.control_period_s,
          .reference_m = vector3(reference_m),
          .position_std_m = deviation(*this, V_m),
          .angle_std_rad = deviation(*this, V_p),
          .position_noise = V_m,
          .angle_noise = V_p,
          .waves = wave_setup(*this)};
}

UnderwaterForce QuadrotorSettings::water(const Model& model) const {
  return {model, vehicle(), physics_kind, wave_setup(*this), vector3(start_m)};
}

std::vector<std::string> QuadrotorSettings::warnings() const {
  const Model model = Model::load_physics(mjcf);
  const double mass_kg = model->body_subtreemass[model.id(mjOBJ_BODY, "quadrotor")];
  if (std::abs(mass_kg - parameters.mass_kg) <= 1e-9 * parameters.mass_kg) return {};
  return {fmt::format(
      "model.mjcf: the vehicle has {:.6g} kg; estimator and controller assume {:.6g} kg", mass_kg,
      parameters.mass_kg)};
}

void check_quadrotor(const QuadrotorSettings& settings, const Config& config) {
  settings.physics.check(config, settings.run);
  const auto is_point = [&](const char* key, const std::vector<double>& point) {
    if (point.size() != 3) config.fail(key, "must have 3 numbers: x, y and z");
  };
  const auto is_under_water = [&](const char* key, double z) {
    if (z > 0.0) config.fail(key, "z must not be above the surface, z = 0");
    const double depth_m = settings.waves.sea.water_depth_m;
    if (depth_m > 0.0 && z <= -depth_m) config.fail(key, "z must be above the water's bottom");
  };
  const std::optional<double> C_m = consistent_inertia_coefficient(settings);
  const double given = settings.inertia_coefficient.value_or(C_m.value_or(0.0));
  if (C_m && std::abs(given - *C_m) > 1e-9 * *C_m) {
    config.fail("wave.inertia_coefficient",
                fmt::format("must be 1 + plant.added_mass_coefficient = {}, is {}; leave it out",
                            *C_m, given));
  }
  is_point("task.start_m", settings.start_m);
  is_point("task.reference_m", settings.reference_m);
  is_point("wave.current_m_s", settings.current_m_s);
  is_under_water("task.start_m", settings.start_m[2]);
  is_under_water("task.reference_m", settings.reference_m[2]);
  Model model = Model::load_physics(settings.mjcf);
  if (model->nu != 4) throw std::invalid_argument(settings.mjcf.path + ": needs 4 thrusters");
  for (int i = 1; i <= 4; ++i) site_id(model, "t" + std::to_string(i));
  settings.water(model);
  config.blame("plant.added_mass_coefficient", [&] { add_mass_of_water(settings, model); });
  settings.parts.check(config, settings.task());
  const SensingSetup sensing = sensing_setup(settings);
  settings.faults.check(config, sensing.channels);
  const Sensing check_only(model, sensing);
}

QuadrotorRig::QuadrotorRig(const QuadrotorSettings& settings)
    : start_(vector3(settings.start_m)),
      reference_(vector3(settings.reference_m)),
      loop_(settings.parts.make(settings.task())),
      simulation_(load_model(settings), *loop_.controller, sensing_setup(settings),
                  settings.physics.steps_per_sample()),
      waves_(settings.water(simulation_.model())) {
  simulation_.add(waves_);
  simulation_.set_position(std::vector<double>{start_.x(), start_.y(), start_.z(), 1, 0, 0, 0});
}

void QuadrotorRig::step() {
  if (simulation_.steps() > 0) {
    const mjData& data = simulation_.data();
    waves_.advance(simulation_.time_of(simulation_.steps()), FreeMotion(data.qpos, data.qvel));
  }
  simulation_.step();
}

void QuadrotorRig::observe() {
  const double time_s = simulation_.time_s();
  const FreeMotion free(simulation_.qpos().data(), simulation_.qvel().data());
  truth_.motion << free.position, free.euler, free.velocity,
      attitude_rates(AttitudeTrig(free.euler), free.body_rates);
  truth_.error = reference_ - free.position;
  const Vector6d load = waves_.wave_load(time_s, free);
  truth_.wave_force = load.head<3>();
  truth_.wave_torque = load.tail<3>();
  truth_.elevation_m = waves_.elevation(time_s, free.position.x(), free.position.y());
  truth_.saturated = simulation_.saturated() ? 1.0 : 0.0;
}

std::vector<Signal> QuadrotorRig::signals() const {
  const Simulation& sim = simulation_;
  std::vector<Signal> signals = {
      {"qpos", "m, m, m, 1, 1, 1, 1", "the engine's generalised positions", sim.qpos()},
      {"motion_true", kMotionUnits, "true zeta and its rate", view(truth_.motion)},
      {"pose_measured", kPoseUnits, "sampled x, y, z, roll, pitch, yaw", view(sim.sample().y)},
      {"thrust_command_N", "N", "commanded thrusts", view(sim.command())},
      {"thrust_applied_N", "N", "thrusts after saturation", view(sim.actuation())},
      {"saturated", "1", "1 where any thrust is at its limit", view(truth_.saturated)},
      {"error_m", "m", "reference minus true position", view(truth_.error)},
      {"wave_force_N", "N", "true force of the waves, in the world", view(truth_.wave_force)},
      {"wave_torque_Nm", "N m", "true torque of the waves, in the world", view(truth_.wave_torque)},
      {"surface_elevation_m", "m", "elevation of the surface above the vehicle",
       view(truth_.elevation_m)}};
  for (const Signal& signal : loop_.controller->signals()) signals.push_back(signal);
  return signals;
}

}  // namespace breakwater
