#include <breakwater/rigs/predictive_settings.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <breakwater/observers/disturbance_model.h>

namespace breakwater {

void RegulatorSettings::bind(Fields& fields) {
  fields.number("controller.period_s", period_s, positive(),
                "period of the controller's decisions, a multiple of control.period_s [s]");
  fields.number("controller.q_position", q_position, not_negative(), "Q: weight on position");
  fields.number("controller.q_velocity", q_velocity, not_negative(), "Q: weight on velocity");
  fields.number("controller.r", r, positive(),
                "R: weight on the change of the input; for LQR, on the input");
}

Eigen::MatrixXd RegulatorSettings::state_weight(const NominalAxis& axis) const {
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(axis.plant.states());
  weights.segment<2>(axis.controlled) << q_position, q_velocity;
  return weights.asDiagonal();
}

LqrDesign RegulatorSettings::regulator(const NominalAxis& axis) const {
  return blame("controller.r", [&] {
    const StateSpace sampled = zero_order_hold(axis.plant, period_s);
    return dlqr(sampled.A, sampled.B, state_weight(axis), Eigen::MatrixXd::Constant(1, 1, r));
  });
}

void PredictiveSettings::bind(Fields& fields) {
  weights.bind(fields);
  fields.choice("controller.disturbance_use", disturbance_use,
                {{"none", DisturbanceUse::none},
                 {"predict", DisturbanceUse::predict},
                 {"cancel", DisturbanceUse::cancel},
                 {"cancel_within_bounds", DisturbanceUse::cancel_within_bounds}},
                "use of the estimated disturbance: none, predict (Eq. 2.46), cancel (Eq. 2.45) or "
                "cancel_within_bounds");
  const char* const at = "controller.cancel_at";
  fields.optional_choice(at, cancel_at,
                         {{"sample", CancelAt::sample}, {"decision", CancelAt::decision}},
                         "for cancel: take the estimate at each sample, or at each decision");
  fields.count("controller.prediction_steps", prediction_steps, between(1, 1000),
               "N_p: number of predicted steps");
  fields.count("controller.control_steps", control_steps, between(1, 1000),
               "N_u: number of planned inputs, at most N_p");
  fields.number("controller.q_disturbance", q_disturbance, not_negative(),
                "for predict: the weight in Q on the disturbance, which changes no result");
  fields.choice(
      "controller.last_weight", last_weight,
      {{"factor", LastWeight::factor}, {"riccati", LastWeight::riccati}},
      "weight at step N_p: last_factor times Q, or the regulator's P (riccati, Eq. 2.49)");
  fields.number("controller.last_factor", last_factor, not_negative(),
                "factor on Q at step N_p, for last_weight factor");

  fields.number("constraint.position_lower_m", position_lower_m, any(),
                "lower bound on the position [m]");
  fields.number("constraint.position_m", position_upper_m, any(),
                "upper bound on the position [m]");
  fields.count(
      "constraint.position_steps", position_steps, between(0, 1000),
      "number of predicted steps with a bound on the position, spread evenly up to N_p; 0: none");
  fields.number("constraint.velocity_m_s", velocity_m_s, positive(), "bound on |v| [m/s]");
  fields.count(
      "constraint.velocity_steps", velocity_steps, between(0, 1000),
      "number of predicted steps with a bound on the velocity, spread evenly up to N_p; 0: none");
  fields.number("constraint.input_lower_N", input_lower_N, any(), "lower bound on the input [N]");
  fields.number("constraint.input_upper_N", input_upper_N, any(), "upper bound on the input [N]");
  fields.count("constraint.input_steps", input_steps, between(0, 1000),
               "number of planned inputs that are bounded, from the first on; 0: none");
  fields.number("constraint.input_change_N", change_N, positive(), "bound on |du| [N]");
  fields.count("constraint.input_change_steps", change_steps, between(0, 1000),
               "number of planned inputs whose change is bounded, from the first on; 0: none");

  fields.choice("solver.name", solver,
                {{"active_set", QpSolverKind::active_set}, {"hildreth", QpSolverKind::hildreth}},
                "solver of the quadratic program: active_set (exact) or hildreth (the thesis')");
  fields.count("solver.max_iterations", max_iterations, between(1, 1e6),
               "for hildreth: largest number of sweeps");
  fields.choice("solver.on_infeasible", on_infeasible,
                {{"soften", OnInfeasible::soften}, {"stop", OnInfeasible::stop}},
                "for active_set, where no input satisfies all constraints: soften the constraints "
                "on the states, or stop");
  fields.choice("solver.soften_first", soften_first,
                {{"position", SoftenFirst::position}, {"velocity", SoftenFirst::velocity}},
                "state whose constraints are softened first");
  fields.number("solver.softness", softness, positive(),
                "softness of a softened constraint: 1 over the weight on its squared violation");

  fields.only_for({at}, "controller.disturbance_use", {"cancel", "cancel_within_bounds"});
  fields.only_for({"controller.q_disturbance"}, "controller.disturbance_use", {"predict"});
  fields.only_for({"controller.last_factor"}, "controller.last_weight", {"factor"});
  fields.only_for({"solver.softness"}, "solver.on_infeasible", {"soften"});
  const auto only_with = [&fields](const std::vector<std::string>& keys, const std::string& steps,
                                   const int& count) {
    fields.only_where(keys, "constraint." + steps + " is not 0", [&count] { return count != 0; });
  };
  only_with({"constraint.position_lower_m", "constraint.position_m"}, "position_steps",
            position_steps);
  only_with({"constraint.input_change_N"}, "input_change_steps", change_steps);
}

void PredictiveSettings::check(const NominalAxis& axis) const {
  if (!is_multiple(weights.period_s, axis.period_s)) {
    throw WrongKey("controller.period_s", "must be a whole multiple of control.period_s");
  }
  if (control_steps > prediction_steps) {
    throw WrongKey("controller.control_steps", "must not be more than controller.prediction_steps");
  }
  const auto at_most = [&](const char* key, int steps, int most) {
    if (steps > most) throw WrongKey(key, "must not be more than " + std::to_string(most));
  };
  at_most("constraint.position_steps", position_steps, prediction_steps);
  at_most("constraint.velocity_steps", velocity_steps, prediction_steps);
  at_most("constraint.input_steps", input_steps, control_steps);
  at_most("constraint.input_change_steps", change_steps, control_steps);
  if (position_lower_m > position_upper_m) {
    throw WrongKey("constraint.position_lower_m", "must not be above constraint.position_m");
  }
  if (input_lower_N > input_upper_N) {
    throw WrongKey("constraint.input_lower_N", "must not be above constraint.input_upper_N");
  }
}

PredictiveControlDesign PredictiveSettings::design(const AxisTask& task) const {
  const NominalAxis& axis = task.axis;
  check(axis);
  const double period_s = weights.period_s;
  const StateSpace sampled = zero_order_hold(axis.plant, period_s);
  PredictiveControlDesign design;
  LmpcDesign& lmpc = design.lmpc;
  lmpc.A = sampled.A;
  lmpc.B = sampled.B;
  lmpc.prediction_steps = prediction_steps;
  lmpc.control_steps = control_steps;
  lmpc.Q = weights.state_weight(axis);
  lmpc.Q_last = last_weight == LastWeight::riccati
                    ? blame("controller.last_weight", [&] { return weights.regulator(axis).P; })
                    : Eigen::MatrixXd(last_factor * lmpc.Q);
  lmpc.R = Eigen::MatrixXd::Constant(1, 1, weights.r);
  if (disturbance_use == DisturbanceUse::predict) {
    const StateSpace extended = axis.extended(0, period_s).sampled;
    lmpc.A = extended.A;
    lmpc.B = extended.B;
    // Q ⊕ q_d and P ⊕ q_d. The disturbance has no Riccati solution, since no input acts on it.
    const double last = last_weight == LastWeight::riccati ? 1.0 : last_factor;
    const auto extend = [](Eigen::MatrixXd& weight, double q) {
      weight.conservativeResizeLike(Eigen::MatrixXd::Zero(weight.rows() + 1, weight.cols() + 1));
      weight(weight.rows() - 1, weight.cols() - 1) = q;
    };
    extend(lmpc.Q, q_disturbance);
    extend(lmpc.Q_last, last * q_disturbance);
  }

  if (change_steps > 0) {
    lmpc.change_bounds.push_back({0, -change_N, change_N, first_steps(change_steps)});
  }
  if (input_steps > 0) {
    lmpc.input_bounds.push_back({0, input_lower_N, input_upper_N, first_steps(input_steps)});
  }
  if (position_steps > 0) {
    lmpc.state_bounds.push_back({axis.controlled, position_lower_m, position_upper_m,
                                 spread_steps(position_steps, prediction_steps)});
  }
  if (velocity_steps > 0) {
    lmpc.state_bounds.push_back({axis.controlled + 1, -velocity_m_s, velocity_m_s,
                                 spread_steps(velocity_steps, prediction_steps)});
  }
  if (soften_first == SoftenFirst::velocity)
    std::reverse(lmpc.state_bounds.begin(), lmpc.state_bounds.end());
  lmpc.solver = solver;
  lmpc.max_iterations = max_iterations;
  lmpc.on_infeasible = on_infeasible;
  lmpc.softness = softness;

  design.disturbance_use = disturbance_use;
  design.cancel_at = cancel_at;
  design.samples_per_move = static_cast<int>(std::lround(period_s / axis.period_s));
  design.reference = task.modelled_reference();
  design.start_state = task.start();
  design.controlled = axis.controlled;
  design.units = axis.units;
  design.force_limit = axis.force_limit;

  const Lmpc trial = blame("controller.prediction_steps", [&] { return Lmpc(lmpc); });
  if (!trial.inputs_are_feasible(Eigen::VectorXd::Zero(1))) {
    throw WrongKey("constraint.input_change_N",
                   "no input satisfies the input constraints from rest on");
  }
  return design;
}

namespace {

// A number of the optimisations of a run, for metrics or costs.
struct QpNumber {
  MetricDefinition definition;
  double (*of)(const QpStatistics& statistics);
  bool is_cost = false;
};

double optimisations(const QpStatistics& s) {
  return static_cast<double>(std::max<std::int64_t>(s.optimisations, 1));
}

const std::vector<QpNumber>& qp_numbers() {
  using S = QpStatistics;
  static const std::vector<QpNumber> all = {
      {{"qp_iterations_mean", "1", "mean number of solver iterations of an optimisation"},
       [](const S& s) { return static_cast<double>(s.iterations) / optimisations(s); }},
      {{"qp_iterations_max", "1", "largest number of solver iterations of an optimisation"},
       [](const S& s) { return static_cast<double>(s.most_iterations); }},
      {{"qp_unsolved_count", "1",
        "number of optimisations whose problem, as it was given, was not solved"},
       [](const S& s) { return static_cast<double>(s.unsolved); }},
      {{"qp_softened_count", "1",
        "number of unsolved optimisations in which constraints were softened"},
       [](const S& s) { return static_cast<double>(s.softened); }},
      {{"qp_capped_count", "1",
        "number of unsolved optimisations that were left with an approximate solution"},
       [](const S& s) { return static_cast<double>(s.capped); }},
      {{"qp_time_mean_us", "us", "cost, in manifest.json: mean time of an optimisation"},
       [](const S& s) { return 1e6 * s.time_s / optimisations(s); },
       true},
      {{"qp_time_max_us", "us", "cost, in manifest.json: longest time of an optimisation"},
       [](const S& s) { return 1e6 * s.longest_s; },
       true}};
  return all;
}

}  // namespace

void add_qp_metrics(const Controller& controller, Recording& recording) {
  const auto* predictive = dynamic_cast<const PredictiveControl*>(&controller);
  if (predictive == nullptr) return;
  for (const QpNumber& one : qp_numbers()) {
    add(one.is_cost ? recording.costs : recording.metrics, one.definition.name, one.definition.unit,
        one.of(predictive->lmpc().statistics()));
  }
}

std::vector<MetricDefinition> with_qp_metrics(std::vector<MetricDefinition> definitions) {
  for (const QpNumber& one : qp_numbers()) definitions.push_back(one.definition);
  return definitions;
}

}  // namespace breakwater
