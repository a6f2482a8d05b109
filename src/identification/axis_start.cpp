#include <breakwater/identification/axis_start.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

constexpr int kShortestWindow = 8;         // rows
constexpr int kWindowLengths = 7;          // each twice the one before
constexpr double kMostStuck = 0.2;         // share of a window without motion
constexpr std::size_t kMostRows = 400000;  // all windows of one length together
constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();  // relative

// Calls use(k, s, length_s, dt) for each row of a window, with s from 0 to 1 and the trapezoids'
// widths dt.
template <typename Use>
void for_rows(const AxisStretch& stretch, std::size_t first, std::size_t rows, const Use& use) {
  const std::vector<double>& t = stretch.times_s;
  const std::size_t last = first + rows - 1;
  const double length = t[last] - t[first];
  for (std::size_t k = first; k <= last; ++k) {
    const double dt = 0.5 * (t[std::min(k + 1, last)] - t[std::max(k, first + 1) - 1]);
    use(k, (t[k] - t[first]) / length, length, dt);
  }
}

// The sign of the velocity from `reach` rows on both sides; 0 if it moves by less than two counts.
double direction(const AxisStretch& stretch, std::size_t k, std::size_t reach, double quantum) {
  const std::size_t a = k > reach ? k - reach : 0;
  const std::size_t b = std::min(k + reach, stretch.positions.size() - 1);
  const double moved = stretch.positions[b] - stretch.positions[a];
  return std::abs(moved) < 1.5 * quantum || moved == 0.0 ? 0.0 : std::copysign(1.0, moved);
}

// The input at each row of a stretch: the mean of those that act just before and just after.
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

// Integrals of one window without the input, and where it lies.
struct WindowIntegrals {
  const AxisStretch* stretch;
  std::size_t first;
  WindowWeights positions;  // each derivative of the position
  double sign;
  double one;
};

std::vector<WindowIntegrals> windows_of(const AxisData& data, std::size_t rows,
                                        const StartEquation& equation) {
  const std::size_t hop =
      std::max(rows / 4, 1 + data.rows() * rows / kMostRows / std::max<std::size_t>(rows / 4, 1));
  std::vector<WindowIntegrals> windows;
  for (const AxisStretch& stretch : data.stretches) {
    for (std::size_t first = 0; first + rows <= stretch.times_s.size(); first += hop) {
      WindowIntegrals window{&stretch, first, {}, 0.0, 0.0};
      double stuck = 0.0;
      const double base = stretch.positions[first];
      for_rows(stretch, first, rows, [&](std::size_t k, double s, double length, double dt) {
        const WindowWeights w = equation.weights(s, length);
        const double sign = direction(stretch, k, std::max<std::size_t>(rows / 8, 1), data.quantum);
        for (std::size_t n = 0; n <= equation.order; ++n) {
          window.positions[n] += w[n] * (stretch.positions[k] - base) * dt;
        }
        window.sign += w[0] * sign * dt;
        window.one += w[0] * dt;
        if (sign == 0.0) stuck += 1.0;
      });
      if (stuck <= kMostStuck * static_cast<double>(rows)) windows.push_back(window);
    }
  }
  return windows;
}

// The least of equal solutions, if the record does not separate two of them.
StartSolution solve(const std::vector<WindowIntegrals>& windows, std::size_t rows,
                    const AxisData& data, const std::vector<std::vector<double>>& inputs,
                    const StartEquation& equation) {
  const auto count = static_cast<Eigen::Index>(windows.size());
  Eigen::MatrixXd A(count, equation.unknowns());
  Eigen::VectorXd b(count);
  for (Eigen::Index n = 0; n < count; ++n) {
    const WindowIntegrals& window = windows[static_cast<std::size_t>(n)];
    const std::vector<double>& u =
        inputs[static_cast<std::size_t>(window.stretch - data.stretches.data())];
    WindowWeights input{};
    for_rows(*window.stretch, window.first, rows,
             [&](std::size_t k, double s, double length, double dt) {
               const WindowWeights w = equation.weights(s, length);
               for (std::size_t i = 0; i < equation.inputs; ++i) input[i] += w[i] * u[k] * dt;
             });
    Eigen::Index column = 0;
    for (std::size_t i = 0; i < equation.inputs; ++i) A(n, column++) = input[i];
    for (std::size_t i = equation.order; i-- > 1;) A(n, column++) = -window.positions[i];
    A(n, column++) = -window.sign;
    A(n, column) = -window.one;
    b(n) = window.positions[equation.order];
  }
  // The rank must not depend on the units of the columns. Powers of two leave their bits.
  Eigen::VectorXd scale(A.cols());
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    scale(j) = math::power_of_two_scale(A.col(j).norm());
    A.col(j) *= scale(j);
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(1e-6);
  solver.compute(A);
  const Eigen::VectorXd scaled = solver.solve(b);
  return {.residual = (A * scaled - b).squaredNorm(), .x = scale.cwiseProduct(scaled)};
}

// φ = s³ (1 − s)³.
WindowWeights cubic_weights(double s, double length_s) {
  const double r = 1.0 - s;
  return {s * s * s * r * r * r, -3.0 * s * s * r * r * (r - s) / length_s,
          6.0 * s * r * (1.0 - 5.0 * s + 5.0 * s * s) / (length_s * length_s)};
}

}  // namespace

std::vector<StartSolution> start_solutions(const AxisData& data, const StartEquation& equation) {
  std::vector<std::vector<WindowIntegrals>> all;
  std::vector<StartSolution> best(kWindowLengths);
  for (int i = 0; i < kWindowLengths; ++i) {
    all.push_back(windows_of(data, kShortestWindow << i, equation));
  }
  const double step_s = 0.5 * data.period_s;
  for (int trial = 0; data.least_delay_s + trial * step_s <= data.largest_delay_s; ++trial) {
    const double delay_s = data.least_delay_s + trial * step_s;
    std::vector<std::vector<double>> inputs;
    for (const AxisStretch& stretch : data.stretches) {
      inputs.push_back(inputs_at_rows(stretch, delay_s));
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (std::ssize(all[i]) < 2 * equation.unknowns()) continue;
      StartSolution one =
          solve(all[i], static_cast<std::size_t>(kShortestWindow) << i, data, inputs, equation);
      one.delay_s = delay_s;
      if (equation.is_plant(one.x) && one.residual < best[i].residual) best[i] = one;
    }
  }
  std::erase_if(best, [](const StartSolution& one) { return !std::isfinite(one.residual); });
  return best;
}

std::vector<AxisValues> start_candidates(const AxisData& data) {
  std::vector<AxisValues> candidates;
  for (const auto& [residual, delay_s, x] : start_solutions(
           data,
           {2, 1, cubic_weights, [](const Eigen::VectorXd& found) { return found(0) > 0.0; }})) {
    AxisValues& values = candidates.emplace_back();
    values[kInertia] = 1.0 / x(0);
    values[kViscous] = std::max(0.0, x(1) / x(0));
    values[kCoulomb] = std::max(0.0, x(2) / x(0));
    values[kOffset] = x(3) / x(0);
    values[kStribeckSpeed] = values[kTorqueConstant] = 1.0;
    values[kDelay] = delay_s;
  }
  return candidates;
}

}  // namespace breakwater
