// Distributions and the indices of sensitivity.
#include <bit>

#include <breakwater/statistics/distribution.h>
#include <breakwater/statistics/sensitivity.h>
#include <breakwater/study/sampling.h>
#include "python.h"
#include "support.h"

namespace breakwater::sensitivity_test {

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
    for (const EstimatedValue& index : {indices.first_order[i], indices.total[i]}) {
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
      const auto holds = [&](const EstimatedValue& index) {
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
  f(5, 2) = kInfinity;
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

// Arguments up to both tails, as far as those of 2⁵² Sobol' points.
std::vector<double> arguments() {
  std::vector<double> all;
  for (int i = 1; i < 400; ++i) all.push_back(i / 400.0);
  for (int k = 9; k <= 53; ++k) {
    all.push_back(std::ldexp(1.0, -k));
    all.push_back(1.0 - std::ldexp(1.0, -k));
  }
  return all;
}

struct Named {
  DistributionKind kind;
  std::string name;
  double first, second;
};

TEST(Distribution, QuantilesMatchSciPy) {
  const std::vector<Named> distributions = {
      {DistributionKind::uniform, "uniform", 0.06, 0.12},
      {DistributionKind::uniform, "uniform", -3.0, 1e6},
      {DistributionKind::log_uniform, "log_uniform", 500.0, 5000.0},
      {DistributionKind::log_uniform, "log_uniform", 1e-9, 1e3},
      {DistributionKind::normal, "normal", 0.0, 1.0},
      {DistributionKind::normal, "normal", 12.0, 0.25}};
  const std::vector<double> u = arguments();
  std::ostringstream input;
  input.precision(17);
  for (const Named& one : distributions) {
    input << "quantile " << one.name << ' ' << one.first << ' ' << one.second << ' ' << u.size();
    for (const double share : u) input << ' ' << share;
    input << '\n';
  }
  const std::vector<double> scipy = testing::run_python("study/scipy_stats.py", input.str());
  ASSERT_EQ(scipy.size(), distributions.size() * u.size());
  std::size_t at = 0;
  for (const Named& one : distributions) {
    const Distribution distribution(one.kind, one.first, one.second);
    for (const double share : u) {
      const double truth = scipy[at++];
      const double scale = std::abs(one.kind == DistributionKind::log_uniform ? truth : one.first) +
                           std::abs(truth - one.first);
      EXPECT_NEAR(distribution.quantile(share), truth, 2e-15 * scale) << one.name << ' ' << share;
    }
  }
}

TEST(Distribution, ValuesStayWithinTheRange) {
  for (const DistributionKind kind : {DistributionKind::uniform, DistributionKind::log_uniform}) {
    for (const auto& [a, b] :
         {std::pair(0.1, 0.7), std::pair(3.0, 3.0000000000000004), std::pair(1e-300, 1e-3)}) {
      const Distribution distribution(kind, a, b);
      for (const double u : arguments()) {
        EXPECT_GE(distribution.quantile(u), a);
        EXPECT_LE(distribution.quantile(u), b);
      }
    }
  }
}

std::string reason(DistributionKind kind, double first, double second) {
  return complaint_of([&] { const Distribution made(kind, first, second); });
}

TEST(Distribution, RefusesInvalidArguments) {
  using enum DistributionKind;
  EXPECT_EQ(reason(uniform, 0.12, 0.06), "the range [0.12, 0.06] is upside down");
  EXPECT_EQ(reason(log_uniform, 2.0, 1.0), "the range [2, 1] is upside down");
  EXPECT_EQ(reason(uniform, 1.0, 1.0), "the range [1, 1] is empty");
  EXPECT_EQ(reason(log_uniform, 0.0, 1.0), "a logarithmic range must be positive, and begins at 0");
  EXPECT_EQ(reason(log_uniform, -1.0, 1.0),
            "a logarithmic range must be positive, and begins at -1");
  EXPECT_EQ(reason(normal, 1.0, 0.0), "the standard deviation must be positive, not 0");
  EXPECT_EQ(reason(normal, 1.0, -2.0), "the standard deviation must be positive, not -2");
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    for (const DistributionKind kind : {uniform, log_uniform, normal}) {
      EXPECT_EQ(reason(kind, bad, 1.0), "must be two finite numbers");
      EXPECT_EQ(reason(kind, 1.0, bad), "must be two finite numbers");
    }
  }
  EXPECT_EQ(reason(uniform, -1e308, 1e308), "the range [-1e+308, 1e+308] is too wide");
  EXPECT_EQ(reason(log_uniform, 1e-200, 1e200), "the range [1e-200, 1e+200] is too wide");
  const Distribution standard(normal, 0.0, 1.0);
  for (const double u : {0.0, 1.0, -0.1, kNaN}) {
    EXPECT_THROW(standard.quantile(u), std::invalid_argument) << u;
  }
}

// On every processor: a study identifies a point by the hash of its configuration.
TEST(Distribution, BitsAreTheSameEverywhere) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const DistributionKind kind :
       {DistributionKind::uniform, DistributionKind::log_uniform, DistributionKind::normal}) {
    const Distribution distribution(kind, 0.3, 7.0);
    for (const double u : arguments()) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(distribution.quantile(u))) * 1099511628211ULL;
    }
  }
  EXPECT_EQ(hash, 0x52fcba5fbe8d7c4cULL) << std::hex << hash;
}

}  // namespace breakwater::sensitivity_test
