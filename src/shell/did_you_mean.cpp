#include <breakwater/shell/did_you_mean.h>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace breakwater {
namespace {

constexpr std::size_t kLongestCorrected = 200;  // a longer word takes too much time

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0U);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, replaced}));
    }
  }
  return row.back();
}

}  // namespace

std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates) {
  if (word.size() > kLongestCorrected) return "";
  const std::string* best = nullptr;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = &candidate;
    }
  }
  return best != nullptr ? " (did you mean " + *best + "?)" : "";
}

std::string did_you_mean_or_list(const std::string& word,
                                 const std::vector<std::string>& candidates) {
  std::string meant = did_you_mean(word, candidates);
  if (!meant.empty() || candidates.empty()) return meant;
  return fmt::format(" (there are {})", fmt::join(candidates, ", "));
}

std::string must_be_one_of(const std::vector<std::string>& names, const std::string& word) {
  return fmt::format("must be one of {}, is \"{}\"{}", fmt::join(names, ", "), word,
                     did_you_mean(word, names));
}

}  // namespace breakwater
