#include <breakwater/rigs/estimator_settings.h>

#include <limits>
#include <stdexcept>

#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/idob_estimator.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/mdob_estimator.h>
#include <breakwater/observers/qvff.h>
#include <breakwater/observers/state_observer.h>
#include <breakwater/observers/stf.h>
#include <breakwater/observers/vfakfd.h>

namespace breakwater {
namespace {

PoleGroup pole_group(const EstimatorSettings& settings) {
  return {settings.poles_rad_s.begin(), settings.poles_rad_s.end()};
}

ExtendedPlant extended_plant(const EstimatorSettings& settings, const AxisSettings& axis) {
  return extend_by_disturbance_model(
      zero_order_hold(axis.nominal_plant(), axis.physics.control_period_s),
      settings.disturbance_order, axis.physics.control_period_s);
}

Eigen::MatrixXd process_noise(const EstimatorSettings& settings, const ExtendedPlant& plant) {
  switch (settings.process_noise_on) {
    case ProcessNoise::input:
      return input_noise(plant, settings.process_noise);
    case ProcessNoise::all:
      return uniform_noise(plant, settings.process_noise);
    case ProcessNoise::disturbance:
      return disturbance_noise(plant, settings.process_noise);
  }
  throw std::logic_error("unknown process noise");
}

KalmanDesign kalman_design(const EstimatorSettings& settings, const AxisSettings& axis) {
  const ExtendedPlant plant = extended_plant(settings, axis);
  const auto& P0 = settings.initial_covariance;
  if (static_cast<Eigen::Index>(P0.size()) != plant.states()) {
    throw std::invalid_argument("needs one initial covariance for each of the " +
                                std::to_string(plant.states()) + " extended states");
  }
  const Eigen::Index p = plant.outputs();
  return {plant, process_noise(settings, plant),
          settings.observation_noise * Eigen::MatrixXd::Identity(p, p),
          Eigen::Map<const Eigen::VectorXd>(P0.data(), plant.states()).asDiagonal()};
}

MdobDesign mdob_design(const EstimatorSettings& settings, const StateSpace& plant) {
  MdobDesign design;
  design.nominal_inertia = 1.0 / plant.B(1, 0);
  design.derivative_cutoff_rad_s = settings.derivative_cutoff_rad_s > 0.0
                                       ? settings.derivative_cutoff_rad_s
                                       : std::numeric_limits<double>::infinity();
  design.observer_cutoff_rad_s = settings.observer_cutoff_rad_s;
  return design;
}

VfakfdDesign vfakfd_design(const EstimatorSettings& settings, const AxisSettings& axis) {
  VfakfdDesign design;
  if (settings.alpha == 0.0 && axis.pulses_per_revolution() == 0.0) {
    throw std::invalid_argument("alpha = 0 means Eq. 4.26, which needs a quantised encoder");
  }
  const double alpha = settings.alpha > 0.0 ? settings.alpha
                                            : vfakfd_alpha(axis.pulses_per_revolution(),
                                                           axis.physics.control_period_s);
  design.alpha = Eigen::VectorXd::Constant(1, alpha);
  design.dead_zone = Eigen::VectorXd::Zero(1);
  design.lambda_min = settings.lambda_min;
  design.lambda_max = settings.lambda_max;
  return design;
}

}  // namespace

void EstimatorSettings::bind(Fields& fields) {
  fields.choice("observer.name", kind,
                {{"state_observer", EstimatorKind::state_observer},
                 {"mdob", EstimatorKind::mdob},
                 {"idob", EstimatorKind::idob},
                 {"kfd", EstimatorKind::kfd},
                 {"fakfd", EstimatorKind::fakfd},
                 {"vfakfd", EstimatorKind::vfakfd},
                 {"qvff", EstimatorKind::qvff},
                 {"stf", EstimatorKind::stf}},
                "state_observer (no disturbance), mdob, idob, kfd, fakfd, vfakfd, qvff or stf");
  fields.count("observer.disturbance_order", disturbance_order, between(0, 2),
               "Kalman filters: the disturbance is a step (0), ramp (1) or parabola (2)");
  fields.number("observer.derivative_cutoff_rad_s", derivative_cutoff_rad_s, not_negative(),
                "mdob: g_d of the pseudo-derivative; 0: the raw difference [rad/s]");
  fields.number("observer.low_pass_cutoff_rad_s", observer_cutoff_rad_s, positive(),
                "mdob: g_w [rad/s]");
  fields.numbers("observer.poles_rad_s", poles_rad_s, any(),
                 "idob, state_observer: continuous poles [1/s]");
  fields.choice("observer.process_noise_on", process_noise_on,
                {{"input", ProcessNoise::input},
                 {"all", ProcessNoise::all},
                 {"disturbance", ProcessNoise::disturbance}},
                "kfd, fakfd: input (B Q B^T, the KFD), all (Q I) or disturbance (the DKF)");
  fields.number("observer.process_noise", process_noise, not_negative(), "kfd, fakfd, vfakfd: Q");
  fields.number("observer.observation_noise", observation_noise, positive(), "kfd, fakfd: R");
  fields.numbers("observer.initial_covariance", initial_covariance, positive(),
                 "kfd, fakfd, vfakfd: diagonal of P0, of position, velocity, d, ...");
  fields.number("observer.alpha", alpha, not_negative(),
                "vfakfd: alpha of Eq. 4.20; 0: 1/(b_reso T_s), Eq. 4.26");
  fields.number("observer.lambda_min", lambda_min, between(0, 1), "vfakfd, qvff");
  fields.number("observer.lambda_max", lambda_max, between(0, 1), "vfakfd, qvff");

  const auto only_for = [&](const std::string& key, const std::vector<std::string>& names) {
    fields.only_for({"observer." + key}, "observer.name", names);
  };
  only_for("disturbance_order", {"kfd", "fakfd", "vfakfd", "qvff", "stf"});
  only_for("derivative_cutoff_rad_s", {"mdob"});
  only_for("low_pass_cutoff_rad_s", {"mdob"});
  only_for("poles_rad_s", {"idob", "state_observer"});
  only_for("process_noise_on", {"kfd", "fakfd", "vfakfd"});
  only_for("process_noise", {"kfd", "fakfd", "vfakfd"});
  only_for("observation_noise", {"kfd", "fakfd"});
  only_for("initial_covariance", {"kfd", "fakfd", "vfakfd"});
  only_for("alpha", {"vfakfd"});
  only_for("lambda_min", {"vfakfd", "qvff"});
  only_for("lambda_max", {"vfakfd", "qvff"});
}

void EstimatorSettings::bind_gamma(Fields& fields) {
  fields.number("observer.gamma", gamma, between(1, 100),
                "fakfd: the factor of all states (Eq. 4.6)");
  fields.number("observer.gamma_d", gamma_d, between(1, 100),
                "fakfd: that of the disturbance and its derivatives, on top (Eq. 4.7)");
  fields.only_for({"observer.gamma", "observer.gamma_d"}, "observer.name", {"fakfd"});
}

std::unique_ptr<DisturbanceEstimator> make_estimator(const EstimatorSettings& settings,
                                                     const AxisSettings& axis) {
  switch (settings.kind) {
    case EstimatorKind::mdob:
      return std::make_unique<MdobEstimator>(mdob_design(settings, axis.nominal_plant()),
                                             axis.physics.control_period_s);
    case EstimatorKind::state_observer:
      return std::make_unique<StateObserver>(axis.nominal_plant(),
                                             std::vector<PoleGroup>{pole_group(settings)},
                                             axis.physics.control_period_s);
    case EstimatorKind::idob:
      return std::make_unique<IdobEstimator>(axis.nominal_plant(),
                                             std::vector<PoleGroup>{pole_group(settings)},
                                             axis.physics.control_period_s);
    case EstimatorKind::kfd:
      return std::make_unique<Kfd<>>(kalman_design(settings, axis));
    case EstimatorKind::fakfd: {
      const KalmanDesign design = kalman_design(settings, axis);
      return std::make_unique<Fakfd<>>(
          design, scalar_gamma(design.plant, settings.gamma)
                      .cwiseProduct(diagonal_gamma(design.plant, settings.gamma_d)));
    }
    case EstimatorKind::vfakfd:
      return std::make_unique<Vfakfd<>>(kalman_design(settings, axis),
                                        vfakfd_design(settings, axis));
    case EstimatorKind::qvff: {
      VfakfdDesign design = qvff_design(axis.sensor_error());
      design.lambda_min = settings.lambda_min;
      design.lambda_max = settings.lambda_max;
      return std::make_unique<Vfakfd<>>(
          variable_forgetting_design(extended_plant(settings, axis), kQvffInitialCovariance),
          design);
    }
    case EstimatorKind::stf: {
      const ExtendedPlant plant = extended_plant(settings, axis);
      return std::make_unique<Stf<>>(
          stf_design(plant, axis.sensor_error(), axis.physics.control_period_s),
          axis.sensor_error());
    }
  }
  throw std::logic_error("unknown estimator");
}

}  // namespace breakwater
