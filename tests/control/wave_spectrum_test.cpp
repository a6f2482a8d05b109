// The spectral model of the wave force: its fit, bank, process and filter.
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <breakwater/control/quadrotor_estimator.h>
#include <breakwater/control/quadrotor_filters.h>
#include <breakwater/observers/resonator.h>
#include <breakwater/observers/wave_force_bank.h>
#include <breakwater/world/waves.h>
#include "support.h"

namespace breakwater::wave_spectrum_test {

constexpr double kPeriod_s = 0.01;
constexpr double kDepth_m = 10.0;
constexpr AxisNoise kVertical{.mass_kg = 1.38,
                              .position_std_m = 0.1,
                              .velocity_std_m_s = 2e-4,
                              .bias_std_N = 5e-4,
                              .period_s = kPeriod_s};

class Normal {
 public:
  explicit Normal(unsigned seed) : engine_(seed) {}
  double operator()() { return normal_(engine_); }
  Eigen::VectorXd vector(const Eigen::VectorXd& variances) {
    Eigen::VectorXd x(variances.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) x(i) = std::sqrt(variances(i)) * (*this)();
    return x;
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

// JONSWAP's formula times ω⁴ exp(−2 ω² d/g), not normalised.
double acceleration_density(double omega, double peak_period_s) {
  const double peak = 2.0 * M_PI / peak_period_s;
  const double width = (omega <= peak ? 0.07 : 0.09) * peak;
  const double bump = std::exp(-0.5 * std::pow((omega - peak) / width, 2.0));
  return std::exp(-1.25 * std::pow(peak / omega, 4.0)) * std::pow(3.3, bump) / omega *
         std::exp(-2.0 * omega * omega / 9.806 * kDepth_m);
}

// The spectrum of a force with this standard deviation on the vertical axis.
ForceSpectrum force_of(double peak_period_s, double std_N) {
  constexpr int kIntervals = 400;
  const double step = 5.0 * 2.0 * M_PI / peak_period_s / kIntervals;
  ForceSpectrum s;
  double variance = 0.0;
  for (int i = 0; i < kIntervals; ++i) {
    const double omega = step * (i + 0.5);
    s.omega_rad_s.push_back(omega);
    s.density.push_back(acceleration_density(omega, peak_period_s));
    s.noise.push_back(force_noise_density(kVertical, omega));
    variance += s.density.back() * step;
  }
  for (double& density : s.density) density *= std_N * std_N / variance;
  return s;
}

double distance_of(const ForceSpectrum& s, const ResonatorPair& pair) {
  double sum = 0.0;
  for (std::size_t i = 0; i < s.density.size(); ++i) {
    const double model = spectral_density(pair[0], s.omega_rad_s[i]) +
                         spectral_density(pair[1], s.omega_rad_s[i]) + s.noise[i];
    const double ratio = (s.density[i] + s.noise[i]) / model;
    sum += ratio - std::log(ratio) - 1.0;
  }
  return sum;
}

TEST(AccelerationSpectrum, IsTheJonswapSpectrumTimesTheDecay) {
  SeaState sea;
  sea.significant_height_m = 2.0;
  const SampledSpectrum s = acceleration_spectrum(sea, kDepth_m, 0.5, 3.0, 200);
  const double scale = s.density[100] / acceleration_density(s.omega_rad_s[100], 8.0);
  for (std::size_t i = 0; i < s.density.size(); ++i) {
    const double expected = scale * acceleration_density(s.omega_rad_s[i], 8.0);
    EXPECT_NEAR(s.density[i], expected, 1e-10 * expected + 1e-30);
  }
  // Its area is the variance of a realisation with many components.
  double area = 0.0, realised = 0.0;
  for (const double density : s.density) area += density * (s.omega_rad_s[1] - s.omega_rad_s[0]);
  sea.components = 1000;
  const Waves waves(sea, 0.3);
  for (const Waves::Component& c : waves.components()) {
    const double a =
        c.amplitude_m * c.omega_rad_s * c.omega_rad_s * std::exp(-c.wave_number_rad_m * kDepth_m);
    realised += 0.5 * a * a;
  }
  EXPECT_NEAR(area, realised, 0.02 * area);  // the band holds 99 % of the waves
}

// The area of the density is σ². Its shape is that of the sampled resonator.
TEST(ResonatorFit, DensityMatchesTheResonator) {
  const Resonator r{0.9, 0.1, 0.2};
  double area = 0.0;
  for (double w = 5e-4; w < 60.0; w += 1e-3) area += spectral_density(r, w) * 1e-3;
  EXPECT_NEAR(area, r.std * r.std, 1e-4 * r.std * r.std);
  const Eigen::Matrix2d step = resonator_step(r.omega_rad_s, r.damping, 1e-3);
  const double noise = resonator_noise(r.omega_rad_s, r.damping, r.std, 1e-3);
  for (const double w : {0.5, 0.9, 1.4}) {
    const Eigen::Matrix2cd z = std::polar(1.0, 1e-3 * w) * Eigen::Matrix2cd::Identity();
    const std::complex<double> gain = (z - step.cast<std::complex<double>>()).inverse()(0, 1);
    const double sampled = std::norm(gain) * noise * 1e-3 / M_PI;
    EXPECT_NEAR(spectral_density(r, w), sampled, 5e-3 * sampled);
  }
}

TEST(ResonatorFit, RecoversAKnownPair) {
  const ResonatorPair truth = {{{0.7, 0.05, 0.1}, {1.2, 0.15, 0.15}}};
  ForceSpectrum s;
  for (int i = 0; i < 3000; ++i) {
    const double w = 0.01 * (i + 0.5);  // covers the whole variance
    s.omega_rad_s.push_back(w);
    s.density.push_back(spectral_density(truth[0], w) + spectral_density(truth[1], w));
    s.noise.push_back(1e-6);
  }
  const ResonatorPair found = fit_resonators(s);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(found[i].omega_rad_s, truth[i].omega_rad_s, 1e-3 * truth[i].omega_rad_s);
    EXPECT_NEAR(found[i].damping, truth[i].damping, 1e-2 * truth[i].damping);
    EXPECT_NEAR(found[i].std, truth[i].std, 1e-2 * truth[i].std);
  }
}

// No neighbour is closer, by a separate distance. The best single resonator of a search over
// frequency and damping is not closer either. Before scaling, the pair has 0.90 to 1.05 of the
// force's variance, so scaling hardly changes the fit.
TEST(ResonatorFit, IsTheBestFitToTheForce) {
  for (const double period_s : {4.0, 6.0, 8.0, 10.0, 14.0}) {
    const ForceSpectrum s = force_of(period_s, 0.17);
    const ResonatorPair pair = fit_resonators(s);
    EXPECT_LT(pair[0].omega_rad_s, pair[1].omega_rad_s);
    EXPECT_NEAR(pair[0].std * pair[0].std + pair[1].std * pair[1].std, 0.17 * 0.17, 1e-9);
    const auto scaled = [&](ResonatorPair other, double scale) {
      for (Resonator& r : other) r.std *= scale;
      return other;
    };
    double scale = 1.0, best = distance_of(s, pair);
    for (double trial = 0.9; trial < 1.05; trial += 1e-4) {
      const double there = distance_of(s, scaled(pair, trial));
      if (there < best) best = there, scale = trial;
    }
    EXPECT_GT(scale, 0.90);
    EXPECT_LT(scale, 1.049);
    const ResonatorPair nearest = scaled(pair, scale);
    testing::Random random(3);
    for (int i = 0; i < 200; ++i) {
      ResonatorPair other = nearest;
      for (Resonator& r : other) {
        r.omega_rad_s *= 1.0 + random.uniform(-0.02, 0.02);
        r.damping *= 1.0 + random.uniform(-0.05, 0.05);
        r.std *= 1.0 + random.uniform(-0.02, 0.02);
      }
      EXPECT_GT(distance_of(s, other), best - 1e-4) << period_s;
    }
    double single = 1e300;
    for (double omega = 0.4; omega < 2.0; omega += 0.01) {
      for (double damping = 0.02; damping < 0.4; damping *= 1.1) {
        const Resonator half{omega, damping, 0.17 * std::sqrt(0.5)};
        single = std::min(single, distance_of(s, {half, half}));
      }
    }
    EXPECT_LT(distance_of(s, pair), 0.9 * single) << period_s;
  }
}

TEST(ResonatorFit, RandomWalkIsTheBestFit) {
  ForceSpectrum s = force_of(8.0, 0.17);
  const auto distance = [&](double std_N) {
    double sum = 0.0;
    for (std::size_t i = 0; i < s.density.size(); ++i) {
      const double w = s.omega_rad_s[i];
      const double ratio =
          (s.density[i] + s.noise[i]) / (std_N * std_N / (M_PI * kPeriod_s * w * w) + s.noise[i]);
      sum += ratio - std::log(ratio) - 1.0;
    }
    return sum;
  };
  const double walk = fit_walk(s, kPeriod_s);
  for (double factor = 0.2; factor < 5.0; factor *= 1.05) {
    EXPECT_GE(distance(factor * walk), distance(walk) - 1e-9) << factor;
  }
  for (std::size_t i = 0; i < s.density.size(); ++i) {
    const double w = s.omega_rad_s[i];
    s.density[i] = 4e-6 / (M_PI * kPeriod_s * w * w);
  }
  EXPECT_NEAR(fit_walk(s, kPeriod_s), 2e-3, 1e-8);
}

// White noise of the position, random walks of the velocity and of the force, as forces.
TEST(ResonatorFit, NoiseOfAnAxisIsTheSumOfItsParts) {
  const AxisNoise none{2.0, 0.0, 0.0, 0.0, 0.1};
  AxisNoise position = none, velocity = none, bias = none;
  position.position_std_m = 0.5;
  velocity.velocity_std_m_s = 0.3;
  bias.bias_std_N = 0.3;
  EXPECT_NEAR(force_noise_density(position, 3.0), 8.1 / M_PI, 1e-12);
  EXPECT_NEAR(force_noise_density(velocity, 3.0), 3.6 / M_PI, 1e-12);
  EXPECT_NEAR(force_noise_density(bias, 3.0), 0.1 / M_PI, 1e-12);
}

TEST(ResonatorFit, RefusesNonsense) {
  const ForceSpectrum good = force_of(8.0, 0.17);
  const auto refuses = [&](auto&& spoil) {
    ForceSpectrum s = good;
    spoil(s);
    EXPECT_REFUSED(fit_resonators(s));
  };
  refuses([](ForceSpectrum& s) { s = {}; });
  refuses([](ForceSpectrum& s) { s.noise[3] = 0.0; });
  refuses([](ForceSpectrum& s) { std::fill(s.density.begin(), s.density.end(), 0.0); });
  refuses([](ForceSpectrum& s) { s.density.pop_back(); });
  refuses([](ForceSpectrum& s) { s.noise.push_back(1.0); });
  refuses([](ForceSpectrum& s) { s.omega_rad_s[4] = s.omega_rad_s[3]; });
  refuses([](ForceSpectrum& s) {
    for (std::vector<double>* values : {&s.omega_rad_s, &s.density, &s.noise}) values->resize(5);
  });
  EXPECT_REFUSED(fit_walk(force_of(8.0, 0.17), 0.0));
}

// An axis under the force of a resonator pair, held in place by a known force.
class Axis {
 public:
  Axis(const ResonatorPair& pair, unsigned seed) : pair_(pair), normal_(seed) {}

