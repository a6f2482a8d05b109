// Breakwater's estimators and controllers of the quadrotor: their keys, and how to make them.
#include <breakwater/rigs/quadrotor_parts.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <breakwater/control/wave_mpc.h>
#include <breakwater/math/functions.h>
#include <breakwater/observers/resonator.h>
#include <breakwater/rigs/sea_forecasts.h>
#include <breakwater/world/waves.h>

namespace breakwater {
namespace {

struct KalmanSettings {
  QuadrotorEstimatorDesign design;
  bool has_printed_covariance = false;
  bool estimates_force = true;  // the force of the waves; else it is given
  double assumed_period_s = 0.0;
  double torque_arm_m = 0.0;

  bool is_spectrum() const { return design.order == DisturbanceOrder::spectrum; }
  void bind(Fields& fields);
  std::unique_ptr<QuadrotorEstimator> make(const QuadrotorTask& task) const;
};

void KalmanSettings::bind(Fields& fields) {
  fields.choice("estimator.filter", design.filter,
                {{"ukf", QuadrotorFilter::ukf}, {"ekf", QuadrotorFilter::ekf}},
                "nonlinear Kalman filter");
  fields.choice(
      "estimator.disturbance", design.order,
      {{"none", DisturbanceOrder::none},
       {"zero", DisturbanceOrder::zero},
       {"second", DisturbanceOrder::second},
       {"resonator", DisturbanceOrder::resonator},
       {"spectrum", DisturbanceOrder::spectrum}},
      "model of the disturbance: none; zero or second order, at the thrusters; resonator or "
      "spectrum (two resonators for each axis), of the waves' force");
  fields.optional_choice(
      "estimator.kinematics", design.kinematics,
      {{"level", AttitudeKinematics::level}, {"exact", AttitudeKinematics::exact}},
      "kinematics of the attitude: level (the angular rates equal the derivatives of the "
      "angles), or exact");
  fields.choice(
      "estimator.process_noise", design.noise,
      {{"printed", ProcessNoiseSource::printed},
       {"input", ProcessNoiseSource::input},
       {"tuned", ProcessNoiseSource::tuned}},
      "process noise: printed (Q_ukf), input (W_s through the thrusts, only for the EKF) or tuned");
  fields.choice(
      "estimator.process_noise_mode", design.noise_power,
      {{"per_step", 0}, {"delta", 1}, {"delta_squared", 2}},
      "how the printed Q is added at each sample: as it is, times delta, or times delta^2");
  fields.optional_choice("estimator.process_noise_states", design.only_highest_has_noise,
                         {{"all", false}, {"highest", true}},
                         "states with the printed Q: all, or only the model's highest derivative");
  fields.choice(
      "estimator.measurement_covariance", has_printed_covariance,
      {{"printed", true}, {"actual", false}},
      "R: printed (diag(V), for any noise.interpretation), or actual (the covariance of the "
      "noise)");
  fields.number("estimator.input_noise", design.input_noise, positive(),
                "W_s: variance of the noise of a thruster's input [N^2]");
  fields.number("estimator.tuned_velocity_std_m_s", design.velocity_std_m_s, positive(),
                "standard deviation of the random walk of the velocities, for each sample");
  fields.number("estimator.tuned_rate_std_rad_s", design.rate_std_rad_s, positive(),
                "standard deviation of the random walk of the angular rates, for each sample");
  fields.number("estimator.tuned_disturbance_std", design.disturbance_std, positive(),
                "standard deviation of the random walk of d, or of its second derivative, for each "
                "sample [N, N/s^2]");
  fields.choice("estimator.wave_frequency", design.estimates_wave_frequency,
                {{"given", false}, {"estimated", true}},
                "source of the waves' frequency: a given T_p, or an online estimate");
  fields.number(
      "estimator.assumed_period_s", assumed_period_s, not_negative(),
      "T_p of the estimator, or the initial value of its estimate; 0: wave.peak_period_s");
  fields.optional_choice(
      "estimator.wave_force", estimates_force, {{"given", false}, {"estimated", true}},
      "for spectrum: the standard deviation of the force is resonator_force_std_N (given) or "
      "estimated online");
  fields.optional_number(
      "estimator.wave_torque_arm_m", torque_arm_m, not_negative(),
      "for spectrum: ratio of the waves' torque to their horizontal force, z_B/C_m");
  ResonatorDesign& resonator = design.resonator;
  fields.number("estimator.resonator_damping", resonator.damping, between(0.001, 0.999),
                "damping ratio of the resonators");
  fields.number("estimator.resonator_force_std_N", resonator.force_std_N, positive(),
                "stationary standard deviation of the waves' vertical force");
  fields.number("estimator.resonator_velocity_std_m_s", resonator.velocity_std_m_s, positive(),
                "standard deviation of the random walk of the velocities, for each sample");
  fields.number("estimator.resonator_rate_std_rad_s", resonator.rate_std_rad_s, positive(),
                "standard deviation of the random walk of the angular rates, for each sample");
  fields.number("estimator.resonator_bias_std_N", resonator.bias_std_N, positive(),
                "standard deviation of the random walk of the constant forces, for each sample");
  fields.number("estimator.resonator_torque_std_Nm", resonator.torque_std_Nm, positive(),
                "standard deviation of the random walk of the torques, for each sample");

  fields.only_for({"estimator.process_noise", "estimator.process_noise_mode",
                   "estimator.process_noise_states", "estimator.input_noise",
                   "estimator.tuned_velocity_std_m_s", "estimator.tuned_rate_std_rad_s"},
                  "estimator.disturbance", {"none", "zero", "second"});
  fields.only_for({"estimator.tuned_disturbance_std"}, "estimator.disturbance", {"zero", "second"});
  fields.only_for({"estimator.process_noise_mode", "estimator.process_noise_states"},
                  "estimator.process_noise", {"printed"});
  fields.only_for({"estimator.input_noise"}, "estimator.process_noise", {"input"});
  fields.only_for({"estimator.tuned_velocity_std_m_s", "estimator.tuned_rate_std_rad_s",
                   "estimator.tuned_disturbance_std"},
                  "estimator.process_noise", {"tuned"});
  fields.only_for(
      {"estimator.wave_frequency", "estimator.assumed_period_s", "estimator.resonator_force_std_N",
       "estimator.resonator_velocity_std_m_s", "estimator.resonator_rate_std_rad_s",
       "estimator.resonator_bias_std_N", "estimator.resonator_torque_std_Nm"},
      "estimator.disturbance", {"resonator", "spectrum"});
  fields.only_for({"estimator.resonator_damping"}, "estimator.disturbance", {"resonator"});
  fields.only_for({"estimator.wave_force", "estimator.wave_torque_arm_m"}, "estimator.disturbance",
                  {"spectrum"});
  fields.only_where({"estimator.resonator_force_std_N"},
                    "estimator.disturbance is resonator, or estimator.wave_force is given",
                    [this] { return !is_spectrum() || !estimates_force; });
  fields.only_where({"estimator.assumed_period_s"},
                    "estimator.disturbance is resonator, or estimator.wave_frequency is given",
                    [this] { return !is_spectrum() || !design.estimates_wave_frequency; });
}

// The vertical force's spectrum in this sea, scaled to the standard deviation `strength_N`.
ForceSpectrum force_spectrum(const SeaState& sea, double depth_m, double strength_N) {
  constexpr double kLowest = 0.1, kHighest = 5.0;  // multiples of ω_p with all of the force
  constexpr int kIntervals = 400;
  SeaState unit = sea;  // the shape does not depend on the height
  unit.significant_height_m = 1.0;
  const SampledSpectrum water = acceleration_spectrum(unit, depth_m, kLowest, kHighest, kIntervals);
  double variance = 0.0;
  for (const double density : water.density) {
    variance += density * (water.omega_rad_s[1] - water.omega_rad_s[0]);
  }
  constexpr double kNothing = 1e-200;  // (m/s²)² for a wave of 1 m
  if (!(variance > kNothing)) {
    throw std::invalid_argument(
        "no waves of this period reach the reference depth: choose a longer period");
  }
  ForceSpectrum force{water.omega_rad_s, water.density, {}};
  for (double& density : force.density) density *= strength_N * strength_N / variance;
  return force;
}

ForceSpectrum with_noise_of(const AxisNoise& axis, ForceSpectrum spectrum) {
  for (const double omega : spectrum.omega_rad_s) {
    spectrum.noise.push_back(force_noise_density(axis, omega));
  }
  return spectrum;
}

// The seas of the spectrum's multiple-model estimator: one period, or fifteen from 4 to 14 s. The
// resonators fit the visible part of the spectrum of a force of medium strength.
void describe_waves(QuadrotorEstimatorDesign& design, const KalmanSettings& settings,
                    const SeaState& assumed, const QuadrotorTask& task) {
  const QuadrotorParameters& vehicle = task.plant.parameters();
  const AxisNoise vertical{.mass_kg = vehicle.moving_mass_kg(),
                           .position_std_m = design.position_std_m,
                           .velocity_std_m_s = design.resonator.velocity_std_m_s,
                           .bias_std_N = design.resonator.bias_std_N,
                           .period_s = design.period_s};
  const AxisNoise roll{.mass_kg = vehicle.inertia_kgm2.x(),
                       .position_std_m = design.angle_std_rad,
                       .velocity_std_m_s = design.resonator.rate_std_rad_s,
                       .bias_std_N = 0.0,
                       .period_s = design.period_s};
  WaveForceBankDesign& bank = design.waves;
  double middle_N = std::sqrt(bank.weakest_N * bank.strongest_N);
  if (!settings.estimates_force) {
    bank.weakest_N = middle_N = design.resonator.force_std_N;
    bank.strengths = 1;
  }
  const std::vector<double> periods_s =
      design.estimates_wave_frequency ? candidate_periods() : std::vector{assumed.peak_period_s};
  double log_walk = 0.0;
  for (const double period_s : periods_s) {
    SeaState sea = assumed;
    sea.peak_period_s = period_s;
    const ForceSpectrum force = force_spectrum(sea, -task.reference_m.z(), middle_N);
    ResonatorPair pair = fit_resonators(with_noise_of(vertical, force));
    for (Resonator& r : pair) r.std /= middle_N;
    bank.shapes.push_back(pair);
    if (settings.torque_arm_m == 0.0) continue;
    ForceSpectrum torque = force;  // about a horizontal axis
    for (double& density : torque.density) {
      density *= kHorizontalShare * settings.torque_arm_m * settings.torque_arm_m;
    }
    log_walk += math::log(fit_walk(with_noise_of(roll, torque), design.period_s) / middle_N) /
                static_cast<double>(periods_s.size());
  }
  design.torque_walk_per_force_m = settings.torque_arm_m == 0.0 ? 0.0 : math::exp(log_walk);
}

std::unique_ptr<QuadrotorEstimator> KalmanSettings::make(const QuadrotorTask& task) const {
  QuadrotorEstimatorDesign made = design;
  made.position_std_m =
      has_printed_covariance ? std::sqrt(task.position_noise) : task.position_std_m;
  made.angle_std_rad = has_printed_covariance ? std::sqrt(task.angle_noise) : task.angle_std_rad;
  made.period_s = task.period_s;
  // Place the resonators where the force has its energy, at the reference depth.
  SeaState assumed = task.waves.sea;
  if (assumed_period_s > 0.0) assumed.peak_period_s = assumed_period_s;
  made.wave_frequency_rad_s = mean_acceleration_frequency(assumed, -task.reference_m.z());
  if (is_spectrum()) {
    blame("estimator.assumed_period_s", [&] { describe_waves(made, *this, assumed, task); });
  }
  return blame("estimator.filter", [&] { return make_quadrotor_estimator(made, task.plant); });
}

enum class Gains { retuned, dlqr, printed, given };

struct BacksteppingSettings {
  Gains gains = Gains::retuned;
  double horizontal_gain = 1.0;
  double vertical_gain = 3.0;
  bool compensates = true;
  double lead_s = 0.0;
  BacksteppingDesign given;  // the clamps

