// Every observer of an axis in the catalogue, with numbers that a broken sensor may send.
#include <Eigen/Eigenvalues>

#include <breakwater/config/fields.h>
#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/parts.h>
#include <breakwater/observers/kalman_estimator.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/rigs/axis_parts.h>
#include "support.h"

namespace breakwater::axis_estimators_test {

NominalAxis one_axis() {
  return {.plant = damped_inertia(1.0, 0.2),
          .period_s = 1e-3,
          .sensor = {Eigen::VectorXd::Constant(1, 1e-3), Eigen::VectorXd::Zero(1)},
          .pulses_per_revolution = 6283.0};
}

std::unique_ptr<DisturbanceEstimator> make(const std::string& name,
                                           const std::vector<std::string>& sets,
                                           const NominalAxis& axis = one_axis()) {
  Catalogue catalogue;
  for (const AxisEstimatorKind& kind : axis_estimators()) catalogue.add(kind);
  for (const AxisEstimatorKind& kind : published_estimators()) catalogue.add(kind);
  PartChoice<AxisEstimatorKind> choice(catalogue, "observer.name", "");
  Fields fields;
  choice.bind(fields);
  Config config("test", {});
  const char* const poles =
      name == "idob" ? "observer.poles_rad_s=[-10,-20,-30]" : "observer.poles_rad_s=[-10,-20]";
  for (const std::string& set : std::vector<std::string>{
           "observer.name=" + name, poles, "observer.derivative_cutoff_rad_s=4",
           "observer.low_pass_cutoff_rad_s=2", "observer.disturbance_order=0",
           "observer.process_noise_on=disturbance", "observer.process_noise=1e-4",
           "observer.observation_noise=1e-6", "observer.initial_covariance=[1e-4,1e-4,1e-4]",
           "observer.alpha=0.1", "observer.lambda_min=0.8", "observer.lambda_max=1.0",
           "observer.largest_disturbance=10"}) {
    config.set(set);
  }
  for (const std::string& set : sets) config.set(set);
  fields.read(config);
  return choice.check(config, axis);
}

// The values of observer.likelihood that the observer knows, or one that it does not use.
std::vector<std::string> likelihoods_of(const std::string& name) {
  if (name == "immkf" || name == "mckf") return {"gauss", "code"};
  return {"gauss"};
}

bool is_finite(const DisturbanceEstimator& estimator) {
  bool finite = estimator.state().allFinite() && estimator.disturbance().allFinite();
  for (const Signal& signal : estimator.signals()) {
    for (const double value : signal.values) finite = finite && std::isfinite(value);
  }
  return finite;
}

class AxisEstimators : public ::testing::TestWithParam<std::string> {};

// A random axis: inertia, friction, period and sensor of any usual size.
NominalAxis any_axis(testing::Random& random) {
  const auto any = [&](double from, double to) { return std::pow(10.0, random.uniform(from, to)); };
  NominalAxis axis{
      .plant = damped_inertia(any(-3.0, 2.0), any(-3.0, 1.0)),
      .period_s = any(-4.0, -1.5),
      .force_limit = 10.0,
      .sensor = {
          Eigen::VectorXd::Constant(1, random.uniform(0.0, 1.0) < 0.2 ? 0.0 : any(-7.0, -2.0)),
          Eigen::VectorXd::Constant(1, random.uniform(0.0, 1.0) < 0.3 ? 0.0 : any(-7.0, -3.0))}};
  // Behind a sensor without any error a covariance has no digits left (docs/reliability.md).
  if (axis.sensor.quantum(0) == 0.0) axis.sensor.noise_std.setConstant(any(-7.0, -3.0));
  axis.pulses_per_revolution = 6.2832 / std::max(1e-6, axis.sensor.quantum(0));
  return axis;
}

std::vector<std::string> any_sets(testing::Random& random, const std::string& name) {
  const auto set = [&](const std::string& key, double from, double to) {
    return "observer." + key + "=" + std::to_string(std::pow(10.0, random.uniform(from, to)));
  };
  // The STF is for order 0 (stf.h): with more, its inflations lose all digits of P.
  const int order = name == "stf" ? 0 : static_cast<int>(random.uniform(0.0, 2.99));
  std::string covariance = "observer.initial_covariance=[1e-4";
  for (int i = 0; i < 2 + order; ++i) covariance += ",1e-2";
  const double pole = -std::pow(10.0, random.uniform(0.0, 2.0));
  std::string poles =
      "observer.poles_rad_s=[" + std::to_string(pole) + "," + std::to_string(1.1 * pole);
  if (name == "idob") poles += "," + std::to_string(1.2 * pole);
  const auto likelihoods = likelihoods_of(name);
  return {poles + "]",
          covariance + "]",
          "observer.disturbance_order=" + std::to_string(order),
          "observer.likelihood=" +
              likelihoods[static_cast<std::size_t>(random.uniform(0.0, 0.99) *
                                                   static_cast<double>(likelihoods.size()))],
          set("process_noise", -5.0, 5.0),
          set("observation_noise", -6.0, 0.0),
          set("bandwidth_rad_s", 0.0, 2.0),
          set("alpha", -2.0, 2.0)};
}

// P of a Kalman filter; empty for the others.
Eigen::MatrixXd covariance_of(const DisturbanceEstimator& estimator) {
  if (const auto* one = dynamic_cast<const KalmanEstimator*>(&estimator)) return one->P();
  return {};
}

// Symmetric, and no eigenvalue is negative beyond rounding. A correction rounds to some digits of
// the covariance before it, so `largest` has the largest variances so far.
void expect_covariance(const Eigen::MatrixXd& P, const Eigen::VectorXd& largest) {
  ASSERT_TRUE(P.allFinite());
  ASSERT_GE(P.diagonal().minCoeff(), 0.0);
  Eigen::MatrixXd unit = P;
  unit.diagonal() += 1e-13 * largest;
  const Eigen::VectorXd scale = unit.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  unit = scale.asDiagonal() * unit * scale.asDiagonal();
  ASSERT_LE((unit - unit.transpose()).cwiseAbs().maxCoeff(), 1e-9);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(unit, Eigen::EigenvaluesOnly);
  ASSERT_GE(eigen.eigenvalues().minCoeff(), -1e-4);
}

// Random axes and designs: sequences of plausible and of huge finite numbers, with plausible ones
// between them. Sizes are up to 1e75: squares of them, and their product with another square, are
// finite numbers.
TEST_P(AxisEstimators, PropertyStayFiniteWithACovarianceForAnyDesign) {
  constexpr int kSamples = 100;
  const int count = testing::property_count(4000);
  testing::Random random(7);
  int samples = 0, designs = 0, refused = 0, with_covariance = 0;
  while (samples < count) {
    std::unique_ptr<DisturbanceEstimator> estimator;
    const NominalAxis axis = any_axis(random);
    const std::vector<std::string> sets = any_sets(random, GetParam());
    try {
      estimator = make(GetParam(), sets, axis);
    } catch (const std::invalid_argument&) {
      ASSERT_LT(++refused, count) << "no design is accepted";
      continue;
    }
    ++designs;
    estimator->reset(Eigen::VectorXd::Zero(2));
    const bool is_huge = designs % 3 == 0;
    Eigen::VectorXd variances = covariance_of(*estimator).diagonal();
    for (int k = 0; k < kSamples; ++k, ++samples) {
      const double largest = is_huge && k / 20 % 2 == 0 ? 75.0 : 1.0;
      const auto any = [&] {
        return Eigen::VectorXd::Constant(
            1, random.uniform(-1.0, 1.0) * std::pow(10.0, random.uniform(-largest, largest)));
      };
      const Eigen::VectorXd u = any(), y = any();
      estimator->update(u, y);
      const auto trace = [&] {
        std::string text = "design " + std::to_string(designs) + ", sample " + std::to_string(k);
        for (const std::string& set : sets) text += " " + set;
        return text + " period " + std::to_string(axis.period_s);
      };
      ASSERT_TRUE(is_finite(*estimator)) << trace();
      const Eigen::MatrixXd P = covariance_of(*estimator);
      // Jumps of 10⁷⁵ standard deviations leave no digits of P. The likelihood of a code leaves
      // none after many jumps that no model explains (docs/reliability.md).
      const bool is_of_code =
          std::find(sets.begin(), sets.end(), "observer.likelihood=code") != sets.end();
      if (P.size() == 0 || is_huge || is_of_code) continue;
      ++with_covariance;
      variances = variances.cwiseMax(P.diagonal());
      expect_covariance(P, variances);
      ASSERT_FALSE(HasFatalFailure()) << trace() << "\n" << P;
    }
  }
  std::printf("%s: %d samples in %d designs, %d with a covariance; %d designs refused\n",
              GetParam().c_str(), samples, designs, with_covariance, refused);
}

TEST_P(AxisEstimators, ResetRestoresTheInitialState) {
  const auto used = make(GetParam(), {}), fresh = make(GetParam(), {});
  testing::Random random(2);
  const auto any = [&](double size) { return random.vector(1, size); };
  for (int k = 0; k < 300; ++k) {
    Eigen::VectorXd u = any(5.0), y = any(0.3);
    if (k % 50 == 7) u(0) = NAN;
    if (k % 40 == 9) y(0) = NAN;
    used->update(u, y);
  }
  used->reset(Eigen::Vector2d(0.1, -0.2));
  fresh->reset(Eigen::Vector2d(0.1, -0.2));
  for (int k = 0; k < 100; ++k) {
    const Eigen::VectorXd u = any(5.0), y = any(0.3);
    used->update(u, y);
    fresh->update(u, y);
    ASSERT_EQ(used->state(), fresh->state()) << k;
    ASSERT_EQ(used->disturbance(), fresh->disturbance()) << k;
    ASSERT_TRUE(is_finite(*used)) << k;
  }
}

// NaN and infinity: the estimate is finite without them, or not finite from the next sample on. An
// observer shows a measurement in its next state. After a reset it is as if it had never been.
TEST_P(AxisEstimators, PropertySayWhenTheyAreNotFinite) {
  const int count = testing::property_count(300);
  testing::Random random(8);
  int survived = 0, said = 0;
  const auto one = make(GetParam(), {});
  const auto fresh = make(GetParam(), {});
  const auto any = [&] { return Eigen::VectorXd::Constant(1, random.uniform(-1.0, 1.0)); };
  for (int k = 0; k < count; ++k) {
    one->reset(Eigen::VectorXd::Zero(2));
    fresh->reset(Eigen::VectorXd::Zero(2));
    const int good = static_cast<int>(random.uniform(1.0, 6.0));
    for (int i = 0; i < good; ++i) {
      const Eigen::VectorXd u = any(), y = any();
      one->update(u, y);
      fresh->update(u, y);
      ASSERT_TRUE(one->state() == fresh->state() && one->disturbance() == fresh->disturbance())
          << k << ": a reset leaves something";
    }
    constexpr double kBad[] = {kNaN, kInfinity, -kInfinity};
    const Eigen::VectorXd bad = Eigen::VectorXd::Constant(1, kBad[k % 3]);
    one->update(any(), bad);
    one->update(any(), any());
    const bool is_sound = one->state().allFinite() && one->disturbance().allFinite();
    ++(is_sound ? survived : said);
    one->update(any(), any());
    ASSERT_EQ(is_sound, one->state().allFinite() && one->disturbance().allFinite()) << k;
  }
  std::printf("%s: %d sequences, finite in %d, not finite in %d\n", GetParam().c_str(), count,
              survived, said);
  EXPECT_TRUE(survived == 0 || said == 0) << "it depends";
}

template <typename... Lists>
std::vector<std::string> names(const Lists&... lists) {
  std::vector<std::string> all;
  const auto add = [&](const auto& kinds) {
    for (const AxisEstimatorKind& kind : kinds) all.push_back(kind.name);
  };
  (add(lists), ...);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Catalogue, AxisEstimators,
                         ::testing::ValuesIn(names(axis_estimators(), published_estimators())),
                         [](const auto& row) { return row.param; });

class PublishedOnes : public AxisEstimators {};
INSTANTIATE_TEST_SUITE_P(Catalogue, PublishedOnes,
                         ::testing::ValuesIn(names(published_estimators())),
                         [](const auto& row) { return row.param; });

// They also survive what is not a number, and what overflows.
TEST_P(PublishedOnes, SurviveAnyNumber) {
  for (const std::string& likelihood : likelihoods_of(GetParam())) {
    const auto estimator = make(GetParam(), {"observer.likelihood=" + likelihood});
    testing::Random random(6);
    for (int k = 0; k < 2000; ++k) {
      const auto any = [&] {
        const double size = std::pow(10.0, random.uniform(-308.0, 308.0));
        const double kind = random.uniform(0.0, 1.0);
        return Eigen::VectorXd::Constant(1, kind < 0.1   ? NAN
                                            : kind < 0.2 ? -INFINITY
                                            : kind < 0.6 ? -size
                                                         : size);
      };
      estimator->update(any(), any());
      ASSERT_TRUE(is_finite(*estimator)) << likelihood << " " << k;
    }
  }
}

}  // namespace breakwater::axis_estimators_test