  void run(WaveForceBank& bank, double strength, double duration_s) {
    for (int k = 0; k < duration_s / kPeriod_s; ++k) {
      const double hold = -1.0 * p_ - 1.5 * v_;
      double force = 0.0;
      for (std::size_t i = 0; i < 2; ++i) {
        const Resonator& r = pair_[i];
        x_[i] = resonator_step(r.omega_rad_s, r.damping, kPeriod_s) * x_[i];
        x_[i](1) +=
            std::sqrt(resonator_noise(r.omega_rad_s, r.damping, strength * r.std, kPeriod_s)) *
            normal_();
        force += x_[i](0);
      }
      p_ += kPeriod_s * v_;
      v_ += kPeriod_s / kVertical.mass_kg * (force + hold);
      bank.update(hold, p_ + kVertical.position_std_m * normal_());
    }
  }

 private:
  ResonatorPair pair_;
  Normal normal_;
  std::array<Eigen::Vector2d, 2> x_ = {Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  double p_ = 0.0, v_ = 0.0;
};

WaveForceBankDesign bank_of(std::initializer_list<double> periods_s) {
  WaveForceBankDesign design;
  for (const double period_s : periods_s) {
    ResonatorPair pair = fit_resonators(force_of(period_s, 0.17));
    for (Resonator& r : pair) r.std /= 0.17;
    design.shapes.push_back(pair);
  }
  design.mass_kg = kVertical.mass_kg;
  design.position_std_m = kVertical.position_std_m;
  return design;
}

// 60 s of a sea with a period of 8 s have about ten waves. The strength itself varies by a quarter.
TEST(WaveForceBank, FindsTheStrength) {
  const WaveForceBankDesign design = bank_of({8.0});
  for (const double strength : {0.06, 0.2, 0.6}) {
    WaveForceBank bank(design);
    EXPECT_NEAR(total_std(bank.resonators()), std::sqrt(0.03), 1e-9);  // no measurement yet
    double log_ratio = 0.0;
    Axis axis(design.shapes[0], 5);
    axis.run(bank, strength, 100.0);
    for (int i = 0; i < 10; ++i) {
      axis.run(bank, strength, 60.0);
      log_ratio += 0.1 * std::log(total_std(bank.resonators()) / strength);
    }
    EXPECT_NEAR(log_ratio, 0.0, 0.2) << strength;
    axis.run(bank, 2.0 * strength, 300.0);
    EXPECT_GT(total_std(bank.resonators()), 1.4 * strength) << strength;
  }
}

TEST(WaveForceBank, FindsThePeriod) {
  const WaveForceBankDesign design = bank_of({5.0, 8.0, 12.0});
  for (const ResonatorPair& truth : design.shapes) {
    WaveForceBank bank(design);
    Axis(truth, 7).run(bank, 0.25, 200.0);
    EXPECT_NEAR(mean_frequency(bank.resonators()), mean_frequency(truth),
                0.1 * mean_frequency(truth));
  }
}

// Two equal resonators of half the variance are one. The likelihood of a noisy sine over a minute
// is flat, and its mean is up to 17 % too long. The right one of two candidates has all the
// likelihood.
TEST(WaveForceBank, FindsThePeriodOfASine) {
  const auto found = [](const std::vector<double>& candidates_s, double period_s, double noise_m) {
    WaveForceBankDesign design{.mass_kg = 1.38,
                               .bias_std_N = 2e-3,
                               .velocity_std_m_s = 3e-3,
                               .weakest_N = 0.3,
                               .strengths = 1};
    for (const double candidate_s : candidates_s) {
      const Resonator half{2.0 * M_PI / candidate_s, 0.15, std::sqrt(0.5)};
      design.shapes.push_back({half, half});
    }
    WaveForceBank bank(design);
    testing::Random random(3);
    double p = 0.0, v = 0.0;
    for (int k = 0; k < 12000; ++k) {
      const double force = 0.3 * std::sin(2.0 * M_PI / period_s * kPeriod_s * k);
      const double hold = -1.0 * p - 1.5 * v;  // a known force against drift
      bank.update(hold, p + noise_m * random.uniform(-1, 1));
      p += kPeriod_s * v;
      v += kPeriod_s / 1.38 * (force + hold);
    }
    return 2.0 * M_PI / mean_frequency(bank.resonators());
  };
  for (const double period_s : {6.0, 8.0, 11.0}) {
    EXPECT_NEAR(found(candidate_periods(), period_s, 0.17), period_s, 0.2 * period_s);
  }
  for (const double period_s : {5.0, 12.0}) {
    EXPECT_NEAR(found({5.0, 12.0}, period_s, 0.0), period_s, 1e-3 * period_s);
  }
}

// Derivatives of ψ̇ = (q sin φ + r cos φ)/cos θ and the other angles, by differences. A rotation
// matrix moves with body rates under torques and drag.
TEST(QuadrotorModel, RigidAccelerationMatchesTheBody) {
  const QuadrotorModel model({}, QuadrotorPhysics::physical);
  const QuadrotorParameters& p = model.parameters();
  testing::Random random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Vector3d angles = random.vector(3, 1.0);
    const Eigen::Vector3d omega = random.vector(3, 1.0);
    const Eigen::Vector4d U = random.vector(4, 2.0);
    const Eigen::Matrix3d R = (Eigen::AngleAxisd(angles(2), Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(angles(1), Eigen::Vector3d::UnitY()) *
                               Eigen::AngleAxisd(angles(0), Eigen::Vector3d::UnitX()))
                                  .toRotationMatrix();
    Vector6d rates = Vector6d::Zero();
    rates.tail<3>() = omega;
    const Eigen::Vector3d turning =
        (U.tail<3>() - p.drag(rates).tail<3>() - omega.cross(p.inertia_kgm2.cwiseProduct(omega)))
            .cwiseQuotient(p.inertia_kgm2);
    const auto rates_after = [&](double h) {
      const Eigen::Vector3d half = omega + 0.5 * h * turning;
      const Eigen::Matrix3d turned =
          R * Eigen::AngleAxisd(h * half.norm(), half.normalized()).toRotationMatrix();
      const Eigen::Vector3d there(std::atan2(turned(2, 1), turned(2, 2)), std::asin(-turned(2, 0)),
                                  std::atan2(turned(1, 0), turned(0, 0)));
      return attitude_rates(AttitudeTrig(there), omega + h * turning);
    };
    constexpr double kStep_s = 1e-4;
    const Eigen::Vector3d expected =
        (rates_after(kStep_s) - rates_after(-kStep_s)) / (2.0 * kStep_s);
    Vector6d velocity;
    velocity << random.vector(3, 1.0), attitude_rates(AttitudeTrig(angles), omega);
    const Vector6d a = model.rigid_acceleration(AttitudeTrig(angles), velocity, U);
    EXPECT_LT((a.tail<3>() - expected).norm(), 1e-5);
    const Vector6d level = model.acceleration(AttitudeTrig(angles), velocity, U);
    EXPECT_EQ(a.head<3>(), level.head<3>());
  }
}

using Waves2 = WaveForces<2, 2>;
constexpr ResonatorPair kSea = {{{0.81, 0.03, 0.11}, {1.13, 0.09, 0.07}}};

// The model is linear without thrust, drag and gyroscopic terms.
QuadrotorModel linear_vehicle() {
  QuadrotorParameters p;
  p.linear_drag.setZero();
  p.quadratic_drag.setZero();
  p.inertia_kgm2.setConstant(0.85);
  return {p, QuadrotorPhysics::physical};
}

template <typename Process>
NonlinearKalmanDesign<Process::kStates, 6> design_of(const Process& process) {
  NonlinearKalmanDesign<Process::kStates, 6> design;
  design.Q = process.Q();
  design.R = (Vector6d() << 1e-2, 1e-2, 1e-2, 1e-4, 1e-4, 1e-4).finished().asDiagonal();
  Eigen::VectorXd p = Eigen::VectorXd::Constant(Process::kStates, 1e-2);
  p.segment<3>(3).setConstant(1e-4);
  p.segment<6>(6) << 2e-3, 2e-3, 2e-3, 4e-4, 4e-4, 4e-4;
  p.segment<3>(Process::kTorque).setConstant(1e-5);
  design.P0 = p.asDiagonal();
  return design;
}

// The solution of V = Φ V Φᵀ + Q has the variances of the pair, with the sum of the force's
// spectrum. The spectrum of the sampled process has the force's distribution over frequency within
// 0.12.
TEST(WaveForces, HasTheForcesVarianceAndSpectrum) {
  for (const double period_s : {6.0, 8.0, 10.0}) {
    const ForceSpectrum s = force_of(period_s, 0.24);
    const Waves2 process(QuadrotorModel({}, QuadrotorPhysics::physical), {}, fit_resonators(s),
                         kHorizontalShare, kPeriod_s, AttitudeKinematics::exact);
    for (const int axis : {0, 2}) {
      const int rows[] = {Waves2::force_row(0) + axis, Waves2::rate_row(0) + axis,
                          Waves2::force_row(1) + axis, Waves2::rate_row(1) + axis};
      Eigen::Matrix4d phi, Q;
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
          phi(i, j) = process.linear()(rows[i], rows[j]);
          Q(i, j) = process.Q()(rows[i], rows[j]);
        }
      }
      Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(16, 16);  // less the Kronecker product
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) rest.block<4, 4>(4 * i, 4 * j) -= phi(i, j) * phi;
      }
      const Eigen::VectorXd v = rest.lu().solve(Eigen::VectorXd(Q.reshaped()));
      const Eigen::Map<const Eigen::Matrix4d> V(v.data());
      const double variance = V(0, 0) + V(2, 2) + 2.0 * V(0, 2);
      const double expected = 0.24 * 0.24 * (axis == 2 ? 1.0 : kHorizontalShare);
      EXPECT_NEAR(variance, expected, 0.01 * expected);
      if (axis == 0) continue;
      const double step = s.omega_rad_s[1] - s.omega_rad_s[0];
      const Eigen::RowVector4cd force = Eigen::RowVector4cd(1.0, 0.0, 1.0, 0.0);
      double own = 0.0, models = 0.0, largest = 0.0;
      for (std::size_t i = 0; i < s.density.size(); ++i) {
        const Eigen::Matrix4cd z =
            std::polar(1.0, kPeriod_s * s.omega_rad_s[i]) * Eigen::Matrix4cd::Identity();
        const Eigen::RowVector4cd gain = force * (z - phi.cast<std::complex<double>>()).inverse();
        const double density = (gain.cwiseAbs2() * Q.diagonal()).value() * kPeriod_s / M_PI;
        own += s.density[i] * step / expected;
        models += density * step / expected;
        largest = std::max(largest, std::abs(own - models));
      }
      EXPECT_LT(largest, 0.12) << period_s;
    }
  }
}

