// Breakwater's estimators and controllers of the quadrotor: the keys of each, and how it is made.
#include <breakwater/rigs/quadrotor_parts.h>

#include <cmath>

#include <breakwater/control/backstepping.h>
#include <breakwater/world/waves.h>

namespace breakwater {
namespace {

enum class WaveFrequencySource { given, estimated };
enum class MeasurementCovariance { printed, actual };

struct KalmanSettings {
  QuadrotorEstimatorDesign design;
  MeasurementCovariance covariance = MeasurementCovariance::actual;
  WaveFrequencySource frequency_source = WaveFrequencySource::given;
  double assumed_period_s = 0.0;
};

void bind_kalman(Fields& fields, KalmanSettings& settings) {
  fields.choice("estimator.filter", settings.design.filter,
                {{"ukf", QuadrotorFilter::ukf}, {"ekf", QuadrotorFilter::ekf}}, "ukf or ekf");
  fields.choice("estimator.disturbance", settings.design.order,
                {{"none", DisturbanceOrder::none},
                 {"zero", DisturbanceOrder::zero},
                 {"second", DisturbanceOrder::second},
                 {"resonator", DisturbanceOrder::resonator}},
                "the disturbance model: none, zero or second order at the thrusters, resonator");
  fields.choice("estimator.process_noise", settings.design.noise,
                {{"printed", ProcessNoiseSource::printed},
                 {"input", ProcessNoiseSource::input},
                 {"tuned", ProcessNoiseSource::tuned}},
                "printed: Q_ukf; input: W_s through the thrusts, EKF only; tuned: as below");
  fields.choice("estimator.process_noise_mode", settings.design.noise_mode,
                {{"per_step", ProcessNoiseMode::per_step},
                 {"delta", ProcessNoiseMode::delta},
                 {"delta_squared", ProcessNoiseMode::delta_squared}},
                "printed Q is added at each sample as it is, times delta, or times delta^2");
  fields.choice(
      "estimator.measurement_covariance", settings.covariance,
      {{"printed", MeasurementCovariance::printed}, {"actual", MeasurementCovariance::actual}},
      "R: printed, diag(V) whatever V is taken for; actual: the noise's own");
  fields.number("estimator.input_noise", settings.design.input_noise, positive(), "W_s [N^2]");
  fields.number("estimator.tuned_velocity_std_m_s", settings.design.velocity_std_m_s, positive(),
                "walk of the velocities at each sample [m/s]");
  fields.number("estimator.tuned_rate_std_rad_s", settings.design.rate_std_rad_s, positive(),
                "walk of the angular rates at each sample [rad/s]");
  fields.number("estimator.tuned_disturbance_std", settings.design.disturbance_std, positive(),
                "walk of d, or of its second derivative, at each sample [N, N/s^2]");
  fields.choice(
      "estimator.wave_frequency", settings.frequency_source,
      {{"given", WaveFrequencySource::given}, {"estimated", WaveFrequencySource::estimated}},
      "resonator: the frequency follows from a given T_p, or is estimated on line from there");
  fields.number("estimator.assumed_period_s", settings.assumed_period_s, not_negative(),
                "resonator: the sea's T_p that is given or guessed; 0: wave.peak_period_s [s]");
  ResonatorDesign& resonator = settings.design.resonator;
  fields.number("estimator.resonator_damping", resonator.damping, between(0.001, 0.999),
                "relative");
  fields.number("estimator.resonator_force_std_N", resonator.force_std_N, positive(),
                "of each resonator, stationary [N]");
  fields.number("estimator.resonator_velocity_std_m_s", resonator.velocity_std_m_s, positive(),
                "walk of the velocities at each sample [m/s]");
  fields.number("estimator.resonator_rate_std_rad_s", resonator.rate_std_rad_s, positive(),
                "walk of the angular rates at each sample [rad/s]");
  fields.number("estimator.resonator_bias_std_N", resonator.bias_std_N, positive(),
                "walk of the constant forces at each sample [N]");
  fields.number("estimator.resonator_torque_std_Nm", resonator.torque_std_Nm, positive(),
                "walk of the torques at each sample [N m]");

  fields.only_for(
      {"estimator.process_noise", "estimator.process_noise_mode", "estimator.input_noise",
       "estimator.tuned_velocity_std_m_s", "estimator.tuned_rate_std_rad_s"},
      "estimator.disturbance", {"none", "zero", "second"});
  fields.only_for({"estimator.tuned_disturbance_std"}, "estimator.disturbance", {"zero", "second"});
  fields.only_for({"estimator.process_noise_mode"}, "estimator.process_noise", {"printed"});
  fields.only_for({"estimator.input_noise"}, "estimator.process_noise", {"input"});
  fields.only_for({"estimator.tuned_velocity_std_m_s", "estimator.tuned_rate_std_rad_s",
                   "estimator.tuned_disturbance_std"},
                  "estimator.process_noise", {"tuned"});
  fields.only_for({"estimator.wave_frequency", "estimator.assumed_period_s",
                   "estimator.resonator_damping", "estimator.resonator_force_std_N",
                   "estimator.resonator_velocity_std_m_s", "estimator.resonator_rate_std_rad_s",
                   "estimator.resonator_bias_std_N", "estimator.resonator_torque_std_Nm"},
                  "estimator.disturbance", {"resonator"});
}

std::unique_ptr<QuadrotorEstimator> make_kalman(const KalmanSettings& settings,
                                                const QuadrotorTask& task) {
  QuadrotorEstimatorDesign design = settings.design;
  const bool printed = settings.covariance == MeasurementCovariance::printed;
  design.position_std_m = printed ? std::sqrt(task.position_noise) : task.position_std_m;
  design.angle_std_rad = printed ? std::sqrt(task.angle_noise) : task.angle_std_rad;
  design.period_s = task.period_s;
  // The resonators' place is where the force's energy is, at the depth that is to be held.
  SeaState assumed = task.sea;
  if (settings.assumed_period_s > 0.0) assumed.peak_period_s = settings.assumed_period_s;
  design.wave_frequency_rad_s = mean_acceleration_frequency(assumed, -task.reference_m.z());
  design.estimates_wave_frequency = settings.frequency_source == WaveFrequencySource::estimated;
  return blame("estimator.filter", [&] { return make_quadrotor_estimator(design, task.plant); });
}

enum class Gains { retuned, dlqr, printed };

struct BacksteppingSettings {
  Gains gains = Gains::retuned;
  bool compensates = true;
  double position_clamp_m = 0.0;
  double thrust_floor_N = 0.5;
};

void bind_backstepping(Fields& fields, BacksteppingSettings& settings) {
  fields.choice("controller.gains", settings.gains,
                {{"retuned", Gains::retuned}, {"dlqr", Gains::dlqr}, {"printed", Gains::printed}},
                "retuned for the physical plant, dlqr with Q_z = 1e4, or printed");
  fields.flag("controller.compensate", settings.compensates, "take the estimated disturbance off");
  fields.number("controller.position_clamp_m", settings.position_clamp_m, not_negative(),
                "position errors are held below it; 0: no clamp [m]");
  fields.number("controller.thrust_floor_N", settings.thrust_floor_N, positive(),
                "least U_z in divisors [N]");
}

BacksteppingGains gains(const BacksteppingSettings& settings, const QuadrotorTask& task) {
  const QuadrotorParameters& parameters = task.plant.parameters();
  switch (settings.gains) {
    case Gains::retuned:
      return retuned_gains(parameters, task.period_s);
    case Gains::dlqr:
      return dlqr_gains(parameters, task.period_s);
    case Gains::printed:
      return printed_gains();
  }
  throw std::logic_error("unknown gains");
}

std::unique_ptr<Controller> make_backstepping(const BacksteppingSettings& settings,
                                              const QuadrotorTask& task,
                                              std::shared_ptr<QuadrotorEstimator> estimator) {
  BacksteppingDesign design;
  design.alpha = gains(settings, task);
  design.reference.head<3>() = task.reference_m;
  design.position_clamp_m = settings.position_clamp_m;
  design.thrust_floor_N = settings.thrust_floor_N;
  return std::make_unique<QuadrotorController>(Backstepping(task.plant, design),
                                               std::move(estimator), settings.compensates);
}

}  // namespace

std::vector<QuadrotorEstimatorKind> quadrotor_estimators() {
  return {
      {"kalman", "UKF or EKF with one of four disturbance models (3.4)", bind_kalman, make_kalman}};
}

std::vector<QuadrotorControllerKind> quadrotor_controllers() {
  return {{"backstepping", "backstepping on the estimated motion (3.4.2.1)", bind_backstepping,
           make_backstepping}};
}

}  // namespace breakwater
