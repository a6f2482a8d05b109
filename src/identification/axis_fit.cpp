#include <breakwater/identification/axis_fit.h>

#include <ceres/tiny_solver.h>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include <breakwater/math/error_function.h>
#include <breakwater/math/functions.h>
#include <breakwater/observers/code_sensor.h>
#include <breakwater/observers/sensor_error.h>

namespace breakwater {
namespace {

constexpr double kStep = 1e-6;          // step of the search's differences, in the scales
constexpr double kFineStep = 2e-5;      // and of those of second order
constexpr std::size_t kPlainStart = 2;  // position and velocity have no prior
constexpr int kMostIterations = 60;
constexpr int kMostTurns = 8;
constexpr double kNoiseChange = 0.01;   // relative, at which the turns end
constexpr std::size_t kBins = 2000;     // bins of the errors, for the most likely noise
constexpr double kLeastShare = 1e-3;    // least noise without an encoder, in RMS errors
constexpr double kLeastOfRange = 1e-9;  // below it the differences are no derivatives

CodeRange code_of(const AxisData& data, double y) {
  return code_range(y, data.quantum, data.rounding);
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
  const CodeRange code = code_of(data, y);
  const double half = 0.5 * code.width() / noise_std;
  const double off = (position - y - code.middle()) / noise_std;
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
// the numbers of each start.
class Problem {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  Problem(const AxisData& data, const FreeParameters& free, const AxisFit& fit,
          double prior_std = kPriorStd, bool has_fine_differences = false)
      : data_(data),
        base_(fit),
        prior_std_(prior_std),
        has_fine_differences_(has_fine_differences),
        scales_(parameter_scales(data)),
        free_(listed(free)) {
    for (std::size_t s = 0; s < data.stretches.size(); ++s) {
      const Eigen::Index count = data.stretches[s].drifts.cols();
      drifts_ += count;
      if (base_.starts[s].drifts.size() != count) base_.starts[s].drifts.setZero(count);
    }
    const double speed = scales_[kOffset] / scales_[kViscous];
    start_scales_ = {speed * data.period_s, speed};
    centre_ = unknowns();
  }

  int NumResiduals() const {
    const Eigen::Index held = (start_values() - kPlainStart) * std::ssize(data_.stretches);
    return static_cast<int>(data_.rows() + free_.size()) + static_cast<int>(held + drifts_);
  }
  int NumParameters() const { return static_cast<int>(first_drift() + drifts_); }

  std::size_t free_count() const { return free_.size(); }

  Eigen::VectorXd unknowns() const {
    Eigen::VectorXd x(NumParameters());
    Eigen::Index n = 0;
    for_unknowns(base_, [&](double value, ParameterScale how, double scale) {
      x(n++) = how == ParameterScale::logarithmic ? math::log(value) : value / scale;
    });
    return x;
  }

  AxisFit fit_of(const double* x) const {
    AxisFit fit = base_;
    for_unknowns(fit, [&](double& value, ParameterScale how, double scale) {
      value = how == ParameterScale::logarithmic ? math::exp(*x) : *x * scale;
      if (how == ParameterScale::positive) value = std::abs(value);
      ++x;
    });
    double& delay_s = fit.values[kDelay];
    delay_s = std::clamp(delay_s, data_.least_delay_s, data_.largest_delay_s);
    return fit;
  }

  bool operator()(const double* x, double* residuals, double* jacobian) const {
    const Eigen::VectorXd positions = positions_at(x);
    const Eigen::Index rows = positions.size(), free = std::ssize(free_), width = start_values();
    const Eigen::Map<const Eigen::VectorXd> unknowns(x, NumParameters());
    Eigen::Map<Eigen::VectorXd> r(residuals, NumResiduals());
    Eigen::VectorXd slopes(rows);
    Eigen::Index row = 0;
    for (const AxisStretch& stretch : data_.stretches) {
      for (std::size_t i = 0; i < stretch.positions.size(); ++i) {
        const Residual residual = residual_of(data_, stretch.noise_at(i, base_.noise_std),
                                              stretch.positions[i], positions(row));
        r(row) = residual.value;
        slopes(row++) = residual.slope;
      }
    }
    const Eigen::VectorXd off = unknowns - centre_;
    r.segment(row, free) = off.head(free) / prior_std_;
    row += free;
    for (Eigen::Index s = free; s < first_drift(); s += width) {
      for (Eigen::Index i = kPlainStart; i < width; ++i) r(row++) = off(s + i) / kPriorStd;
    }
    r.tail(drifts_) = unknowns.tail(drifts_);
    if (jacobian == nullptr) return true;
    Eigen::Map<Eigen::MatrixXd> J(jacobian, NumResiduals(), NumParameters());
    J.setZero();
    Eigen::MatrixXd by_parameter(rows, free), by_start(rows, width);
    for (Eigen::Index i = 0; i < free; ++i) {
      by_parameter.col(i) = derivatives(x, positions, i, i + 1);
    }
    // A start acts on its stretch alone. The motion does not depend on the position.
    by_start.col(0).setConstant(start_scales_[0]);
    for (Eigen::Index i = 1; i < width; ++i) {
      by_start.col(i) = derivatives(x, positions, free + i, first_drift());
    }
    Eigen::Index top = 0, column = free, drift = first_drift();
    row = rows + free;  // the prior's rows have the order of the starts
    for (const AxisStretch& stretch : data_.stretches) {
      const Eigen::Index count = std::ssize(stretch.positions), drifts = stretch.drifts.cols();
      const auto slope = slopes.segment(top, count).asDiagonal();
      J.block(top, 0, count, free) = slope * by_parameter.middleRows(top, count);
      J.block(top, column, count, width) = slope * by_start.middleRows(top, count);
      if (drifts > 0) J.block(top, drift, count, drifts) = slope * stretch.drifts;
      for (Eigen::Index i = kPlainStart; i < width; ++i) J(row++, column + i) = 1.0 / kPriorStd;
      top += count;
      column += width;
      drift += drifts;
    }
    // NOLINTNEXTLINE(readability-suspicious-call-argument): `free` is rows and columns
    J.block(rows, 0, free, free).diagonal().setConstant(1.0 / prior_std_);
    J.bottomRightCorner(drifts_, drifts_).setIdentity();
    return true;
  }

 private:
  // Calls use(value, how, scale) for the numbers of a fit, in the order of the unknowns.
  template <typename Fit, typename Use>
  void for_unknowns(Fit& fit, const Use& use) const {
    for (const AxisParameter p : free_) use(fit.values[p], known_parameter(p).scale, scales_[p]);
    for (auto& start : fit.starts) {
      for (std::size_t i = 0; i < data_.model->start_values; ++i) {
        use(start.*kStartParts[i], ParameterScale::plain, start_scales_[i % kPlainStart]);
      }
    }
    for (auto& start : fit.starts) {
      for (auto& size : start.drifts) use(size, ParameterScale::plain, 1.0);
    }
  }
  Eigen::Index start_values() const { return static_cast<Eigen::Index>(data_.model->start_values); }
  Eigen::Index first_drift() const {
    return std::ssize(free_) + start_values() * std::ssize(data_.stretches);
  }
  Eigen::VectorXd positions_at(const double* x) const {
    const std::vector<double> positions = fitted_positions(data_, fit_of(x));
    return Eigen::Map<const Eigen::VectorXd>(positions.data(), std::ssize(positions));
  }

  // Derivatives of the positions by one unknown, or by one of each start. Differences look to one
  // side, since friction ends at 0.
  Eigen::VectorXd derivatives(const double* x, const Eigen::VectorXd& positions, Eigen::Index first,
                              Eigen::Index end) const {
    const auto moved = [&](double step) {
      std::vector<double> to(x, x + NumParameters());
      for (Eigen::Index s = first; s < end; s += start_values()) {
        to[static_cast<std::size_t>(s)] += step;
      }
      return positions_at(to.data());
    };
    if (!has_fine_differences_) return (moved(kStep) - positions) / kStep;
    return (4.0 * moved(kFineStep) - moved(2.0 * kFineStep) - 3.0 * positions) / (2.0 * kFineStep);
  }

  const AxisData& data_;
  AxisFit base_;
  double prior_std_;  // for the parameters
  bool has_fine_differences_;
  AxisValues scales_;
  std::vector<AxisParameter> free_;
  Eigen::Index drifts_ = 0;                         // number in all stretches
  Eigen::VectorXd centre_;                          // centre of the prior
  std::array<double, kPlainStart> start_scales_{};  // a position's and a velocity's
};

// `sum` and the deviance of a stretch that begins with this row.
double with_deviance(double sum, const AxisData& data, const AxisStretch& stretch, double noise_std,
                     const std::vector<double>& positions, std::size_t row) {
  for (std::size_t i = 0; i < stretch.positions.size(); ++i) {
    const Residual residual =
        residual_of(data, stretch.noise_at(i, noise_std), stretch.positions[i], positions[row++]);
    sum += residual.value * residual.value - 2.0 * residual.log_centre;
  }
  return sum;
}

double deviance_of(const AxisData& data, double noise_std, const std::vector<double>& positions) {
  double sum = 0.0;
  std::size_t row = 0;
  for (const AxisStretch& stretch : data.stretches) {
    sum = with_deviance(sum, data, stretch, noise_std, positions, row);
    row += stretch.positions.size();
  }
  return sum;
}

// Infinite if the model does not reach the end of a stretch.
double deviance_of(const AxisData& data, const AxisFit& fit) {
  double sum = deviance_of(data, fit.noise_std, fitted_positions(data, fit));
  for (const AxisStart& start : fit.starts) sum += start.drifts.squaredNorm();
  return std::isnan(sum) ? std::numeric_limits<double>::infinity() : sum;
}

// The minimum of a function between two positive numbers, by golden section over the logarithm.
template <typename Function>
double least_over_logarithm(double from, double to, const Function& function) {
  constexpr double kGolden = 0.61803398874989484820;
  double low = math::log(from);
  double high = math::log(to);
  while (high - low > 1e-3) {
    const double length = kGolden * (high - low);
    if (function(math::exp(high - length)) < function(math::exp(low + length))) {
      high = low + length;
    } else {
      low = high - length;
    }
  }
  return math::exp(0.5 * (low + high));
}

// The most likely σ of the errors of a fit.
double likely_noise(const AxisData& data, const AxisFit& fit) {
  const std::vector<double> positions = fitted_positions(data, fit);
  std::vector<double> errors;
  double squares = 0.0;
  bool has_time_noise = false;
  for (const AxisStretch& stretch : data.stretches) {
    for (const double y : stretch.positions) {
      errors.push_back(std::abs(positions[errors.size()] - y - code_of(data, y).middle()));
      squares += errors.back() * errors.back();
    }
    has_time_noise = has_time_noise || !stretch.time_noise.empty();
  }
  const double rms = std::sqrt(squares / static_cast<double>(errors.size()));
  const double number = kLeastOfRange * range_of(data);
  if (data.quantum == 0.0 && !has_time_noise) return std::max(rms, number);
  const double least =
      std::max(number, data.quantum == 0.0 ? kLeastShare * rms : kLeastNoise * data.quantum);
  if (rms < 2.0 * least) return least;
  if (has_time_noise) {
    return least_over_logarithm(least, 2.0 * rms,
                                [&](double noise) { return deviance_of(data, noise, positions); });
  }
  // A histogram saves most of the evaluations.
  const double width = *std::max_element(errors.begin(), errors.end()) / kBins;
  std::vector<double> counts(kBins, 0.0);
  for (const double error : errors) {
    counts[std::min(kBins - 1, static_cast<std::size_t>(error / width))] += 1.0;
  }
  return least_over_logarithm(least, 2.0 * rms, [&](double noise) {
    const double half = 0.5 * data.quantum / noise;
    double sum = 0.0;
    for (std::size_t i = 0; i < kBins; ++i) {
      if (counts[i] == 0.0) continue;
      const double off = (static_cast<double>(i) + 0.5) * width / noise;
      sum -= counts[i] * CodeInterval(-half - off, half - off).log_mass();
    }
    return sum;
  });
}

}  // namespace

AxisFit fit_axis(const AxisData& data, FreeParameters free, const AxisFit& start,
                 int most_iterations) {
  free[kBacklash] = free[kBacklash] && start.values[kBacklash] > 0.0;
  const Problem problem(data, free, start);
  ceres::TinySolver<Problem> solver;
  solver.options.max_num_iterations = most_iterations;
  // Changes of −2 ln L, where 3.84 is the height of an interval.
  solver.options.function_tolerance = 1e-4;
  solver.options.gradient_tolerance = 1e-8;
  // The positions of the starts are large unknowns: changes far below them still count.
  solver.options.parameter_tolerance = 1e-13;
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
  AxisFit best = fit_axis(data, {}, fit, kMostIterations);
  if (data.model->start_values == kPlainStart || model.values[kBacklash] == 0.0) return best;
  // A search does not find the way through the play. The stretches have nothing in common here.
  const auto take_better = [&](const AxisFit& other) {
    const std::vector<double> before = fitted_positions(data, best);
    const std::vector<double> now = fitted_positions(data, other);
    std::size_t row = 0;
    for (std::size_t s = 0; s < data.stretches.size(); ++s) {
      const AxisStretch& stretch = data.stretches[s];
      const double old = with_deviance(0.0, data, stretch, fit.noise_std, before, row);
      const double found = with_deviance(0.0, data, stretch, fit.noise_std, now, row);
      if (found < old || std::isnan(old)) best.starts[s] = other.starts[s];
      row += stretch.positions.size();
    }
  };
  const double half = 0.5 * model.values[kBacklash], wound = rms_twist(data, model);
  for (const double twist : {-half - wound, -half, half, half + wound}) {
    for (AxisStart& start : fit.starts) start.twist = twist;
    take_better(fit_axis(data, {}, fit, kMostIterations));
  }
  if (model.starts.size() == data.stretches.size()) {
    fit.starts = model.starts;
    take_better(fit_axis(data, {}, fit, kMostIterations));
  }
  best.deviance = deviance_of(data, best);
  return best;
}

double range_of(const AxisData& data) {
  double range = 0.0;
  for (const AxisStretch& stretch : data.stretches) {
    const auto [low, high] =
        std::minmax_element(stretch.positions.begin(), stretch.positions.end());
    range = std::max(range, *high - *low);
  }
  return range;
}

double rms_twist(const AxisData& data, const AxisFit& fit) {
  return fit.values[kTorqueConstant] * parameter_scales(data)[kOffset] / fit.values[kStiffness];
}

std::vector<double> fitted_positions(const AxisData& data, const AxisFit& fit) {
  std::vector<double> positions(data.rows());
  std::span<double> rest(positions);
  for (std::size_t s = 0; s < data.stretches.size(); ++s) {
    const std::size_t rows = data.stretches[s].positions.size();
    data.model->move(fit.values, fit.starts[s], data.stretches[s], rest.first(rows));
    const Eigen::MatrixXd& drifts = data.stretches[s].drifts;
    if (drifts.cols() > 0 && fit.starts[s].drifts.size() == drifts.cols()) {
      Eigen::Map<Eigen::VectorXd>(rest.data(), drifts.rows()) += drifts * fit.starts[s].drifts;
    }
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
  const double rms_speed = std::sqrt(way / time);
  scales[kCoulomb] = scales[kBreakaway] = scales[kOffset] = rms_torque;
  scales[kMotorCoulomb] = scales[kLoadCoulomb] = rms_torque;
  scales[kViscous] = scales[kMotorViscous] = scales[kLoadViscous] = rms_torque / rms_speed;
  scales[kDamping] = scales[kViscous];
  scales[kBacklash] = 10.0 * rms_speed * data.period_s;
  scales[kDelay] = data.period_s;
  return scales;
}

Eigen::MatrixXd covariance_of(const AxisData& data, const FreeParameters& free, const AxisFit& fit,
                              double prior_std) {
  // Differences of first order make a direction that the records do not show look known.
  const Problem problem(data, free, fit, prior_std, true);
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
