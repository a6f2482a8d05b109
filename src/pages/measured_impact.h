// breakwater compare RUN --measured FILE: a recorded impact over the simulated one.
#pragma once

#include <string>

#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/impact_pulse.h>

namespace breakwater {

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
  PageData table() const;

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
