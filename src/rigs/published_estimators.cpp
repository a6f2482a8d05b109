#include <limits>

#include <breakwater/observers/eso.h>
#include <breakwater/observers/gsf.h>
#include <breakwater/observers/immkf.h>
#include <breakwater/observers/mckf.h>
#include <breakwater/observers/mhe.h>
#include <breakwater/observers/tracking_differentiator.h>
#include <breakwater/observers/vbakf.h>
#include <breakwater/rigs/estimator_settings.h>

namespace breakwater {
namespace {

// The noise of the published estimators: on the disturbance alone, with R from the sensor.
struct DisturbanceNoise {
  DisturbanceModel model;
  double process_noise = 0.0;

  void bind(Fields& fields) {
    model.bind(fields);
    bind_process_noise(fields, process_noise);
  }
  ExtendedPlant extend(const NominalAxis& axis, const std::string& observer) const {
    need_one_axis(axis, observer);
    if (!(process_noise > 0.0)) {
      throw WrongKey("observer.process_noise", "must be positive for this observer");
    }
    return model.extend(axis);
  }
};

// The same for the published Kalman filters.
struct KnownSensorNoise {
  DisturbanceNoise disturbance;
  std::vector<double> initial_covariance;

  void bind(Fields& fields) {
    disturbance.bind(fields);
    bind_initial_covariance(fields, initial_covariance);
  }
  KalmanDesign design(const NominalAxis& axis, const std::string& observer) const {
    const ExtendedPlant plant = disturbance.extend(axis, observer);
    if (plant.states() > kMostAxisStates) {
      throw WrongKey("observer.disturbance_order",
                     "must be at most " +
                         std::to_string(kMostAxisStates - axis.plant.states() - 1) + " for " +
                         observer + " and this axis");
    }
    return known_sensor_design(plant, axis.sensor, disturbance.process_noise,
                               diagonal_of(initial_covariance, plant));
  }
};

void bind_likelihood(Fields& fields, Likelihood& likelihood) {
  fields.choice("observer.likelihood", likelihood,
                {{"gauss", Likelihood::gauss}, {"code", Likelihood::code}},
                "likelihood of a measurement: a Gaussian density, or the probability of the "
                "encoder's code");
  fields.standard("observer.likelihood", {std::string("gauss")});
}

struct ImmSettings {
  KnownSensorNoise noise;
  ImmDesign imm;
};

void bind_immkf(Fields& fields, ImmSettings& settings) {
  settings.noise.bind(fields);
  bind_likelihood(fields, settings.imm.likelihood);
  fields.optional_number("observer.noise_ratio", settings.imm.noise_ratio, positive(),
                         "eta: process noise of the busy model over that of the quiet one");
  fields.optional_number("observer.stays_quiet", settings.imm.stays_quiet, between(0, 1),
                         "probability that the quiet model stays from a sample to the next");
  fields.optional_number("observer.stays_busy", settings.imm.stays_busy, between(0, 1),
                         "the same for the busy model");
}

Estimator make_immkf(const ImmSettings& settings, const NominalAxis& axis) {
  return sized_immkf(settings.noise.design(axis, "immkf"), axis.sensor, settings.imm);
}

struct CorrentropySettings {
  KnownSensorNoise noise;
  CorrentropyDesign correntropy;
};

void bind_mckf(Fields& fields, CorrentropySettings& settings) {
  settings.noise.bind(fields);
  bind_likelihood(fields, settings.correntropy.likelihood);
  fields.optional_number(
      "observer.kernel_width", settings.correntropy.kernel_width, positive(),
      "sigma: width of the kernel, in standard deviations of the predicted disturbance");
}

Estimator make_mckf(const CorrentropySettings& settings, const NominalAxis& axis) {
  return sized_mckf(settings.noise.design(axis, "mckf"), axis.sensor, settings.correntropy);
}

void bind_eso(Fields& fields, EsoDesign& settings) {
  fields.number("observer.bandwidth_rad_s", settings.bandwidth_rad_s, positive(),
                "omega_o: bandwidth; all poles are at -omega_o [rad/s]");
  fields.standard("observer.bandwidth_rad_s", {60.0});
  fields.number("observer.linear_zone", settings.linear_zone, not_negative(),
                "delta of Han's fal: innovation up to which the gains are linear; 0: always [rad, "
                "or m]");
  fields.standard("observer.linear_zone", {0.0});
}

Estimator make_eso(const EsoDesign& settings, const NominalAxis& axis) {
  need_one_axis(axis, "eso");
  need_one_inertia(axis, "eso");
  EsoDesign design = settings;
  if (design.linear_zone == 0.0) design.linear_zone = std::numeric_limits<double>::infinity();
  return blame("observer.bandwidth_rad_s",
               [&] { return std::make_unique<Eso>(axis.plant, design, axis.period_s); });
}

void bind_tracking_differentiator(Fields& fields, TrackingDesign& settings) {
  fields.number("observer.largest_acceleration", settings.acceleration, positive(),
                "r of Han's fhan: largest acceleration of the estimate [rad/s2, or m/s2]");
  fields.standard("observer.largest_acceleration", {100.0});
  fields.number("observer.filter_samples", settings.filter_samples, between(1, 1e6),
                "h_0/T_s of Han's fhan: larger values filter more");
  fields.standard("observer.filter_samples", {10.0});
  bind_low_pass(fields, settings.cutoff_rad_s);
}

Estimator make_tracking_differentiator(const TrackingDesign& settings, const NominalAxis& axis) {
  need_one_axis(axis, "tracking_differentiator");
  need_one_inertia(axis, "tracking_differentiator");
  TrackingDesign design = settings;
  design.inertia = 1.0 / axis.plant.B(1, 0);
  return std::make_unique<TrackingDifferentiator>(design, axis.period_s);
}

struct VariationalSettings {
  KnownSensorNoise noise;
  VariationalDesign variational;
};

void bind_vbakf(Fields& fields, VariationalSettings& settings) {
  settings.noise.bind(fields);
  fields.optional_number("observer.forgetting", settings.variational.forgetting, between(0.01, 1),
                         "rho: forgetting factor of the estimate of R; 1: R is known");
  fields.optional_number("observer.prior_samples", settings.variational.prior_samples, positive(),
                         "tau: weight of the predicted covariance, in samples");
  fields.optional_count("observer.iterations", settings.variational.iterations, between(1, 100),
                        "fixed-point iterations in a sample");
}

Estimator make_vbakf(const VariationalSettings& settings, const NominalAxis& axis) {
  return sized_vbakf(settings.noise.design(axis, "vbakf"), settings.variational);
}

struct GaussianSumSettings {
  KnownSensorNoise noise;
  int parts = 5;
};

void bind_gsf(Fields& fields, GaussianSumSettings& settings) {
  settings.noise.bind(fields);
  fields.optional_count("observer.parts", settings.parts, between(1, 20),
                        "number of Gaussian densities after a sample");
}

Estimator make_gsf(const GaussianSumSettings& settings, const NominalAxis& axis) {
  return sized_gsf(settings.noise.design(axis, "gsf"), axis.sensor, settings.parts);
}

struct MovingHorizonSettings {
  DisturbanceNoise noise;
  int horizon = 10;
  bool has_constraints = true;
};

void bind_mhe(Fields& fields, MovingHorizonSettings& settings) {
  settings.noise.bind(fields);
  fields.optional_count("observer.horizon", settings.horizon, between(1, 50),
                        "samples in the window");
  fields.flag("observer.code_constraints", settings.has_constraints,
              "whether the codes' intervals are constraints");
  fields.standard("observer.code_constraints", {settings.has_constraints});
}

Estimator make_mhe(const MovingHorizonSettings& settings, const NominalAxis& axis) {
  const ExtendedPlant plant = settings.noise.extend(axis, "mhe");
  const KalmanDesign design =
      known_sensor_design(plant, axis.sensor, settings.noise.process_noise,
                          Eigen::VectorXd::Ones(plant.states()));  // P0 is not used
  return std::make_unique<Mhe>(design, axis.sensor, settings.horizon, settings.has_constraints);
}

}  // namespace

std::vector<AxisEstimatorKind> published_estimators() {
  return {
      {"immkf", "interacting-multiple-model Kalman filter with a quiet and a busy disturbance",
       bind_immkf, make_immkf},
      {"mckf", "maximum-correntropy Kalman filter as a disturbance observer", bind_mckf, make_mckf},
      {"eso", "extended state observer, linear or with Han's nonlinear gains", bind_eso, make_eso},
      {"tracking_differentiator", "Han's tracking differentiator with the MDOB's low-pass",
       bind_tracking_differentiator, make_tracking_differentiator},
      {"vbakf", "variational-Bayes adaptive Kalman filter", bind_vbakf, make_vbakf},
      {"gsf", "Gaussian-sum filter with the quantiser's likelihood", bind_gsf, make_gsf},
      {"mhe", "moving-horizon estimation with the codes' intervals as constraints", bind_mhe,
       make_mhe}};
}

}  // namespace breakwater
