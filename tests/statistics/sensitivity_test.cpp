#include <breakwater/statistics/sensitivity.h>

#include <cmath>
#include <limits>
#include <numbers>

#include <breakwater/statistics/distribution.h>
#include <breakwater/study/sampling.h>
#include "support.h"

namespace breakwater::sensitivity_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

using Model = std::function<double(const Eigen::VectorXd& u)>;

// The outputs of a Saltelli design of n rows, n × (d + 2).
Eigen::MatrixXd outputs(const Model& model, std::uint64_t n, Eigen::Index d, std::uint64_t seed) {
  const auto design = make_sampler(SamplingMethod::saltelli, n, d, seed);
  Eigen::MatrixXd f(static_cast<Eigen::Index>(n), d + 2);
  for (std::uint64_t i = 0; i < design->size(); ++i) {
    f(i / (d + 2), i % (d + 2)) = model(design->point(i));
  }
  return f;
}

// y = sin x₁ + a sin² x₂ + b x₃⁴ sin x₁, xᵢ uniform in [−π, π], a = 7, b = 0.1 (T. Ishigami, T.
// Homma, ISUMA 1990).
double ishigami(const Eigen::VectorXd& u) {
  const Eigen::Array3d x = std::numbers::pi * (2.0 * u.array() - 1.0);
  return std::sin(x(0)) + 7.0 * std::pow(std::sin(x(1)), 2) +
         0.1 * std::pow(x(2), 4) * std::sin(x(0));
}

struct Shares {
  std::vector<double> first_order, total;
};

Shares of_ishigami() {
  const double a = 7.0, b = 0.1, pi4 = std::pow(std::numbers::pi, 4);
  const double V1 = 0.5 * std::pow(1.0 + b * pi4 / 5.0, 2), V2 = a * a / 8.0;
  const double V13 = b * b * pi4 * pi4 * (1.0 / 18.0 - 1.0 / 50.0);
  const double V = V1 + V2 + V13;
  return {{V1 / V, V2 / V, 0.0}, {(V1 + V13) / V, V2 / V, V13 / V}};
}

TEST(Sensitivity, IshigamisIndicesMatchTheClosedForm) {
  const Shares truth = of_ishigami();
  EXPECT_NEAR(truth.first_order[0], 0.3139, 5e-5);
  EXPECT_NEAR(truth.total[2], 0.2437, 5e-5);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SensitivityIndices indices =
        sensitivity_indices(outputs(ishigami, 8192, 3, seed), {.replicates = 0});
    EXPECT_EQ(indices.rows, 8192);
    EXPECT_EQ(indices.dropped_rows, 0);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(indices.first_order[i].value, truth.first_order[i], 0.01) << seed << ' ' << i;
      EXPECT_NEAR(indices.total[i].value, truth.total[i], 0.01) << seed << ' ' << i;
      EXPECT_FALSE(indices.total[i].interval);
    }
  }
}

// y = Σ aᵢ xᵢ of standard normal x: Sᵢ = Tᵢ = aᵢ²/Σ a².
const Eigen::Vector3d kGains(1.0, 2.0, 0.5);

TEST(Sensitivity, ForALinearModelFirstOrderEqualsTotal) {
  const Model linear = [](const Eigen::VectorXd& u) {
    return 1e4 + kGains.dot(u.unaryExpr(&normal_quantile));
  };
  const SensitivityIndices indices = sensitivity_indices(outputs(linear, 4096, 3, 1));
  for (int i = 0; i < 3; ++i) {
    const double truth = kGains(i) * kGains(i) / kGains.squaredNorm();
    EXPECT_NEAR(indices.first_order[i].value, truth, 0.01) << i;
    EXPECT_NEAR(indices.total[i].value, truth, 0.01) << i;
    for (const SensitivityIndex& index : {indices.first_order[i], indices.total[i]}) {
      ASSERT_TRUE(index.interval);
      EXPECT_LT(index.interval->lower, truth);
      EXPECT_GT(index.interval->upper, truth);
    }
  }
}

