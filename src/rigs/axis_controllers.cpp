// Breakwater's controllers of an axis: their keys, and the functions that make them.
#include <algorithm>
#include <cmath>

#include <breakwater/control/predictive_control.h>
#include <breakwater/control/state_feedback.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/rigs/axis_parts.h>

namespace breakwater {
namespace {

using SharedEstimator = std::shared_ptr<DisturbanceEstimator>;

struct PdSettings {
  DisturbanceCancellingPdDesign given;  // without what depends on the axis

  void bind(Fields& fields) {
    fields.number("controller.kp", given.k_p, not_negative(),
                  "K_p: position gain [force per position]");
    fields.number("controller.kd", given.k_d, not_negative(),
                  "K_d: velocity gain [force per velocity]");
    fields.optional_number("controller.cancelled_share", given.cancelled_share, between(0, 1),
                           "part of the estimated disturbance that is cancelled");
  }
  std::unique_ptr<Controller> make(const AxisTask& task, SharedEstimator estimator) const {
    DisturbanceCancellingPdDesign design = given;
    design.loop = task.loop(task.measured_reference());
    return std::make_unique<DisturbanceCancellingPd>(std::move(estimator), design);
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
    const PdSettings pd{resonance_ratio(*axis.inertias, damping_ratio)};
    return pd.make(task, std::move(estimator));
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
                               .loop = task.loop(task.modelled_reference())};
    design.K = blame("controller.poles_rad_s", [&] {
      return place_feedback_poles(axis.plant, {poles_rad_s.begin(), poles_rad_s.end()},
                                  axis.period_s);
    });
    return std::make_unique<StateFeedback>(std::move(estimator), design);
  }
};

// The period and the weights, which predictive control also has.
struct RegulatorSettings {
  double period_s = 0.0;
  double q_position = 0.0;
  double q_velocity = 0.0;
  double r = 0.0;

  void bind(Fields& fields) {
    fields.number("controller.period_s", period_s, positive(),
                  "period of the controller's decisions, a multiple of control.period_s");
    fields.number("controller.q_position", q_position, not_negative(), "Q: weight on position");
    fields.number("controller.q_velocity", q_velocity, not_negative(), "Q: weight on velocity");
    fields.number("controller.r", r, positive(),
                  "R: weight on the change of the input; for LQR, on the input");
  }
  // Weights on position and velocity of the load.
  Eigen::MatrixXd state_weight(const NominalAxis& axis) const {
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(axis.plant.states());
    weights.segment<2>(axis.controlled) << q_position, q_velocity;
    return weights.asDiagonal();
  }
  LqrDesign regulator(const NominalAxis& axis) const {
    return blame("controller.r", [&] {
      const StateSpace sampled = zero_order_hold(axis.plant, period_s);
      return dlqr(sampled.A, sampled.B, state_weight(axis), Eigen::MatrixXd::Constant(1, 1, r));
    });
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
    return std::make_unique<LqrControl>(std::move(estimator), task.loop({}, false),
                                        regulator(task.axis).K, uses_true_state);
  }
};

struct PredictiveSettings {
  struct Limits {
    double lower = 0.0;
    double upper = 0.0;
    int steps = 0;  // at so many steps; 0: at none

    Limits of_size() const { return {-upper, upper, steps}; }
  };

  RegulatorSettings weights;
  PredictiveControlDesign given;  // without what depends on the axis
  double q_disturbance = 0.0;
  bool ends_with_riccati = false;
  double last_factor = 1.0;

  Limits position_m;
  Limits velocity_m_s;
  Limits input_N;
  Limits change_N;
  bool softens_velocity_first = false;

