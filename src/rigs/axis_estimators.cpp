// Breakwater's estimators of an axis: their keys, and the functions that make them.
#include <breakwater/observers/asymmetric_fakfd.h>
#include <breakwater/observers/eso.h>
#include <breakwater/observers/gsf.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/immkf.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/mckf.h>
#include <breakwater/observers/mdob.h>
#include <breakwater/observers/mhe.h>
#include <breakwater/observers/multiple_model_estimator.h>
#include <breakwater/observers/qvff.h>
#include <breakwater/observers/state_observer.h>
#include <breakwater/observers/stf.h>
#include <breakwater/observers/tracking_differentiator.h>
#include <breakwater/observers/vbakf.h>
#include <breakwater/rigs/axis_parts.h>

namespace breakwater {
namespace {

using Estimator = std::unique_ptr<DisturbanceEstimator>;

// The plant of all axes has other inputs, outputs and states than one axis.
bool is_whole(const NominalAxis& axis) {
  const StateSpace& plant = axis.plant;
  return plant.inputs() != 1 || plant.outputs() != 1 || (plant.states() != 2 && axis.E.size() == 0);
}

void need_one_axis(const NominalAxis& axis, const std::string& observer) {
  if (!is_whole(axis)) return;
  throw WrongKey("observer.name", observer +
                                      " estimates a single axis; a whole plant can have none, "
                                      "state_observer, idob, kfd, fakfd, qvff or stf");
}

struct Poles {
  std::vector<std::vector<double>> poles_rad_s;

  std::vector<PoleGroup> of(const NominalAxis& axis) const {
    const std::size_t groups = poles_rad_s.size();
    if (is_whole(axis)) {
      if (static_cast<Eigen::Index>(groups) != axis.plant.outputs()) {
        throw std::invalid_argument("must be a row of poles for each of the " +
                                    std::to_string(axis.plant.outputs()) + " axes");
      }
      std::vector<PoleGroup> rows;
      for (const auto& row : poles_rad_s) rows.emplace_back(row.begin(), row.end());
      return rows;
    }
    if (groups != 1 && groups != static_cast<std::size_t>(axis.joints)) {
      throw std::invalid_argument(axis.joints == 1
                                      ? "must be the poles of one axis"
                                      : "must be poles, or a row of poles for each of the " +
                                            std::to_string(axis.joints) + " joints");
    }
    const std::vector<double>& own =
        poles_rad_s[groups == 1 ? 0 : static_cast<std::size_t>(axis.joint)];
    return {{own.begin(), own.end()}};
  }
};

void bind_poles(Fields& fields, Poles& settings) {
  fields.number_groups(
      "observer.poles_rad_s", settings.poles_rad_s, any(),
      "continuous poles: of an axis, of all joints of an arm alike, or in rows. There is a row for "
      "each joint of an arm, or for each axis of a whole plant, which places them "
      "with its measurement [1/s]");
}

Estimator make_state_observer(const Poles& settings, const NominalAxis& axis) {
  return blame("observer.poles_rad_s", [&] {
    return std::make_unique<StateObserver>(axis.plant, settings.of(axis), axis.period_s);
  });
}

// The IDOB and the MDOB estimate a disturbance at the input.
void need_one_inertia(const NominalAxis& axis, const std::string& observer) {
  if (axis.E.size() == 0) return;
  throw WrongKey("nominal.model", "must be rigid or motor for " + observer +
                                      ": it finds no disturbance behind a spring");
}

Estimator make_idob(const Poles& settings, const NominalAxis& axis) {
  need_one_inertia(axis, "idob");
  return blame("observer.poles_rad_s", [&] {
    return std::make_unique<Idob>(axis.plant, settings.of(axis), axis.period_s);
  });
}

struct MdobCutoffs {
  double derivative_rad_s = 0.0;  // g_d; 0: the raw difference
  double observer_rad_s = 0.0;    // g_w
};

void bind_low_pass(Fields& fields, double& cutoff_rad_s) {
  fields.number("observer.low_pass_cutoff_rad_s", cutoff_rad_s, positive(), "g_w [rad/s]");
}

void bind_mdob(Fields& fields, MdobCutoffs& settings) {
  fields.number("observer.derivative_cutoff_rad_s", settings.derivative_rad_s, not_negative(),
                "g_d: cut-off of the pseudo-derivative; 0: the raw difference [rad/s]");
  bind_low_pass(fields, settings.observer_rad_s);
}

Estimator make_mdob(const MdobCutoffs& settings, const NominalAxis& axis) {
  need_one_axis(axis, "mdob");
  need_one_inertia(axis, "mdob");
  MdobDesign design;
  design.nominal_inertia = 1.0 / axis.plant.B(1, 0);
  design.derivative_cutoff_rad_s = settings.derivative_rad_s > 0.0
                                       ? settings.derivative_rad_s
                                       : std::numeric_limits<double>::infinity();
  design.observer_cutoff_rad_s = settings.observer_rad_s;
  return std::make_unique<Mdob>(design, axis.period_s);
}

struct DisturbanceModel {
  int order = 0;

