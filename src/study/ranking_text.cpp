#include <breakwater/study/comparison_table.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include <breakwater/config/names.h>
#include <breakwater/config/unit_of.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace {

constexpr std::size_t kMostRows = 18;  // in a terminal's table

std::string with_unit(double value, const std::string& metric) {
  const std::string unit = unit_of(metric);
  return in_digits(value) + (unit.empty() ? "" : " ") + unit;
}

std::string text_of(const Requirement& requirement) {
  std::vector<std::string> bounds;
  for (const Bound& one : requirement.bounds) {
    const std::string low = with_unit(one.min, one.metric), high = with_unit(one.max, one.metric);
    bounds.push_back(one.metric + (!std::isfinite(one.min)   ? " at most " + high
                                   : !std::isfinite(one.max) ? " at least " + low
                                                             : " from " + low + " to " + high));
  }
  const std::string share =
      requirement.share < 1.0 ? fmt::format("{:.4g} % of the", 100.0 * requirement.share) : "all";
  return fmt::format("{} in {} conditions", fmt::join(bounds, " and "), share);
}

// The number of conditions that would show the difference of a candidate from the first.
std::string needed_text(const Ranking& ranking, const RankedCandidate& row) {
  const auto& pair = row.with_first;
  if (!pair) return "they have no condition in common";
  const std::string conditions = number_of(pair->blocks, "condition");
  if (pair->smaller + pair->larger == 0) return "they are equal in " + conditions;
  if (pair->verdict == ComparisonVerdict::too_few_blocks) {
    return fmt::format("{} {} too few to show any difference, which needs {} or more", conditions,
                       pair->blocks == 1 ? "is" : "are",
                       blocks_for_verdict(pair->blocks, ranking.comparison.tests));
  }
  if (!pair->needed) return "neither is the lower one in these " + conditions;
  return fmt::format("about {} conditions would show {}", std::max(*pair->needed, pair->blocks + 1),
                     with_unit(std::abs(pair->difference.value), ranking.metric));
}

class Sentence {
 public:
  explicit Sentence(const Ranking& ranking) : ranking_(ranking), rows_(ranking.rows) {}

  std::string text() const { return (ranking_.ranked == 0 ? nobody() : of_ranked()) + left_out(); }

 private:
  std::string of_ranked() const {
    std::string text = ranking_.ranked == 1 ? alone() : ranking_.is_shown() ? best() : level();
    if (!ranking_.requirement.bounds.empty()) {
      text +=
          fmt::format(" {} of {} {}: {}.", ranking_.ranked, number_of(rows_.size(), "candidate"),
                      ranking_.ranked == 1 ? "meets the bounds" : "meet the bounds",
                      text_of(ranking_.requirement));
    }
    const RankedCandidate& first = rows_.front();
    if (first.failed > 0) {
      text += fmt::format(" {} fails in {} of {}.", name(first), first.failed,
                          number_of(first.blocks, "condition"));
    }
    const auto others = std::span(rows_).first(ranking_.ranked);
    const auto best = std::min_element(others.begin(), others.end(), [&](auto& x, auto& y) {
      return ranking_.goal == Goal::max ? x.median.value > y.median.value
                                        : x.median.value < y.median.value;
    });
    if (best->is_worse) {
      text += fmt::format(" {} has the {} median, but is worse in equal conditions.", name(*best),
                          extreme());
    }
    // A count is often the same.
    for (const std::string& metric : ranking_.constant) {
      if (unit_of(metric).empty()) continue;
      text += fmt::format(" {} is the same in all conditions, so they say nothing about others.",
                          metric);
    }
    return text;
  }

  // The candidates without a median, so that no other number of them is in the answer.
  std::string left_out() const {
    std::vector<std::string> failing, lacking;
    for (const RankedCandidate& row : rows_) {
      if (!std::isnan(row.median.value) || row.blocks == 0) continue;
      (row.failed == row.blocks ? failing : lacking).push_back(name(row));
    }
    std::string text;
    if (!failing.empty()) {
      text = fmt::format(" {} {} in all conditions.", listed(failing),
                         failing.size() > 1 ? "fail" : "fails");
    }
    if (!lacking.empty() && ranking_.ranked > 0) {
      text += fmt::format(" No run of {} has {}.", listed(lacking), ranking_.metric);
    }
    return text;
  }

