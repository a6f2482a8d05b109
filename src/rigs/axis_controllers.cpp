// Breakwater's controllers of an axis: their keys, and the functions that make them.
#include <breakwater/control/disturbance_cancelling_pd.h>
#include <breakwater/control/state_feedback.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/rigs/predictive_settings.h>

namespace breakwater {
namespace {

using SharedEstimator = std::shared_ptr<DisturbanceEstimator>;

struct PdSettings {
  double k_p = 0.0;
  double k_d = 0.0;
  double cancelled_share = 1.0;

  void bind(Fields& fields) {
    fields.number("controller.kp", k_p, not_negative(), "K_p: position gain [force per position]");
    fields.number("controller.kd", k_d, not_negative(), "K_d: velocity gain [force per velocity]");
    fields.optional_number("controller.cancelled_share", cancelled_share, between(0, 1),
                           "part of the estimated disturbance that is cancelled");
  }
  std::unique_ptr<Controller> make(const AxisTask& task, SharedEstimator estimator) const {
    return std::make_unique<DisturbanceCancellingPd>(
        std::move(estimator), DisturbanceCancellingPdDesign{.k_p = k_p,
                                                            .k_d = k_d,
                                                            .cancelled_share = cancelled_share,
                                                            .reference = task.measured_reference(),
                                                            .force_limit = task.axis.force_limit,
                                                            .period_s = task.axis.period_s,
                                                            .units = task.axis.units,
                                                            .start_state = task.start()});
  }
};

struct ResonanceRatioSettings {
  double damping_ratio = 1.0;

  void bind(Fields& fields) {
    fields.optional_number(
        "controller.damping_ratio", damping_ratio, positive(),
        "zeta: damping ratio of the closed loop's two double poles at the anti-resonance");
  }
  std::unique_ptr<Controller> make(const AxisTask& task, SharedEstimator estimator) const {
    const NominalAxis& axis = task.axis;
    if (axis.measured != Side::motor || axis.E.size() != 0) {
      throw WrongKey("nominal.model",
                     "must be motor for resonance ratio control, with an encoder on the motor");
    }
    if (!axis.inertias) {
      throw WrongKey(axis.why_no_inertias, "must be positive for resonance ratio control");
    }
    const ResonanceRatioGains gains = resonance_ratio(*axis.inertias, damping_ratio);
    return PdSettings{gains.k_p, gains.k_d, gains.cancelled_share()}.make(task,
                                                                          std::move(estimator));
  }
};

struct StateFeedbackSettings {
  std::vector<double> poles_rad_s;

  void bind(Fields& fields) {
    fields.numbers("controller.poles_rad_s", poles_rad_s, any(),
                   "continuous poles of the state feedback, one for each state [1/s]");
  }
  std::unique_ptr<Controller> make(const AxisTask& task, SharedEstimator estimator) const {
    const NominalAxis& axis = task.axis;
    StateFeedbackDesign design{.plant = axis.plant,
                               .E = axis.E.size() == 0 ? Eigen::VectorXd(axis.plant.B) : axis.E,
                               .controlled = axis.controlled,
                               .K = {},
                               .reference = task.modelled_reference(),
                               .force_limit = axis.force_limit,
                               .period_s = axis.period_s,
                               .units = axis.units,
                               .start_state = task.start()};
    design.K = blame("controller.poles_rad_s", [&] {
      return place_feedback_poles(axis.plant, {poles_rad_s.begin(), poles_rad_s.end()},
                                  axis.period_s);
    });
    return std::make_unique<StateFeedback>(std::move(estimator), design);
  }
};

struct Regulator : RegulatorSettings {
  template <bool uses_true_state>
  std::unique_ptr<Controller> make(const AxisTask& task, SharedEstimator estimator) const {
    if (period_s != task.axis.period_s) {
      throw WrongKey("controller.period_s", "must be control.period_s for a regulator");
    }
    const Reference& reference = task.reference;
    const bool is_held = reference.kind == ReferenceShape::hold;
    if (reference.before != 0.0 || (!is_held && reference.value != 0.0) ||
        reference.kind == ReferenceShape::csv) {
      throw std::invalid_argument(
          "a regulator brings the axis to 0 and has no reference: set the reference to 0");
    }
    if (task.axis.E.size() != 0) {
      throw WrongKey(
          "nominal.model",
          "must be rigid or motor for a regulator: it cancels a disturbance at the drive "
          "alone. state_feedback and mpc take a disturbance behind the spring");
    }
    if (uses_true_state && !task.senses_true_state) {
      throw std::invalid_argument(
          "needs samples with the true state (sensor.true_state in a plant): choose lqr_observer");
    }
    return std::make_unique<LqrControl>(std::move(estimator), regulator(task.axis).K, task.start(),
                                        uses_true_state, task.axis.force_limit);
  }
};

struct Mpc : PredictiveSettings {
  std::unique_ptr<Controller> make(const AxisTask& task, SharedEstimator estimator) const {
    return std::make_unique<PredictiveControl>(std::move(estimator), design(task));
  }
};

}  // namespace

std::vector<AxisControllerKind> axis_controllers() {
  return {
      {"pd", "PD control that cancels the estimated disturbance (Eqs. 4.10, 4.22)",
       &PdSettings::make},
      {"rrc", "resonance ratio control of two inertias", &ResonanceRatioSettings::make},
      {"state_feedback",
       "feedback of all estimated states, with feed-forward of the estimated disturbance",
       &StateFeedbackSettings::make},
      {"lqr", "linear quadratic regulator of the true state", &Regulator::make<true>},
      {"lqr_observer",
       "linear quadratic regulator of the estimated state, with cancellation of the disturbance",
       &Regulator::make<false>},
      {"mpc", "constrained predictive control (2.3)", &Mpc::make}};
}

}  // namespace breakwater
