// The points of a study, each computed from its number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/study/sampling.h>
#include <breakwater/study/study.h>

namespace breakwater {

/// A candidate of a comparison: a case with values of its own for some keys.
struct Candidate {
  std::string case_name;
  std::vector<std::string> values;  ///< values for Study::compare, as TOML
  std::string label;                ///< "hpfc-2N" or "hpfc-2N, K = 3"
};

/// One run of a study.
struct StudyPoint {
  std::size_t sample = 0;
  std::size_t candidate = 0;
  std::optional<std::uint64_t> seed;
  std::vector<std::string> values;  ///< values for Study::vary, as TOML
  std::vector<std::string> sets;    ///< key=value: all changes to the case
};

/// The points of a study in the order sample, seed, candidate, so that runs in the same test
/// condition are adjacent. No point is stored: the memory does not grow with their number.
class Plan {
 public:
  /// The study must have cases. Throws std::invalid_argument (`ORIGIN: KEY: reason`) if there are
  /// more than 10 million points.
  explicit Plan(Study study);

  const Study& study() const { return study_; }
  const std::vector<Candidate>& candidates() const { return candidates_; }
  std::size_t samples() const { return samples_; }
  /// The number of seeds per sample; 1 if the study names none.
  std::size_t seeds() const { return seeds_; }
  std::size_t size() const { return samples_ * seeds_ * candidates_.size(); }

  StudyPoint point(std::size_t number) const;

  /// Points for a check before the first run. Together they have each listed value of the keys and
  /// the ends of each distribution; the other keys are as in the first sample. For a list they are
  /// its samples.
  std::vector<StudyPoint> probes() const;

 private:
  std::vector<std::string> values(std::size_t sample) const;
  StudyPoint make_point(std::vector<std::string> values, std::size_t sample, std::size_t seed,
                        std::size_t candidate) const;

  Study study_;
  std::vector<Candidate> candidates_;
  Sampler sampler_;  // empty for a grid and a list
  std::size_t samples_ = 1;
  std::size_t seeds_ = 1;
};

/// Reads ranges of points such as "0-99,120", sorted and without repetition. Throws
/// std::invalid_argument if the text is not valid or a point is not below `size`.
std::vector<std::size_t> parse_points(const std::string& text, std::size_t size);
std::string print_points(const std::vector<std::size_t>& points);

}  // namespace breakwater
