#include <breakwater/experiment/metric_rows.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <ranges>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <breakwater/config/toml_text.h>
#include <breakwater/config/unit_of.h>
#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/linear/high_pass.h>
#include <breakwater/record/hdf5_log.h>
#include <breakwater/shell/did_you_mean.h>

namespace breakwater {
namespace {

constexpr const char* kNone = "none";
constexpr const char* kZero = "0.0";
constexpr const char* kLevel = "level";
constexpr const char* kCutoff = "cut-off";
constexpr const char* kWatched = "poles_";  // in the names of signals that are computed if asked
const std::string kIsThere = " is there";
const std::string kIsReached = " is reached";
constexpr double kNever = std::numeric_limits<double>::infinity();

// A value that is taken from a signal, and the words for it: {} is the signal, the next {} the
// cut-off.
struct Taking {
  const char* name;
  Taken take;
  const char* words;
};
constexpr Taking kTakings[] = {{"value", Taken::value, "{}"},
                               {"difference", Taken::difference, "rate of change of {}"},
                               {"high_pass", Taken::high_pass, "{} behind a high-pass of {} Hz"},
                               {"largest", Taken::largest, "largest value of {}"},
                               {"largest_size", Taken::largest_size, "largest magnitude of {}"},
                               {"norm", Taken::norm, "norm of {}"}};

std::vector<std::string> split(const std::string& text, const std::string& between) {
  std::vector<std::string> parts;
  for (const auto part : std::views::split(text, between)) {
    parts.emplace_back(part.begin(), part.end());
  }
  if (parts.empty()) parts.emplace_back();
  return parts;
}

std::vector<std::string> conditions_of(const MetricRow& row) {
  return row.where.empty() ? std::vector<std::string>{} : split(row.where, " and ");
}

std::string without_end(const std::string& text, const std::string& end) {
  return text.substr(0, text.size() - end.size());
}

// The value of a signal, NAME or NAME[2], or all values; empty if there is none.
std::span<const double> value_of(const std::string& name, const std::vector<Signal>& signals,
                                 bool takes_all) {
  const SignalName wanted = signal_name(name);
  for (const Signal& signal : signals) {
    if (signal.name != wanted.name) continue;
    if (takes_all && wanted.index == 0) return signal.values;
    const std::size_t index = std::max<std::size_t>(1, wanted.index);
    if (index > signal.values.size() || (wanted.index == 0 && signal.values.size() > 1)) {
      throw std::invalid_argument(name + ": the signal has " +
                                  std::to_string(signal.values.size()) + " values");
    }
    return signal.values.subspan(index - 1, 1);
  }
  return {};
}

bool takes_all(const MetricRow& row, const MetricKind& kind) {
  return kind.takes_all || row.take == Taken::largest || row.take == Taken::largest_size ||
         row.take == Taken::norm;
}

// A row for each table of a file.
std::vector<MetricRow> rows_in(const Config& config) {
  std::vector<MetricRow> rows;
  for (const std::string& name : config.names_in("metric")) rows.emplace_back().table = name;
  for (const std::string& name : config.names_in("signal")) {
    MetricRow& row = rows.emplace_back();
    row.is_signal = true;
    row.table = name;
    row.kind = "last";
    row.at = MetricRate::sample;
  }
  return rows;
}

// Whether a run gives a row other keys than the scenario's own file. A case, --set and an alias may
// do so with each value: all points of a study then have the same keys.
bool has_other_keys(const Config& config, const Config& own, const std::string& prefix) {
  const auto is_of_row = [&](const auto& alias) { return alias.second.starts_with(prefix); };
  const auto is_other = [&](const auto& entry) {
    if (!entry.first.starts_with(prefix)) return false;
    const ConfigEntry* known = own.find(entry.first);
    return known == nullptr || entry.second.rank() > 0 ||
           toml_value(entry.second.value) != toml_value(known->value);
  };
  return std::ranges::any_of(config.aliases(), is_of_row) ||
         std::ranges::any_of(own.aliases(), is_of_row) ||
         std::ranges::any_of(config.entries(), is_other);
}

// The file may leave out the key if there is a value.
void default_is(Fields& fields, const char* key, const std::string& present) {
  if (!present.empty()) fields.standard(key, {present});
}

}  // namespace

void MetricRow::bind(Fields& fields, const std::vector<MetricKind>& kinds) {
  const Fields::Under under(fields, prefix());
  const auto number_key = [&](const char* key, std::string& target, const char* doc) {
    fields.number_or_text(key, target, doc);
    fields.standard(key, {target});
  };
  fields.text("of", of,
              "signal of the log, with a number in square brackets for one of its values. "
              "relative_rms: two, with a comma between them");
  default_is(fields, "of", of);
  fields.optional_text("minus", minus, "signal that is subtracted from it; none: nothing");
  if (!is_signal) {
    std::vector<std::pair<std::string, std::string>> names;
    std::vector<std::string> with_level;
    for (const MetricKind& one : kinds) {
      names.emplace_back(one.name, one.name);
      if (one.name == "rms") names.emplace_back("rmse", "rms");
      if (one.has_level) with_level.push_back(one.name);
    }
    fields.choice("kind", kind, names, "reduction of the values of the window to one number");
    default_is(fields, "kind", kind);
    number_key(
        "from_s", from_s,
        "start of the window. This and the other numbers may be sums and products of numbers, "
        "keys and the scenario's events: first_contact + 0.2 [s]");
    number_key("to_s", to_s,
               "end of the window, which a run must cover; 0: the end of the run [s]");
    number_key("before_s", before_s,
               "end of the window, which does not belong to it, and which a run need not reach; 0: "
               "none [s]");
    number_key("level", level, "level, in the signal's unit");
    number_key("lower", lower, "lower level, in the signal's unit");
    fields.only_for({"level"}, "kind", with_level);
    fields.only_for({"lower"}, "kind", {"time_outside", "jump"});
  }
  std::vector<std::pair<std::string, Taken>> takings;
  for (const Taking& one : kTakings) takings.emplace_back(one.name, one.take);
  fields.optional_choice(
      "take", take, takings,
      "value that is taken from the signal, before minus. difference: to the last sample (of a "
      "contact's force the last physics step), divided by the time between; largest, largest_size "
      "(magnitude), norm: of several values");
  if (!is_signal) {
    fields.optional_choice(
        "at", at,
        {{"auto", MetricRate::by_signal},
         {"sample", MetricRate::sample},
         {"step", MetricRate::step}},
        "take the values at each sample or at each physics step; auto: a contact's force at each "
        "step");
    fields.optional_text(
        "where", where,
        "conditions without which the metric is absent, with and between them: KEY is VALUE "
        "or VALUE, SIGNAL is there, TIME is reached");
    fields.optional_text("name", name, "name of the metric, if it is not that of the table");
    fields.optional_text("unit", unit, "unit; without it, that of the signal is added to the name");
  }
  const char* const meaning = is_signal ? "meaning of the signal, for the log"
                                        : "meaning of the metric, one sentence without a full stop";
  fields.optional_text("text", text, meaning);
  if (!is_signal) {
    fields.optional_count("rank", rank, between(0, 1000),
                          "place among the main metrics, from 1 on; 0: it is none of them");
  }
  const Fields::OfPart high_pass(fields, "take", "high_pass");
  fields.number_or_text("cutoff_Hz", cutoff_Hz,
                        "cut-off of the high-pass, a Butterworth filter of second order [Hz]");
  if (cutoff_Hz != kZero) fields.standard("cutoff_Hz", {cutoff_Hz});
}

MetricDefinition MetricRow::definition(const MetricKind& kind_of_row) const {
  const std::string own_name = name.empty() ? table : name;
  std::string of_signal = unit_of(whole_key(split(of, ", ").front()));
  if (of_signal.empty()) of_signal = "1";
  if (take == Taken::difference) of_signal += "/s";
  const auto& words =
      std::find_if(std::begin(kTakings), std::end(kTakings), [this](const Taking& one) {
        return one.take == take;
      })->words;
  std::string of_what = fmt::format(fmt::runtime(words), of, cutoff_Hz);
  if (minus != kNone) of_what += " less " + minus;
  const std::string meaning = text.empty() ? of_what + ": " + kind_of_row.meaning : text;
  if (!unit.empty()) return {own_name, unit, meaning};
  std::string own_unit = kind_of_row.unit.empty() ? of_signal : kind_of_row.unit;
  if (own_unit == kTimesSeconds) {
    own_unit = of_signal == "1"            ? "s"
               : of_signal.ends_with("/s") ? of_signal.substr(0, of_signal.size() - 2)
                                           : of_signal + " s";
  }
  const std::string end = unit_suffix(own_unit);
  return {own_name.ends_with(end) ? own_name : own_name + end, own_unit, meaning};
}

MetricRows::MetricRows(const Catalogue& catalogue, const std::string& name,
                       std::vector<MetricKind> own_kinds) {
  if (catalogue.has<ScenarioKind>(name)) {
    scenario_ = std::make_shared<ScenarioKind>(catalogue.get<ScenarioKind>(name));
  }
  kinds_.insert(kinds_.end(), own_kinds.begin(), own_kinds.end());
}

// Each run asks for them: they are read again only if the file changed.
std::shared_ptr<const MetricRows::OwnRows> MetricRows::own_rows() const {
  if (!scenario_) return own_;
  static std::mutex reading;
  static std::map<std::string, std::shared_ptr<const OwnRows>> known;
  const auto file = scenario_->scenario_file();
  const std::lock_guard lock(reading);
  std::shared_ptr<const OwnRows>& read = known[scenario_->name];
  if (read && read->file == file) return read;

  const Config all = file->tables().front();
  std::map<std::string, ConfigEntry> entries;
  for (const auto& [key, entry] : all.entries()) {
    if (key.starts_with("metric.") || key.starts_with("signal.")) entries.emplace(key, entry);
  }
  const Config keys(file->file(), std::move(entries), file->aliases());
  std::vector<MetricRow> rows = rows_in(keys);
  Fields fields;
  for (MetricRow& row : rows) row.bind(fields, kinds_);
  fields.read(keys);
  return read = std::make_shared<OwnRows>(OwnRows{file, keys, std::move(rows)});
}

void MetricRows::learn(const Config& config) {
  own_ = own_rows();
  rows_ = own_->rows;
  is_unchanged_.clear();
  for (const MetricRow& row : rows_) {
    is_unchanged_.push_back(!has_other_keys(config, own_->keys, row.prefix()));
  }
  for (MetricRow& one : rows_in(config)) {
    const bool is_own = std::ranges::any_of(
        own_->rows, [&](const MetricRow& row) { return row.prefix() == one.prefix(); });
    if (!is_own) rows_.push_back(std::move(one));
  }
  is_unchanged_.resize(rows_.size(), false);
  numbers_.clear();
  for (const MetricRow& row : rows_) {
    const Config own = config.under(row.prefix());
    const std::string given = own.text("name").value_or(row.name);
    const std::string& name = given.empty() ? row.table : given;
    const auto look = [&](const char* key, const std::string& shipped, const char* role) {
      name_number(own.text(key).value_or(shipped), role, name);
    };
    look("from_s", row.from_s, "start of the window");
    look("to_s", row.to_s, "end of the window");
    look("before_s", row.before_s, "end of the window");
    look("level", row.level, kLevel);
    look("lower", row.lower, "lower level");
    look("cutoff_Hz", row.cutoff_Hz, kCutoff);
  }
}

void MetricRows::name_number(const std::string& text, const char* role, const std::string& name) {
  const std::string begin = "metrics.";
  std::size_t end = 0;
  for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, end)) {
    end = std::min(text.find(' ', at), text.size());
    Number& number = numbers_[text.substr(at, end - at)];
    const bool is_sum =
        text.find(" + ") != std::string::npos || text.find(" - ") != std::string::npos;
    const std::string_view what = role;
    number.is_positive = number.is_positive || ((what == kLevel || what == kCutoff) && !is_sum);
    if (number.help.empty()) {
      number.help = fmt::format("{} of {}", role, name);
    } else if (!number.help.ends_with(" " + name)) {  // a row's numbers come one after the other
      number.help += ", " + name;
    }
  }
}

