// Identification of an axis from records: values, intervals, and what the records cannot show.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/identification/axis_fit.h>
#include <breakwater/recorded/recorded_axis.h>

namespace breakwater {

struct IdentificationSettings {
  const AxisModel* model = &friction_axis();
  bool has_stribeck = false;
  bool inputs_act_before = false;
  std::optional<double> quantum;  ///< default: found in the positions
  EncoderRounding rounding = EncoderRounding::nearest;
  /// Takes this as J and fits the torque constant instead.
  std::optional<double> known_inertia;
  /// Gets the done share of the work, if set. A second search begins again.
  std::function<void(double)> progress;
};

/// An estimated parameter with its 95 % interval, in SI units.
struct ParameterEstimate {
  AxisParameter parameter{};
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
  bool is_identifiable = true;
  std::string reason;      ///< why not
  std::string excitation;  ///< which one would help
};

/// Errors of the fit on one set of records.
struct FitErrors {
  double rms = 0.0;  ///< measured minus simulated position
  /// RMS of the errors by what noise, encoder and the parameters' uncertainty explain: about 1. The
  /// noise is that of the fit, but at most that of the record's differences.
  double normalised = 0.0;
};

/// Ljung's and Box's test of the scores of the fit: white if the model explains the records.
struct Whiteness {
  double statistic = 0.0;
  double limit = 0.0;  ///< 99 % quantile
  bool is_white() const { return statistic <= limit; }
};

struct Identification {
  AxisData data;
  AxisFit fit;
  FreeParameters free{};
  std::vector<ParameterEstimate> parameters;
  Eigen::MatrixXd covariance;  ///< covariance_of() the fit
  bool is_quantum_found = false;
  bool is_bootstrapped = false;  ///< intervals by parametric bootstrap
  bool is_converged = false;
  FitErrors errors;
  Whiteness whiteness;
  std::optional<FitErrors> held_out;
  std::vector<std::string> notes;

  /// A held-out record has errors of at most twice what the fit explains.
  bool holds() const { return !held_out || held_out->normalised <= 2.0; }
};

/// Throws std::invalid_argument if the position hardly moves, the input is 0, or the records are
/// too short.
Identification identify_axis(const std::vector<RecordedAxis>& records,
                             const std::vector<RecordedAxis>& held_out,
                             const IdentificationSettings& settings);

/// The records as stretches without long gaps. `quantum` is not set. The rows of the first
/// `settle_s` of each stretch give inputs alone.
AxisData axis_data(const std::vector<RecordedAxis>& records, bool inputs_act_before,
                   double settle_s);

/// identify_axis(), also for records in which the input acts much later or earlier than its rows
/// say, by up to 2 s. If the fit has no start or no white residuals, each record's offset is
/// searched, where start_candidates() for windows of several lengths agree. The offsets are taken
/// if they halve the error. The delay then is what remains, and not identifiable.
Identification identify_despite_clocks(std::vector<RecordedAxis> records,
                                       std::vector<RecordedAxis> held_out,
                                       const IdentificationSettings& settings);

}  // namespace breakwater
