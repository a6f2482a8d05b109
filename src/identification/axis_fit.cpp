#include <breakwater/identification/axis_fit.h>

#include <ceres/tiny_solver.h>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include <breakwater/math/functions.h>
#include <breakwater/math/mills_ratio.h>
#include <breakwater/observers/code_likelihood.h>

namespace breakwater {
namespace {

constexpr double kStep = 1e-6;     // step of the differences, in the scales
constexpr double kPriorStd = 3.0;  // in the scales
constexpr int kMostIterations = 60;
constexpr int kMostTurns = 8;
constexpr double kNoiseChange = 0.01;  // relative, at which the turns end
constexpr std::size_t kBins = 2000;    // bins of the errors, for the most likely noise

// The positions with the code y: [y - below, y + above].
struct Code {
  double below;
  double above;
};

Code code_of(const AxisData& data, double y) {
  const double d = data.quantum;
  if (data.rounding == EncoderRounding::nearest) return {0.5 * d, 0.5 * d};
  if (std::abs(y) < 0.5 * d) return {d, d};
  return y > 0.0 ? Code{0.0, d} : Code{d, 0.0};
}

// A deviance residual and its derivative by the position, and ln P at the centre of the code.
struct Residual {
  double value;
  double slope;
  double log_centre;
};

Residual residual_of(const AxisData& data, double noise_std, double y, double position) {
  if (data.quantum == 0.0) {
    return {(position - y) / noise_std, 1.0 / noise_std,
            -math::kLogRootTwoPi - math::log(noise_std)};
  }
  const Code code = code_of(data, y);
  const double half = 0.5 * (code.below + code.above) / noise_std;
  const double off = (position - y - 0.5 * (code.above - code.below)) / noise_std;
  const CodeInterval centred(-half, half);
  const CodeInterval at(-half - off, half - off);
  const double log_centre = centred.log_mass();
  const double square = 2.0 * (log_centre - at.log_mass());
  constexpr double kCentre = 1e-6;  // below, cancellation spoils the quotient
  if (square < kCentre) {
    const double slope = std::sqrt(std::max(0.0, 1.0 - centred.moments().variance));
    return {slope * off, slope / noise_std, log_centre};
  }
  const double value = std::copysign(std::sqrt(square), off);
  return {value, -at.moments().mean / (noise_std * value), log_centre};
}

// The fit as a problem of least squares. Its unknowns are the free parameters in their scales, then
// position and velocity of each start.
class Problem {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  Problem(const AxisData& data, const FreeParameters& free, const AxisFit& fit)
      : data_(data), base_(fit), scales_(parameter_scales(data)) {
    for (std::size_t i = 0; i < kAxisParameters; ++i) {
      if (free[i]) free_.push_back(static_cast<AxisParameter>(i));
    }
    speed_ = scales_[kOffset] / scales_[kViscous];
    length_ = speed_ * data.period_s;
    centre_ = unknowns().head(static_cast<Eigen::Index>(free_.size()));
  }

  int NumResiduals() const { return static_cast<int>(data_.rows() + free_.size()); }
  int NumParameters() const { return static_cast<int>(free_.size() + 2 * data_.stretches.size()); }
  std::size_t free_count() const { return free_.size(); }

  Eigen::VectorXd unknowns() const {
    Eigen::VectorXd x(NumParameters());
    Eigen::Index n = 0;
    for (const AxisParameter i : free_) {
      x(n++) = is_logarithmic(i) ? math::log(base_.values[i]) : base_.values[i] / scales_[i];
    }
    for (const AxisStart& start : base_.starts) {
      x(n++) = start.position / length_;
      x(n++) = start.velocity / speed_;
    }
    return x;
  }

  AxisFit fit_of(const double* x) const {
    AxisFit fit = base_;
    for (const AxisParameter i : free_) {
      const double value = is_logarithmic(i) ? math::exp(*x) : *x * scales_[i];
      fit.values[i] = is_positive(i) ? std::abs(value) : value;
      if (i == kDelay)
        fit.values[i] = std::clamp(value, data_.least_delay_s, data_.largest_delay_s);
      ++x;
    }
    for (AxisStart& start : fit.starts) {
      start.position = *x++ * length_;
      start.velocity = *x++ * speed_;
    }
    return fit;
  }