void MetricRows::bind(Fields& fields) {
  fields.alias(own_->keys.aliases());
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (is_unchanged_[i]) {
      fields.leave(rows_[i].prefix(), [this, i](const Config& keys) {
        MetricRow row = rows_[i];
        Fields alone;
        row.bind(alone, kinds_);
        alone.check(std::span(&keys, 1));
      });
    } else {
      rows_[i].bind(fields, kinds_);
    }
  }
  for (auto& [key, number] : numbers_) {
    if (fields.has(key)) continue;
    fields.number(key, number.value, number.is_positive ? positive() : not_negative(), number.help);
  }
}

void MetricRows::check(const Config& config, const Fields& fields, const PhysicsSettings& physics,
                       const MetricContext& context) {
  physics_ = physics;
  known_ = context.known;
  fast_signals_ = context.fast_signals;
  unmet_.assign(rows_.size(), "");
  const auto number = [&](const std::string& name) -> std::optional<double> {
    if (const auto known = known_.find(name); known != known_.end()) return known->second;
    auto found = config.number(name);
    if (!found) found = fields.number_of(name);
    if (found) known_[name] = *found;
    return found;
  };
  MetricExpression::Events events;
  for (const std::string& name : context.events) events[name] = &kNever;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const MetricRow& row = rows_[i];
    const Config own = config.under(row.prefix());
    const auto read = [&](const char* key, const std::string& text) {
      return own.blame(key, [&] { return MetricExpression(text, number, events); });
    };
    const auto parse = [&](const char* key, const std::string& text) {
      auto expression = read(key, text);
      if (number_in(text) && expression.value() < 0.0) {
        own.fail(key, "must be 0 or more, is " + text);
      }
      return expression;
    };
    const MetricExpression from = parse("from_s", row.from_s), to = parse("to_s", row.to_s);
    const MetricExpression before = parse("before_s", row.before_s);
    kind_of(row).name == "time_outside" ? read("level", row.level) : parse("level", row.level);
    read("lower", row.lower);
    for (const auto& [end, time] : {std::pair(row.to_s, to), std::pair(row.before_s, before)}) {
      if (numbers_.contains(row.from_s) && numbers_.contains(end) && time.value() <= from.value()) {
        config.fail(end, "must be later than " + row.from_s);
      }
    }
    if (i >= own_->rows.size() && row.to_s != kZero && from.is_constant() && to.is_constant() &&
        to.value() <= from.value()) {
      own.fail("to_s", "must be later than from_s, or 0 for the end of the run");
    }
    if (row.take == Taken::high_pass) {
      const bool is_key = numbers_.contains(row.cutoff_Hz);
      (is_key ? config : own).blame(is_key ? row.cutoff_Hz : "cutoff_Hz", [&] {
        HighPass(MetricExpression(row.cutoff_Hz, number, events).value(), period_of(row));
      });
    }
    for (const std::string& condition : conditions_of(row)) {
      if (condition.ends_with(kIsThere)) continue;
      if (condition.ends_with(kIsReached)) {
        read("where", without_end(condition, kIsReached));
        continue;
      }
      const std::vector<std::string> parts = split(condition, " is ");
      const bool is_known = config.find(parts.front()) != nullptr || fields.has(parts.front());
      if (parts.size() != 2 || !is_known) {
        own.fail("where",
                 "\"" + condition + "\" must be KEY is VALUE, SIGNAL is there or TIME is reached");
      }
      const auto word = config.text(parts.front());
      const std::vector<std::string> values = split(parts[1], " or ");
      const bool holds = std::any_of(values.begin(), values.end(), [&](const std::string& value) {
        return word ? *word == value : fields.has_chosen(parts.front(), value);
      });
      if (!holds) unmet_[i] = "it is defined only where " + condition;
    }
  }
}

