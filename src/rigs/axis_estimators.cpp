// Breakwater's estimators of an axis: their keys, and the functions that make them.
#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/mdob.h>
#include <breakwater/observers/multiple_model_estimator.h>
#include <breakwater/observers/state_observer.h>
#include <breakwater/observers/stf.h>
#include <breakwater/observers/vfakfd.h>
#include <breakwater/rigs/estimator_settings.h>

namespace breakwater {
namespace {

struct Poles {
  std::vector<std::vector<double>> poles_rad_s;

  void bind(Fields& fields) {
    fields.number_groups(
        "observer.poles_rad_s", poles_rad_s, any(),
        "continuous poles: of an axis, of all joints of an arm alike, or in rows. There is a row "
        "for each joint of an arm, or for each axis of a whole plant, which places them "
        "with its measurement [1/s]");
  }
  Estimator state_observer(const NominalAxis& axis) const {
    need_continuous(axis, "state_observer");
    return placed<StateObserver>(axis);
  }
  Estimator idob(const NominalAxis& axis) const {
    need_one_inertia(axis, "idob");
    return placed<Idob>(axis);
  }

 private:
  template <typename Observer>
  Estimator placed(const NominalAxis& axis) const {
    return blame("observer.poles_rad_s",
                 [&] { return std::make_unique<Observer>(axis.plant, of(axis), axis.period_s); });
  }
  std::vector<PoleGroup> of(const NominalAxis& axis) const {
    const bool has_rows = is_whole(axis);
    const std::size_t rows = has_rows ? static_cast<std::size_t>(axis.plant.outputs())
                                      : static_cast<std::size_t>(axis.joints);
    if (poles_rad_s.size() != rows && (has_rows || poles_rad_s.size() != 1)) {
      const std::string each = "a row of poles for each of the " + std::to_string(rows);
      throw std::invalid_argument(has_rows    ? "must be " + each + " axes"
                                  : rows == 1 ? "must be the poles of one axis"
                                              : "must be poles, or " + each + " joints");
    }
    std::vector<PoleGroup> all;
    for (const auto& row : poles_rad_s) all.emplace_back(row.begin(), row.end());
    if (has_rows || all.size() == 1) return all;
    return {all[static_cast<std::size_t>(axis.joint)]};
  }
};

struct MdobSettings {
  MdobDesign given;

  void bind(Fields& fields) {
    fields.number("observer.derivative_cutoff_rad_s", given.derivative_cutoff_rad_s, not_negative(),
                  "g_d: cut-off of the pseudo-derivative; 0: the raw difference");
    bind_low_pass(fields, given.observer_cutoff_rad_s);
  }
  Estimator make(const NominalAxis& axis) const {
    need_one_axis(axis, "mdob");
    need_one_inertia(axis, "mdob");
    MdobDesign design = given;
    design.nominal_inertia = 1.0 / axis.plant.B(1, 0);
    double& g_d = design.derivative_cutoff_rad_s;
    if (g_d == 0.0) g_d = std::numeric_limits<double>::infinity();
    return std::make_unique<Mdob>(design, axis.period_s);
  }
};

// The noise of the Kalman filters. Filters with a variable forgetting factor have no R.
struct KalmanNoise : KalmanKeys {
  Eigen::MatrixXd (*Q)(const ExtendedPlant& plant, double process_noise) = input_noise;
  double observation_noise = 1.0;

  void bind(Fields& fields) {
    model.bind(fields);
    fields.choice(
        "observer.process_noise_on", Q,
        {{"input", input_noise}, {"all", uniform_noise}, {"disturbance", disturbance_noise}},
        "place of the process noise: input (B Q B^T, the KFD), all states (Q I) or "
        "disturbance (the DKF)");
    bind_process_noise(fields, not_negative());
    bind_initial_covariance(fields);
  }

  KalmanDesign design(const NominalAxis& axis) const {
    const ExtendedPlant plant = model.extend(axis);
    const Eigen::Index p = plant.outputs();
    return {plant, Q(plant, process_noise), observation_noise * Eigen::MatrixXd::Identity(p, p),
            P0(plant).asDiagonal()};
  }
};

struct KfdSettings : KalmanNoise {
  void bind(Fields& fields) {
    KalmanNoise::bind(fields);
    fields.number("observer.observation_noise", observation_noise, positive(), "R");
  }
  Estimator make(const NominalAxis& axis) const { return std::make_unique<Kfd>(design(axis)); }
};

struct FakfdSettings : KfdSettings {
  double gamma = 1.0;
  double lambda = 1.0;
  double gamma_d = 1.0;
  CovarianceForm form = CovarianceForm::symmetric;

