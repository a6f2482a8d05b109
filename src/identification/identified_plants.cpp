#include <breakwater/identification/identified_plants.h>

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include <breakwater/identification/axis_intervals.h>
#include <breakwater/identification/axis_model.h>
#include <breakwater/math/functions.h>
#include <breakwater/statistics/distribution.h>
#include <breakwater/study/result_row.h>
#include <breakwater/study/sampling.h>

namespace breakwater {
namespace {

constexpr double kLeastShare = 1e-3;      // breakaway by Coulomb friction; less is none
constexpr double kMostStaticRatio = 1e3;  // the largest that friction.static_ratio may have
constexpr int kMostBits = 30;
constexpr double kPrinted = 1e-5;  // error of a number of counts, from printed digits

double largest_input(const AxisData& data) {
  double largest = 0.0;
  for (const AxisStretch& stretch : data.stretches) {
    for (const double u : stretch.inputs) largest = std::max(largest, std::abs(u));
  }
  return largest;
}

// A square root of the covariance, in the scales of the parameters.
Eigen::MatrixXd spread_of(const Identification& identification) {
  const AxisData& data = identification.data;
  const AxisValues scales = parameter_scales(data);
  Eigen::MatrixXd covariance = covariance_of(data, identification.free, identification.fit);
  Eigen::VectorXd deviations(covariance.rows());
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    const ParameterEstimate& estimate = identification.parameters[static_cast<std::size_t>(i)];
    const auto scaled = [&](double value) {
      return is_logarithmic(estimate.parameter) ? math::log(value)
                                                : value / scales[estimate.parameter];
    };
    // The longer side: an interval may end at 0 or at a bound of the delay.
    const double reach = std::max(scaled(estimate.high) - scaled(estimate.value),
                                  scaled(estimate.value) - scaled(estimate.low));
    deviations(i) = reach / (kRoot95 * std::sqrt(covariance(i, i)));
  }
  covariance = deviations.asDiagonal() * covariance * deviations.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> directions(covariance);
  return directions.eigenvectors() *
         directions.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

IdentifiedNumbers plant_of(const Identification& identification, const AxisValues& values) {
  const AxisData& data = identification.data;
  const AxisValues& fitted = identification.fit.values;
  // The command is in N m of the fitted torque constant. With another constant the axis moves as
  // one whose inertia and torques are smaller.
  const double share = fitted[kTorqueConstant] / values[kTorqueConstant];
  const bool has_stribeck = identification.free[kBreakaway] &&
                            fitted[kBreakaway] > kLeastShare * fitted[kCoulomb] &&
                            fitted[kCoulomb] > 0.0;
  const double coulomb = share * values[kCoulomb];
  const double counts = data.quantum == 0.0 ? 0.0 : 2.0 * std::numbers::pi / data.quantum;
  int bits = 0;
  // Printed digits leave a power of two a little too small.
  while (bits < kMostBits && std::ldexp(1.0, bits + 1) <= counts * (1.0 + kPrinted)) ++bits;
  const double gear = counts / std::ldexp(1.0, bits);
  return {{"inertia", share * values[kInertia]},
          {"viscous_friction", share * values[kViscous]},
          {"coulomb_friction", coulomb},
          {"static_ratio", std::min(kMostStaticRatio, 1.0 + share * values[kBreakaway] / coulomb)},
          {"stribeck_speed", has_stribeck ? values[kStribeckSpeed] : 0.0},
          {"offset_torque", share * values[kOffset]},
          {"largest_torque", fitted[kTorqueConstant] * largest_input(data)},
          {"delay_s", std::max(0.0, values[kDelay])},
          {"period_s", rounded_period(data.period_s)},
          {"quantum", data.quantum},
          {"phase", 0.0},
          {"encoder_bits", bits},
          {"encoder_gear_ratio", std::abs(gear - 1.0) < kPrinted ? 1.0 : gear},
          {"rounds_to_nearest", data.rounding == EncoderRounding::nearest ? 1.0 : 0.0},
          {"noise_std", identification.fit.noise_std}};
}

}  // namespace

double rounded_period(double period_s) {
  const double few_digits = std::stod(fmt::format("{:.3g}", period_s));
  return std::abs(few_digits - period_s) < 1e-4 * period_s ? few_digits : period_s;
}

IdentifiedNumbers identified_plant(const Identification& identification) {
  return plant_of(identification, identification.fit.values);
}

std::vector<IdentifiedNumbers> drawn_plants(const Identification& identification,
                                            std::size_t count) {
  const Eigen::MatrixXd spread = spread_of(identification);
  const Eigen::Index free = spread.rows();
  const Sampler sampler = make_sampler(Method::sobol, count, free + 1, 1);
  std::vector<IdentifiedNumbers> plants;
  for (std::uint64_t n = 0; n < count; ++n) {
    const Eigen::VectorXd point = sampler.point(n);
    const Eigen::VectorXd change = spread * point.head(free).unaryExpr(&normal_quantile);
    AxisValues values = identification.fit.values;
    for (Eigen::Index i = 0; i < free; ++i) {
      const AxisParameter p = identification.parameters[static_cast<std::size_t>(i)].parameter;
      values[p] = moved_parameter(identification.data, p, values[p], change(i));
    }
    plants.push_back(plant_of(identification, values));
    plants.back()["phase"] = (point(free) - 0.5) * identification.data.quantum;
  }
  return plants;
}

std::string drawn_csv(const Identification& identification, const IdentifiedKeys& scenario) {
  constexpr std::size_t kDraws = 32;
  std::vector<ResultRow> rows;
  for (const IdentifiedNumbers& plant : drawn_plants(identification, kDraws)) {
    ResultRow& row = rows.emplace_back();
    for (const std::string& set : scenario.sets(true, plant)) {
      const std::size_t equals = set.find('=');
      row.put(set.substr(0, equals), set.substr(equals + 1));
    }
  }
  return csv_table(rows);
}

}  // namespace breakwater