std::vector<MetricDefinition> MetricRows::definitions() const {
  std::vector<MetricDefinition> definitions;
  const std::shared_ptr<const OwnRows> own = rows_.empty() ? own_rows() : own_;
  for (const MetricRow& row : rows_.empty() ? own->rows : rows_) {
    if (!row.is_signal) definitions.push_back(row.definition(kind_of(row)));
  }
  return definitions;
}

std::vector<std::string> MetricRows::main() const {
  std::vector<MetricRow> rows = rows_.empty() ? own_rows()->rows : rows_;
  std::erase_if(rows, [](const MetricRow& row) { return row.is_signal; });
  const auto is_ranked = [](const MetricRow& row) { return row.rank > 0; };
  if (std::any_of(rows.begin(), rows.end(), is_ranked)) {
    std::erase_if(rows, std::not_fn(is_ranked));
    std::ranges::stable_sort(rows, {}, &MetricRow::rank);
  }
  std::vector<std::string> names;
  for (const MetricRow& row : rows) names.push_back(row.definition(kind_of(row)).name);
  return names;
}

const MetricKind& MetricRows::kind_of(const MetricRow& row) const {
  return *std::ranges::find(kinds_, row.kind, &MetricKind::name);
}

bool MetricRows::is_at_step(const MetricRow& row) const {
  if (row.at != MetricRate::by_signal) return row.at == MetricRate::step;
  return std::any_of(fast_signals_.begin(), fast_signals_.end(),
                     [&](const std::string& begin) { return row.of.starts_with(begin); });
}

