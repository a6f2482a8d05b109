#include <breakwater/identification/modulation.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace breakwater {
namespace {

constexpr std::size_t kMostRows = 400000;  // all windows of one length together
constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();  // relative

}  // namespace

std::size_t hop_of(const AxisData& data, std::size_t rows) {
  return std::max(rows / 4,
                  1 + data.rows() * rows / kMostRows / std::max<std::size_t>(rows / 4, 1));
}

double direction(const AxisStretch& stretch, std::size_t k, std::size_t reach, double quantum) {
  const std::size_t a = k > reach ? k - reach : 0;
  const std::size_t b = std::min(k + reach, stretch.positions.size() - 1);
  const double moved = stretch.positions[b] - stretch.positions[a];
  return std::abs(moved) < 1.5 * quantum || moved == 0.0 ? 0.0 : std::copysign(1.0, moved);
}

std::vector<double> inputs_at_rows(const AxisStretch& stretch, double delay_s) {
  std::vector<double> inputs;
  std::size_t i = 0;
  for (const double t : stretch.times_s) {
    while (i + 1 < stretch.inputs.size() && stretch.input_times_s[i + 1] + delay_s <= t) ++i;
    const double change_s = stretch.input_times_s[i] + delay_s;
    const bool is_change = std::abs(change_s - t) <= kRounding * std::abs(t) && i > 0;
    inputs.push_back(is_change ? 0.5 * (stretch.inputs[i - 1] + stretch.inputs[i])
                               : stretch.inputs[i]);
  }
  return inputs;
}

}  // namespace breakwater
