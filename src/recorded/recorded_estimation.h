// An estimator of an axis on recorded data, without a simulation: keys, scenario, command.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <breakwater/config/fields.h>
#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/scenario.h>
#include <breakwater/record/recording.h>
#include <breakwater/recorded/recorded_axis.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/signals/encoder_rounding.h>

namespace breakwater {

/// csv.time_column, …, csv.input_acts.
void bind_record_format(Fields& fields, RecordFormat& format);

/// Refuses scales of 0.
void check_record_format(const Config& config);

/// "the model does not explain the data: ..." if an estimation's metrics show this; nothing if the
/// model explains them or the sensor's error is unknown.
std::optional<std::string> doubt_of(const std::vector<Metric>& metrics);

/// It has settings and a run as every scenario, but no plant. Its hash is of the estimates.
class RecordedEstimation final : public Scenario {
 public:
  explicit RecordedEstimation(const Catalogue& catalogue)
      : estimator_(catalogue, "observer.name") {}

  std::string name() const override { return "estimate"; }
  std::string summary() const override { return "an estimator on recorded data of one axis"; }
  std::vector<MetricDefinition> metric_definitions() const override;
  Fields fields() override;
  void check(const Config& config, const Fields& fields) override;
  const RunSettings& run_settings() const override { return run_; }
  /// Warns of gaps, and of jitter if the estimator takes all intervals as equal.
  std::vector<std::string> warnings() const override;
  Recording run(const RunControl& control) const override;

  const std::string& file() const { return file_; }
  /// Whether a scale seems forgotten. Then warnings() says so.
  bool is_doubtful() const { return !record_.doubts.empty(); }

 private:
  enum class Motion { rotation, translation };

  NominalAxis axis() const;

  RunSettings run_;
  std::string file_;
  RecordFormat format_;
  double time_std_s_ = 0.0;
  double period_s_ = 0.0;
  double gap_periods_ = 0.0;
  double longest_gap_s_ = 1.0;
  double jitter_share_ = 0.0;
  Motion motion_ = Motion::rotation;
  double inertia_ = 0.0;
  double viscous_friction_ = 0.0;
  double quantum_ = 0.0;
  EncoderRounding rounding_ = EncoderRounding::nearest;
  double pulses_ = 0.0;
  double noise_std_ = 0.0;
  PartChoice<AxisEstimatorKind> estimator_;

  RecordedAxis record_;  // filled by check()
  RecordedTiming timing_;
  double largest_input_ = 0.0;  // the largest magnitude
  bool follows_ = false;        // the estimator uses the length of each interval
};

/// It with the file of its cases, as if it were a scenario that the catalogue has.
ScenarioKind recorded_estimation();

/// Runs an estimator of the catalogue on recorded data, and writes a folder like that of a run.
CommandKind estimate_command();

}  // namespace breakwater