// One sample of constant acceleration, which is exact at rest for position, velocity and angles.
TEST(WaveForces, StepsAsUnderConstantAcceleration) {
  const QuadrotorModel model = linear_vehicle();
  const Waves2 process(model, {}, kSea, 1.0, kPeriod_s, AttitudeKinematics::exact);
  testing::Random random(4);
  Eigen::Matrix<double, 30, 1> x = random.vector(30, 0.3);
  x.segment<3>(3).setZero();
  x.segment<3>(9).setZero();
  Eigen::Matrix<double, 12, 1> g;
  process.nonlinear(x, Eigen::Vector4d::Zero(), g);
  Eigen::Matrix<double, 30, 1> next = process.linear() * x;
  next.head<12>() += g;
  Vector6d a;
  a << (x.segment<3>(12) + x.segment<3>(15) + x.segment<3>(24)) / model.parameters().mass_kg,
      x.segment<3>(18) / 0.85;
  a(2) -= model.parameters().net_weight_N() / model.parameters().mass_kg;
  const Vector6d v = x.segment<6>(6);
  EXPECT_LT((next.segment<6>(6) - v - kPeriod_s * a).norm(), 1e-14);
  EXPECT_LT((next.head<6>() - x.head<6>() - kPeriod_s * v - 5e-5 * a).norm(), 1e-14);
}

