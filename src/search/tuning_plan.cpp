#include <breakwater/search/tuning_plan.h>

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <stdexcept>

#include <breakwater/record/file_hash.h>
#include <breakwater/signals/input_file.h>
#include <breakwater/study/sweep.h>

namespace breakwater {
namespace {

constexpr double kMostRuns = 1e7;

// A study whose probes cover all values that a case may have.
Study probed_study(const Tuning& tuning, const TunedCase& tuned, const Study& worlds) {
  Study study;
  static_cast<StudyBase&>(study) = tuning;
  study.method = Method::random;
  study.samples = 1;
  study.cases = {tuned.name};
  study.vary = tuned.search;
  study.vary.insert(study.vary.end(), worlds.vary.begin(), worlds.vary.end());
  if (!worlds.seeds.empty()) study.seeds = {worlds.seeds.front()};
  return study;
}

// Test conditions whose values may be combined freely. In a list each test condition is alone.
std::vector<Study> probed_at_once(const Study& worlds) {
  if (worlds.method != Method::list || worlds.vary.empty()) return {worlds};
  std::vector<Study> each(worlds.vary.front().values.size(), worlds);
  for (std::size_t i = 0; i < each.size(); ++i) {
    for (VariedKey& key : each[i].vary) key.values = {key.values[i]};
  }
  return each;
}

}  // namespace

TuningPlan::TuningPlan(const Catalogue& catalogue, Tuning tuning)
    : catalogue_(catalogue), tuning_(std::move(tuning)) {
  file_ = scenario_file(catalogue, tuning_.scenario, tuning_.config, tuning_.places);
  for (TunedCase& tuned : tuning_.cases) {
    if (tuned.name.empty()) tuned.name = file_->default_case();
    file_->check_case(tuned.name, tuned.place);
  }
  const double evaluations =
      static_cast<double>(tuning_.cases.size()) * static_cast<double>(tuning_.budget);
  const double each = static_cast<double>(tuning_.worlds.size()) +
                      (tuning_.validation ? static_cast<double>(tuning_.validation->size()) : 0.0);
  if (evaluations * each > kMostRuns) {
    throw std::invalid_argument(
        fmt::format("budget: {:.3g} runs are more than {:.0f}: {} cases, {} evaluations, {:.0f} "
                    "worlds and seeds",
                    evaluations * each, kMostRuns, tuning_.cases.size(), tuning_.budget, each));
  }
  values_.resize(tuning_.cases.size());
}

std::vector<std::string> TuningPlan::check() const {
  std::vector<std::string> warnings;
  const auto check_in = [&](const TunedCase& tuned, const Plan& worlds) {
    // A key counts as ineffective only if it is so in all test conditions.
    std::map<std::string, std::size_t> said;
    const std::vector<Study> probed = probed_at_once(worlds.study());
    for (const Study& some : probed) {
      for (const std::string& warning :
           Sweep(catalogue_, probed_study(tuning_, tuned, some)).check()) {
        ++said[tuned.name + ": " + warning];
      }
    }
    for (const auto& [text, times] : said) {
      const bool is_new = std::find(warnings.begin(), warnings.end(), text) == warnings.end();
      if (is_new && times == probed.size()) warnings.push_back(text);
    }
  };
  for (const TunedCase& tuned : tuning_.cases) {
    check_in(tuned, tuning_.worlds);
    if (tuning_.validation) check_in(tuned, *tuning_.validation);
  }
  return warnings;
}

std::size_t TuningPlan::size() const {
  const std::size_t each =
      tuning_.worlds.size() + (tuning_.validation ? tuning_.validation->size() : 0);
  return tuning_.cases.size() * tuning_.budget * each;
}

std::size_t TuningPlan::searches() const {
  return tuning_.cases.size() * tuning_.budget * tuning_.worlds.size();
}

std::size_t TuningPlan::evaluations() const {
  return used_budget(tuning_.settings(tuning_.cases.front()));
}

std::size_t TuningPlan::number(const TuningRun& run) const {
  const std::size_t evaluation = run.tuned * tuning_.budget + run.evaluation;
  const std::size_t first = run.is_validation ? searches() : 0;
  return first + evaluation * worlds(run.is_validation).size() + run.world;
}

TuningRun TuningPlan::run(std::size_t number) const {
  TuningRun run;
  run.is_validation = number >= searches();
  if (run.is_validation) number -= searches();
  const std::size_t each = worlds(run.is_validation).size();
  run.world = number % each;
  run.evaluation = number / each % tuning_.budget;
  run.tuned = number / each / tuning_.budget;
  return run;
}

std::vector<std::string> TuningPlan::values(std::size_t tuned, const std::vector<double>& u) const {
  std::vector<std::string> values;
  for (std::size_t i = 0; i < u.size(); ++i) {
    values.push_back(value_at(tuning_.cases[tuned].search[i], u[i]));
  }
  return values;
}

void TuningPlan::begin(std::size_t tuned, std::size_t evaluation, std::vector<std::string> values) {
  if (values_[tuned].size() <= evaluation) values_[tuned].resize(evaluation + 1);
  values_[tuned][evaluation] = std::move(values);
}

std::vector<std::string> TuningPlan::own_sets(std::size_t tuned,
                                              const std::vector<std::string>& values) const {
  std::vector<std::string> sets = tuning_.sets;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sets.push_back(tuning_.cases[tuned].search[i].key + "=" + values[i]);
  }
  return sets;
}

std::string TuningPlan::config_text(std::size_t tuned, std::size_t evaluation) const {
  return prepare_point(catalogue_, tuning_.scenario, *file_, tuning_.cases[tuned].name,
                       own_sets(tuned, values_of(tuned, evaluation)))
      .config_text;
}

std::vector<std::string> TuningPlan::sets(std::size_t number) const {
  const TuningRun one = run(number);
  std::vector<std::string> sets = own_sets(one.tuned, values_of(one.tuned, one.evaluation));
  const std::vector<std::string> more = worlds(one.is_validation).point(one.world).sets;
  sets.insert(sets.end(), more.begin(), more.end());
  return sets;
}

PreparedRun TuningPlan::prepare(std::size_t number) const {
  return prepare_point(catalogue_, tuning_.scenario, *file_, tuning_.cases[run(number).tuned].name,
                       sets(number), bound_);
}

std::string TuningPlan::candidate_lines() const {
  std::string lines;
  for (std::size_t tuned = 0; tuned < values_.size(); ++tuned) {
    for (std::size_t i = 0; i < values_[tuned].size(); ++i) {
      lines += fmt::format("{}\t{}\t{}\n", tuned, i, fmt::join(values_[tuned][i], "\t"));
    }
  }
  return lines;
}

void TuningPlan::begin(const std::filesystem::path& file) {
  std::ifstream stream = open_input(file);
  for (std::string line; std::getline(stream, line);) {
    auto candidate = read_candidate(line, tuning_);
    if (!candidate) {
      throw std::invalid_argument(fmt::format("{}: has no candidate in: {}", file.string(), line));
    }
    begin(candidate->tuned, candidate->evaluation, std::move(candidate->values));
  }
}

std::string TuningPlan::asked(std::size_t number) const {
  const TuningRun one = run(number);
  if (!has(one.tuned, one.evaluation)) return "";
  std::vector<std::string> parts = {tuning_.scenario, tuning_.cases[one.tuned].name};
  for (std::string& set : sets(number)) parts.push_back(std::move(set));
  return fingerprint(parts);
}

}  // namespace breakwater
