// A study's points, each made from its number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/study/sampling.h>
#include <breakwater/study/study.h>

namespace breakwater {

/// What is compared: a case, with values of keys of its own.
struct Candidate {
  std::string case_name;
  std::vector<std::string> values;  ///< of Study::compare, as TOML
  std::string label;                ///< what tells it from the others: "hpfc-2N", "hpfc-2N, K = 3"
};

/// One run of a study.
struct StudyPoint {
  std::size_t sample = 0;
  std::size_t candidate = 0;
  std::optional<std::uint64_t> seed;
  std::vector<std::string> values;  ///< of Study::vary, as TOML
  std::vector<std::string> sets;    ///< key=value: all that lies on the case
};

/// The points of a study in their order: samples, in them seeds, in them candidates, so that runs
/// of the same world stand together. It holds none of them: 10 million take the memory of one.
class Plan {
 public:
  /// The study has cases. Throws std::invalid_argument, `ORIGIN: KEY: reason` where it is a key's
  /// fault, if there are more than 10 million points.
  explicit Plan(Study study);

  const Study& study() const { return study_; }
  const std::vector<Candidate>& candidates() const { return candidates_; }
  std::size_t samples() const { return samples_; }
  /// Seeds of each sample; 1 if the study names none.
  std::size_t seeds() const { return seeds_; }
  std::size_t size() const { return samples_ * seeds_ * candidates_.size(); }

  StudyPoint point(std::size_t number) const;

  /// Points that between them have each value that keys take by themselves, and the ends of each
  /// distribution, with everything else as in the first sample; of a list its samples: what is
  /// wrong with one of them is found before anything runs.
  std::vector<StudyPoint> probes() const;

 private:
  std::vector<std::string> values(std::size_t sample) const;
  StudyPoint make_point(std::vector<std::string> values, std::size_t sample, std::size_t seed,
                        std::size_t candidate) const;

  Study study_;
  std::vector<Candidate> candidates_;
  std::unique_ptr<const Sampler> sampler_;
  std::size_t samples_ = 1;
  std::size_t seeds_ = 1;
};

}  // namespace breakwater