  void bind(Fields& fields) {
    fields.choice(
        "controller.gains", gains,
        {{"retuned", Gains::retuned},
         {"dlqr", Gains::dlqr},
         {"printed", Gains::printed},
         {"given", Gains::given}},
        "gains: retuned (for the physical plant), dlqr (with Q_z = 1e4), printed, or given "
        "(retuned with controller.horizontal_gain and vertical_gain)");
    fields.optional_number("controller.horizontal_gain", horizontal_gain, positive(),
                           "for given: the gain alpha of x and y, and of their rates [1/s]");
    fields.optional_number("controller.vertical_gain", vertical_gain, positive(),
                           "for given: the gain alpha of z and of its rate [1/s]");
    fields.only_for({"controller.horizontal_gain", "controller.vertical_gain"}, "controller.gains",
                    {"given"});
    fields.flag("controller.compensate", compensates,
                "subtract the estimated disturbance from the input");
    fields.optional_number("controller.lead_s", lead_s, not_negative(),
                           "for resonator and spectrum: the horizontal force is the estimator's "
                           "forecast for so much later, since the vehicle must turn first");
    bind_clamps(fields);
  }
  void bind_clamps(Fields& fields) {
    fields.number("controller.position_clamp_m", given.position_clamp_m, not_negative(),
                  "clamp on the position errors; 0: no clamp");
    fields.number("controller.thrust_floor_N", given.thrust_floor_N, positive(),
                  "smallest U_z by which the controller divides");
  }
  BacksteppingGains alpha(const QuadrotorTask& task) const {
    const QuadrotorParameters& parameters = task.plant.parameters();
    if (gains == Gains::printed) return printed_gains();
    if (gains == Gains::dlqr) return dlqr_gains(parameters, task.period_s);
    BacksteppingGains alpha = retuned_gains(parameters, task.period_s);
    if (gains == Gains::given) {
      alpha(0) = alpha(1) = alpha(6) = alpha(7) = horizontal_gain;
      alpha(2) = alpha(8) = vertical_gain;
    }
    return alpha;
  }
  Backstepping make_law(const QuadrotorTask& task) const {
    BacksteppingDesign design = given;
    design.alpha = alpha(task);
    design.reference.head<3>() = task.reference_m;
    return {task.plant, design};
  }
  std::unique_ptr<Controller> make(const QuadrotorTask& task,
                                   std::shared_ptr<QuadrotorEstimator> estimator) const {
    return std::make_unique<BacksteppingController>(make_law(task), std::move(estimator),
                                                    compensates, lead_s);
  }
};

struct WaveMpcSettings {
  BacksteppingSettings law;  // clamps and the attitude's gains
  WaveMpcDesign mpc;
  using Forecast = std::unique_ptr<ForceForecast>;
  Forecast (WaveMpcSettings::*forecast)(const QuadrotorTask& task) const =
      &WaveMpcSettings::own<true>;
  AutoregressiveDesign autoregressive;
  double spacing_s = 0.5;
  double memory_s = 60.0;
  UpstreamDesign upstream;

