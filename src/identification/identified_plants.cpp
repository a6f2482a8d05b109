#include <breakwater/identification/identified_plants.h>

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <stdexcept>

#include <breakwater/config/toml_entry.h>
#include <breakwater/config/toml_file.h>
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
constexpr double kLongestPhysicsStep = 0.2;  // step of the physics times the resonance
constexpr double kLeastVariance = 1e-14;     // rad², for an encoder without counts and noise
constexpr double kPrinted = 1e-5;            // error of a number of counts, from printed digits

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
  Eigen::MatrixXd covariance = identification.covariance;
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

// Jitter leaves the mean interval a little beside a round period: that one.
double rounded_period(double period_s) {
  const double few_digits = std::stod(fmt::format("{:.3g}", period_s));
  return std::abs(few_digits - period_s) < 1e-4 * period_s ? few_digits : period_s;
}

// The parameters by their keys, and numbers that follow from them.
IdentifiedNumbers plant_of(const Identification& identification, const AxisValues& values) {
  const AxisData& data = identification.data;
  const AxisValues& fitted = identification.fit.values;
  // The command is in N m of the fitted torque constant. With another constant the axis moves as
  // one whose inertia and torques are smaller.
  const double share = fitted[kTorqueConstant] / values[kTorqueConstant];
  IdentifiedNumbers numbers;
  for (std::size_t i = 0; i < kAxisParameters; ++i) {
    const KnownParameter& known = known_parameter(static_cast<AxisParameter>(i));
    numbers[known.key] = (known.is_torque ? share : 1.0) * values[i];
  }
  const bool has_stribeck = identification.free[kBreakaway] &&
                            fitted[kBreakaway] > kLeastShare * fitted[kCoulomb] &&
                            fitted[kCoulomb] > 0.0;
  if (!has_stribeck) numbers[parameter_key(kStribeckSpeed)] = 0.0;
  numbers[parameter_key(kDelay)] = std::max(0.0, values[kDelay]);

  const double quantum = data.quantum, noise_std = identification.fit.noise_std;
  const double counts = quantum == 0.0 ? 0.0 : 2.0 * std::numbers::pi / quantum;
  int bits = counts > 0.0 ? 1 : 0;
  // Printed digits leave a power of two a little too small.
  while (bits < kMostBits && std::ldexp(1.0, bits + 1) <= counts * (1.0 + kPrinted)) ++bits;
  const double gear = counts / std::ldexp(1.0, bits);
  const double period_s = rounded_period(data.period_s);
  const TwoInertia spring{.motor_inertia = values[kMotorInertia],
                          .load_inertia = values[kLoadInertia],
                          .stiffness = values[kStiffness]};
  const double steps = std::ceil(period_s * resonance_rad_s(spring) / kLongestPhysicsStep);
  numbers.insert(
      {{"static_ratio", std::min(kMostStaticRatio, 1.0 + values[kBreakaway] / values[kCoulomb])},
       {"antiresonance_rad_s", antiresonance_rad_s(spring)},
       {"largest_torque", fitted[kTorqueConstant] * largest_input(data)},
       {"period_s", period_s},
       {"timestep_s", period_s / std::max(1.0, steps)},
       {"quantum", quantum},
       {"phase", 0.0},
       {"encoder_bits", bits},
       {"encoder_gear_ratio", std::abs(gear - 1.0) < kPrinted ? 1.0 : gear},
       {"rounds_to_nearest", data.rounding == EncoderRounding::nearest ? 1.0 : 0.0},
       {"truncates", data.rounding == EncoderRounding::nearest ? 0.0 : 1.0},
       {"measures_load", data.model == &two_inertia_axis(Side::load) ? 1.0 : 0.0},
       {"noise_std", noise_std},
       {"sensor_variance",
        std::max(kLeastVariance, quantum * quantum / 12.0 + noise_std * noise_std)}});
  return numbers;
}

double value_of(const std::string& expression, const IdentifiedNumbers& numbers) {
  const auto number = [&](const std::string& name) {
    const auto found = numbers.find(name);
    return found != numbers.end() ? std::optional(found->second) : std::nullopt;
  };
  return MetricExpression(expression, number, {}).value();
}

// The text with a number for each <EXPRESSION> in it.
std::string with_numbers(const std::string& text, const IdentifiedNumbers& numbers) {
  constexpr int kDigits = 12;
  std::string filled;
  std::size_t from = 0;
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', from)) {
    const std::size_t end = text.find('>', at);
    if (end == std::string::npos) throw std::invalid_argument(text + ": lacks a \">\"");
    const double value = value_of(text.substr(at + 1, end - at - 1), numbers);
    filled += text.substr(from, at - from) + fmt::format("{:.{}g}", value, kDigits);
    from = end + 1;
  }
  return filled + text.substr(from);
}

}  // namespace

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
    const AxisFit moved =
        moved_fit(identification.data, identification.free, identification.fit, change);
    plants.push_back(plant_of(identification, moved.values));
    plants.back()["phase"] = (point(free) - 0.5) * identification.data.quantum;
  }
  return plants;
}

std::vector<std::string> IdentifiedKeys::sets(const IdentifiedNumbers& numbers,
                                              bool only_drawn) const {
  std::vector<std::string> sets;
  for (const Key& key : keys) {
    if (only_drawn && !key.is_drawn) continue;
    if (!key.needs.empty() && value_of(key.needs, numbers) == 0.0) continue;
    sets.push_back(with_numbers(key.set, numbers));
  }
  return sets;
}

IdentifiedKeys identified_keys(const Catalogue& catalogue, const std::string& model) {
  for (const ScenarioKind& kind : catalogue.all<ScenarioKind>()) {
    const std::string file = kind.file().replace_filename("identified.toml").string();
    if (!std::filesystem::exists(file)) continue;
    const toml::table table = parse_toml_file(file);
    const TomlEntry root(table, file);
    if (root["model"].text() != model) continue;
    IdentifiedKeys found{kind.name, root["case"].text(), {}};
    for (const bool is_drawn : {true, false}) {
      for (const auto& [name, entry] : root[is_drawn ? "drawn" : "set"].entries()) {
        if (!entry.node()->is_table()) {
          found.keys.push_back({is_drawn, "", name + "=" + entry.text()});
          continue;
        }
        for (const auto& [key, value] : entry.entries()) {
          found.keys.push_back({is_drawn, name, key + "=" + value.text()});
        }
      }
    }
    return found;
  }
  return {};
}

std::string drawn_csv(const Identification& identification, const IdentifiedKeys& scenario) {
  constexpr std::size_t kDraws = 32;
  std::vector<ResultRow> rows;
  for (const IdentifiedNumbers& plant : drawn_plants(identification, kDraws)) {
    ResultRow& row = rows.emplace_back();
    for (const std::string& set : scenario.sets(plant, true)) {
      const std::size_t equals = set.find('=');
      row.put(set.substr(0, equals), set.substr(equals + 1));
    }
  }
  return csv_table(rows);
}

}  // namespace breakwater
