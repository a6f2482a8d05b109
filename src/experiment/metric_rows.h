// The metrics that a scenario declares, and the signals that it computes from others: the tables
// [metric.NAME] and [signal.NAME] of its TOML.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/experiment/metric_reductions.h>
#include <breakwater/experiment/settings.h>
#include <breakwater/record/recording.h>
#include <breakwater/signals/signal.h>

namespace breakwater {

class Catalogue;
struct ScenarioKind;

/// The value that is taken from a signal.
enum class Taken {
  value,
  difference,  ///< its change since the last value, divided by the period; 0 at the first value
  high_pass,
  largest,       ///< the largest of a signal's several values
  largest_size,  ///< the largest magnitude of its values
  norm           ///< the root of the sum of their squares
};

/// The rate of a metric's values. For `by_signal` it is that of the physics steps for the signals
/// that MetricContext names, and that of the samples for all others.
enum class MetricRate { by_signal, sample, step };

/// The keys of one metric, or of a signal of the log. Numbers are expressions (MetricExpression).
struct MetricRow {
  bool is_signal = false;  ///< it has only the keys of, minus, take, cutoff_Hz and text
  std::string table;       ///< NAME of [metric.NAME] or [signal.NAME]
  std::string name;        ///< name of the metric: that of the table if this is empty
  std::string of;
  std::string minus = "none";
  std::string kind;
  Taken take = Taken::value;
  std::string cutoff_Hz = "0.0";
  std::string from_s = "0.0";
  std::string to_s = "0.0";
  std::string before_s = "0.0";
  std::string level = "0.0";
  std::string lower = "0.0";
  MetricRate at = MetricRate::by_signal;
  std::string where;
  std::string unit;
  std::string text;
  int rank = 0;

  std::string prefix() const { return (is_signal ? "signal." : "metric.") + table + "."; }
  void bind(Fields& fields, const std::vector<MetricKind>& kinds);
  /// The name, which ends with the unit unless the row has a unit; the unit; the meaning.
  MetricDefinition definition(const MetricKind& kind) const;
};

/// The names that a scenario gives to its rows, besides its keys.
struct MetricContext {
  std::map<std::string, double> known = {};  ///< times that are known before a run
  std::vector<std::string> events = {};      ///< names of times that the run finds out
  /// How the names of signals begin that change within a sample.
  std::vector<std::string> fast_signals = {};
};

/// The metrics of a scenario: those of its own file, and those of the file of a run. A file without
/// the scenario's own rows has them all the same. It may replace keys of one, and add others.
class MetricRows {
 public:
  /// Has only the metrics of a run's file.
  MetricRows() = default;
  /// The scenario `name` of the catalogue, if it is there, and its own kinds of reductions.
  MetricRows(const Catalogue& catalogue, const std::string& name,
             std::vector<MetricKind> own_kinds = {});

  /// Finds the tables of a run's file.
  void learn(const Config& config);
  /// Binds the rows of the run's file, and the aliases of the scenario's own. Rows that are the
  /// scenario's own, unchanged, have their values already: they are neither printed nor among the
  /// keys of a reference. Binds the numbers metrics.… that rows name, unless the scenario has bound
  /// them.
  void bind(Fields& fields);
  /// Checks the rows after reading, and takes the numbers of keys. Call it from Scenario::check().
  void check(const Config& config, const Fields& fields, const PhysicsSettings& physics,
             const MetricContext& context = {});

  /// Before learn() those of the scenario's own file.
  std::vector<MetricDefinition> definitions() const;
  /// The names of the rows with a rank, or of all if there is none.
  std::vector<std::string> main() const;

  const std::vector<MetricRow>& rows() const { return rows_; }
  const MetricKind& kind_of(const MetricRow& row) const;
  bool is_at_step(const MetricRow& row) const;
  double period_of(const MetricRow& row) const;
  /// The keys' conditions that a row does not meet; empty if it meets all.
  const std::string& unmet(std::size_t row) const { return unmet_.at(row); }
  MetricExpression expression(const std::string& text,
                              const MetricExpression::Events& events) const;
  double timestep_s() const { return physics_.timestep_s; }

 private:
  // A key metrics.… that rows name.
  struct Number {
    double value = 0.0;
    bool is_positive = false;
    std::string help;
  };
  // The rows of the scenario's own file, and their keys there.
  struct OwnRows {
    std::shared_ptr<const ScenarioFile> file = nullptr;
    Config keys{"", {}};
    std::vector<MetricRow> rows = {};
  };

  std::shared_ptr<const OwnRows> own_rows() const;
  void name_number(const std::string& text, const char* role, const std::string& name);

  std::shared_ptr<const ScenarioKind> scenario_;
  std::vector<MetricKind> kinds_ = standard_metric_kinds();
  std::vector<MetricRow> rows_;  // the scenario's own ones come first
  std::shared_ptr<const OwnRows> own_ = std::make_shared<OwnRows>();
  std::vector<bool> is_unchanged_;  // one for each row
  std::vector<std::string> unmet_;
  std::map<std::string, Number> numbers_;
  std::map<std::string, double> known_;  // the numbers of names
  std::vector<std::string> fast_signals_;
  PhysicsSettings physics_;
};

/// The reason why a metric does not apply: the run lacks a signal, or `minus` has another unit.
/// Empty if it has all. Throws std::invalid_argument if the row needs one value of a signal with
/// several.
std::string missing_signal(const MetricRow& row, const MetricKind& kind,
                           const std::vector<Signal>& signals);

/// The metrics of one run, computed value by value.
class MetricValues {
 public:
  /// `signals` must outlive it. The first one of a name counts. `events` are the events of
  /// MetricContext. Throws std::invalid_argument if a cut-off is too high. A row [signal.NAME] may
  /// neither have the name of another signal nor need one value of a signal with several.
  MetricValues(const MetricRows& rows, const std::vector<Signal>& of_run, double end_s,
               const MetricExpression::Events& events = {});
  ~MetricValues();

  /// The signals of the rows [signal.NAME]. A run without a signal that one needs lacks it.
  const std::vector<Signal>& signals() const { return signals_; }
  /// Adds the values of a physics step, or of a sample. Allocates nothing.
  void at_step(double time_s);
  void at_sample(double time_s);

  /// The metrics so far.
  std::vector<Metric> metrics() const;
  /// The other metrics of the rows, with the reason.
  std::vector<AbsentMetric> absent() const;
  /// Whether a metric needs the estimators' poles now, which they compute only if asked.
  bool watches(double time_s) const;

 private:
  struct Value;
  struct Row;

  std::vector<Row> rows_;
  std::vector<std::unique_ptr<Value>> of_signals_;
  std::vector<Signal> signals_;
  std::vector<Value*> at_steps_;
  std::vector<Value*> at_samples_;
  std::vector<const Value*> watched_;
  double end_s_ = 0.0;
  double step_s_ = 0.0;
  double now_s_ = 0.0;
};

}  // namespace breakwater