// The textbook filter: P = A P Aᵀ + Q, K = P Cᵀ (C P Cᵀ + R)⁻¹, Joseph's form.
TEST(WaveForces, UkfIsTheKalmanFilterOfALinearVehicle) {
  const QuadrotorModel model = linear_vehicle();
  const Waves2 process(model, {}, kSea, kHorizontalShare, kPeriod_s, AttitudeKinematics::level);
  const auto design = design_of(process);
  Ukf<Waves2, 6> ukf(process, design);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(30);
  // Matrices of any size compile sooner: their kernels exist.
  const Eigen::MatrixXd A = process.linear(), Q = design.Q, R = design.R;
  Eigen::MatrixXd P = design.P0, C = Eigen::MatrixXd::Zero(6, 30);
  C.leftCols<6>().setIdentity();
  const double fall = -model.parameters().net_weight_N() / model.parameters().mass_kg;
  testing::Random random(6);
  for (int k = 0; k < 1000; ++k) {
    const Vector6d y = design.R.diagonal().cwiseSqrt().cwiseProduct(random.vector(6));
    ukf.predict(Eigen::Vector4d::Zero());
    ukf.correct(y);
    x = A * x;
    x(2) += 0.5 * kPeriod_s * kPeriod_s * fall;
    x(8) += kPeriod_s * fall;
    P = testing::congruence(A, P) + Q;
    const Eigen::MatrixXd K = testing::kalman_gain(P, C, R);
    const Eigen::MatrixXd keep = Eigen::MatrixXd::Identity(30, 30) - K * C;
    x += K * (y - C * x);
    P = testing::congruence(keep, P) + testing::congruence(K, R);
    ASSERT_LT((ukf.x() - x).cwiseAbs().maxCoeff(), 1e-10) << k;
    ASSERT_LT((ukf.P() - P).cwiseAbs().maxCoeff(), 1e-10) << k;
  }
}