double MetricRows::period_of(const MetricRow& row) const {
  return is_at_step(row) ? physics_.timestep_s : physics_.control_period_s;
}

MetricExpression MetricRows::expression(const std::string& text,
                                        const MetricExpression::Events& events) const {
  const auto number = [this](const std::string& name) -> std::optional<double> {
    const auto known = known_.find(name);
    return known != known_.end() ? std::optional(known->second) : std::nullopt;
  };
  return {text, number, events};
}

std::string missing_signal(const MetricRow& row, const MetricKind& kind,
                           const std::vector<Signal>& signals) {
  std::vector<std::string> names;
  for (const Signal& signal : signals) names.push_back(signal.name);
  std::vector<std::pair<std::string, std::string>> needed;  // key and signal
  for (const std::string& name : split(row.of, ", ")) needed.emplace_back("of", name);
  if (row.minus != kNone) needed.emplace_back("minus", row.minus);
  for (const auto& [key, name] : needed) {
    const bool all = key == "of" ? takes_all(row, kind) : kind.takes_all;
    if (!value_of(name, signals, all).empty()) continue;
    return row.prefix() + key + ": the log has no signal " + toml_string(name) +
           did_you_mean(signal_name(name).name, names);
  }
  if (row.minus == kNone || row.take == Taken::difference) return "";
  const auto unit_in = [&](const std::string& name) {
    return std::ranges::find(signals, signal_name(name).name, &Signal::name)->unit;
  };
  const std::string unit = unit_in(needed.front().second), other = unit_in(row.minus);
  if (unit == other || (unit + other).find(',') != std::string::npos) return "";  // a list of units
  return fmt::format("{}minus: {} is in {}, and not in {}", row.prefix(), toml_string(row.minus),
                     other, unit);
}

