#include <breakwater/pages/signal_charts.h>

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include <breakwater/config/unit_of.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/record/recording.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace {

constexpr std::size_t kKeyCharts = 5;

// Signals of one width and unit. They differ by their roles: true, measured, estimated, reference,
// commanded or applied. One that two groups have is here once, from the group with more rows.
struct LoggedQuantity {
  std::string title;  // "contact_force", without its unit
  std::vector<LogEntry> kinds;
  std::size_t rank = 0;
};

// "physics/force_true_N"; a signal of the group `control` goes without "force_true_N".
std::string signal_path(const LogEntry& entry) {
  return entry.group == "control" ? entry.name : entry.group + "/" + entry.name;
}

// A name without the unit that it ends with: "force_true" of "force_true_N".
std::string without_unit(const std::string& name, const std::string& unit) {
  for (const std::string& one : {unit, unit.substr(0, unit.find(", "))}) {
    const std::string suffix = unit_suffix(one);
    if (suffix.size() > 1 && name.size() > suffix.size() && name.ends_with(suffix)) {
      return name.substr(0, name.size() - suffix.size());
    }
  }
  return name;
}

// And without its roles: "force".
std::string quantity_of(const LogEntry& entry) {
  std::vector<std::string> words = words_of(without_unit(entry.name, entry.unit));
  std::erase_if(words, [](const std::string& word) { return role_of_word(word).has_value(); });
  return words.empty() ? "input" : fmt::format("{}", fmt::join(words, "_"));
}

// The true signal comes first, then the measured one, then the estimates.
LineStyle order_of(const LogEntry& entry) {
  const LineStyle role = role_of_signal(entry.name).value_or(kStyleColours);
  return role == kReferenceStyle ? kStyleColours : role;
}

// The signal's name for "physics/NAME[3]".
std::string bare(const std::string& name) {
  const std::string whole = name.substr(0, name.find('['));
  return whole.substr(whole.find('/') + 1);
}

// Another group may have the same signal at another rate.
void add_kind(std::vector<LogEntry>& kinds, const LogEntry& entry) {
  const auto same = std::ranges::find(kinds, entry.name, &LogEntry::name);
  if (same == kinds.end()) {
    kinds.push_back(entry);
  } else if (entry.rows > same->rows) {
    *same = entry;
  }
}

// Makes the charts of one run. A signal is in one chart at most, and a constant one in none.
class Charts {
 public:
  Charts(const SavedRun& run, const std::string& id) : run_(run), id_(id) {}

  // One chart for each unit.
  void add(const std::string& title, const std::vector<std::string>& names,
           std::vector<PageChart>& to) {
    std::vector<PageChart> made;
    const auto chart_with = [&made](const std::string& unit) {
      return std::ranges::find_if(
          made, [&](const PageChart& chart) { return chart.series.front().unit == unit; });
    };
    std::vector<ChartSeries> constant;
    for (const std::string& name : names) {
      const std::string label = name.substr(name.find('/') + 1);
      // The same of another group counts too.
      if (!used_.insert(label).second) continue;
      ChartSeries series = series_of(run_, name, label);
      series.style = role_of_signal(bare(name));
      const std::vector<double>& values = series.values.values;
      if (std::ranges::all_of(values, [&](double value) { return value == values.front(); })) {
        constant.push_back(std::move(series));
        continue;
      }
      auto chart = chart_with(series.unit);
      if (chart == made.end()) {
        chart = made.insert(made.end(), PageChart{.group = id_, .title = title});
      }
      chart->series.push_back(std::move(series));
    }
    // A reference that stands still says where the others should be.
    for (ChartSeries& series : constant) {
      const auto chart = chart_with(series.unit);
      if (series.style == kReferenceStyle && chart != made.end()) {
        chart->series.push_back(std::move(series));
      }
    }
    for (PageChart& chart : made) {
      chart.id = fmt::format("{}-{}", id_, ++count_);
      // Another chart has the rest of the quantity already.
      const bool is_rest = names.size() > 1 && chart.series.size() == 1;
      if (is_rest) chart.title += ", " + chart.series.front().label;
      to.push_back(std::move(chart));
    }
  }

 private:
  const SavedRun& run_;
  const std::string& id_;
  std::size_t count_ = 0;
  std::set<std::string> used_;
};

// The values of a shot list's names, of those that the run has.
std::vector<std::string> named(const SavedRun& run, const std::vector<std::string>& names) {
  std::vector<std::string> all;
  for (const std::string& name : names) {
    if (!run.has_signal(name)) continue;
    const std::size_t index = std::min(name.find('['), name.size());
    const auto values = value_names(run, signal_path(run.entry(name)) + name.substr(index));
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

// "j1_reference_rad" is the reference of "j1_position_true_rad".
void join_references(std::vector<LoggedQuantity>& all) {
  for (auto one = all.begin(); one != all.end();) {
    const LogEntry& entry = one->kinds.front();
    const auto whole = std::find_if(all.begin(), all.end(), [&](const LoggedQuantity& other) {
      const LogEntry& first = other.kinds.front();
      return other.title.starts_with(one->title + "_") && other.kinds.size() > 1 &&
             first.unit == entry.unit && first.width == entry.width;
    });
    const bool is_alone = one->kinds.size() == 1 && role_of_signal(entry.name) == kReferenceStyle;
    if (is_alone && whole != all.end()) {
      whole->kinds.push_back(entry);
      one = all.erase(one);
    } else {
      ++one;
    }
  }
}

// All quantities of a log. First come those of the shot list in its order, then those of several
// kinds, then the others.
std::vector<LoggedQuantity> quantities(const std::vector<LogEntry>& signals,
                                       const ShotList& shots) {
  std::vector<std::string> shown;
  for (const ShotPage::KeyChart& chart : shots.page.charts) {
    for (const std::string& name : chart.signals) shown.push_back(bare(name));
  }
  for (const ShotLine& line : shots.lines) shown.push_back(bare(line.value));
  for (const ShotArrow& arrow : shots.arrows) shown.push_back(bare(arrow.track.signal));
  std::vector<LoggedQuantity> all;
  for (const LogEntry& entry : signals) {
    if (entry.name == "qpos" || entry.rows == 0) continue;
    const std::string stem = quantity_of(entry);
    const auto found = std::find_if(all.begin(), all.end(), [&](const LoggedQuantity& quantity) {
      const LogEntry& first = quantity.kinds.front();
      return first.width == entry.width && first.unit == entry.unit && quantity.title == stem;
    });
    if (found != all.end()) {
      add_kind(found->kinds, entry);
    } else {
      all.push_back({stem, {entry}});
    }
  }
  join_references(all);
  for (LoggedQuantity& quantity : all) {
    std::ranges::stable_sort(quantity.kinds, {}, order_of);
    const bool is_true = order_of(quantity.kinds.front()) == 0;
    quantity.rank = shown.size() + (quantity.kinds.size() == 1 ? 2 : is_true ? 0 : 1);
    for (const LogEntry& kind : quantity.kinds) {
      const auto place = std::find(shown.begin(), shown.end(), kind.name);
      if (place == shown.end()) continue;
      quantity.rank = std::min(quantity.rank, static_cast<std::size_t>(place - shown.begin()));
    }
  }
  std::ranges::stable_sort(all, {}, &LoggedQuantity::rank);
  return all;
}

}  // namespace

ChartSeries series_of(const SavedRun& run, const std::string& signal, const std::string& label) {
  return {.label = label,
          .unit = run.unit(signal),
          .description = signal + ": " + run.entry(signal).description,
          .values = run.signal(signal),
          .signal = signal};
}

SignalCharts signal_charts(const SavedRun& run, const std::string& id, const ShotList& shots) {
  SignalCharts made;
  Charts charts(run, id);
  for (const ShotPage::KeyChart& chart : shots.page.charts) {
    charts.add(chart.title, named(run, chart.signals), made.key);
  }
  const bool has_own = !made.key.empty();
  for (const LoggedQuantity& quantity : quantities(run.signals(), shots)) {
    std::vector<PageChart>& to = has_own || made.key.size() >= kKeyCharts ? made.others : made.key;
    const std::size_t width = quantity.kinds.front().width;
    if (quantity.kinds.size() == 1) {
      charts.add(quantity.title, value_names(run, signal_path(quantity.kinds.front())), to);
      continue;
    }
    for (std::size_t i = 0; i < width; ++i) {
      std::vector<std::string> kinds;
      for (const LogEntry& entry : quantity.kinds) {
        kinds.push_back(value_names(run, signal_path(entry))[i]);
      }
      charts.add(width == 1 ? quantity.title : fmt::format("{} [{}]", quantity.title, i + 1), kinds,
                 to);
    }
  }
  return made;
}

}  // namespace breakwater