// If the true process is the model, (x − x̂)ᵀ P⁻¹ (x − x̂) of all 30 states is χ² with 30 degrees
// of freedom.
TEST(WaveForces, NeesIsInItsBandWithATrueModel) {
  const QuadrotorModel model({}, QuadrotorPhysics::physical);
  ProcessNoiseStd process_noise{.velocity_std_m_s = 2e-4, .rate_std_rad_s = 1e-4};
  const Waves2 process(model, process_noise, kSea, kHorizontalShare, kPeriod_s,
                       AttitudeKinematics::exact);
  const auto design = design_of(process);
  constexpr int kRuns = 60;
  double nees = 0.0;
  Normal normal(9);
  for (int run = 0; run < kRuns; ++run) {
    Ukf<Waves2, 6> ukf(process, design);
    Eigen::Matrix<double, 30, 1> x = normal.vector(design.P0.diagonal());
    for (int k = 0; k < 300; ++k) {
      Eigen::Vector4d T = Eigen::Vector4d::Constant(0.25 * model.parameters().net_weight_N());
      T += 0.1 * Eigen::Vector4d(normal(), normal(), normal(), normal());
      Eigen::Matrix<double, 12, 1> g;
      process.nonlinear(x, T, g);
      x = (process.linear() * x + normal.vector(design.Q.diagonal())).eval();
      x.head<12>() += g;
      ukf.predict(T);
      ukf.correct(x.head<6>() + normal.vector(design.R.diagonal()));
    }
    nees += (x - ukf.x()).dot(ukf.P().llt().solve(x - ukf.x())) / kRuns;
  }
  EXPECT_NEAR(nees, 30.0, 1.96 * std::sqrt(2.0 * 30.0 / kRuns));
}