  void bind(Fields& fields) {
    fields.count("observer.disturbance_order", order, between(0, 2),
                 "disturbance model: step (0), ramp (1) or parabola (2)");
  }
  ExtendedPlant extend(const NominalAxis& axis) const {
    return axis.extended(order, axis.period_s);
  }
};

void bind_process_noise(Fields& fields, double& process_noise) {
  fields.number("observer.process_noise", process_noise, not_negative(), "Q: process noise");
}

void bind_initial_covariance(Fields& fields, std::vector<double>& initial_covariance) {
  fields.numbers("observer.initial_covariance", initial_covariance, positive(),
                 "diagonal of the initial covariance P0 of position, velocity, d, ...");
}

Eigen::VectorXd diagonal_of(const std::vector<double>& P0, const ExtendedPlant& plant) {
  if (static_cast<Eigen::Index>(P0.size()) != plant.states()) {
    throw WrongKey("observer.initial_covariance", "needs one initial covariance for each of the " +
                                                      std::to_string(plant.states()) +
                                                      " extended states");
  }
  return Eigen::Map<const Eigen::VectorXd>(P0.data(), plant.states());
}

enum class ProcessNoise { input, all, disturbance };

// The noise of the Kalman filters. Filters with a variable forgetting factor have no R.
struct KalmanNoise {
  DisturbanceModel model;
  ProcessNoise process_noise_on = ProcessNoise::input;
  double process_noise = 0.0;
  double observation_noise = 1.0;
  std::vector<double> initial_covariance;

  void bind(Fields& fields) {
    model.bind(fields);
    fields.choice("observer.process_noise_on", process_noise_on,
                  {{"input", ProcessNoise::input},
                   {"all", ProcessNoise::all},
                   {"disturbance", ProcessNoise::disturbance}},
                  "place of the process noise: input (B Q B^T, the KFD), all states (Q I) or "
                  "disturbance (the DKF)");
    bind_process_noise(fields, process_noise);
    bind_initial_covariance(fields, initial_covariance);
  }
  void bind_observation(Fields& fields) {
    fields.number("observer.observation_noise", observation_noise, positive(), "R");
  }

  KalmanDesign design(const NominalAxis& axis) const {
    const ExtendedPlant plant = model.extend(axis);
    const Eigen::Index p = plant.outputs();
    return {plant, Q(plant), observation_noise * Eigen::MatrixXd::Identity(p, p),
            diagonal_of(initial_covariance, plant).asDiagonal()};
  }

 private:
  Eigen::MatrixXd Q(const ExtendedPlant& plant) const {
    switch (process_noise_on) {
      case ProcessNoise::input:
        return input_noise(plant, process_noise);
      case ProcessNoise::all:
        return uniform_noise(plant, process_noise);
      case ProcessNoise::disturbance:
        return disturbance_noise(plant, process_noise);
    }
    throw std::logic_error("unknown process noise");
  }
};

void bind_kfd(Fields& fields, KalmanNoise& settings) {
  settings.bind(fields);
  settings.bind_observation(fields);
}

Estimator make_kfd(const KalmanNoise& settings, const NominalAxis& axis) {
  return std::make_unique<Kfd>(settings.design(axis));
}

struct FakfdSettings {
  KalmanNoise noise;
  double gamma = 1.0;
  double lambda = 1.0;
  double gamma_d = 1.0;
  CovarianceForm form = CovarianceForm::symmetric;
};

void bind_fakfd(Fields& fields, FakfdSettings& settings) {
  bind_kfd(fields, settings.noise);
  fields.number("observer.gamma", settings.gamma, between(1, 100),
                "gamma: forgetting of all states, 1/lambda (Eq. 4.6)");
  fields.number("observer.lambda", settings.lambda, between(0.01, 1),
                "lambda: the same as a forgetting factor, 1/gamma");
  fields.number("observer.gamma_d", settings.gamma_d, between(1, 100),
                "further forgetting of the disturbance and its derivatives (Eq. 4.7)");
  for (const char* key : {"observer.gamma", "observer.lambda", "observer.gamma_d"}) {
    fields.standard(key, {1.0});
  }
  const char* const form = "observer.covariance_form";
  fields.choice(
      form, settings.form,
      {{"symmetric", CovarianceForm::symmetric},
       {"printed", CovarianceForm::printed},
       {"left", CovarianceForm::left}},
      "Eq. 4.5 with G = Gamma: symmetric sqrt(G) (I - K C) P sqrt(G), printed (G - K C) P "
      "or left G (I - K C) P");
  fields.standard(form, {std::string("symmetric")});
}

Estimator make_fakfd(const FakfdSettings& settings, const NominalAxis& axis) {
  if (settings.gamma != 1.0 && settings.lambda != 1.0) {
    throw WrongKey("observer.lambda",
                   "must be 1 if observer.gamma is not 1, since both set the same factor");
  }
  const KalmanDesign design = settings.noise.design(axis);
  const Eigen::VectorXd gamma = scalar_gamma(design.plant, settings.gamma / settings.lambda)
                                    .cwiseProduct(diagonal_gamma(design.plant, settings.gamma_d));
  if (settings.form == CovarianceForm::symmetric) {
    return std::make_unique<Fakfd>(design, gamma);
  }
  return std::make_unique<AsymmetricFakfd>(design, gamma, settings.form);
}

struct ForgettingLimits {
  double lambda_min = 0.0;
  double lambda_max = 0.0;