// ---- the values of a run -----------------------------------------------------------------------

struct MetricValues::Value {
  Value(const MetricRows& rows, const MetricRow& row, const std::vector<Signal>& signals,
        double end_s, const MetricExpression::Events& events)
      : kind(rows.kind_of(row)),
        take(row.take),
        period_s(rows.period_of(row)),
        window{rows.expression(row.from_s, events),
               end_of(rows, row.to_s, events),
               end_of(rows, row.before_s, events),
               end_s,
               1e-6 * rows.timestep_s(),
               kind.goes_on},
        level(rows.expression(row.level, events)),
        lower(rows.expression(row.lower, events)) {
    std::size_t count = 0;
    for (const std::string& name : split(row.of, ", ")) {
      of.push_back(value_of(name, signals, takes_all(row, kind)));
      count += of.back().size();
    }
    if (row.minus != kNone) minus = value_of(row.minus, signals, kind.takes_all);
    if (kind.takes_all) {
      all.resize(count);
      if (!minus.empty() && minus.size() != count) {
        throw std::invalid_argument(row.minus + ": must have as many values as " + row.of);
      }
    }
    if (take == Taken::high_pass) {
      high_pass.emplace(rows.expression(row.cutoff_Hz, events).value(), period_s);
    }
    reduction = kind.make({window, level, lower, period_s, count});
  }

