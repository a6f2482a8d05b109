// Disturbance models of order 0, 1 and 2: thesis 4.2.2.
#pragma once

#include <optional>

#include <breakwater/linear/state_space.h>

namespace breakwater {

/// A sampled plant extended by a model of what disturbs its inputs: x̄ = [x; d; ḋ; d̈], of which the
/// derivatives are there as far as the model's order goes.
struct ExtendedPlant {
  StateSpace sampled;         ///< A̅, B̅, C̅
  Eigen::Index plant_states;  ///< n, of x
  int order;                  ///< of the disturbance model: 0 step, 1 ramp, 2 parabola
  double period_s;            ///< T_s
  /// The plant in continuous time, if it is known: it can then be sampled over other intervals.
  std::optional<StateSpace> continuous = {};

  Eigen::Index states() const { return sampled.states(); }    ///< n + m (order + 1)
  Eigen::Index inputs() const { return sampled.inputs(); }    ///< m, which also d has
  Eigen::Index outputs() const { return sampled.outputs(); }  ///< p
};

/// Extends a sampled plant x(k+1) = A_d x + B_d u by a chain of sums for each input's disturbance
/// (order 0: Eqs. 2.46, 2.47, 3.3, 3.4; 1: Eqs. 4.1, 4.2; 2: Eqs. 4.3, 4.4):
///     A̅ = [A_d −B_d 0; 0 I T_s·I; 0 0 I],  B̅ = [B_d; 0; 0],  C̅ = [C_d 0 0]      (order 1).
///
/// Throws std::invalid_argument if the order is not 0, 1 or 2, the period is not positive, or the
/// extended plant is not observable (with its rank).
ExtendedPlant extend_by_disturbance_model(const StateSpace& sampled_plant, int order,
                                          double period_s);

/// The same of a plant in continuous time, sampled with a zero-order hold.
ExtendedPlant sample_with_disturbance_model(const StateSpace& continuous_plant, int order,
                                            double period_s);

}  // namespace breakwater