  void bind(Fields& fields) {
    fields.number("observer.lambda_min", lambda_min, between(0, 1),
                  "lower bound of the forgetting factor");
    fields.number("observer.lambda_max", lambda_max, between(0, 1),
                  "upper bound of the forgetting factor");
  }
  void apply(VfakfdDesign& design) const {
    design.lambda_min = lambda_min;
    design.lambda_max = lambda_max;
  }
};

struct VfakfdSettings {
  KalmanNoise noise;
  double alpha = 0.0;
  ForgettingLimits limits;
};

void bind_vfakfd(Fields& fields, VfakfdSettings& settings) {
  settings.noise.bind(fields);
  fields.number("observer.alpha", settings.alpha, not_negative(),
                "alpha of Eq. 4.20; 0: 1/(b_reso T_s), Eq. 4.26");
  settings.limits.bind(fields);
}

Estimator make_vfakfd(const VfakfdSettings& settings, const NominalAxis& axis) {
  need_one_axis(axis, "vfakfd");
  if (settings.alpha == 0.0 && axis.pulses_per_revolution == 0.0) {
    throw WrongKey(
        "observer.alpha",
        "must be positive: 0 selects Eq. 4.26, which needs the encoder's counts per revolution");
  }
  VfakfdDesign design;
  design.alpha = Eigen::VectorXd::Constant(
      1, settings.alpha > 0.0 ? settings.alpha
                              : vfakfd_alpha(axis.pulses_per_revolution, axis.period_s));
  design.dead_zone = Eigen::VectorXd::Zero(1);
  settings.limits.apply(design);
  const KalmanDesign filter = settings.noise.design(axis);
  return blame("observer.lambda_min", [&] { return std::make_unique<Vfakfd>(filter, design); });
}

struct QvffSettings {
  DisturbanceModel model;
  ForgettingLimits limits;
};

void bind_qvff(Fields& fields, QvffSettings& settings) {
  settings.model.bind(fields);
  settings.limits.bind(fields);
}

Estimator make_qvff(const QvffSettings& settings, const NominalAxis& axis) {
  VfakfdDesign design = qvff_design(axis.sensor);
  settings.limits.apply(design);
  const KalmanDesign filter =
      variable_forgetting_design(settings.model.extend(axis), kQvffInitialCovariance);
  return blame("observer.lambda_min", [&] { return std::make_unique<Vfakfd>(filter, design); });
}

void bind_stf(Fields& fields, DisturbanceModel& settings) {
  settings.bind(fields);
}

Estimator make_stf(const DisturbanceModel& settings, const NominalAxis& axis) {
  return std::make_unique<Stf>(stf_design(settings.extend(axis), axis.sensor, axis.period_s),
                               axis.sensor);
}

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

struct MultipleModelSettings {
  double largest_d = 0.0;
};

void bind_multiple_model(Fields& fields, MultipleModelSettings& settings) {
  fields.number(
      "observer.largest_disturbance", settings.largest_d, not_negative(),
      "D: largest possible disturbance; 0: the drive's largest force, or the largest input "
      "of a record [N m, or N]");
  fields.standard("observer.largest_disturbance", {0.0});
}

Estimator make_multiple_model(const MultipleModelSettings& settings, const NominalAxis& axis) {
  need_one_axis(axis, "qbank");
  const double largest_d = settings.largest_d > 0.0 ? settings.largest_d : axis.force_limit;
  if (!(largest_d > 0.0) || !std::isfinite(largest_d)) {
    throw WrongKey("observer.largest_disturbance",
                   "must be positive here: 0 selects the largest input, which is 0 or unlimited");
  }
  return sized_multiple_model(
      {axis.plant, axis.period_s, axis.sensor, largest_d, axis.E, axis.inertia});
}

}  // namespace

std::vector<AxisEstimatorKind> axis_estimators() {
  return {
      {"state_observer", "state observer with placed poles, without a disturbance", bind_poles,
       make_state_observer},
      {"mdob", "minimal-order disturbance observer, the conventional one", bind_mdob, make_mdob},
      {"idob", "identity disturbance observer with placed poles", bind_poles, make_idob},
      {"kfd", "Kalman filter with a disturbance model", bind_kfd, make_kfd},
      {"fakfd", "KFD with constant forgetting factors", bind_fakfd, make_fakfd},
      {"vfakfd", "KFD with a variable forgetting factor", bind_vfakfd, make_vfakfd},
      {"qvff", "VFAKFD designed for quantisation and noise", bind_qvff, make_qvff},
      {"stf", "strong tracking filter: KFD that raises its covariance after a change", bind_stf,
       make_stf},
      {"qbank", "multiple-model estimator with the exact likelihood of the encoder",
       bind_multiple_model, make_multiple_model},
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
