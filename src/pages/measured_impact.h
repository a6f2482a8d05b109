// breakwater compare RUN --measured FILE: a recorded impact over the simulated one.
#pragma once

#include <optional>
#include <string>

#include <breakwater/experiment/saved_run.h>
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

/// A simulated and a measured impact, aligned at the beginning of the first contact. The search for
/// the simulated one begins where the log's true contact force is first positive, if it has that.
class ImpactComparison {
 public:
  /// `signal` is the simulated force in the run's log. Throws std::invalid_argument, one line, if
  /// the log has no such signal, or one of them has no contact.
  ImpactComparison(const SavedRun& run, const std::string& signal, const std::string& file);

  const ImpactPulse& simulated() const { return simulated_pulse_; }
  const ImpactPulse& measured() const { return measured_pulse_; }
  /// Root mean square of simulated less measured force [N], at the measured samples. The window
  /// ends with the longer contact; if one does not end, with the measured or simulated record. Then
  /// the simulated peak and impulse are also those of the window.
  double rmse_N() const { return rmse_N_; }

  std::string text(std::size_t width) const;
  /// `simulated` and `measured` with `peak_N`, `duration_s`, `impulse_Ns`; `rmse_N`.
  std::string json() const;
  /// A page with both forces over the time since contact, and the table.
  std::string html() const;

 private:
  std::string run_;
  std::string signal_;
  std::string file_;
  Series simulated_;  // since contact
  Series measured_;
  ImpactPulse simulated_pulse_;
  ImpactPulse measured_pulse_;
  double window_s_ = 0.0;
  double rmse_N_ = 0.0;
};

}  // namespace breakwater
