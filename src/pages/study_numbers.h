// A study's results as columns, of which its report is made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/study/key_effects.h>
#include <breakwater/study/plan.h>
#include <breakwater/study/shards.h>

namespace breakwater {

/// One run, as far as charts need it.
struct StudyRun {
  std::size_t number = 0;      ///< the point's
  std::uint32_t sample = 0;    ///< where StudyKey::values has its sample
  std::uint32_t block = 0;     ///< of a saltelli design: its row, else the sample; gapless
  std::uint32_t in_block = 0;  ///< of a saltelli design: its column A, AB⁽¹⁾ … B, else 0
  std::uint32_t seed = 0;      ///< which of the study's
  std::uint32_t candidate = 0;
  bool failed = false;  ///< it is not complete, for whatever reason
};

/// One run that failed, with its values of the varied keys.
struct FailedRun {
  std::size_t number = 0;
  std::size_t candidate = 0;
  std::vector<double> values;
};

/// Runs that failed for the same reason but for the numbers in it.
struct FailureKind {
  PointStatus status = PointStatus::failed;
  std::string reason;  ///< of the first of them
  std::size_t runs = 0;
  std::vector<std::size_t> of_candidate;  ///< runs of each
  std::vector<std::string> where;         ///< "key from A to B", "key A, B", of each varied key
  std::vector<std::size_t> first;         ///< numbers of some points
};

struct StudyNumbers {
  std::vector<StudyKey> keys;
  std::vector<StudyRun> runs;  ///< in the points' order
  std::vector<std::string> metrics;
  std::vector<std::vector<double>> columns;  ///< of each metric by run; NaN: not measured
  std::size_t samples = 0;                   ///< that keys have values of
  std::size_t blocks = 0;                    ///< 1 + the runs' largest
  std::vector<FailureKind> failures;         ///< of all points, most runs first
  std::vector<FailedRun> failed;             ///< of all points; of very many some
  bool is_sample = false;                    ///< `runs` are not all that are there
};

/// Reads every result once. The metrics in `first` stand first, the others in the order in which
/// points have them. If the study has more than `most` points, runs are a sample of about so many:
/// of each sample and seed (of a saltelli design: row and seed) all candidates or none, chosen by a
/// hash of their numbers. Failures are counted over all points, whatever is sampled.
StudyNumbers study_numbers(const Plan& plan, const ShardIndex& index,
                           const std::vector<std::string>& first, std::size_t most = 200'000);

/// A number's place in an order that has nothing to do with the numbers: SplitMix64's output
/// function (G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014).
std::uint64_t scattered(std::uint64_t number);

}  // namespace breakwater