  static std::optional<MetricExpression> end_of(const MetricRows& rows, const std::string& text,
                                                const MetricExpression::Events& events) {
    if (text == kZero) return std::nullopt;
    return rows.expression(text, events);
  }

  double taken() {
    const std::span<const double> values = of.front();
    switch (take) {
      case Taken::value:
        break;
      case Taken::difference: {
        const double before = last_of.value_or(values.front());
        last_of = values.front();
        return (values.front() - before) / period_s;
      }
      case Taken::high_pass:
        return high_pass->update(values.front());
      case Taken::largest:
        return *std::max_element(values.begin(), values.end());
      case Taken::largest_size: {
        double largest = 0.0;
        for (const double value : values) largest = std::max(largest, std::abs(value));
        return largest;
      }
      case Taken::norm:
        return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0));
    }
    return values.front();
  }

  void add(double time_s) {
    double value = 0.0;
    if (kind.takes_all) {
      auto next = all.begin();
      for (const auto& values : of) next = std::copy(values.begin(), values.end(), next);
      for (std::size_t i = 0; i < minus.size(); ++i) all[i] -= minus[i];
      value = all.front();
    } else {
      value = taken() - (minus.empty() ? 0.0 : minus.front());
    }
    if (window.contains(time_s)) {
      const std::span<const double> added = kind.takes_all ? all : view(value);
      reduction->add({time_s, added, value, last, !has_values});
      has_values = true;
    }
    last = now = value;
  }

  std::optional<double> result() const { return has_values ? reduction->value() : std::nullopt; }

  MetricKind kind;
  Taken take;
  double period_s;
  MetricWindow window;
  MetricExpression level;
  MetricExpression lower;
  std::vector<std::span<const double>> of;
  std::span<const double> minus;
  std::vector<double> all;
  std::optional<HighPass> high_pass;
  std::optional<double> last_of;  // for a difference
  std::optional<double> last;
  double now = 0.0;  // the last value
  bool has_values = false;
  std::unique_ptr<Reduction> reduction;
};

struct MetricValues::Row {
  MetricDefinition definition;
  std::string unmet;    // a condition that the configuration does not meet
  std::string missing;  // a signal that the run lacks
  std::string window;   // as its keys say it
  std::vector<std::pair<std::string, MetricExpression>> reached;  // times that it needs
  std::unique_ptr<Value> value;                                   // null if it cannot apply

  // The reason why there is no value; empty if there is one.
  std::string why_absent(double now_s) const {
    if (!unmet.empty()) return unmet;
    if (!missing.empty()) return missing;
    for (const auto& [text, time] : reached) {
      if (!(time.value() <= now_s)) return "the run does not reach " + text;
    }
    if (!value->has_values) return "the run does not cover its window, " + window;
    const auto result = value->result();
    return result && std::isfinite(*result) ? "" : value->kind.why_absent;
  }
};

MetricValues::~MetricValues() = default;

