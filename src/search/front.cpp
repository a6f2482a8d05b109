#include <breakwater/search/front.h>

#include <algorithm>
#include <functional>

#include <breakwater/search/engines.h>

namespace breakwater {
namespace {

bool dominates(const std::vector<double>& one, const std::vector<double>& other) {
  return one != other &&
         std::equal(one.begin(), one.end(), other.begin(), other.end(), std::less_equal<>());
}

}  // namespace

std::vector<std::size_t> front_of(const Vectors& points) {
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto rules_out = [&](std::size_t other) {
      return points[other] == points[i] || dominates(points[other], points[i]);
    };
    if (std::any_of(front.begin(), front.end(), rules_out)) continue;
    std::erase_if(front, [&](std::size_t other) { return dominates(points[i], points[other]); });
    front.push_back(i);
  }
  return front;
}

double hypervolume_below(const Vectors& points, const std::vector<double>& reference) {
  Vectors inside;
  for (const std::vector<double>& point : points) {
    bool is_inside = true;
    for (std::size_t k = 0; k < point.size(); ++k) is_inside &= point[k] < reference[k];
    if (is_inside) inside.push_back(point);
  }
  if (inside.empty()) return 0.0;
  if (reference.size() == 1)
    return reference[0] - std::min_element(inside.begin(), inside.end())->front();
  return search_engines().hypervolume(inside, reference);
}

std::vector<std::size_t> evenly_spaced(std::size_t size, std::size_t count) {
  std::vector<std::size_t> numbers;
  if (size <= count) {
    for (std::size_t i = 0; i < size; ++i) numbers.push_back(i);
    return numbers;
  }
  if (count == 1) return {size / 2};
  for (std::size_t i = 0; i < count; ++i) numbers.push_back(i * (size - 1) / (count - 1));
  return numbers;
}

}  // namespace breakwater