  std::string name(const RankedCandidate& row) const { return ranking_.candidates[row.candidate]; }
  std::string value(double value) const { return with_unit(value, ranking_.metric); }
  std::string extreme() const { return ranking_.goal == Goal::max ? "highest" : "lowest"; }

  std::string nobody() const {
    if (ranking_.requirement.bounds.empty() || rows_.front().blocks == 0) {
      return "No run has " + ranking_.metric + ".";
    }
    const RankedCandidate& next = *std::max_element(
        rows_.begin(), rows_.end(), [](const auto& a, const auto& b) { return a.met < b.met; });
    std::vector<std::string> nearest;
    for (const RankedCandidate& row : rows_) {
      if (row.met == next.met && row.blocks == next.blocks) nearest.push_back(name(row));
    }
    const bool is_met = std::isnan(next.median.value) && next.met == next.blocks;
    if (is_met) return "No candidate that meets the bounds has " + ranking_.metric + ".";
    return fmt::format("No candidate has {}: {} {} nearest, with {} of {}.",
                       text_of(ranking_.requirement), listed(nearest),
                       nearest.size() > 1 ? "come" : "comes", next.met, next.blocks);
  }

  std::string alone() const {
    return fmt::format("{} alone is ranked, with {} {}.", name(rows_[0]), ranking_.metric,
                       value(rows_[0].median.value));
  }

  std::string best() const {
    const RankedCandidate& next = rows_[1];
    const EstimatedValue& by = next.behind;
    return fmt::format("{} has the {} {}: {}, {} {} the next ({}), 95 % {} to {}, in {} of {}.",
                       name(rows_[0]), extreme(), ranking_.metric, value(rows_[0].median.value),
                       value(by.value), ranking_.goal == Goal::max ? "above" : "below", name(next),
                       in_digits(by.interval->lower), value(by.interval->upper), next.worse_in,
                       number_of(next.with_first->blocks, "condition"));
  }

  std::string level() const {
    std::vector<std::string> level, worse;
    const RankedCandidate* second = nullptr;
    for (std::size_t i = 0; i < ranking_.ranked; ++i) {
      if (rows_[i].is_worse) {
        worse.push_back(name(rows_[i]));
        continue;
      }
      level.push_back(fmt::format("{} ({})", name(rows_[i]), value(rows_[i].median.value)));
      if (i > 0 && second == nullptr) second = &rows_[i];
    }
    // The others may differ from each other.
    const std::string first = level.front();
    level.erase(level.begin());
    std::string text = fmt::format("No difference in {} is shown between {} and {}{}: {}",
                                   ranking_.metric, first, level.size() > 1 ? "any of " : "",
                                   listed(level), needed_text(ranking_, *second));
    if (level.size() > 1) {
      text += fmt::format(", between {} and {}", name(rows_[0]), name(*second));
    }
    if (worse.empty()) return text + ".";
    return fmt::format("{}. {} {} shown to be {} than {}.", text, listed(worse),
                       worse.size() > 1 ? "are" : "is",
                       ranking_.goal == Goal::max ? "lower" : "higher", name(rows_[0]));
  }

  const Ranking& ranking_;
  const std::vector<RankedCandidate>& rows_;
};

// NaN is null in the file.
nlohmann::ordered_json json_of(const EstimatedValue& one) {
  const ConfidenceInterval interval = one.interval.value_or(ConfidenceInterval{});
  return {{"value", one.value}, {"lower", interval.lower}, {"upper", interval.upper}};
}

}  // namespace

std::string ranking_sentence(const Ranking& ranking) {
  return Sentence(ranking).text();
}