  bool operator()(const double* x, double* residuals, double* jacobian) const {
    const std::vector<double> positions = fitted_positions(data_, fit_of(x));
    const std::size_t rows = positions.size();
    std::vector<double> slopes(rows);
    std::size_t k = 0;
    for (const AxisStretch& stretch : data_.stretches) {
      for (const double y : stretch.positions) {
        const Residual residual = residual_of(data_, base_.noise_std, y, positions[k]);
        residuals[k] = residual.value;
        slopes[k++] = residual.slope;
      }
    }
    for (std::size_t i = 0; i < free_.size(); ++i) {
      residuals[rows + i] = (x[i] - centre_(static_cast<Eigen::Index>(i))) / kPriorStd;
    }
    if (jacobian == nullptr) return true;
    const auto unknowns = static_cast<std::size_t>(NumParameters());
    Eigen::Map<Eigen::MatrixXd> J(jacobian, NumResiduals(), NumParameters());
    J.setZero();
    J.bottomLeftCorner(centre_.size(), centre_.size()).diagonal().setConstant(1.0 / kPriorStd);
    std::vector<double> moved(x, x + unknowns);
    const auto fill = [&](const std::vector<double>& shifted, std::size_t column, std::size_t from,
                          std::size_t to) {
      for (std::size_t i = from; i < to; ++i) {
        J(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(column)) =
            slopes[i] * (shifted[i] - positions[i]) / kStep;
      }
    };
    for (std::size_t column = 0; column < free_.size(); ++column) {
      moved[column] = x[column] + kStep;
      fill(fitted_positions(data_, fit_of(moved.data())), column, 0, rows);
      moved[column] = x[column];
    }
    // A start acts on its stretch alone. The motion does not depend on the position.
    for (std::size_t s = free_.size() + 1; s < unknowns; s += 2) moved[s] += kStep;
    const std::vector<double> faster = fitted_positions(data_, fit_of(moved.data()));
    std::size_t from = 0;
    std::size_t column = free_.size();
    for (const AxisStretch& stretch : data_.stretches) {
      const std::size_t to = from + stretch.positions.size();
      for (std::size_t i = from; i < to; ++i) {
        J(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(column)) = slopes[i] * length_;
      }
      fill(faster, column + 1, from, to);
      from = to;
      column += 2;
    }
    return true;
  }