  void bind(Fields& fields);
  PredictiveControlDesign design(const AxisTask& task) const;
  std::unique_ptr<Controller> make(const AxisTask& task, SharedEstimator estimator) const {
    return std::make_unique<PredictiveControl>(std::move(estimator), design(task));
  }
};

void PredictiveSettings::bind(Fields& fields) {
  LmpcDesign& lmpc = given.lmpc;
  weights.bind(fields);
  fields.choice("controller.disturbance_use", given.disturbance_use,
                {{"none", DisturbanceUse::none},
                 {"predict", DisturbanceUse::predict},
                 {"cancel", DisturbanceUse::cancel},
                 {"cancel_within_bounds", DisturbanceUse::cancel_within_bounds}},
                "use of the estimated disturbance: none, predict (Eq. 2.46), cancel (Eq. 2.45) or "
                "cancel_within_bounds");
  const char* const at = "controller.cancel_at";
  fields.optional_choice(at, given.cancel_at,
                         {{"sample", CancelAt::sample}, {"decision", CancelAt::decision}},
                         "for cancel: take the estimate at each sample, or at each decision");
  fields.count("controller.prediction_steps", lmpc.prediction_steps, between(1, 1000),
               "N_p: number of predicted steps");
  fields.count("controller.control_steps", lmpc.control_steps, between(1, 1000),
               "N_u: number of planned inputs, at most N_p");
  fields.number("controller.q_disturbance", q_disturbance, not_negative(),
                "for predict: the weight in Q on the disturbance, which changes no result");
  fields.choice(
      "controller.last_weight", ends_with_riccati, {{"factor", false}, {"riccati", true}},
      "weight at step N_p: last_factor times Q, or the regulator's P (riccati, Eq. 2.49)");
  fields.number("controller.last_factor", last_factor, not_negative(),
                "factor on Q at step N_p, for last_weight factor");

  fields.number("constraint.position_lower_m", position_m.lower, any(),
                "lower bound on the position");
  fields.number("constraint.position_m", position_m.upper, any(), "upper bound on the position");
  fields.count(
      "constraint.position_steps", position_m.steps, between(0, 1000),
      "number of predicted steps with a bound on the position, spread evenly up to N_p; 0: none");
  fields.number("constraint.velocity_m_s", velocity_m_s.upper, positive(), "bound on |v|");
  fields.count(
      "constraint.velocity_steps", velocity_m_s.steps, between(0, 1000),
      "number of predicted steps with a bound on the velocity, spread evenly up to N_p; 0: none");
  fields.number("constraint.input_lower_N", input_N.lower, any(), "lower bound on the input");
  fields.number("constraint.input_upper_N", input_N.upper, any(), "upper bound on the input");
  fields.count("constraint.input_steps", input_N.steps, between(0, 1000),
               "number of planned inputs that are bounded, from the first on; 0: none");
  fields.number("constraint.input_change_N", change_N.upper, positive(), "bound on |du|");
  fields.count("constraint.input_change_steps", change_N.steps, between(0, 1000),
               "number of planned inputs whose change is bounded, from the first on; 0: none");

  fields.choice("solver.name", lmpc.solver,
                {{"active_set", QpSolverKind::active_set}, {"hildreth", QpSolverKind::hildreth}},
                "solver of the quadratic program: active_set (exact) or hildreth (the thesis')");
  fields.count("solver.max_iterations", lmpc.max_iterations, between(1, 1e6),
               "for hildreth: largest number of sweeps");
  fields.choice("solver.on_infeasible", lmpc.on_infeasible,
                {{"soften", OnInfeasible::soften}, {"stop", OnInfeasible::stop}},
                "for active_set, where no input satisfies all constraints: soften the constraints "
                "on the states, or stop");
  fields.choice("solver.soften_first", softens_velocity_first,
                {{"position", false}, {"velocity", true}},
                "state whose constraints are softened first");
  fields.number("solver.softness", lmpc.softness, positive(),
                "softness of a softened constraint: 1 over the weight on its squared violation");

  fields.only_for({at}, "controller.disturbance_use", {"cancel", "cancel_within_bounds"});
  fields.only_for({"controller.q_disturbance"}, "controller.disturbance_use", {"predict"});
  fields.only_for({"controller.last_factor"}, "controller.last_weight", {"factor"});
  fields.only_for({"solver.softness"}, "solver.on_infeasible", {"soften"});
  fields.only_with({"constraint.position_lower_m", "constraint.position_m"},
                   "constraint.position_steps");
  fields.only_with({"constraint.input_change_N"}, "constraint.input_change_steps");
}

PredictiveControlDesign PredictiveSettings::design(const AxisTask& task) const {
  const NominalAxis& axis = task.axis;
  if (!is_multiple(weights.period_s, axis.period_s)) {
    throw WrongKey("controller.period_s", "must be a whole multiple of control.period_s");
  }
  const int prediction_steps = given.lmpc.prediction_steps;
  const int control_steps = given.lmpc.control_steps;
  if (control_steps > prediction_steps) {
    throw WrongKey("controller.control_steps", "must not be more than controller.prediction_steps");
  }
  PredictiveControlDesign design = given;
  LmpcDesign& lmpc = design.lmpc;
  const auto limit = [&](std::vector<PredictedBound>& bounds, const char* key, const Limits& limits,
                         Eigen::Index component = 0) {
    const bool is_state = &bounds == &lmpc.state_bounds;
    const int most = is_state ? prediction_steps : control_steps;
    if (limits.steps > most) throw WrongKey(key, "must not be more than " + std::to_string(most));
    if (limits.steps == 0) return;
    bounds.push_back({component, limits.lower, limits.upper,
                      is_state ? spread_steps(limits.steps, most) : first_steps(limits.steps)});
  };
  limit(lmpc.state_bounds, "constraint.position_steps", position_m, axis.controlled);
  limit(lmpc.state_bounds, "constraint.velocity_steps", velocity_m_s.of_size(),
        axis.controlled + 1);
  limit(lmpc.input_bounds, "constraint.input_steps", input_N);
  limit(lmpc.change_bounds, "constraint.input_change_steps", change_N.of_size());
  if (position_m.lower > position_m.upper) {
    throw WrongKey("constraint.position_lower_m", "must not be above constraint.position_m");
  }
  if (input_N.lower > input_N.upper) {
    throw WrongKey("constraint.input_lower_N", "must not be above constraint.input_upper_N");
  }
  const double period_s = weights.period_s;
  const StateSpace sampled = zero_order_hold(axis.plant, period_s);
  lmpc.A = sampled.A;
  lmpc.B = sampled.B;
  lmpc.Q = weights.state_weight(axis);
  lmpc.Q_last = ends_with_riccati
                    ? blame("controller.last_weight", [&] { return weights.regulator(axis).P; })
                    : Eigen::MatrixXd(last_factor * lmpc.Q);
  lmpc.R = Eigen::MatrixXd::Constant(1, 1, weights.r);
  if (design.disturbance_use == DisturbanceUse::predict) {
    const StateSpace extended = axis.extended(0, period_s).sampled;
    lmpc.A = extended.A;
    lmpc.B = extended.B;
    // Q ⊕ q_d and P ⊕ q_d. The disturbance has no Riccati solution, since no input acts on it.
    const double last = ends_with_riccati ? 1.0 : last_factor;
    const auto extend = [](Eigen::MatrixXd& weight, double q) {
      weight.conservativeResizeLike(Eigen::MatrixXd::Zero(weight.rows() + 1, weight.cols() + 1));
      weight(weight.rows() - 1, weight.cols() - 1) = q;
    };
    extend(lmpc.Q, q_disturbance);
    extend(lmpc.Q_last, last * q_disturbance);
  }

  if (softens_velocity_first) std::reverse(lmpc.state_bounds.begin(), lmpc.state_bounds.end());
  design.samples_per_move = static_cast<int>(std::lround(period_s / axis.period_s));
  design.loop = task.loop(task.modelled_reference(), false);
  design.controlled = axis.controlled;

  blame("controller.prediction_steps", [&] { Lmpc trial(lmpc); });
  // If the first input satisfies both, the later ones may stay there.
  const bool bounds_first = input_N.steps > 0 && change_N.steps > 0;
  if (bounds_first && (input_N.lower > change_N.upper || input_N.upper < -change_N.upper)) {
    throw WrongKey("constraint.input_change_N",
                   "no input satisfies the input constraints from rest on");
  }
  return design;
}

}  // namespace

