// Disturbance models of order 0, 1 and 2: thesis 4.2.2.
#pragma once

#include <optional>

#include <breakwater/linear/state_space.h>

namespace breakwater {

/// A sampled plant with m disturbances, one at each input unless said otherwise. Its state
/// x̄ = [x; d; ḋ; d̈] has the derivatives up to the order of the disturbance model.
struct ExtendedPlant {
  StateSpace sampled;         ///< A̅, B̅, C̅
  Eigen::Index plant_states;  ///< n, the size of x
  double period_s;            ///< T_s
  /// The plant in continuous time, if known, to sample it over other intervals.
  std::optional<StateSpace> continuous = {};

  Eigen::Index states() const { return sampled.states(); }    ///< n + m (order + 1)
  Eigen::Index inputs() const { return sampled.inputs(); }    ///< m, the size of u and d
  Eigen::Index outputs() const { return sampled.outputs(); }  ///< p
};

/// Extends a sampled plant x(k+1) = A_d x + B_d u by a chain of sums for the disturbance of each
/// input. Order 0 is a step (Eqs. 2.46, 2.47, 3.3, 3.4), 1 a ramp (Eqs. 4.1, 4.2), 2 a parabola
/// (Eqs. 4.3, 4.4):
///     A̅ = [A_d −B_d 0; 0 I T_s·I; 0 0 I],  B̅ = [B_d; 0; 0],  C̅ = [C_d 0 0]      (order 1).
///
/// With E (n×m), −E replaces −B_d, for disturbances that do not enter at the inputs, such as a load
/// behind a spring. Throws std::invalid_argument unless the order is 0, 1 or 2, the period is
/// positive and the extended plant is observable. The message has the rank.
ExtendedPlant extend_by_disturbance_model(const StateSpace& sampled_plant, int order,
                                          double period_s, const Eigen::MatrixXd& E = {});

/// The same for a plant in continuous time, sampled with a zero-order hold. It is
/// ẋ = A x + B (u − d) or, with E, ẋ = A x + B u − E d. With E, `continuous` is empty.
ExtendedPlant sample_with_disturbance_model(const StateSpace& continuous_plant, int order,
                                            double period_s, const Eigen::MatrixXd& E = {});

}  // namespace breakwater