// Rows that are independent, as the bootstrap assumes.
Eigen::MatrixXd linear_outputs(testing::Random& random, Eigen::Index n) {
  Eigen::MatrixXd f(n, 5);
  for (Eigen::Index row = 0; row < n; ++row) {
    Eigen::Vector3d A, B;
    for (int i = 0; i < 3; ++i) {
      A(i) = normal_quantile(random.uniform(1e-15, 1.0));
      B(i) = normal_quantile(random.uniform(1e-15, 1.0));
    }
    f(row, 0) = kGains.dot(A);
    f(row, 4) = kGains.dot(B);
    for (int i = 0; i < 3; ++i) f(row, 1 + i) = f(row, 0) + kGains(i) * (B(i) - A(i));
  }
  return f;
}

// The estimators as written, on resampled rows.
TEST(Sensitivity, AReplicateIsTheEstimateFromResampledRows) {
  testing::Random random(3);
  constexpr Eigen::Index n = 20;
  const Eigen::MatrixXd f = linear_outputs(random, n).array() + 3.0;
  const SensitivityIndices one = sensitivity_indices(f, {.replicates = 1, .seed = 9});
  std::mt19937_64 draw(9);
  Eigen::MatrixXd drawn(n, 5);
  for (Eigen::Index j = 0; j < n; ++j) drawn.row(j) = f.row(draw() % n);
  const Eigen::ArrayXd A = drawn.col(0), B = drawn.col(4);
  const double mu = 0.5 * (A.mean() + B.mean());
  const double V = 0.5 * ((A - mu).square().mean() + (B - mu).square().mean());
  for (int i = 0; i < 3; ++i) {
    const Eigen::ArrayXd AB = drawn.col(1 + i);
    EXPECT_NEAR(one.first_order[i].interval->lower, ((B - mu) * (AB - A)).mean() / V, 1e-13);
    EXPECT_NEAR(one.total[i].interval->upper, 0.5 * (A - AB).square().mean() / V, 1e-13);
  }
}

TEST(Sensitivity, IntervalsHaveTheirNominalCoverage) {
  testing::Random random(5);
  constexpr int kTrials = 400;
  Eigen::Array3i first_order = Eigen::Array3i::Zero(), total = Eigen::Array3i::Zero();
  for (int trial = 0; trial < kTrials; ++trial) {
    const SensitivityIndices indices = sensitivity_indices(
        linear_outputs(random, 200),
        {.replicates = 300, .level = 0.9, .seed = static_cast<std::uint64_t>(trial)});
    for (int i = 0; i < 3; ++i) {
      const double truth = kGains(i) * kGains(i) / kGains.squaredNorm();
      const auto holds = [&](const SensitivityIndex& index) {
        return index.interval->lower <= truth && truth <= index.interval->upper;
      };
      first_order(i) += holds(indices.first_order[i]);
      total(i) += holds(indices.total[i]);
    }
  }
  // 90 % with a standard error of 1.5 %. Percentiles of few rows have a slightly lower coverage.
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(first_order(i), 0.9 * kTrials, 0.05 * kTrials) << i;
    EXPECT_NEAR(total(i), 0.9 * kTrials, 0.05 * kTrials) << i;
  }
}

// Failure where x₁ > 0.7 and x₂ > 0.6: p = 0.12, Vᵢ = p²(1 − pᵢ)/pᵢ, V = p(1 − p).
TEST(Sensitivity, ForFailuresUsesTheirIndicator) {
  const Model fails = [](const Eigen::VectorXd& u) { return u(0) > 0.7 && u(1) > 0.6 ? 1.0 : 0.0; };
  const SensitivityIndices indices = sensitivity_indices(outputs(fails, 8192, 3, 2));
  const double p = 0.12, V = p * (1.0 - p);
  const double S1 = p * p * (0.7 / 0.3) / V, S2 = p * p * (0.6 / 0.4) / V;
  EXPECT_NEAR(indices.first_order[0].value, S1, 0.02);
  EXPECT_NEAR(indices.first_order[1].value, S2, 0.02);
  EXPECT_NEAR(indices.total[0].value, 1.0 - S2, 0.02);
  EXPECT_NEAR(indices.total[1].value, 1.0 - S1, 0.02);
  EXPECT_EQ(indices.first_order[2].value, 0.0) << "x₃ has no effect at all";
  EXPECT_EQ(indices.total[2].value, 0.0);
}

