#include <breakwater/identification/axis_start.h>

#include <Eigen/QR>
#include <cmath>
#include <limits>

namespace breakwater {
namespace {

constexpr Eigen::Index kUnknowns = 8;  // β₀, β₁, β₂, α₃, α₂, α₁, f, d
constexpr double kMotorShares[] = {0.3, 0.7};
constexpr std::size_t kRigidPlants = 3;
constexpr double kResonances_rad_s[] = {50.0, 200.0};

// φ = p⁵ with p = s (1 − s), and its derivatives by the time with alternating signs. So the
// integral of weight k times q is that of φ times the derivative k of q.
struct Weights {
  double of[5];
};

Weights weights(double s, double length_s) {
  const double p = s * (1.0 - s), r = 1.0 - 2.0 * s, n = 1.0 / length_s;
  const double p2 = p * p, r2 = r * r, n2 = n * n;
  return {{p2 * p2 * p, -5.0 * p2 * p2 * r * n, (20.0 * p * r2 - 10.0 * p2) * p2 * n2,
           -(60.0 * r2 - 120.0 * p) * p2 * r * n2 * n,
           (120.0 * r2 * r2 - 720.0 * p * r2 + 240.0 * p2) * p * n2 * n2}};
}

// Integrals of one window without the input, and where it lies.
struct Window {
  const AxisStretch* stretch;
  std::size_t first;
  double positions[5];
  double sign;
  double one;
};

std::vector<Window> windows_of(const AxisData& data, std::size_t rows) {
  std::vector<Window> windows;
  for (const AxisStretch& stretch : data.stretches) {
    for (std::size_t first = 0; first + rows <= stretch.times_s.size();
         first += hop_of(data, rows)) {
      Window window{&stretch, first, {}, 0.0, 0.0};
      double stuck = 0.0;
      const double base = stretch.positions[first];
      for_rows(stretch, first, rows, [&](std::size_t k, double s, double length, double dt) {
        const Weights w = weights(s, length);
        const double sign = direction(stretch, k, std::max<std::size_t>(rows / 8, 1), data.quantum);
        for (int n = 0; n < 5; ++n) {
          window.positions[n] += w.of[n] * (stretch.positions[k] - base) * dt;
        }
        window.sign += w.of[0] * sign * dt;
        window.one += w.of[0] * dt;
        if (sign == 0.0) stuck += 1.0;
      });
      if (stuck <= kMostStuck * static_cast<double>(rows)) windows.push_back(window);
    }
  }
  return windows;
}

struct Solution {
  double residual = std::numeric_limits<double>::infinity();
  double delay_s = 0.0;
  Eigen::VectorXd x;
};

Solution solve(const std::vector<Window>& windows, std::size_t rows, const AxisData& data,
               const std::vector<std::vector<double>>& inputs, Side measured) {
  const auto count = static_cast<Eigen::Index>(windows.size());
  Eigen::MatrixXd A(count, kUnknowns);
  Eigen::VectorXd b(count);
  for (Eigen::Index n = 0; n < count; ++n) {
    const Window& window = windows[static_cast<std::size_t>(n)];
    const auto stretch = static_cast<std::size_t>(window.stretch - data.stretches.data());
    double input[3] = {};
    for_rows(*window.stretch, window.first, rows,
             [&](std::size_t k, double s, double length, double dt) {
               const Weights w = weights(s, length);
               for (int i = 0; i < 3; ++i) input[i] += w.of[i] * inputs[stretch][k] * dt;
             });
    A.row(n) << input[0], input[1], measured == Side::motor ? input[2] : 0.0, -window.positions[3],
        -window.positions[2], -window.positions[1], -window.sign, -window.one;
    b(n) = window.positions[4];
  }
  // The columns have different units.
  Eigen::VectorXd sizes = A.colwise().norm().transpose();
  for (double& size : sizes) size = size > 0.0 ? 1.0 / size : 0.0;
  A = A * sizes.asDiagonal();
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(1e-6);
  solver.compute(A);
  const Eigen::VectorXd scaled = solver.solve(b);
  return {.residual = (A * scaled - b).squaredNorm(), .x = sizes.asDiagonal() * scaled};
}

void add_plants(const Solution& solution, Side measured, std::vector<AxisValues>& candidates) {
  const Eigen::VectorXd& x = solution.x;
  const double beta = x(0), square = x(4);  // β₀ and ω_r²
  if (!(beta > 0.0) || !(square > 0.0)) return;
  const double inertia = square / beta;
  AxisValues values{};
  values[kMotorViscous] = values[kLoadViscous] = std::max(0.0, 0.5 * x(5) / beta);
  values[kMotorCoulomb] = values[kLoadCoulomb] = std::max(0.0, 0.5 * x(6) / beta);
  values[kOffset] = x(7) / beta;
  values[kDelay] = solution.delay_s;
  values[kTorqueConstant] = values[kStribeckSpeed] = 1.0;
  const auto add = [&](double motor_share) {
    if (!(motor_share > 0.0) || !(motor_share < 1.0)) return;
    const double reduced = motor_share * (1.0 - motor_share) * inertia;
    values[kMotorInertia] = motor_share * inertia;
    values[kLoadInertia] = inertia - values[kMotorInertia];
    values[kStiffness] = square * reduced;
    values[kDamping] = std::max(0.0, x(3)) * reduced;
    candidates.push_back(values);
  };
  if (measured == Side::motor) add(1.0 / (x(2) * inertia));
  for (const double share : kMotorShares) add(share);
}

// A plant that a record without vibration shows as one inertia.
void add_rigid_plants(const std::vector<AxisValues>& rigid, std::vector<AxisValues>& candidates) {
  const std::size_t first = rigid.size() > kRigidPlants ? rigid.size() - kRigidPlants : 0;
  for (std::size_t i = first; i < rigid.size(); ++i) {
    AxisValues values = rigid[i];
    values[kMotorInertia] = values[kLoadInertia] = 0.5 * rigid[i][kInertia];
    values[kMotorViscous] = values[kLoadViscous] = 0.5 * rigid[i][kViscous];
    values[kMotorCoulomb] = values[kLoadCoulomb] = 0.5 * rigid[i][kCoulomb];
    values[kInertia] = values[kViscous] = values[kCoulomb] = 0.0;
    for (const double resonance : kResonances_rad_s) {
      const double reduced = 0.25 * rigid[i][kInertia];
      values[kStiffness] = resonance * resonance * reduced;
      values[kDamping] = 0.1 * resonance * reduced;
      candidates.push_back(values);
    }
  }
}

}  // namespace

template <Side measured>
std::vector<AxisValues> two_inertia_candidates(const AxisData& data, double least_delay_s,
                                               double largest_delay_s) {
  std::vector<std::vector<Window>> all;
  std::vector<Solution> best(kWindowLengths);
  for (int i = 0; i < kWindowLengths; ++i) all.push_back(windows_of(data, kShortestWindow << i));
  const double step_s = 0.5 * data.period_s;
  for (int trial = 0; least_delay_s + trial * step_s <= largest_delay_s; ++trial) {
    const double delay_s = least_delay_s + trial * step_s;
    std::vector<std::vector<double>> inputs;
    for (const AxisStretch& stretch : data.stretches) {
      inputs.push_back(inputs_at_rows(stretch, delay_s));
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].size() < 2 * kUnknowns) continue;
      Solution one =
          solve(all[i], static_cast<std::size_t>(kShortestWindow) << i, data, inputs, measured);
      one.delay_s = delay_s;
      if (one.x(0) > 0.0 && one.x(4) > 0.0 && one.residual < best[i].residual) best[i] = one;
    }
  }
  std::vector<AxisValues> candidates;
  for (const Solution& one : best) {
    if (std::isfinite(one.residual)) add_plants(one, measured, candidates);
  }
  add_rigid_plants(start_candidates(data, least_delay_s, largest_delay_s), candidates);
  return candidates;
}

template std::vector<AxisValues> two_inertia_candidates<Side::motor>(const AxisData&, double,
                                                                     double);
template std::vector<AxisValues> two_inertia_candidates<Side::load>(const AxisData&, double,
                                                                    double);

}  // namespace breakwater
