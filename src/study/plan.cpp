#include <breakwater/study/plan.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <utility>

#include <breakwater/config/config.h>
#include <breakwater/config/toml_text.h>
#include <breakwater/shell/did_you_mean.h>

namespace breakwater {
namespace {

constexpr double kMostOfAStudy = 1e7;
constexpr double kMostCandidates = 1000;
constexpr std::size_t kMostProbes = 1000;  // per key or list

std::vector<Candidate> make_candidates(const Study& study) {
  const double count = static_cast<double>(study.cases.size()) * combinations(study.compare);
  if (count > kMostCandidates) {
    throw std::invalid_argument(
        fmt::format("compare: {:.0f} candidates are more than {:.0f}", count, kMostCandidates));
  }
  const auto others = static_cast<std::size_t>(combinations(study.compare));
  std::vector<Candidate> candidates;
  for (const std::string& name : study.cases) {
    for (std::size_t i = 0; i < others; ++i) {
      Candidate candidate{name, combination(study.compare, i), ""};
      std::vector<std::string> parts;
      if (study.cases.size() > 1 || study.compare.empty()) parts.push_back(name);
      for (std::size_t k = 0; k < study.compare.size(); ++k) {
        parts.push_back(
            fmt::format("{} = {}", study.compare[k].key, plain_text(candidate.values[k])));
      }
      candidate.label = fmt::format("{}", fmt::join(parts, ", "));
      candidates.push_back(std::move(candidate));
    }
  }
  return candidates;
}

void check_baseline(const Study& study, const std::vector<Candidate>& candidates) {
  if (study.baseline.empty()) return;
  std::vector<std::string> labels;
  for (const Candidate& candidate : candidates) {
    if (candidate.label == study.baseline) return;
    labels.push_back(candidate.label);
  }
  throw std::invalid_argument(fmt::format(
      "{}: \"{}\" is not among what is compared: {}{}", place_of(study.places, "compare.baseline"),
      study.baseline, fmt::join(labels, "; "), did_you_mean(study.baseline, labels)));
}

}  // namespace

Plan::Plan(Study study) : study_(std::move(study)), candidates_(make_candidates(study_)) {
  check_baseline(study_, candidates_);
  seeds_ = std::max<std::size_t>(1, study_.seeds.size());
  double samples = 1.0;
  if (draws(study_.method)) {
    const auto d = static_cast<Eigen::Index>(study_.vary.size());
    sampler_ = make_sampler(study_.method, study_.samples, d, study_.sampling_seed);
    samples = static_cast<double>(sampler_.size);
  } else {
    samples = combinations(study_.vary, study_.method == Method::list);
  }
  const double points =
      samples * static_cast<double>(seeds_) * static_cast<double>(candidates_.size());
  if (points > kMostOfAStudy) {
    throw std::invalid_argument(
        fmt::format("{}: {:.3g} points are more than {:.0f}: {:.3g} samples, {} seeds, {} "
                    "candidates",
                    place_of(study_.places, "vary"), points, kMostOfAStudy, samples, seeds_,
                    candidates_.size()));
  }
  samples_ = static_cast<std::size_t>(samples);
}

std::vector<std::string> Plan::values(std::size_t sample) const {
  if (!sampler_.point) return combination(study_.vary, sample, study_.method == Method::list);
  const Eigen::VectorXd u = sampler_.point(sample);
  std::vector<std::string> values;
  for (std::size_t i = 0; i < study_.vary.size(); ++i) {
    values.push_back(value_at(study_.vary[i], u(static_cast<Eigen::Index>(i))));
  }
  return values;
}

StudyPoint Plan::make_point(std::vector<std::string> values, std::size_t sample, std::size_t seed,
                            std::size_t candidate) const {
  StudyPoint point;
  point.sample = sample;
  point.candidate = candidate;
  point.values = std::move(values);
  point.sets = study_.sets;
  for (std::size_t i = 0; i < study_.compare.size(); ++i) {
    point.sets.push_back(study_.compare[i].key + "=" + candidates_[candidate].values[i]);
  }
  for (std::size_t i = 0; i < study_.vary.size(); ++i) {
    point.sets.push_back(study_.vary[i].key + "=" + point.values[i]);
  }
  if (!study_.seeds.empty()) {
    point.seed = study_.seeds[seed];
    point.sets.push_back(fmt::format("run.seed={}", *point.seed));
  }
  return point;
}

StudyPoint Plan::point(std::size_t number) const {
  const std::size_t candidate = number % candidates_.size();
  const std::size_t seed = number / candidates_.size() % seeds_;
  const std::size_t sample = number / candidates_.size() / seeds_;
  return make_point(values(sample), sample, seed, candidate);
}

std::vector<StudyPoint> Plan::probes() const {
  constexpr double kNearTheEnd = 1e-9;
  std::vector<StudyPoint> probes;
  const std::vector<std::string> first = values(0);
  for (std::size_t c = 0; c < candidates_.size(); ++c) probes.push_back(make_point(first, 0, 0, c));
  if (study_.method == Method::list) {  // the keys of a list vary together
    const std::size_t stride = 1 + samples_ / kMostProbes;
    for (std::size_t s = stride; s < samples_; s += stride) {
      probes.push_back(make_point(values(s), s, 0, 0));
    }
    return probes;
  }
  for (std::size_t i = 0; i < study_.vary.size(); ++i) {
    const VariedKey& key = study_.vary[i];
    std::vector<std::string> others;
    const std::size_t stride = 1 + key.values.size() / kMostProbes;
    for (std::size_t k = 0; k < key.values.size(); k += stride) others.push_back(key.values[k]);
    if (key.distribution && key.distribution->is_bounded()) {
      for (const double u : {kNearTheEnd, 1.0 - kNearTheEnd}) {
        others.push_back(toml_number(key.distribution->quantile(u)));
      }
    }
    for (const std::string& value : others) {
      if (value == first[i]) continue;
      std::vector<std::string> values = first;
      values[i] = value;
      probes.push_back(make_point(std::move(values), 0, 0, 0));
    }
  }
  return probes;
}

std::vector<std::size_t> parse_points(const std::string& text, std::size_t size) {
  const auto fail = [&]() -> std::vector<std::size_t> {
    throw std::invalid_argument(
        fmt::format("--points: {}: must be ranges of 0 to {}: 0-99,120", text, size - 1));
  };
  std::vector<std::size_t> points;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    std::size_t first = 0;
    auto read = std::from_chars(at, end, first);
    if (read.ec != std::errc()) return fail();
    std::size_t last = first;
    if (read.ptr != end && *read.ptr == '-') read = std::from_chars(read.ptr + 1, end, last);
    if (read.ec != std::errc() || last < first || last >= size) return fail();
    for (std::size_t point = first; point <= last; ++point) points.push_back(point);
    if (read.ptr == end) break;
    if (*read.ptr != ',') return fail();
    at = read.ptr + 1;
  }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

std::string print_points(const std::vector<std::size_t>& points) {
  std::string text;
  for (std::size_t i = 0; i < points.size();) {
    std::size_t end = i + 1;
    while (end < points.size() && points[end] == points[end - 1] + 1) ++end;
    if (!text.empty()) text += ',';
    text += std::to_string(points[i]);
    if (end - i > 1) text += fmt::format("-{}", points[end - 1]);
    i = end;
  }
  return text;
}

}  // namespace breakwater
