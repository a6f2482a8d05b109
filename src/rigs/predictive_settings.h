// The keys of predictive control of an axis, and of a regulator.
#pragma once

#include <breakwater/control/predictive_control.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/record/recording.h>
#include <breakwater/rigs/axis_parts.h>

namespace breakwater {

/// The keys `controller.…` of the period and the weights, which a regulator also has.
struct RegulatorSettings {
  double period_s = 0.0;
  double q_position = 0.0;
  double q_velocity = 0.0;
  double r = 0.0;

  void bind(Fields& fields);

  /// Weights on position and velocity of the load.
  Eigen::MatrixXd state_weight(const NominalAxis& axis) const;
  /// The regulator with these weights and r. Throws a WrongKey if there is none.
  LqrDesign regulator(const NominalAxis& axis) const;
};

enum class LastWeight { factor, riccati };
enum class SoftenFirst { position, velocity };

/// The keys `controller.…`, `constraint.…` and `solver.…` of predictive control.
struct PredictiveSettings {
  RegulatorSettings weights;
  DisturbanceUse disturbance_use = DisturbanceUse::predict;
  CancelAt cancel_at = CancelAt::sample;
  int prediction_steps = 0;
  int control_steps = 0;
  double q_disturbance = 0.0;
  LastWeight last_weight = LastWeight::factor;
  double last_factor = 1.0;

  double position_lower_m = 0.0;
  double position_upper_m = 0.0;
  int position_steps = 0;
  double velocity_m_s = 0.0;
  int velocity_steps = 0;
  double input_lower_N = 0.0;
  double input_upper_N = 0.0;
  int input_steps = 0;
  double change_N = 0.0;
  int change_steps = 0;

  QpSolverKind solver = QpSolverKind::active_set;
  int max_iterations = 0;
  OnInfeasible on_infeasible = OnInfeasible::soften;
  SoftenFirst soften_first = SoftenFirst::position;
  double softness = 0.0;

  void bind(Fields& fields);

  /// The design for an axis, with estimates at every control period. Throws a WrongKey.
  PredictiveControlDesign design(const AxisTask& task) const;

 private:
  void check(const NominalAxis& axis) const;
};

/// If `controller` is predictive control, adds the metrics and costs of its optimisations.
void add_qp_metrics(const Controller& controller, Recording& recording);
/// Appends the definitions of the metrics of add_qp_metrics().
std::vector<MetricDefinition> with_qp_metrics(std::vector<MetricDefinition> definitions);

}  // namespace breakwater
