// A recorded force, and its first contact.
#pragma once

#include <optional>
#include <string>

#include <breakwater/record/series.h>

namespace breakwater {

/// The first contact of a recorded force. It begins where the force rises beyond a small share of
/// its largest value, and ends where it falls below that again.
struct ImpactPulse {
  double begin_s = 0.0;
  std::optional<double> duration_s;  ///< absent: it does not end in the series
  double peak_N = 0.0;
  double impulse_Ns = 0.0;
};

/// The threshold, as a share of the largest force.
inline constexpr double kContactShare = 0.02;

/// Times are interpolated between samples. If `contact_s` is given, samples before this time are
/// not part of the contact: a sensor also reads the inertia of its tool. A contact that does not
/// end has the peak and the impulse up to the last sample. Throws std::invalid_argument, one line,
/// if the force is never positive or the series begins in contact.
ImpactPulse first_pulse(const Series& force, const std::optional<double>& contact_s = {});

/// A force over time from a text table with the columns time_s and force_N. Throws
/// std::invalid_argument `FILE[:LINE]: reason` if it cannot be read or time does not rise.
Series read_measured_force(const std::string& file);

}  // namespace breakwater