  void bind(Fields& fields) {
    KfdSettings::bind(fields);
    fields.optional_number("observer.gamma", gamma, between(1, 100),
                           "gamma: forgetting of all states, 1/lambda (Eq. 4.6)");
    fields.optional_number("observer.lambda", lambda, between(0.01, 1),
                           "lambda: the same as a forgetting factor, 1/gamma");
    fields.optional_number("observer.gamma_d", gamma_d, between(1, 100),
                           "further forgetting of the disturbance and its derivatives (Eq. 4.7)");
    fields.optional_choice(
        "observer.covariance_form", form,
        {{"symmetric", CovarianceForm::symmetric},
         {"printed", CovarianceForm::printed},
         {"left", CovarianceForm::left}},
        "Eq. 4.5 with G = Gamma: symmetric sqrt(G) (I - K C) P sqrt(G), printed (G - K C) P "
        "or left G (I - K C) P");
  }
  Estimator make(const NominalAxis& axis) const {
    if (gamma != 1.0 && lambda != 1.0) {
      throw WrongKey("observer.lambda",
                     "must be 1 if observer.gamma is not 1, since both set the same factor");
    }
    const KalmanDesign filter = design(axis);
    const Eigen::VectorXd all = scalar_gamma(filter.plant, gamma / lambda)
                                    .cwiseProduct(diagonal_gamma(filter.plant, gamma_d));
    return std::make_unique<Fakfd>(filter, all, form);
  }
};

struct ForgettingLimits {
  double lambda_min = 0.0;
  double lambda_max = 0.0;

  void bind(Fields& fields) {
    fields.number("observer.lambda_min", lambda_min, between(0, 1),
                  "lower bound of the forgetting factor");
    fields.number("observer.lambda_max", lambda_max, between(0, 1),
                  "upper bound of the forgetting factor");
  }
  Estimator make(const KalmanDesign& filter, VfakfdDesign design) const {
    design.lambda_min = lambda_min;
    design.lambda_max = lambda_max;
    return blame("observer.lambda_min", [&] { return std::make_unique<Vfakfd>(filter, design); });
  }
};

struct VfakfdSettings {
  KalmanNoise noise;
  double alpha = 0.0;
  double dead_zone = 0.0;
  ForgettingLimits limits;

  void bind(Fields& fields) {
    noise.bind(fields);
    fields.number("observer.alpha", alpha, not_negative(),
                  "alpha of Eq. 4.20; 0: 1/(b_reso T_s), Eq. 4.26");
    fields.optional_number("observer.dead_zone", dead_zone, not_negative(),
                           "size by which the innovation is reduced first [rad or m]");
    limits.bind(fields);
  }
  Estimator make(const NominalAxis& axis) const {
    need_one_axis(axis, "vfakfd");
    if (alpha == 0.0 && axis.pulses_per_revolution == 0.0) {
      throw WrongKey(
          "observer.alpha",
          "must be positive: 0 selects Eq. 4.26, which needs the encoder's counts per revolution");
    }
    VfakfdDesign design;
    design.alpha = Eigen::VectorXd::Constant(
        1, alpha > 0.0 ? alpha : vfakfd_alpha(axis.pulses_per_revolution, axis.period_s));
    design.dead_zone = Eigen::VectorXd::Constant(1, dead_zone);
    return limits.make(noise.design(axis), design);
  }
};

struct QvffSettings {
  DisturbanceModelKeys model;
  ForgettingLimits limits;

  void bind(Fields& fields) {
    model.bind(fields);
    limits.bind(fields);
  }
  Estimator make(const NominalAxis& axis) const {
    return limits.make(variable_forgetting_design(model.extend(axis), kQvffInitialCovariance),
                       qvff_design(axis.sensor));
  }
};

struct StfSettings : DisturbanceModelKeys {
  Estimator make(const NominalAxis& axis) const {
    return std::make_unique<Stf>(stf_design(extend(axis), axis.sensor, axis.period_s), axis.sensor);
  }
};

struct QbankSettings {
  double largest_d = 0.0;

  void bind(Fields& fields) {
    fields.optional_number(
        "observer.largest_disturbance", largest_d, not_negative(),
        "D: largest possible disturbance; 0: the drive's largest force, or the largest input "
        "of a record [N m, or N]");
  }
  Estimator make(const NominalAxis& axis) const {
    need_continuous(axis, "qbank");
    need_one_axis(axis, "qbank");
    const double largest = largest_d > 0.0 ? largest_d : axis.force_limit;
    if (!(largest > 0.0) || !std::isfinite(largest)) {
      throw WrongKey("observer.largest_disturbance",
                     "must be positive here: 0 selects the largest input, which is 0 or unlimited");
    }
    return sized_multiple_model(
        {axis.plant, axis.period_s, axis.sensor, largest, axis.E, axis.inertia});
  }
};

}  // namespace

std::vector<AxisEstimatorKind> axis_estimators() {
  return {{"state_observer", "state observer with placed poles, without a disturbance",
           &Poles::state_observer},
          {"mdob", "minimal-order disturbance observer, the conventional one", &MdobSettings::make},
          {"idob", "identity disturbance observer with placed poles", &Poles::idob},
          {"kfd", "Kalman filter with a disturbance model", &KfdSettings::make},
          {"fakfd", "KFD with constant forgetting factors", &FakfdSettings::make},
          {"vfakfd", "KFD with a variable forgetting factor", &VfakfdSettings::make},
          {"qvff", "VFAKFD designed for quantisation and noise, in m or rad", &QvffSettings::make},
          {"stf", "strong tracking filter: KFD that raises its covariance after a change",
           &StfSettings::make},
          {"qbank", "multiple-model estimator with the exact likelihood of the encoder",
           &QbankSettings::make}};
}

}  // namespace breakwater