TEST(Sensitivity, RowsWithAMissingOutputAreDropped) {
  Eigen::MatrixXd f = outputs(ishigami, 256, 3, 1);
  const Eigen::MatrixXd last = f.bottomRows(250);
  for (Eigen::Index column = 0; column < 5; ++column) f(column, column) = kNaN;
  f(5, 2) = std::numeric_limits<double>::infinity();
  const SensitivityIndices some = sensitivity_indices(f), whole = sensitivity_indices(last);
  EXPECT_EQ(some.rows, 250);
  EXPECT_EQ(some.dropped_rows, 6);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(some.first_order[i].value, whole.first_order[i].value);
    EXPECT_EQ(some.total[i].interval->upper, whole.total[i].interval->upper);
  }
}

TEST(Sensitivity, WithoutVarianceIsAbsent) {
  const auto is_absent = [](const Eigen::MatrixXd& f) {
    const SensitivityIndices indices = sensitivity_indices(f);
    return indices.first_order.empty() && indices.total.empty();
  };
  const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(100, 5);
  EXPECT_TRUE(is_absent(0.0 * ones)) << "no run failed";
  EXPECT_TRUE(is_absent(ones)) << "every run failed";
  EXPECT_TRUE(is_absent(0.1 * ones));
  EXPECT_TRUE(is_absent(kNaN * ones));
  EXPECT_TRUE(is_absent(Eigen::MatrixXd(0, 5)));
  EXPECT_TRUE(is_absent(Eigen::MatrixXd::Identity(1, 5)));
  testing::Random random;
  EXPECT_TRUE(is_absent(3.0 * ones + 1e-15 * random.matrix(100, 5))) << "rounding alone";
  EXPECT_FALSE(is_absent(3.0 * ones + 1e-9 * random.matrix(100, 5)));
}

// The single failed row is in two of three replicates. No interval is better than a wrong one.
TEST(Sensitivity, WithOneFailureHasNoInterval) {
  for (const double rest : {0.0, 0.1, 1.0 / 3.0, -7.7}) {
    Eigen::MatrixXd f = Eigen::MatrixXd::Constant(100, 5, rest);
    f(17, 0) = f(17, 2) = f(17, 3) = 1.0;
    const SensitivityIndices indices = sensitivity_indices(f);
    ASSERT_EQ(indices.total.size(), 3U);
    for (const auto& index : indices.total) {
      EXPECT_TRUE(std::isfinite(index.value));
      EXPECT_FALSE(index.interval) << rest;
    }
  }
}

TEST(Sensitivity, DoesNotDependOnTheUnit) {
  const Eigen::MatrixXd f = outputs(ishigami, 512, 3, 4);
  const SensitivityIndices plain = sensitivity_indices(f);
  for (const double unit : {1e-200, 1e-3, 1e250}) {
    const SensitivityIndices scaled = sensitivity_indices(unit * f);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(scaled.first_order[i].value, plain.first_order[i].value, 1e-13);
      EXPECT_NEAR(scaled.total[i].interval->lower, plain.total[i].interval->lower, 1e-13);
    }
  }
}

TEST(Sensitivity, RefusesInvalidArguments) {
  const Eigen::MatrixXd f = Eigen::MatrixXd::Random(8, 4);
  EXPECT_THROW(sensitivity_indices(f.leftCols(2)), std::invalid_argument);
  EXPECT_THROW(sensitivity_indices(f, {.replicates = -1}), std::invalid_argument);
  EXPECT_THROW(sensitivity_indices(f, {.level = 1.0}), std::invalid_argument);
  EXPECT_THROW(sensitivity_indices(f, {.level = kNaN}), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater::sensitivity_test
