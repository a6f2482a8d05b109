// Inputs that identify an axis well.
#pragma once

#include <vector>

#include <breakwater/identification/axis_fit.h>

namespace breakwater {

struct ExcitationLimits {
  double torque = 0.0;                                     ///< N m
  double speed = std::numeric_limits<double>::infinity();  ///< rad/s
  double duration_s = 0.0;
  double period_s = 0.0;
};

/// A guess of an unknown axis: the torque reaches the speed in 0.2 s, and 10 % of it is Coulomb, a
/// further 10 % viscous friction. `inertia` 0: from the limits. Needs a finite speed or an inertia.
AxisValues guessed_axis(const ExcitationLimits& limits, double inertia);

/// Two common inputs, scaled to the limits for this axis. One is a chirp from 0.1 Hz to 20 Hz, the
/// other a pseudo-random binary sequence (11 bits) with this clock.
std::vector<double> chirp(const ExcitationLimits& limits, const AxisValues& axis);
std::vector<double> binary_sequence(const ExcitationLimits& limits, const AxisValues& axis,
                                    double clock_s);

/// Standard deviations that a record with this input would give. Their order is inertia (relative),
/// viscous friction [N m s/rad], Coulomb friction [N m], offset [N m], delay [s].
std::vector<double> expected_std(const std::vector<double>& inputs, const ExcitationLimits& limits,
                                 const AxisValues& axis);

/// The best of `tries` clipped multisines, the later ones varied from the best so far. The measure
/// is the largest ratio of a standard deviation to the least of the chirp and binary sequences.
/// The same arguments give the same input.
std::vector<double> designed_excitation(const ExcitationLimits& limits, const AxisValues& axis,
                                        int tries = 300);

/// That measure: below 1, all intervals are smaller.
double worst_ratio(const std::vector<double>& inputs, const ExcitationLimits& limits,
                   const AxisValues& axis);

}  // namespace breakwater
