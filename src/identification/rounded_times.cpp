#include <breakwater/identification/rounded_times.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include <breakwater/recorded/recorded_axis.h>

namespace breakwater {
namespace {

constexpr std::size_t kBlocks = 128;
constexpr double kSmall = 0.25;    // share of the variance of the white errors
constexpr double kHalfStep = 0.6;  // with the error of the fitted clock

bool are_multiples(std::span<const double> times_s, double step) {
  return std::all_of(times_s.begin(), times_s.end(), [&](double t) {
    const double resolved = std::numeric_limits<double>::epsilon() * std::abs(t);
    return std::abs(t - step * std::round(t / step)) <= resolved;
  });
}

// Whether a clock without jitter explains the times. Missing rows are no jitter.
bool is_regular(std::span<const double> times_s, double step) {
  const std::vector<double> times(times_s.begin(), times_s.end());
  const double period_s = timing_of(times, 0.0, 1.5, 0.1).period_s;
  std::vector<double> ticks = {0.0};
  double n_sum = 0.0, t_sum = 0.0, squares = 0.0, products = 0.0;
  for (std::size_t k = 1; k < times.size(); ++k) {
    const double n = ticks.back() + std::round((times[k] - times[k - 1]) / period_s);
    const double t = times[k] - times.front();
    ticks.push_back(n);
    n_sum += n;
    t_sum += t;
    squares += n * n;
    products += n * t;
  }
  const auto rows = static_cast<double>(times.size());
  const double slope = (rows * products - n_sum * t_sum) / (rows * squares - n_sum * n_sum);
  const double first = (t_sum - slope * n_sum) / rows;
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (std::abs(times[k] - times.front() - first - slope * ticks[k]) > kHalfStep * step)
      return false;
  }
  return true;
}

// The variance of the errors of a fit without their slow part, at least that of the encoder.
double white_variance(const AxisData& data, const AxisFit& fit) {
  const std::vector<double> positions = fitted_positions(data, fit);
  double squares = 0.0, count = 0.0;
  std::size_t from = 0;
  for (const AxisStretch& stretch : data.stretches) {
    const auto error = [&](std::size_t k) { return stretch.positions[k] - positions[from + k]; };
    for (std::size_t k = 2; k < stretch.positions.size(); ++k) {
      const double second = error(k) - 2.0 * error(k - 1) + error(k - 2);
      squares += second * second / 6.0;
      count += 1.0;
    }
    from += stretch.positions.size();
  }
  return std::max(squares / count, data.quantum * data.quantum / 12.0);
}

// |v| by the standard deviation of a time.
std::vector<double> time_noise(const AxisStretch& stretch, const Eigen::VectorXd& positions) {
  std::vector<double> noise;
  const Eigen::Index last = positions.size() - 1;
  for (Eigen::Index k = 0; k <= last; ++k) {
    const Eigen::Index from = std::max<Eigen::Index>(k - 1, 0), to = std::min(k + 1, last);
    const double h = stretch.times_s[static_cast<std::size_t>(to)] -
                     stretch.times_s[static_cast<std::size_t>(from)];
    noise.push_back(std::abs(positions(to) - positions(from)) / h * stretch.time_step_s /
                    std::sqrt(12.0));
  }
  return noise;
}

// The motions by the errors of the changes of the input, of one standard deviation. In a block
// they are in proportion to the changes: their pushes have the variance of independent errors.
template <typename Move>
Eigen::MatrixXd pushed(const AxisStretch& stretch, const Eigen::VectorXd& exact,
                       const Move& moved) {
  const std::size_t changes = stretch.inputs.size();
  const auto change = [&](std::size_t k) {
    return k == 0 ? 0.0 : stretch.inputs[k] - stretch.inputs[k - 1];
  };
  Eigen::MatrixXd pushes = Eigen::MatrixXd::Zero(exact.size(), kBlocks);
  for (std::size_t block = 0; block < kBlocks; ++block) {
    const std::size_t from = block * changes / kBlocks, to = (block + 1) * changes / kBlocks;
    double squares = 0.0;
    for (std::size_t k = from; k < to; ++k) squares += change(k) * change(k);
    if (squares == 0.0) continue;
    AxisStretch late = stretch;
    for (std::size_t k = from; k < to; ++k) {
      late.input_times_s[k] += stretch.time_step_s * change(k) / std::sqrt(12.0 * squares);
    }
    pushes.col(static_cast<Eigen::Index>(block)) = moved(late) - exact;
  }
  return pushes;
}

}  // namespace

double rounding_step(std::span<const double> times_s) {
  double latest = 0.0;
  for (const double t : times_s) latest = std::max(latest, std::abs(t));
  constexpr double kResolved = 0.4;
  for (int digits = 0; digits <= 12; ++digits) {
    const double step = std::pow(10.0, -digits);
    if (std::numeric_limits<double>::epsilon() * latest > kResolved * step) break;
    if (are_multiples(times_s, step)) return is_regular(times_s, step) ? 0.0 : step;
  }
  return 0.0;
}

bool allow_rounded_times(AxisData& data, const AxisFit& fit) {
  const auto is_rounded = [](const AxisStretch& stretch) { return stretch.time_step_s > 0.0; };
  if (std::none_of(data.stretches.begin(), data.stretches.end(), is_rounded)) return false;
  const double variance = white_variance(data, fit);
  bool is_added = false;
  for (std::size_t s = 0; s < data.stretches.size(); ++s) {
    AxisStretch& stretch = data.stretches[s];
    if (!is_rounded(stretch)) continue;
    const auto rows = static_cast<Eigen::Index>(stretch.positions.size());
    const auto moved = [&](const AxisStretch& one) {
      Eigen::VectorXd positions(rows);
      data.model->move(fit.values, fit.starts[s], one,
                       {positions.data(), stretch.positions.size()});
      return positions;
    };
    const Eigen::VectorXd exact = moved(stretch);
    const Eigen::MatrixXd pushes = pushed(stretch, exact, moved);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts(pushes.transpose() * pushes);
    const auto large = (parts.eigenvalues().array() > kSmall * variance).count();
    stretch.drifts = pushes * parts.eigenvectors().rightCols(large);
    stretch.time_noise = time_noise(stretch, exact);
    double squares = 0.0;
    for (const double noise : stretch.time_noise) squares += noise * noise;
    if (squares < kSmall * variance * static_cast<double>(rows)) stretch.time_noise.clear();
    is_added = is_added || large > 0 || !stretch.time_noise.empty();
  }
  return is_added;
}

}  // namespace breakwater