std::vector<std::vector<std::string>> ranking_table(const Ranking& ranking) {
  const bool has_bounds = !ranking.requirement.bounds.empty();
  const bool has_failures = std::any_of(ranking.rows.begin(), ranking.rows.end(),
                                        [](const auto& row) { return row.failed > 0; });
  const std::string unit = unit_of(ranking.metric);
  std::vector<std::vector<std::string>> rows = {
      {"", "candidate", "median" + (unit.empty() ? "" : " [" + unit + "]"), "behind (95 %)", "p",
       has_failures ? "failed in" : "worse in"}};
  if (has_bounds) {
    rows[0].push_back(fmt::format("meets ({:.4g} %)", 100.0 * ranking.requirement.confidence));
  }
  for (const RankedCandidate& one : ranking.rows) {
    std::vector<std::string> row = {
        one.place > 0 ? std::to_string(one.place) : "-", ranking.candidates[one.candidate],
        std::isnan(one.median.value) ? "-" : in_digits(one.median.value)};
    const auto& beside = one.with_first;
    row.push_back(beside ? brief(one.behind) : "-");
    row.push_back(beside ? p_text(beside->p_holm) : "-");
    if (has_failures) {
      row.push_back(fmt::format("{} of {}", one.failed, one.blocks));
    } else {
      row.push_back(beside ? fmt::format("{} of {}", one.worse_in, beside->blocks) : "-");
    }
    if (has_bounds) {
      const auto blocks = static_cast<double>(std::max<std::size_t>(1, one.blocks));
      const double met = static_cast<double>(one.met) / blocks;
      row.push_back(fmt::format("{:.0f} % [{:.0f}, {:.0f}]", 100.0 * met, 100.0 * one.share.lower,
                                100.0 * one.share.upper));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

nlohmann::ordered_json ranking_json(const Ranking& ranking) {
  nlohmann::ordered_json json;
  json["metric"] = ranking.metric;
  json["unit"] = unit_of(ranking.metric);
  json["goal"] = name_of(goal_names(), ranking.goal);
  json["sentence"] = ranking_sentence(ranking);
  json["is_shown"] = ranking.is_shown();
  json["table"] = ranking_table(ranking);
  json["require"] = {{"share", ranking.requirement.share},
                     {"confidence", ranking.requirement.confidence},
                     {"bounds", nlohmann::ordered_json::object()}};
  for (const Bound& one : ranking.requirement.bounds) {
    json["require"]["bounds"][one.metric] = {{"min", one.min}, {"max", one.max}};
  }
  json["candidates"] = nlohmann::ordered_json::array();
  for (const RankedCandidate& one : ranking.rows) {
    json["candidates"].push_back({{"place", one.place},
                                  {"candidate", ranking.candidates[one.candidate]},
                                  {"median", json_of(one.median)},
                                  {"conditions", one.blocks},
                                  {"failed", one.failed},
                                  {"missing", one.missing},
                                  {"met", one.met},
                                  {"met_lower", one.share.lower},
                                  {"met_upper", one.share.upper}});
  }
  json["pairs"] = nlohmann::ordered_json::array();
  for (const PairComparison& one : ranking.comparison.metrics) {
    json["pairs"].push_back(
        {{"candidate", ranking.comparison.candidates[one.candidate]},
         {"reference", ranking.comparison.candidates[one.reference]},
         {"conditions", one.blocks},
         {"difference", json_of(one.difference)},
         {"p", one.p},
         {"p_holm", one.p_holm},
         {"smaller_in", one.smaller},
         {"larger_in", one.larger},
         {"needed", one.needed ? nlohmann::ordered_json(*one.needed) : nlohmann::ordered_json()},
         {"verdict", name_of(one.verdict)}});
  }
  return json;
}

std::string ranking_text(const Ranking& ranking, std::size_t width) {
  std::string text =
      fmt::format("{}\n\n", fmt::join(wrapped(ranking_sentence(ranking), width), "\n"));
  auto rows = ranking_table(ranking);
  std::string more;
  if (rows.size() > kMostRows + 1) {
    more = fmt::format("… and {} more\n", rows.size() - kMostRows);
    rows.resize(kMostRows);
  }
  constexpr std::size_t kLabels = 2;
  return text + in_columns(std::move(rows), width, kLabels) + more;
}

}  // namespace breakwater
