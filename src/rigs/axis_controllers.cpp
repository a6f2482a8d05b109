// Breakwater's controllers of an axis: their keys, and the functions that make them.
#include <breakwater/control/disturbance_cancelling_pd.h>
#include <breakwater/control/state_feedback.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/rigs/predictive_settings.h>

namespace breakwater {
namespace {

using SharedEstimator = std::shared_ptr<DisturbanceEstimator>;

struct PdGains {
  double k_p = 0.0;
  double k_d = 0.0;
  double cancelled_share = 1.0;
};

void bind_pd(Fields& fields, PdGains& gains) {
  fields.number("controller.kp", gains.k_p, not_negative(),
                "K_p: position gain [force per position]");
  fields.number("controller.kd", gains.k_d, not_negative(),
                "K_d: velocity gain [force per velocity]");
  fields.optional_number("controller.cancelled_share", gains.cancelled_share, between(0, 1),
                         "part of the estimated disturbance that is cancelled");
}

std::unique_ptr<Controller> make_pd(const PdGains& gains, const AxisTask& task,
                                    SharedEstimator estimator) {
  return std::make_unique<DisturbanceCancellingPd>(
      std::move(estimator), DisturbanceCancellingPdDesign{.k_p = gains.k_p,
                                                          .k_d = gains.k_d,
                                                          .cancelled_share = gains.cancelled_share,
                                                          .reference = task.measured_reference(),
                                                          .force_limit = task.axis.force_limit,
                                                          .period_s = task.axis.period_s,
                                                          .units = task.axis.units,
                                                          .start_state = task.start()});
}

struct ResonanceRatioSettings {
  double damping_ratio = 1.0;
};

void bind_resonance_ratio(Fields& fields, ResonanceRatioSettings& settings) {
  fields.optional_number(
      "controller.damping_ratio", settings.damping_ratio, positive(),
      "zeta: damping ratio of the closed loop's two double poles at the anti-resonance");
}

std::unique_ptr<Controller> make_resonance_ratio(const ResonanceRatioSettings& settings,
                                                 const AxisTask& task, SharedEstimator estimator) {
  const NominalAxis& axis = task.axis;
  if (axis.measured != Side::motor || axis.E.size() != 0) {
    throw WrongKey("nominal.model",
                   "must be motor for resonance ratio control, with an encoder on the motor");
  }
  if (!axis.inertias) {
    throw WrongKey(axis.why_no_inertias, "must be positive for resonance ratio control");
  }
  const ResonanceRatioGains gains = resonance_ratio(*axis.inertias, settings.damping_ratio);
  return std::make_unique<DisturbanceCancellingPd>(
      std::move(estimator),
      DisturbanceCancellingPdDesign{.k_p = gains.k_p,
                                    .k_d = gains.k_d,
                                    .cancelled_share = gains.cancelled_share(),
                                    .reference = task.measured_reference(),
                                    .force_limit = axis.force_limit,
                                    .period_s = axis.period_s,
                                    .units = axis.units,
                                    .start_state = task.start()});
}

struct FeedbackPoles {
  std::vector<double> real_rad_s;
};

void bind_state_feedback(Fields& fields, FeedbackPoles& settings) {
  fields.numbers("controller.poles_rad_s", settings.real_rad_s, any(),
                 "continuous poles of the state feedback, one for each state [1/s]");
}

std::unique_ptr<Controller> make_state_feedback(const FeedbackPoles& settings, const AxisTask& task,
                                                SharedEstimator estimator) {
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
    return place_feedback_poles(
        axis.plant, {settings.real_rad_s.begin(), settings.real_rad_s.end()}, axis.period_s);
  });
  return std::make_unique<StateFeedback>(std::move(estimator), design);
}

void bind_regulator(Fields& fields, RegulatorSettings& settings) {
  settings.bind(fields);
}

std::unique_ptr<Controller> regulator(const RegulatorSettings& settings, const AxisTask& task,
                                      SharedEstimator estimator, bool uses_true_state) {
  if (settings.period_s != task.axis.period_s) {
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
    throw WrongKey("nominal.model",
                   "must be rigid or motor for a regulator: it cancels a disturbance at the drive "
                   "alone. state_feedback and mpc take a disturbance behind the spring");
  }
  if (uses_true_state && !task.senses_true_state) {
    throw std::invalid_argument(
        "needs samples with the true state (sensor.true_state in a plant): choose lqr_observer");
  }
  return std::make_unique<LqrControl>(std::move(estimator), settings.regulator(task.axis).K,
                                      task.start(), uses_true_state, task.axis.force_limit);
}

std::unique_ptr<Controller> make_lqr(const RegulatorSettings& settings, const AxisTask& task,
                                     SharedEstimator estimator) {
  return regulator(settings, task, std::move(estimator), true);
}

std::unique_ptr<Controller> make_lqr_observer(const RegulatorSettings& settings,
                                              const AxisTask& task, SharedEstimator estimator) {
  return regulator(settings, task, std::move(estimator), false);
}

void bind_mpc(Fields& fields, PredictiveSettings& settings) {
  settings.bind(fields);
}

std::unique_ptr<Controller> make_mpc(const PredictiveSettings& settings, const AxisTask& task,
                                     SharedEstimator estimator) {
  return std::make_unique<PredictiveControl>(std::move(estimator), settings.design(task));
}

}  // namespace

std::vector<AxisControllerKind> axis_controllers() {
  return {
      {"pd", "PD control that cancels the estimated disturbance (Eqs. 4.10, 4.22)", bind_pd,
       make_pd},
      {"rrc", "resonance ratio control of two inertias", bind_resonance_ratio,
       make_resonance_ratio},
      {"state_feedback",
       "feedback of all estimated states, with feed-forward of the estimated disturbance",
       bind_state_feedback, make_state_feedback},
      {"lqr", "linear quadratic regulator of the true state", bind_regulator, make_lqr},
      {"lqr_observer",
       "linear quadratic regulator of the estimated state, with cancellation of the disturbance",
       bind_regulator, make_lqr_observer},
      {"mpc", "constrained predictive control (2.3)", bind_mpc, make_mpc}};
}

}  // namespace breakwater
