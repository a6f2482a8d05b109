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
struct KnownSensorNoise : KalmanKeys {
  void bind(Fields& fields) {
    bind_model(fields);
    bind_initial_covariance(fields);
  }
  void bind_model(Fields& fields) {
    model.bind(fields);
    bind_process_noise(fields, positive());
  }
  KalmanDesign design(const NominalAxis& axis, const std::string& observer,
                      Eigen::Index most_states = kMostAxisStates) const {
    need_one_axis(axis, observer);
    const ExtendedPlant plant = model.extend(axis);
    if (plant.states() > most_states) {
      throw WrongKey("observer.disturbance_order",
                     "must be at most " + std::to_string(most_states - axis.plant.states() - 1) +
                         " for " + observer + " and this axis");
    }
    return known_sensor_design(plant, axis.sensor, process_noise, P0(plant));
  }
};

void bind_likelihood(Fields& fields, Likelihood& likelihood) {
  fields.optional_choice(
      "observer.likelihood", likelihood, {{"gauss", Likelihood::gauss}, {"code", Likelihood::code}},
      "likelihood of a measurement: a Gaussian density, or the probability of the "
      "encoder's code");
}

struct ImmkfSettings {
  KnownSensorNoise noise;
  ImmDesign imm;

  void bind(Fields& fields) {
    noise.bind(fields);
    bind_likelihood(fields, imm.likelihood);
    fields.optional_number("observer.noise_ratio", imm.noise_ratio, positive(),
                           "eta: process noise of the busy model over that of the quiet one");
    fields.optional_number("observer.stays_quiet", imm.stays_quiet, between(0, 1),
                           "probability that the quiet model stays from a sample to the next");
    fields.optional_number("observer.stays_busy", imm.stays_busy, between(0, 1),
                           "the same for the busy model");
  }
  Estimator make(const NominalAxis& axis) const {
    return sized_immkf(noise.design(axis, "immkf"), axis.sensor, imm);
  }
};

struct MckfSettings {
  KnownSensorNoise noise;
  CorrentropyDesign correntropy;

  void bind(Fields& fields) {
    noise.bind(fields);
    bind_likelihood(fields, correntropy.likelihood);
    fields.optional_number(
        "observer.kernel_width", correntropy.kernel_width, positive(),
        "sigma: width of the kernel, in standard deviations of the predicted disturbance");
  }
  Estimator make(const NominalAxis& axis) const {
    return sized_mckf(noise.design(axis, "mckf"), axis.sensor, correntropy);
  }
};

struct EsoSettings {
  EsoDesign given{.bandwidth_rad_s = 60.0, .linear_zone = 0.0};

  void bind(Fields& fields) {
    fields.optional_number("observer.bandwidth_rad_s", given.bandwidth_rad_s, positive(),
                           "omega_o: bandwidth; all poles are at -omega_o");
    fields.optional_number(
        "observer.linear_zone", given.linear_zone, not_negative(),
        "delta of Han's fal: innovation up to which the gains are linear; 0: always [rad, "
        "or m]");
  }
  Estimator make(const NominalAxis& axis) const {
    need_one_axis(axis, "eso");
    need_one_inertia(axis, "eso");
    EsoDesign design = given;
    if (design.linear_zone == 0.0) design.linear_zone = std::numeric_limits<double>::infinity();
    return blame("observer.bandwidth_rad_s",
                 [&] { return std::make_unique<Eso>(axis.plant, design, axis.period_s); });
  }
};

struct TrackingSettings {
  TrackingDesign given{.acceleration = 100.0, .filter_samples = 10.0};

  void bind(Fields& fields) {
    fields.optional_number("observer.largest_acceleration", given.acceleration, positive(),
                           "r of Han's fhan: largest acceleration of the estimate [rad/s2, or "
                           "m/s2]");
    fields.optional_number("observer.filter_samples", given.filter_samples, between(1, 1e6),
                           "h_0/T_s of Han's fhan: larger values filter more");
    bind_low_pass(fields, given.cutoff_rad_s);
  }
  Estimator make(const NominalAxis& axis) const {
    need_one_axis(axis, "tracking_differentiator");
    need_one_inertia(axis, "tracking_differentiator");
    TrackingDesign design = given;
    design.inertia = 1.0 / axis.plant.B(1, 0);
    return std::make_unique<TrackingDifferentiator>(design, axis.period_s);
  }
};

struct VbakfSettings {
  KnownSensorNoise noise;
  VariationalDesign variational;

  void bind(Fields& fields) {
    noise.bind(fields);
    fields.optional_number("observer.forgetting", variational.forgetting, between(0.01, 1),
                           "rho: forgetting factor of the estimate of R; 1: R is known");
    fields.optional_number("observer.prior_samples", variational.prior_samples, positive(),
                           "tau: weight of the predicted covariance, in samples");
    fields.optional_count("observer.iterations", variational.iterations, between(1, 100),
                          "fixed-point iterations in a sample");
  }
  Estimator make(const NominalAxis& axis) const {
    return sized_vbakf(noise.design(axis, "vbakf"), variational);
  }
};

struct GsfSettings {
  KnownSensorNoise noise;
  int parts = 5;

  void bind(Fields& fields) {
    noise.bind(fields);
    fields.optional_count("observer.parts", parts, between(1, 20),
                          "number of Gaussian densities after a sample");
  }
  Estimator make(const NominalAxis& axis) const {
    return sized_gsf(noise.design(axis, "gsf"), axis.sensor, parts);
  }
};

struct MheSettings {
  KnownSensorNoise noise;
  int horizon = 10;
  bool has_constraints = true;

  void bind(Fields& fields) {
    noise.bind_model(fields);  // P0 is not used
    fields.optional_count("observer.horizon", horizon, between(1, 50), "samples in the window");
    fields.optional_flag("observer.code_constraints", has_constraints,
                         "whether the codes' intervals are constraints");
  }
  Estimator make(const NominalAxis& axis) const {
    constexpr Eigen::Index kAnySize = 100;
    return std::make_unique<Mhe>(noise.design(axis, "mhe", kAnySize), axis.sensor, horizon,
                                 has_constraints);
  }
};

}  // namespace

std::vector<AxisEstimatorKind> published_estimators() {
  return {
      {"immkf", "interacting-multiple-model Kalman filter with a quiet and a busy disturbance",
       &ImmkfSettings::make},
      {"mckf", "maximum-correntropy Kalman filter as a disturbance observer", &MckfSettings::make},
      {"eso", "extended state observer, linear or with Han's nonlinear gains", &EsoSettings::make},
      {"tracking_differentiator", "Han's tracking differentiator with the MDOB's low-pass",
       &TrackingSettings::make},
      {"vbakf", "variational-Bayes adaptive Kalman filter", &VbakfSettings::make},
      {"gsf", "Gaussian-sum filter with the quantiser's likelihood", &GsfSettings::make},
      {"mhe", "moving-horizon estimation with the codes' intervals as constraints",
       &MheSettings::make}};
}

}  // namespace breakwater
