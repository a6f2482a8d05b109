#include <breakwater/identification/identified_study.h>

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include <breakwater/config/toml_text.h>
#include <breakwater/identification/axis_intervals.h>
#include <breakwater/identification/axis_model.h>
#include <breakwater/math/functions.h>
#include <breakwater/statistics/distribution.h>
#include <breakwater/study/sampling.h>

namespace breakwater {
namespace {

constexpr std::size_t kDraws = 32;        // in a sweep
constexpr std::size_t kTuned = 8;         // in a tuning, the first ones
constexpr std::size_t kTested = 24;       // in its validation, the next ones
constexpr std::size_t kOnALine = 6;       // values
constexpr double kLeastShare = 1e-3;      // breakaway by Coulomb friction; less is none
constexpr double kMostStaticRatio = 1e3;  // the largest that friction.static_ratio may have
constexpr int kMostBits = 30;
constexpr double kPrinted = 1e-5;  // error of a number of counts, from printed digits
constexpr int kTuningDigits = 6;

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
  const double inertia = share * values[kInertia], coulomb = share * values[kCoulomb];
  const double offset = share * values[kOffset], delay_s = std::max(0.0, values[kDelay]);
  const double period_s = rounded_period(data.period_s);
  // Delay and period bound the frequencies of a controller and an observer.
  const double fastest = 1.0 / (delay_s + period_s), cubed = fastest * fastest * fastest;
  const double counts = data.quantum == 0.0 ? 0.0 : 2.0 * std::numbers::pi / data.quantum;
  int bits = 0;
  // Printed digits leave a power of two a little too small.
  while (bits < kMostBits && std::ldexp(1.0, bits + 1) <= counts * (1.0 + kPrinted)) ++bits;
  const double gear = counts / std::ldexp(1.0, bits);
  return {{"inertia", inertia},
          {"viscous_friction", share * values[kViscous]},
          {"coulomb_friction", coulomb},
          {"static_ratio", std::min(kMostStaticRatio, 1.0 + share * values[kBreakaway] / coulomb)},
          {"stribeck_speed", has_stribeck ? values[kStribeckSpeed] : 0.0},
          {"offset_torque", offset},
          {"offset_size", std::abs(offset)},
          {"largest_torque", fitted[kTorqueConstant] * largest_input(data)},
          {"delay_s", delay_s},
          {"period_s", period_s},
          {"fastest_rad_s", fastest},
          // The poles of a Kalman filter have about the magnitude (Q/(J² R T²))^(1/6).
          {"fastest_process_noise", cubed * cubed * inertia * inertia * period_s * period_s},
          {"quantum", data.quantum},
          {"phase", 0.0},
          {"encoder_bits", bits},
          {"encoder_gear_ratio", std::abs(gear - 1.0) < kPrinted ? 1.0 : gear},
          {"rounds_to_nearest", data.rounding == EncoderRounding::nearest ? 1.0 : 0.0},
          {"noise_std", identification.fit.noise_std}};
}

// A table of the keys that differ between the draws first … last − 1.
std::string table_of(const char* title, const std::vector<IdentifiedNumbers>& plants,
                     std::size_t first, std::size_t last, const IdentifiedKeys& scenario) {
  std::string text = fmt::format("\n[{}]\n", title);
  std::vector<std::vector<std::string>> rows;
  for (std::size_t n = first; n < last; ++n) rows.push_back(scenario.sets(true, plants[n]));
  for (std::size_t key = 0; key < rows.front().size(); ++key) {
    const auto is_as_first = [&](const std::vector<std::string>& row) {
      return row[key] == rows.front()[key];
    };
    if (std::all_of(rows.begin(), rows.end(), is_as_first)) continue;
    const std::size_t equals = rows.front()[key].find('=');
    text += fmt::format("{} = [", toml_string(rows.front()[key].substr(0, equals)));
    for (std::size_t n = 0; n < rows.size(); ++n) {
      text += n % kOnALine == 0 ? "\n  " : " ";
      text += rows[n][key].substr(equals + 1) + ",";
    }
    text += "\n]\n";
  }
  return text;
}

std::string cautions_of(const Identification& identification) {
  std::string text;
  for (const ParameterEstimate& estimate : identification.parameters) {
    if (estimate.is_identifiable) continue;
    text += fmt::format("# {} is not identifiable: its draws are wide.\n",
                        parameter_key(estimate.parameter));
  }
  if (!identification.whiteness.is_white()) {
    text += "# The residuals are not white: the draws are too narrow.\n";
  }
  return text;
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
  const auto sampler = make_sampler(SamplingMethod::sobol, count, free + 1, 1);
  std::vector<IdentifiedNumbers> plants;
  for (std::uint64_t n = 0; n < count; ++n) {
    const Eigen::VectorXd point = sampler->point(n);
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

std::string identified_sweep(const Identification& identification, const IdentifiedKeys& scenario) {
  return fmt::format(
             "# The identified axis with its uncertainty.\n"
             "#     breakwater sweep sweep.toml --out ../studies/sweep\n"
             "# Each column of the lists is a joint draw of all parameters and the phase.\n"
             "# The seeds draw the noise, which often matters more.\n{}\n"
             "scenario = {}\nconfig = \"identified.toml\"\nmethod = \"list\"\n"
             "seeds = {{ first = 1, count = 40 }}\n",
             cautions_of(identification), toml_string(scenario.scenario)) +
         table_of("vary", drawn_plants(identification, kDraws), 0, kDraws, scenario);
}

std::string identified_tuning(const Identification& identification,
                              const IdentifiedKeys& scenario) {
  const std::vector<IdentifiedNumbers> plants = drawn_plants(identification, kDraws);
  return fmt::format(
             "# A search for a controller over the uncertainty of the axis.\n"
             "#     breakwater tune tune.toml --out ../studies/tune\n"
             "# Each column of [world] is a joint draw of all parameters and the phase.\n"
             "# The columns of [validate.world] are other draws.\n{}\n"
             "scenario = {}\nconfig = \"identified.toml\"\nworlds = \"list\"\n"
             "seeds = {{ first = 1, count = 4 }}\n{}",
             cautions_of(identification), toml_string(scenario.scenario),
             with_numbers(scenario.tuning, identified_plant(identification), kTuningDigits)) +
         table_of("world", plants, 0, kTuned, scenario) +
         "\n[validate]\nseeds = { first = 1001, count = 2 }\n" +
         table_of("validate.world", plants, kTuned, kTuned + kTested, scenario);
}

}  // namespace breakwater