std::vector<ControllerTotal> qp_totals(const Controller* controller) {
  const auto* predictive = dynamic_cast<const PredictiveControl*>(controller);
  if (controller != nullptr && predictive == nullptr) return {};
  const QpStatistics s = predictive != nullptr ? predictive->lmpc().statistics() : QpStatistics();
  const auto optimisations = static_cast<double>(std::max<std::int64_t>(s.optimisations, 1));
  const auto count = [](auto number) { return static_cast<double>(number); };
  return {{{"qp_iterations_mean", "1", "mean number of solver iterations of an optimisation"},
           count(s.iterations) / optimisations},
          {{"qp_iterations_max", "1", "largest number of solver iterations of an optimisation"},
           count(s.most_iterations)},
          {{"qp_unsolved_count", "1",
            "number of optimisations whose problem, as it was given, was not solved"},
           count(s.unsolved)},
          {{"qp_softened_count", "1",
            "number of unsolved optimisations in which constraints were softened"},
           count(s.softened)},
          {{"qp_capped_count", "1",
            "number of unsolved optimisations that were left with an approximate solution"},
           count(s.capped)},
          {{"qp_time_mean_us", "us", "cost, in manifest.json: mean time of an optimisation"},
           1e6 * s.time_s / optimisations,
           true},
          {{"qp_time_max_us", "us", "cost, in manifest.json: longest time of an optimisation"},
           1e6 * s.longest_s,
           true}};
}

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
      {"mpc", "constrained predictive control (2.3)", &PredictiveSettings::make}};
}

}  // namespace breakwater
