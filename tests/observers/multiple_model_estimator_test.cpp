// QBANK: its likelihoods against quadrature, its models against linear theory, its weights against
// a second implementation, and its behaviour with a faulty sensor.
#include <breakwater/observers/multiple_model_estimator.h>

#include <Eigen/LU>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/observers/code_sensor.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/plants/damped_inertia.h>
#include "observers/motor_loop.h"
#include "support.h"

namespace breakwater::multiple_model_estimator_test {

using testing::MotorLoop;
using Kind = MultipleModelEstimator::Kind;

SensorError sensor(double quantum, double noise_std) {
  return {Eigen::VectorXd::Constant(1, quantum), Eigen::VectorXd::Constant(1, noise_std)};
}

MultipleModelDesign design(double quantum, double noise_std, double period_s = 1e-3,
                           double friction = 0.0) {
  return {damped_inertia(1.0, friction), period_s, sensor(quantum, noise_std), 10.0};
}

double quantum_of(int bits) {
  return 2.0 * std::numbers::pi / std::exp2(bits);
}

// ∫ z^power φ(z) e^{shift} dz by Simpson's rule.
long double integral(double alpha, double beta, int power, long double shift) {
  constexpr int kSteps = 20000;
  const long double h = (static_cast<long double>(beta) - alpha) / kSteps;
  long double sum = 0.0L;
  for (int i = 0; i <= kSteps; ++i) {
    const long double z = alpha + h * i;
    const long double weight = i == 0 || i == kSteps ? 1.0L : i % 2 == 1 ? 4.0L : 2.0L;
    sum += weight * std::pow(z, static_cast<long double>(power)) * std::exp(shift - z * z / 2.0L);
  }
  return sum * h / 3.0L / std::sqrt(2.0L * std::acos(-1.0L));
}

struct Bounds {
  double alpha, beta;
};

class Interval : public ::testing::TestWithParam<Bounds> {};

TEST_P(Interval, HasTheMomentsAndTheMassOfQuadrature) {
  const auto [alpha, beta] = GetParam();
  const double nearest = alpha > 0.0 ? alpha : beta < 0.0 ? beta : 0.0;
  const long double shift = 0.5L * nearest * nearest;
  const long double mass = integral(alpha, beta, 0, shift);
  const long double mean = integral(alpha, beta, 1, shift) / mass;
  const long double square = integral(alpha, beta, 2, shift) / mass;
  const CodeInterval interval(alpha, beta);
  EXPECT_NEAR(interval.log_mass(), static_cast<double>(std::log(mass) - shift), 1e-11);
  EXPECT_NEAR(interval.moments().mean, static_cast<double>(mean), 1e-11 * (1.0 + std::abs(alpha)));
  EXPECT_NEAR(interval.moments().variance / static_cast<double>(square - mean * mean), 1.0, 1e-7);
  const double inside = static_cast<double>(mass * std::exp(-shift));
  EXPECT_NEAR(interval.outside(), 1.0 - inside, 1e-14);
}

INSTANTIATE_TEST_SUITE_P(CodeInterval, Interval,
                         ::testing::Values(Bounds{-1, 1}, Bounds{-0.3, 4}, Bounds{-6, 0.1},
                                           Bounds{0, 2}, Bounds{1.5, 1.6}, Bounds{-1.6, -1.5},
                                           Bounds{4, 5}, Bounds{-9, -4}, Bounds{-5, 7}),
                         [](const auto& row) { return "n" + std::to_string(row.index); });

TEST(CodeInterval, FarTailsHaveAFiniteLogarithm) {
  // P(z > a) ≈ φ(a)/a.
  for (const double a : {50.0, 1e3, 1e6}) {
    const double expected = -0.5 * a * a - std::log(a) - 0.5 * std::log(2.0 * std::numbers::pi);
    EXPECT_NEAR(CodeInterval(a, 2.0 * a).log_mass() / expected, 1.0, 1e-6);
    EXPECT_EQ(CodeInterval(a, 2.0 * a).log_mass(), CodeInterval(-2.0 * a, -a).log_mass());
  }
  // The mass outside ±40 σ is not lost by rounding.
  EXPECT_NEAR(std::log(CodeInterval(-30.0, 30.0).outside()), -0.5 * 900.0 - std::log(30.0) - 0.2257,
              0.01);
}

// With white noise alone each model is a Kalman filter and QBANK is their Bayesian mixture, here
// with dense matrices, inverses and densities.
TEST(MultipleModelEstimator, IsTheMixtureOfTextbookFiltersBehindWhiteNoise) {
  constexpr double kPeriod = 1e-2, kNoise = 0.02, kFriction = 0.4;
  MultipleModelEstimator bank(design(0.0, kNoise, kPeriod, kFriction));
  const std::size_t n = bank.models().size();
  ASSERT_GT(n, 6u);
  const StateSpace plant = zero_order_hold(damped_inertia(1.0, kFriction), kPeriod);
  const double R = kNoise * kNoise + 4e-20;

  std::vector<Eigen::VectorXd> x(n, Eigen::VectorXd::Zero(4));
  std::vector<Eigen::MatrixXd> P;
  std::vector<double> log_weight(n, 0.0);
  for (const MultipleModelEstimator::Model& model : bank.models()) P.push_back(model.P);
  testing::Random random(11);
  double q = 0.0, v = 0.0;
  Eigen::VectorXd u = Eigen::VectorXd::Zero(1), y = u;
  for (int k = 0; k < 40; ++k) {
    y(0) = q + kNoise * random.uniform(-1.0, 1.0);
    if (k > 0) u(0) = random.uniform(-2.0, 2.0);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double sum = 0.0, largest = -1e300;
    for (std::size_t i = 0; i < n; ++i) {
      const MultipleModelEstimator::Model& model = bank.models()[i];
      Eigen::MatrixXd F = Eigen::MatrixXd::Identity(4, 4), Q = Eigen::MatrixXd::Zero(4, 4);
      F.topLeftCorner(2, 2) = plant.A;
      F.block(0, 2, 2, 1) = -plant.B;
      if (model.kind == Kind::inertia) F.block(0, 3, 2, 1) = plant.B * u(0);
      const double w = model.bandwidth_rad_s;
      if (model.kind == Kind::walk) Q(2, 2) = std::pow(w, 6) * kNoise * kNoise * kPeriod * kPeriod;
      if (model.kind == Kind::ramp) {
        F(2, 3) = kPeriod;
        Q(3, 3) = std::pow(w, 8) * kNoise * kNoise * kPeriod * kPeriod;
      }
      if (k > 0) {
        x[i] = F * x[i];
        x[i].head(2) += plant.B * u;
        P[i] = testing::congruence(F, P[i]) + Q;
      }
      const double S = P[i](0, 0) + R, e = y(0) - x[i](0);
      ASSERT_LT(std::abs(e), 4.0 * std::sqrt(S)) << "the test means to surprise nobody";
      log_weight[i] += -0.5 * (std::log(2.0 * std::numbers::pi * S) + e * e / S);
      const Eigen::VectorXd K = P[i].col(0) / S;
      x[i] += K * e;
      Eigen::MatrixXd C = Eigen::MatrixXd::Zero(1, 4);
      C(0) = 1.0;
      P[i] = (Eigen::MatrixXd::Identity(4, 4) - K * C) * P[i];
      largest = std::max(largest, log_weight[i]);
    }
    bank.update(u, y);
    for (std::size_t i = 0; i < n; ++i) {
      const MultipleModelEstimator::Model& model = bank.models()[i];
      EXPECT_LT((model.x - x[i]).norm(), 1e-9 * (1.0 + x[i].norm())) << k << " " << i;
      EXPECT_LT((model.P - P[i]).norm(), 1e-9 * (1.0 + P[i].norm())) << k << " " << i;
      EXPECT_NEAR(model.log_weight, log_weight[i] - largest, 1e-8);
      if (log_weight[i] - largest <= -3.0) continue;
      const double weight = std::exp(log_weight[i] - largest);
      const double gain = model.kind == Kind::inertia ? 1.0 + x[i](3) : 1.0;
      ASSERT_GT(gain, 0.5);
      mean += weight * Eigen::Vector3d(x[i](0), x[i](1), x[i](2) / gain);
      sum += weight;
    }
    mean /= sum;
    EXPECT_LT((bank.state() - mean.head(2)).norm(), 1e-9);
    EXPECT_NEAR(bank.disturbance()(0), mean(2), 1e-9);
    q += kPeriod * v;
    v += kPeriod * u(0);
  }
}

TEST(MultipleModelEstimator, ItsConstantModelEqualsTheKalmanFilter) {
  constexpr double kPeriod = 1e-2, kNoise = 0.01;
  MultipleModelEstimator bank(design(0.0, kNoise, kPeriod));
  const ExtendedPlant plant =
      extend_by_disturbance_model(zero_order_hold(damped_inertia(1.0, 0.0), kPeriod), 0, kPeriod);
  const double variance = kNoise * kNoise;
  Kfd plain({plant, Eigen::MatrixXd::Zero(3, 3),
             (variance + 4e-20) * Eigen::MatrixXd::Identity(1, 1),
             variance * Eigen::MatrixXd::Identity(3, 3)});
  testing::Random random(5);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(1), y = u;
  for (int k = 0; k < 500; ++k) {
    u(0) = random.uniform(-0.1, 0.1);
    y(0) = kNoise * random.uniform(-1.7, 1.7);
    bank.update(u, y);
    plain.update(u, y);
    const MultipleModelEstimator::Model& constant = bank.models()[0];
    ASSERT_EQ(constant.kind, Kind::constant);
    ASSERT_GT(constant.log_weight, -10.0) << "it must not have been seeded anew";
    EXPECT_LT((constant.x.head(3) - plain.extended_state()).norm(),
              1e-10 * (1.0 + plain.extended_state().norm()));
    EXPECT_LT((constant.P.topLeftCorner(3, 3) - plain.P()).norm(), 1e-10 * plain.P().norm());
  }
}

// For small T_s the poles of the steady filters lie on the circle of radius w. They are s⁶ = −w⁶
// and s⁸ = w⁸ in the left half plane (spectral factorisation).
TEST(MultipleModelEstimator, BandwidthsMatchTheRadiusOfThePoles) {
  constexpr double kPeriod = 1e-3, kNoise = 0.01;
  const MultipleModelEstimator bank(design(0.0, kNoise, kPeriod));
  for (const MultipleModelEstimator::Model& model : bank.models()) {
    if (model.bandwidth_rad_s < 1.0 || model.bandwidth_rad_s * kPeriod > 0.02) continue;
    const int order = model.kind == Kind::ramp ? 1 : 0;
    const ExtendedPlant plant = extend_by_disturbance_model(
        zero_order_hold(damped_inertia(1.0, 0.0), kPeriod), order, kPeriod);
    const Eigen::Index N = plant.states();
    Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(N, N);
    Q(N - 1, N - 1) = model.step_variance;
    const Eigen::MatrixXd A = plant.sampled.A, C = plant.sampled.C;
    const Eigen::MatrixXd R = kNoise * kNoise * Eigen::MatrixXd::Identity(1, 1);
    const Eigen::MatrixXd P = solve_dare(A.transpose(), C.transpose(), Q, R);
    const Eigen::MatrixXd K = A * testing::kalman_gain(P, C, R);
    for (const std::complex<double>& z : eigenvalues(A - K * C)) {
      EXPECT_NEAR(std::abs(std::log(z)) / kPeriod, model.bandwidth_rad_s,
                  0.05 * model.bandwidth_rad_s);
    }
  }
}

// A code gives only its interval. After one sample the position of the constant model has the mean
// and variance of the truncated prior, by quadrature.
TEST(MultipleModelEstimator, OneCodeUpdatesByBayesRule) {
  const double quantum = quantum_of(8);
  MultipleModelEstimator bank(design(quantum, 0.0));
  const double prior = bank.models()[0].P(0, 0);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(1), y = u;
  y(0) = quantum;  // one count from the predicted position
  bank.update(u, y);
  const double root = std::sqrt(prior + 4e-20);
  const double alpha = 0.5 * quantum / root, beta = 1.5 * quantum / root;
  const long double mass = integral(alpha, beta, 0, 0.0L);
  const long double mean = integral(alpha, beta, 1, 0.0L) / mass;
  const long double square = integral(alpha, beta, 2, 0.0L) / mass;
  const MultipleModelEstimator::Model& model = bank.models()[0];
  EXPECT_NEAR(model.x(0), root * static_cast<double>(mean), 1e-12);
  EXPECT_NEAR(model.P(0, 0), prior * static_cast<double>(square - mean * mean), 1e-9 * prior);
}

TEST(MultipleModelEstimator, AnUnchangedCodeInformsOnlyIfItCouldHaveChanged) {
  const double quantum = quantum_of(8);
  MultipleModelEstimator bank(design(quantum, 0.0));
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(1);
  bank.update(zero, zero);
  const Eigen::Matrix4d first = bank.models()[0].P;
  bank.update(zero, zero);
  // The velocity of the constant model is nearly zero, to ρ/s: the code cannot change within 1 ms.
  EXPECT_NEAR(bank.models()[0].P(0, 0), first(0, 0), 0.01 * first(0, 0));
  for (int k = 0; k < 5000; ++k) bank.update(zero, zero);
  // In 5 s it could change, so an unchanged code shows that the shaft does not move.
  EXPECT_LT(bank.models()[0].P(1, 1), 0.3 * (first(1, 1) + 25.0 * first(2, 2)));
  EXPECT_GT(bank.models()[0].P(0, 0), quantum * quantum / 100.0);
}

class Recovery : public ::testing::TestWithParam<double> {};

double share_of(const MultipleModelEstimator& bank, Kind kind) {
  double share = 0.0, sum = 0.0;
  for (const MultipleModelEstimator::Model& model : bank.models()) {
    sum += std::exp(model.log_weight);
    if (model.kind == kind) share += std::exp(model.log_weight);
  }
  return share / sum;
}

// The sensor fails between 4 and 4.5 s in three ways. From 7 s on the estimate is as good as
// before, at rates from 10 Hz to 10 kHz. All values stay finite.
TEST_P(Recovery, AfterNanAJumpAndASaturatedCode) {
  const double period = GetParam();
  const double quantum = quantum_of(12);
  const auto from = static_cast<int>(std::lround(4.0 / period));
  const auto to = static_cast<int>(std::lround(4.5 / period));
  const std::function<double(int, double)> failures[] = {
      [](int, double y) { return y; },
      [&](int k, double y) { return k >= from && k < to ? kNaN : y; },
      [&](int k, double y) { return k >= from ? y + 100.0 * quantum : y; },
      [&](int k, double y) { return k >= from && k < to ? 3.0 * quantum : y; }};
  double healthy = 0.0;
  for (int failure = 0; failure < 4; ++failure) {
    SCOPED_TRACE(failure);
    MultipleModelEstimator bank(design(quantum, 0.0, period));
    MotorLoop loop;
    loop.period_s = period;
    loop.encoder = {.quantum = quantum, .phase = 0.2 * quantum};
    loop.disturbance = {DisturbanceKind::step, 2.0, 0.0, 1.0};
    loop.from_s = 8.0;
    loop.spoil = failures[failure];
    double lowest_share = 1.0, share_before = 0.0, share_after = 0.0;
    loop.watch = [&](double t, double, double) {
      ASSERT_TRUE(bank.state().allFinite() && bank.disturbance().allFinite());
      double sum = 0.0;
      for (const double share : bank.signals()[1].values) sum += share;
      ASSERT_NEAR(sum, 1.0, 1e-12);
      const double known = share_of(bank, Kind::constant) + share_of(bank, Kind::inertia);
      if (t < 4.0) share_before = known;
      if (t >= 4.0 && t < 6.0) lowest_share = std::min(lowest_share, known);
      share_after = known;
    };
    const testing::MotorErrors errors = testing::run_motor(loop, bank);
    if (failure == 0) {
      healthy = errors.velocity;
      continue;
    }
    EXPECT_LT(errors.velocity, 10.0 * healthy + 2.0 * quantum);
    EXPECT_LT(errors.disturbance, 0.1);
    if (failure == 2) {
      // The probability of the constant model falls until the jump is over.
      EXPECT_LT(lowest_share, 0.5 * share_before);
      EXPECT_GT(share_after, 0.7 * share_before);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(MultipleModelEstimator, Recovery,
                         ::testing::Values(1e-1, 1e-2, 1e-3, 1e-4), [](const auto& row) {
                           return "T" + std::to_string(static_cast<int>(1e6 * row.param)) + "us";
                         });

// The encoder is the reference: its positions fill the range and have the stated error.
TEST(SensorError, CodesBoundThePosition) {
  for (const EncoderRounding rounding : {EncoderRounding::nearest, EncoderRounding::truncate}) {
    const Encoder encoder{.quantum = 0.2, .rounding = rounding};
    SensorError error = sensor(encoder.quantum, 0.03);
    error.rounding = rounding;
    testing::Random random(3);
    constexpr int kDraws = 20000;
    double squares = 0.0, lowest = 1.0, highest = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      const double q = random.uniform(-1.0, 1.0);
      const double y = encoder.measure(q);
      const CodeRange range = code_range(y, encoder.quantum, rounding);
      const double place = (q - y - range.lower) / range.width();
      lowest = std::min(lowest, place);
      highest = std::max(highest, place);
      squares += (y - q) * (y - q);
      EXPECT_EQ(code_range(y + 0.03, encoder.quantum, rounding).lower, range.lower);  // noise
    }
    EXPECT_GE(lowest, -1e-12);
    EXPECT_LT(lowest, 1e-3);
    EXPECT_LE(highest, 1.0 + 1e-12);
    EXPECT_GT(highest, 1.0 - 1e-3);
    EXPECT_NEAR(error.variance()(0), squares / kDraws + 0.03 * 0.03, 0.05 * error.variance()(0));
  }
}

// A truncating encoder, and QBANK with the right and the wrong rounding.
TEST(MultipleModelEstimator, NeedsTheTruncationOfTheEncoderAsAParameter) {
  const double quantum = quantum_of(8);
  const auto error = [&](EncoderRounding encoder, EncoderRounding told) {
    MultipleModelDesign known = design(quantum, 0.0);
    known.sensor.rounding = told;
    MultipleModelEstimator bank(known);
    std::vector<double> errors;
    for (const double phase : {-0.35, -0.1, 0.0, 0.15, 0.4}) {
      MotorLoop loop;
      loop.encoder = {.quantum = quantum, .phase = phase * quantum, .rounding = encoder};
      loop.disturbance = {DisturbanceKind::ramp, 1.0, 0.0, 1.0};
      errors.push_back(testing::run_motor(loop, bank).velocity);
    }
    return testing::median(errors);
  };
  const double told = error(EncoderRounding::truncate, EncoderRounding::truncate);
  EXPECT_LT(told, 0.5 * error(EncoderRounding::truncate, EncoderRounding::nearest));
  EXPECT_LT(told, 8.0 * error(EncoderRounding::nearest, EncoderRounding::nearest));
}

TEST(MultipleModelEstimator, RefusesAPlantThatIsNotAnAxis) {
  EXPECT_NO_THROW(MultipleModelEstimator(design(1e-3, 0.0)));
  MultipleModelDesign wrong = design(1e-3, 0.0);
  wrong.plant.A(1, 0) = -1.0;  // a spring
  EXPECT_THROW(MultipleModelEstimator{wrong}, std::invalid_argument);
  wrong = design(1e-3, 0.0);
  wrong.plant.C(0, 1) = 1.0;
  EXPECT_THROW(MultipleModelEstimator{wrong}, std::invalid_argument);
  wrong = design(1e-3, 0.0);
  wrong.largest_d = 0.0;
  EXPECT_THROW(MultipleModelEstimator{wrong}, std::invalid_argument);
  wrong.largest_d = kInfinity;
  EXPECT_THROW(MultipleModelEstimator{wrong}, std::invalid_argument);
  EXPECT_THROW(MultipleModelEstimator(design(-1.0, 0.0)), std::invalid_argument);
  EXPECT_THROW(MultipleModelEstimator(design(1e-3, 0.0, 0.0)), std::invalid_argument);
}

}  // namespace breakwater::multiple_model_estimator_test
