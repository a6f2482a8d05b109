// First values of the fit of an axis, by linear least squares.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include <breakwater/identification/axis_fit.h>
#include <breakwater/identification/axis_model.h>

namespace breakwater {

/// Candidates for the fit, from the equation of motion weighted with a window φ. The window and its
/// slope vanish at its ends, so the equation needs no derivative of the position:
///     J ∫φ̈ q − c ∫φ̇ q + F_C ∫φ sgn v + d₀ ∫φ = k ∫φ u(t − τ)
///
/// Each length of the window gives one candidate, with the delay of least residual between the
/// bounds of the data. No candidate has a Stribeck friction.
///
/// Source: M. Shinbrot, Trans. ASME 79 (1957) 547–552 (modulating functions).
std::vector<AxisValues> start_candidates(const AxisData& data);

/// A window φ and its derivatives by the time, with alternating signs. The integral of number k
/// times q is that of φ times the derivative k of q.
using WindowWeights = std::array<double, 5>;

/// The equation of motion of a measured position, linear in the unknowns x. The first ones are
/// factors of the input and its derivatives. Then come those of the lower derivatives of the
/// position (the highest first), of sgn v and of 1.
struct StartEquation {
  std::size_t order;
  std::size_t inputs;                                   ///< the input and its derivatives
  WindowWeights (*weights)(double s, double length_s);  ///< at s in [0, 1]
  bool (*is_plant)(const Eigen::VectorXd& x);

  Eigen::Index unknowns() const { return static_cast<Eigen::Index>(inputs + order + 1); }
};

struct StartSolution {
  double residual = std::numeric_limits<double>::infinity();
  double delay_s = 0.0;
  Eigen::VectorXd x = {};
};

/// For each length of the window the plant of least residual over the delay, if there is one.
std::vector<StartSolution> start_solutions(const AxisData& data, const StartEquation& equation);

}  // namespace breakwater