  void bind(Fields& fields);
  template <bool goes_on>
  Forecast own(const QuadrotorTask& /*task*/) const {
    return std::make_unique<EstimatorForecast>(mpc.period_s, goes_on);
  }
  Forecast learned(const QuadrotorTask& task) const {
    AutoregressiveDesign design = autoregressive;
    design.spacing = static_cast<int>(std::round(std::min(spacing_s / mpc.period_s, 1e4)));
    design.memory = memory_s / mpc.period_s;
    design.largest = task.plant.parameters().thrust_limit_N;
    return blame("controller.autoregressive_spacing_s",
                 [&] { return std::make_unique<AutoregressiveForecast>(design); });
  }
  Forecast from_probe(const QuadrotorTask& task) const {
    UpstreamDesign design = upstream;
    design.period_s = mpc.period_s;
    return blame("controller.probe_window_s",
                 [&] { return std::make_unique<UpstreamForecast>(task, design); });
  }
  Forecast told(const QuadrotorTask& task) const {
    return blame("controller.forecast",
                 [&] { return std::make_unique<ToldForecast>(task, mpc.period_s); });
  }
  std::unique_ptr<Controller> make(const QuadrotorTask& task,
                                   std::shared_ptr<QuadrotorEstimator> estimator) const {
    return std::make_unique<WaveMpc>(law.make_law(task), std::move(estimator),
                                     (this->*forecast)(task), mpc, task.period_s);
  }
};

void WaveMpcSettings::bind(Fields& fields) {
  fields.optional_choice(
      "controller.forecast", forecast,
      {{"estimator", &WaveMpcSettings::own<true>},
       {"held", &WaveMpcSettings::own<false>},
       {"autoregressive", &WaveMpcSettings::learned},
       {"upstream", &WaveMpcSettings::from_probe},
       {"told", &WaveMpcSettings::told}},
      "forecast of the force: estimator (its model's free response), held (the present estimate) "
      "or autoregressive (identified on line). Told of the sea: upstream (a probe of the "
      "elevation), told (the future)");
  fields.optional_number("controller.period_s", mpc.period_s, positive(),
                         "period of the controller's decisions, a multiple of control.period_s");
  fields.optional_count("controller.prediction_steps", mpc.prediction_steps, between(1, 1000),
                        "N_p: number of predicted steps");
  fields.optional_number("controller.q_velocity", mpc.q_velocity, not_negative(),
                         "Q: weight on velocity");
  fields.optional_number("controller.r_horizontal", mpc.r_horizontal, positive(),
                         "R: weight on the change of the horizontal force [m^2/N^2]");
  fields.optional_number("controller.r_vertical", mpc.r_vertical, positive(),
                         "R: weight on the change of the vertical force [m^2/N^2]");
  law.bind_clamps(fields);

  fields.optional_count("controller.autoregressive_order", autoregressive.order, between(1, 50),
                        "number of past values in the autoregressive model");
  fields.optional_number(
      "controller.autoregressive_spacing_s", spacing_s, positive(),
      "time from one of these values to the next, a multiple of controller.period_s");
  fields.optional_number("controller.autoregressive_memory_s", memory_s, positive(),
                         "time constant of its forgetting");
  fields.only_for({"controller.autoregressive_order", "controller.autoregressive_spacing_s",
                   "controller.autoregressive_memory_s"},
                  "controller.forecast", {"autoregressive"});

  fields.optional_number("controller.probe_distance_m", upstream.distance_m, not_negative(),
                         "distance of the probe upstream from the reference");
  fields.optional_number("controller.probe_noise_m", upstream.noise_m, positive(),
                         "standard deviation of the probe's noise");
  fields.optional_number("controller.probe_window_s", upstream.window_s, positive(),
                         "length of the probe's record that the prediction takes");
  fields.only_for(
      {"controller.probe_distance_m", "controller.probe_noise_m", "controller.probe_window_s"},
      "controller.forecast", {"upstream"});
}

}  // namespace

std::vector<QuadrotorEstimatorKind> quadrotor_estimators() {
  return {{"kalman",
           "unscented or extended Kalman filter with one of five disturbance models (3.4)",
           &KalmanSettings::make}};
}

std::vector<QuadrotorControllerKind> quadrotor_controllers() {
  return {{"backstepping", "backstepping control with the estimated motion (3.4.2.1)",
           &BacksteppingSettings::make},
          {"wave_mpc", "predictive control with a forecast of the disturbing force",
           &WaveMpcSettings::make}};
}

}  // namespace breakwater
