#include <breakwater/statistics/multiple_tests.h>

#include <algorithm>
#include <numeric>

namespace breakwater {
namespace {

// Indices in ascending order of p.
std::vector<std::size_t> ascending(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  return order;
}

}  // namespace

std::vector<double> holm(const std::vector<double>& p) {
  const std::vector<std::size_t> order = ascending(p);
  std::vector<double> adjusted(p.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double times = static_cast<double>(p.size() - i);
    largest = std::max(largest, std::min(1.0, times * p[order[i]]));
    adjusted[order[i]] = largest;
  }
  return adjusted;
}

std::vector<double> holm_levels(const std::vector<double>& p, double alpha) {
  const std::vector<std::size_t> order = ascending(p);
  const std::vector<double> adjusted = holm(p);
  std::vector<double> levels(p.size());
  std::size_t first = 0;  // of equal p, in `order`
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_rejected = i > 0 && adjusted[order[i - 1]] <= alpha;
    if (is_rejected && p[order[i]] > p[order[first]]) first = i;
    levels[order[i]] = alpha / static_cast<double>(p.size() - first);
  }
  return levels;
}

}  // namespace breakwater