TEST(WaveForceBank, DoesNotDependOnWhereTheAxisStarts) {
  const WaveForceBankDesign design{.shapes = {kSea}, .settling_s = 1.0};
  WaveForceBank here(design), there(design);
  const double first = total_std(here.resonators());
  there.reset(50.0);
  for (int k = 0; k < 500; ++k) {
    const double p = 1e-3 * std::sin(0.02 * k);
    here.update(0.0, p);
    there.update(0.0, 50.0 + p);
  }
  EXPECT_NEAR(total_std(there.resonators()), total_std(here.resonators()), 1e-6);
  EXPECT_NE(total_std(here.resonators()), first);
}

TEST(WaveForceBank, RefusesNonsense) {
  EXPECT_REFUSED(WaveForceBank({}));
  const WaveForceBankDesign good{.shapes = {kSea}};
  EXPECT_NO_THROW(WaveForceBank{good});
  using D = WaveForceBankDesign;
  for (double D::*positive : {&D::mass_kg, &D::bias_std_N, &D::velocity_std_m_s, &D::position_std_m,
                              &D::weakest_N, &D::memory_s, &D::period_s}) {
    D wrong = good;
    wrong.*positive = 0.0;
    EXPECT_EQ(complaint_of([&] { WaveForceBank{wrong}; }),
              "wave force bank: every value must be positive");
  }
  D wrong = good;
  wrong.strongest_N = wrong.weakest_N;
  EXPECT_REFUSED(WaveForceBank{wrong});
  wrong.strengths = 1;
  EXPECT_NO_THROW(WaveForceBank{wrong});
}

TEST(WaveForces, RefuseNonsense) {
  const QuadrotorModel model({}, QuadrotorPhysics::physical);
  const auto make = [&](const ResonatorPair& pair, double share) {
    return Waves2(model, {}, pair, share, kPeriod_s, AttitudeKinematics::exact);
  };
  ResonatorPair pair = kSea;
  pair[1].damping = 1.0;
  EXPECT_REFUSED(make(pair, 1.0));
  EXPECT_REFUSED(make(kSea, 0.0));
  Waves2 process = make(kSea, 1.0);
  EXPECT_REFUSED(process.set_torque_noise(0.0));
  QuadrotorEstimatorDesign design;
  design.order = DisturbanceOrder::spectrum;
  EXPECT_REFUSED(make_quadrotor_estimator(design, model));  // no sea
  design.waves.shapes = {kSea};
  EXPECT_NO_THROW(make_quadrotor_estimator(design, model));
  design.filter = QuadrotorFilter::ekf;
  EXPECT_REFUSED(make_quadrotor_estimator(design, model));
}

}  // namespace breakwater::wave_spectrum_test
