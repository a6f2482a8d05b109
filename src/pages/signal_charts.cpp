#include <breakwater/pages/signal_charts.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

namespace breakwater {
namespace {

// The kinds of a signal, as its name has them.
const std::set<std::string> kKinds = {"true",   "measured",  "hat",     "estimate",
                                      "ref",    "reference", "command", "applied",
                                      "sensor", "filtered",  "raw"};
const std::set<std::string> kReferences = {"ref", "reference"};

std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words(1);
  for (const char c : name) {
    if (c == '_') {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

// A unit as the end of a name: "rad_s2" for "rad/s^2".
std::string suffix_of(const std::string& unit) {
  std::string suffix = "_";
  for (const char c : unit) {
    if (c == '/') suffix += '_';
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) suffix += c;
  }
  return suffix;
}

std::string without_unit(const std::string& signal, const std::string& unit) {
  for (const std::string& one : {unit, unit.substr(0, unit.find(", "))}) {
    // "²" has two bytes and neither is a letter.
    std::string plain = one;
    const std::size_t square = plain.find("²");
    if (square != std::string::npos) plain.replace(square, std::string("²").size(), "2");
    const std::string suffix = suffix_of(plain);
    if (suffix.size() > 1 && signal.size() > suffix.size() && signal.ends_with(suffix)) {
      return signal.substr(0, signal.size() - suffix.size());
    }
  }
  return signal;
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

// A name without its unit and its kind.
std::string stem_of(const LogEntry& entry) {
  const std::string& unit = entry.unit;
  std::vector<std::string> words = words_of(without_unit(entry.name, unit));
  const auto kind = std::find_if(words.begin(), words.end(),
                                 [](const std::string& word) { return kKinds.contains(word); });
  if (kind != words.end()) words.erase(kind);
  return joined(words);
}

bool is_reference(const LogEntry& entry) {
  const std::vector<std::string> words = words_of(entry.name);
  return std::any_of(words.begin(), words.end(),
                     [](const std::string& word) { return kReferences.contains(word); });
}

// The true signal comes first, then the measured one, then the estimates.
std::size_t order_of(const LogEntry& entry) {
  constexpr std::array<const char*, 4> kOrder = {"true", "measured", "hat", "estimate"};
  const std::vector<std::string> words = words_of(entry.name);
  for (std::size_t i = 0; i < kOrder.size(); ++i) {
    if (std::find(words.begin(), words.end(), kOrder[i]) != words.end()) return i;
  }
  return kOrder.size();
}

// The name of the signal without an index: "NAME" for "NAME[3]".
std::string bare(const std::string& name) {
  return name.substr(0, name.find('['));
}

}  // namespace

std::string readable_name(const std::string& signal, const std::string& unit) {
  return joined(words_of(without_unit(signal, unit)));
}

std::vector<LoggedQuantity> quantities(const std::vector<LogEntry>& signals,
                                       const ShotList& shots) {
  std::vector<std::string> shown;
  for (const ShotLine& line : shots.lines) shown.push_back(bare(line.value));
  for (const ShotArrow& arrow : shots.arrows) shown.push_back(bare(arrow.signal));
  std::vector<LoggedQuantity> all;
  for (const LogEntry& entry : signals) {
    if (entry.name == "qpos" || entry.rows == 0) continue;
    const std::string stem = stem_of(entry);
    const auto found = std::find_if(all.begin(), all.end(), [&](const LoggedQuantity& quantity) {
      const LogEntry& first = quantity.kinds.front();
      return first.group == entry.group && first.width == entry.width && first.unit == entry.unit &&
             stem_of(first) == stem;
    });
    if (found != all.end()) {
      found->kinds.push_back(entry);
    } else {
      all.push_back({stem, {entry}});
    }
  }
  for (LoggedQuantity& quantity : all) {
    std::stable_sort(
        quantity.kinds.begin(), quantity.kinds.end(),
        [](const LogEntry& a, const LogEntry& b) { return order_of(a) < order_of(b); });
    const LogEntry& first = quantity.kinds.front();
    quantity.rank = shown.size() + (first.group != "control"     ? 2
                                    : quantity.kinds.size() == 1 ? 1
                                                                 : 0);
    for (const LogEntry& kind : quantity.kinds) {
      const auto place = std::find(shown.begin(), shown.end(), kind.name);
      if (kind.group == "control" && place != shown.end()) {
        quantity.rank = std::min(quantity.rank, static_cast<std::size_t>(place - shown.begin()));
      }
    }
    if (quantity.kinds.size() == 1) {
      quantity.title = readable_name(first.name, first.unit);
    } else if (quantity.title.empty()) {
      quantity.title = "input";  // command and applied alone leave no name
    }
    if (first.group != "control") quantity.title += " (" + first.group + ")";
  }
  std::stable_sort(all.begin(), all.end(), [](const LoggedQuantity& a, const LoggedQuantity& b) {
    return a.rank < b.rank;
  });
  return all;
}

std::vector<PageChart> signal_charts(const SavedRun& run, const std::string& id,
                                     const ShotList& shots) {
  std::vector<PageChart> charts;
  const auto add = [&](const std::string& title) -> PageChart& {
    PageChart& chart = charts.emplace_back();
    chart.id = fmt::format("{}-{}", id, charts.size());
    chart.group = id;
    chart.title = title;
    return chart;
  };
  const auto series = [&](const LogEntry& entry, std::size_t index) {
    const std::string name = entry.group == "control" ? entry.name : entry.group + "/" + entry.name;
    const std::string one = entry.width == 1 ? "" : fmt::format("[{}]", index);
    ChartSeries made;
    made.label = name + one;
    made.unit = entry.unit_of(index);
    made.description = entry.description;
    made.values = run.signal(entry.group + "/" + entry.name + one);
    return made;
  };
  for (const LoggedQuantity& quantity : quantities(run.signals(), shots)) {
    const std::size_t width = quantity.kinds.front().width;
    if (width == 1 || quantity.kinds.size() == 1) {
      PageChart& chart = add(quantity.title);
      for (const LogEntry& entry : quantity.kinds) {
        for (std::size_t i = 1; i <= width; ++i) {
          chart.series.push_back(series(entry, i));
          chart.series.back().is_reference =
              width == 1 && quantity.kinds.size() > 1 && is_reference(entry);
        }
      }
      continue;
    }
    for (std::size_t i = 1; i <= width; ++i) {
      PageChart& chart = add(fmt::format("{}[{}]", quantity.title, i));
      for (const LogEntry& entry : quantity.kinds) {
        chart.series.push_back(series(entry, i));
        chart.series.back().is_reference = is_reference(entry);
      }
    }
  }
  return charts;
}

}  // namespace breakwater
