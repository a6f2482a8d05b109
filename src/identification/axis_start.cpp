#include <breakwater/identification/axis_start.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

constexpr Eigen::Index kUnknowns = 4;  // 1/J, c/J, F_C/J, d₀/J

// Integrals of one window without the delay, and where it lies.
struct Window {
  const AxisStretch* stretch;
  std::size_t first;
  double position;  // ∫φ̈ q
  double velocity;  // ∫φ v
  double sign;      // ∫φ sgn v
  double one;       // ∫φ
};

struct Weight {
  double value, slope, curvature;
};

// φ = s³ (1 − s)³ at s in [0, 1], and its derivatives by the time.
Weight weight(double s, double length_s) {
  const double r = 1.0 - s;
  return {s * s * s * r * r * r, 3.0 * s * s * r * r * (r - s) / length_s,
          6.0 * s * r * (1.0 - 5.0 * s + 5.0 * s * s) / (length_s * length_s)};
}

std::vector<Window> windows_of(const AxisData& data, std::size_t rows) {
  const std::size_t hop = hop_of(data, rows);
  std::vector<Window> windows;
  for (const AxisStretch& stretch : data.stretches) {
    for (std::size_t first = 0; first + rows <= stretch.times_s.size(); first += hop) {
      Window window{&stretch, first, 0.0, 0.0, 0.0, 0.0};
      double stuck = 0.0;
      const double base = stretch.positions[first];
      for_rows(stretch, first, rows, [&](std::size_t k, double s, double length, double dt) {
        const Weight w = weight(s, length);
        const double q = stretch.positions[k] - base;
        const double sign = direction(stretch, k, std::max<std::size_t>(rows / 8, 1), data.quantum);
        window.position += w.curvature * q * dt;
        window.velocity -= w.slope * q * dt;
        window.sign += w.value * sign * dt;
        window.one += w.value * dt;
        if (sign == 0.0) stuck += 1.0;
      });
      if (stuck <= kMostStuck * static_cast<double>(rows)) windows.push_back(window);
    }
  }
  return windows;
}

}  // namespace

std::vector<AxisValues> start_candidates(const AxisData& data, double least_delay_s,
                                         double largest_delay_s) {
  const double step_s = 0.5 * data.period_s;
  std::vector<AxisValues> candidates;
  std::vector<std::vector<Window>> all;
  struct Best {
    double residual = std::numeric_limits<double>::infinity();
    AxisValues values{};
  };
  std::vector<Best> best(kWindowLengths);
  for (int i = 0; i < kWindowLengths; ++i) all.push_back(windows_of(data, kShortestWindow << i));
  for (int trial = 0; least_delay_s + trial * step_s <= largest_delay_s; ++trial) {
    const double delay = least_delay_s + trial * step_s;
    std::vector<std::vector<double>> inputs;
    for (const AxisStretch& stretch : data.stretches) {
      inputs.push_back(inputs_at_rows(stretch, delay));
    }
    for (int i = 0; i < kWindowLengths; ++i) {
      const std::vector<Window>& windows = all[static_cast<std::size_t>(i)];
      const auto count = static_cast<Eigen::Index>(windows.size());
      if (count < 2 * kUnknowns) continue;
      Eigen::MatrixXd A(count, kUnknowns);
      Eigen::VectorXd b(count);
      for (Eigen::Index n = 0; n < count; ++n) {
        const Window& window = windows[static_cast<std::size_t>(n)];
        const std::vector<double>& u =
            inputs[static_cast<std::size_t>(window.stretch - data.stretches.data())];
        double input = 0.0;
        for_rows(*window.stretch, window.first, static_cast<std::size_t>(kShortestWindow) << i,
                 [&](std::size_t k, double s, double length, double dt) {
                   input += weight(s, length).value * u[k] * dt;
                 });
        A.row(n) << input, -window.velocity, -window.sign, -window.one;
        b(n) = window.position;
      }
      // The rank must not depend on the units of the columns. Powers of two leave their bits.
      Eigen::VectorXd scale(kUnknowns);
      for (Eigen::Index j = 0; j < kUnknowns; ++j) {
        scale(j) = math::power_of_two_scale(A.col(j).norm());
        A.col(j) *= scale(j);
      }
      // The least of equal solutions, if the record does not separate two of them.
      Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
      solver.setThreshold(1e-6);
      solver.compute(A);
      const Eigen::VectorXd scaled = solver.solve(b);
      const double residual = (A * scaled - b).squaredNorm();
      const Eigen::VectorXd x = scale.cwiseProduct(scaled);
      Best& so_far = best[static_cast<std::size_t>(i)];
      if (!(x(0) > 0.0) || residual >= so_far.residual) continue;
      so_far.residual = residual;
      so_far.values[kInertia] = 1.0 / x(0);
      so_far.values[kViscous] = std::max(0.0, x(1) / x(0));
      so_far.values[kCoulomb] = std::max(0.0, x(2) / x(0));
      so_far.values[kOffset] = x(3) / x(0);
      so_far.values[kStribeckSpeed] = 1.0;
      so_far.values[kDelay] = delay;
      so_far.values[kTorqueConstant] = 1.0;
    }
  }
  for (const Best& one : best) {
    if (std::isfinite(one.residual)) candidates.push_back(one.values);
  }
  return candidates;
}

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