 private:
  const AxisData& data_;
  AxisFit base_;
  AxisValues scales_;
  std::vector<AxisParameter> free_;
  Eigen::VectorXd centre_;  // centre of the prior
  double speed_ = 0.0;
  double length_ = 0.0;
};

double deviance_of(const AxisData& data, const AxisFit& fit) {
  const std::vector<double> positions = fitted_positions(data, fit);
  double sum = 0.0;
  std::size_t k = 0;
  for (const AxisStretch& stretch : data.stretches) {
    for (const double y : stretch.positions) {
      const Residual residual = residual_of(data, fit.noise_std, y, positions[k++]);
      sum += residual.value * residual.value - 2.0 * residual.log_centre;
    }
  }
  return sum;
}

// The most likely σ of the errors of a fit, by golden section over its logarithm.
double likely_noise(const AxisData& data, const AxisFit& fit) {
  const std::vector<double> positions = fitted_positions(data, fit);
  std::vector<double> errors;
  double squares = 0.0;
  for (const AxisStretch& stretch : data.stretches) {
    for (const double y : stretch.positions) {
      const Code code = code_of(data, y);
      errors.push_back(std::abs(positions[errors.size()] - y - 0.5 * (code.above - code.below)));
      squares += errors.back() * errors.back();
    }
  }
  const double rms = std::sqrt(squares / static_cast<double>(errors.size()));
  if (data.quantum == 0.0) return rms;
  const double least = kLeastNoise * data.quantum;
  if (rms < 2.0 * least) return least;
  // A histogram saves most of the evaluations.
  const double width = *std::max_element(errors.begin(), errors.end()) / kBins;
  std::vector<double> counts(kBins, 0.0);
  for (const double error : errors) {
    counts[std::min(kBins - 1, static_cast<std::size_t>(error / width))] += 1.0;
  }
  const auto cost = [&](double log_noise) {
    const double noise = math::exp(log_noise);
    const double half = 0.5 * data.quantum / noise;
    double sum = 0.0;
    for (std::size_t i = 0; i < kBins; ++i) {
      if (counts[i] == 0.0) continue;
      const double off = (static_cast<double>(i) + 0.5) * width / noise;
      sum -= counts[i] * CodeInterval(-half - off, half - off).log_mass();
    }
    return sum;
  };
  constexpr double kGolden = 0.61803398874989484820;
  double low = math::log(least);
  double high = math::log(2.0 * rms);
  while (high - low > 1e-3) {
    const double length = kGolden * (high - low);
    if (cost(high - length) < cost(low + length)) {
      high = low + length;
    } else {
      low = high - length;
    }
  }
  return math::exp(0.5 * (low + high));
}

}  // namespace

bool is_logarithmic(AxisParameter parameter) {
  return parameter == kInertia || parameter == kStribeckSpeed || parameter == kTorqueConstant;
}

bool is_positive(AxisParameter parameter) {
  return parameter == kViscous || parameter == kCoulomb || parameter == kBreakaway;
}

std::size_t AxisData::rows() const {
  std::size_t rows = 0;
  for (const AxisStretch& stretch : stretches) rows += stretch.positions.size();
  return rows;
}

AxisFit fit_axis(const AxisData& data, const FreeParameters& free, const AxisFit& start,
                 int most_iterations) {
  const Problem problem(data, free, start);
  ceres::TinySolver<Problem> solver;
  solver.options.max_num_iterations = most_iterations;
  // Changes of −2 ln L, where 3.84 is the height of an interval.
  solver.options.function_tolerance = 1e-4;
  solver.options.gradient_tolerance = 1e-8;
  Eigen::VectorXd x = problem.unknowns();
  solver.Solve(problem, &x);
  AxisFit fit = problem.fit_of(x.data());
  fit.deviance = deviance_of(data, fit);
  fit.is_converged = std::isfinite(fit.deviance) &&
                     solver.summary.status != ceres::TinySolver<Problem>::HIT_MAX_ITERATIONS;
  return fit;
}

AxisFit fit_axis_and_noise(const AxisData& data, const FreeParameters& free, AxisFit start) {
  for (int turn = 0; turn < kMostTurns; ++turn) {
    const double noise = start.noise_std;
    start = fit_axis(data, free, start, kMostIterations);
    start.noise_std = likely_noise(data, start);
    if (std::abs(start.noise_std - noise) < kNoiseChange * noise) break;
  }
  start.deviance = deviance_of(data, start);
  return start;
}

AxisFit fit_starts(const AxisData& data, const AxisFit& model) {
  AxisFit fit = model;
  fit.starts.clear();
  for (const AxisStretch& stretch : data.stretches) {
    const std::size_t k = std::min<std::size_t>(stretch.times_s.size() - 1, 10);
    fit.starts.push_back(
        {stretch.positions.front(), (stretch.positions[k] - stretch.positions.front()) /
                                        (stretch.times_s[k] - stretch.times_s.front())});
  }
  return fit_axis(data, {}, fit, kMostIterations);
}

std::vector<double> fitted_positions(const AxisData& data, const AxisFit& fit) {
  std::vector<double> positions(data.rows());
  std::span<double> rest(positions);
  for (std::size_t s = 0; s < data.stretches.size(); ++s) {
    const std::size_t rows = data.stretches[s].positions.size();
    move_axis(fit.values, fit.starts[s], data.stretches[s], rest.first(rows));
    rest = rest.subspan(rows);
  }
  return positions;
}

AxisValues parameter_scales(const AxisData& data) {
  double torque = 0.0, torques = 0.0, way = 0.0, time = 0.0;
  for (const AxisStretch& stretch : data.stretches) {
    for (const double u : stretch.inputs) torque += u * u;
    torques += static_cast<double>(stretch.inputs.size());
    // Over ten rows, so that single counts do not look fast.
    for (std::size_t k = 10; k < stretch.times_s.size(); k += 10) {
      const double h = stretch.times_s[k] - stretch.times_s[k - 10];
      const double moved = stretch.positions[k] - stretch.positions[k - 10];
      way += moved * moved / h;
      time += h;
    }
  }
  AxisValues scales;
  scales.fill(1.0);
  const double rms_torque = std::sqrt(torque / torques);
  scales[kCoulomb] = scales[kBreakaway] = scales[kOffset] = rms_torque;
  scales[kViscous] = rms_torque / std::sqrt(way / time);
  scales[kDelay] = data.period_s;
  return scales;
}

Eigen::MatrixXd covariance_of(const AxisData& data, const FreeParameters& free,
                              const AxisFit& fit) {
  const Problem problem(data, free, fit);
  Eigen::VectorXd residuals(problem.NumResiduals());
  Eigen::MatrixXd J(problem.NumResiduals(), problem.NumParameters());
  const Eigen::VectorXd x = problem.unknowns();
  problem(x.data(), residuals.data(), J.data());
  // Not from JᵀJ, whose small eigenvalues are lost beside those of well-known parameters.
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(J);
  const Eigen::MatrixXd inverse =
      qr.matrixQR().topRows(J.cols()).triangularView<Eigen::Upper>().solve(
          Eigen::MatrixXd::Identity(J.cols(), J.cols()));
  const auto n = static_cast<Eigen::Index>(problem.free_count());
  return (inverse * inverse.transpose()).topLeftCorner(n, n);
}

}  // namespace breakwater