MetricValues::MetricValues(const MetricRows& rows, const std::vector<Signal>& of_run, double end_s,
                           const MetricExpression::Events& events)
    : end_s_(end_s), step_s_(rows.timestep_s()) {
  std::vector<Signal> signals = of_run;
  const auto watch = [this](const MetricRow& row, const Value* value) {
    if (row.of.find(kWatched) != std::string::npos) watched_.push_back(value);
  };
  for (const MetricRow& row : rows.rows()) {
    if (!row.is_signal || !missing_signal(row, rows.kind_of(row), signals).empty()) continue;
    if (!value_of(row.table, signals, true).empty()) {
      throw std::invalid_argument(row.prefix() + "of: the log has a signal of this name already");
    }
    of_signals_.push_back(std::make_unique<Value>(rows, row, signals, end_s, events));
    const Value* const value = of_signals_.back().get();
    watch(row, value);
    const std::string unit = unit_of(row.table);
    signals_.push_back({row.table, unit.empty() ? "1" : unit, row.text, view(value->now)});
    signals.push_back(signals_.back());
  }
  for (std::size_t i = 0; i < rows.rows().size(); ++i) {
    const MetricRow& row = rows.rows()[i];
    if (row.is_signal) continue;
    const MetricKind& kind = rows.kind_of(row);
    Row& made = rows_.emplace_back();
    made.definition = row.definition(kind);
    made.unmet = rows.unmet(i);
    const std::string end = row.to_s != kZero ? row.to_s : row.before_s;
    made.window = fmt::format("from {} to {}", row.from_s, end == kZero ? "the run's end" : end);
    for (const std::string& condition : conditions_of(row)) {
      const std::string signal = without_end(condition, kIsThere);
      if (condition.ends_with(kIsThere) && value_of(signal, signals, true).empty()) {
        made.missing = "the run has no signal " + toml_string(signal);
      }
      if (condition.ends_with(kIsReached)) {
        const std::string time = without_end(condition, kIsReached);
        made.reached.emplace_back(time, rows.expression(time, events));
      }
    }
    try {
      if (made.missing.empty()) made.missing = missing_signal(row, kind, signals);
      if (!made.unmet.empty() || !made.missing.empty()) continue;
      made.value = std::make_unique<Value>(rows, row, signals, end_s, events);
    } catch (const std::invalid_argument& error) {
      made.missing = row.prefix() + "of: " + error.what();
      continue;
    }
    (rows.is_at_step(row) ? at_steps_ : at_samples_).push_back(made.value.get());
    watch(row, made.value.get());
  }
}

void MetricValues::at_step(double time_s) {
  now_s_ = std::min(time_s + step_s_, end_s_);
  for (Value* value : at_steps_) value->add(time_s);
}

void MetricValues::at_sample(double time_s) {
  for (const auto& value : of_signals_) value->add(time_s);
  for (Value* value : at_samples_) value->add(time_s);
}

std::vector<Metric> MetricValues::metrics() const {
  std::vector<Metric> metrics;
  for (const Row& row : rows_) {
    if (!row.why_absent(now_s_ + 1e-6 * step_s_).empty()) continue;
    add(metrics, row.definition.name, row.definition.unit, row.value->result());
  }
  return metrics;
}

std::vector<AbsentMetric> MetricValues::absent() const {
  std::vector<AbsentMetric> absent;
  const auto is_called = [](const std::string& name) {
    return [&name](const auto& one) { return one.name == name; };
  };
  const std::vector<Metric> metrics = this->metrics();
  // Among rows with one name, one that the configuration asks for has the reason.
  for (const bool is_unmet : {false, true}) {
    for (const Row& row : rows_) {
      const std::string& name = row.definition.name;
      if (row.unmet.empty() == is_unmet || std::ranges::any_of(metrics, is_called(name)) ||
          std::ranges::any_of(absent, is_called(name))) {
        continue;
      }
      absent.push_back({name, row.definition.unit, row.why_absent(now_s_ + 1e-6 * step_s_)});
    }
  }
  return absent;
}

bool MetricValues::watches(double time_s) const {
  return std::any_of(watched_.begin(), watched_.end(),
                     [=](const Value* value) { return value->window.contains(time_s); });
}

}  // namespace breakwater
