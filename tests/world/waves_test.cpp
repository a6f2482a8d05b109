// The sea: its spectrum, its realisations, and the laws of water.
#include <breakwater/world/waves.h>
#include "support.h"

namespace breakwater::waves_test {

SeaState sea(double height_m = 2.0, double period_s = 8.0) {
  SeaState s;
  s.significant_height_m = height_m;
  s.peak_period_s = period_s;
  s.heading_rad = 0.6;
  return s;
}

TEST(Jonswap, SignificantHeightIsFourTimesTheRootOfM0) {
  for (const double gamma : {1.0, 3.3, 7.0}) {
    SeaState s = sea();
    s.gamma = gamma;
    const JonswapSpectrum spectrum(s);
    double m0 = 0.0;  // midpoint rule with equal steps
    for (double w = 5e-4; w < 30.0; w += 1e-3) m0 += 1e-3 * spectrum.density(w);
    EXPECT_NEAR(4.0 * std::sqrt(m0), 2.0, 0.02) << gamma;
  }
}

// With γ = 1 it is the Pierson-Moskowitz spectrum, whose integral has a closed form:
// S = 5/16 H_s² ω_p⁴ ω⁻⁵ exp(−5/4 (ω_p/ω)⁴).
TEST(Jonswap, WithoutPeakEnhancementIsPiersonMoskowitz) {
  SeaState s = sea(3.0, 10.0);
  s.gamma = 1.0;
  const JonswapSpectrum spectrum(s);
  const double wp = 2.0 * std::numbers::pi / 10.0;
  for (const double w : {0.4, 0.63, 1.0, 2.0}) {
    const double closed = 5.0 / 16.0 * 9.0 * std::pow(wp, 4) * std::pow(w, -5) *
                          std::exp(-1.25 * std::pow(wp / w, 4));
    EXPECT_NEAR(spectrum.density(w), closed, 1e-6 * closed);
  }
}

TEST(Jonswap, PeaksAtThePeakPeriod) {
  for (const double period_s : {6.0, 8.0, 10.0}) {
    const JonswapSpectrum spectrum(sea(2.0, period_s));
    const double wp = 2.0 * std::numbers::pi / period_s;
    double best = 0.0, at = 0.0;
    for (double w = 0.2; w < 3.0; w += 1e-4) {
      if (spectrum.density(w) > best) {
        best = spectrum.density(w);
        at = w;
      }
    }
    EXPECT_NEAR(at, wp, 1e-3 * wp);
  }
}

// Compared with a sea's components: Σ g ω / Σ g, where g is the squared acceleration of a
// component.
TEST(Waves, AccelerationHasItsMeanFrequencyAboveThePeak) {
  for (const double depth : {0.0, 5.0, 10.0, 40.0}) {
    for (const double water : {0.0, 50.0}) {
      SeaState s = sea();
      s.water_depth_m = water;
      s.components = 1000;
      const Waves waves(s, 0.0);
      double moment = 0.0, area = 0.0;
      for (const Waves::Component& c : waves.components()) {
        const double k = c.wave_number_rad_m;
        const double decay = water > 0.0 ? std::sinh(k * (water - depth)) / std::sinh(k * water)
                                         : std::exp(-k * depth);
        const double g = std::pow(c.amplitude_m * c.omega_rad_s * c.omega_rad_s * decay, 2);
        moment += g * c.omega_rad_s;
        area += g;
      }
      EXPECT_NEAR(mean_acceleration_frequency(s, depth), moment / area, 2e-3 * moment / area);
    }
  }
  // It falls with depth, towards the peak frequency.
  EXPECT_GT(mean_acceleration_frequency(sea(), 0.0), mean_acceleration_frequency(sea(), 10.0));
  EXPECT_GT(mean_acceleration_frequency(sea(), 10.0), 2.0 * M_PI / sea().peak_period_s);
  EXPECT_REFUSED(mean_acceleration_frequency(sea(), -1.0));
}

TEST(Waves, AnHourHasTheSignificantHeight) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SeaState s = sea();
    s.seed = seed;
    const Waves waves(s, 0.0);
    double sum = 0.0;
    const int samples = 7200;
    for (int i = 0; i < samples; ++i) {
      const double eta = waves.elevation(0.5 * i, 0.0, 0.0);
      sum += eta * eta;
    }
    EXPECT_NEAR(4.0 * std::sqrt(sum / samples), 2.0, 0.1) << seed;
  }
}

// The Fourier transform of an hour, compared with the spectrum over bands.
TEST(Waves, SpectrumIsRecovered) {
  const SeaState s = sea();
  const Waves waves(s, 0.0);
  const JonswapSpectrum spectrum(s);
  const int samples = 7200;
  const double dt = 0.5, length_s = samples * dt;
  std::vector<double> eta(samples);
  for (int i = 0; i < samples; ++i) eta[i] = waves.elevation(dt * i, 0.0, 0.0);
  const double wp = spectrum.peak_rad_s();
  const double bounds[] = {0.5, 0.8125, 0.9375, 1.0625, 1.1875, 1.5, 2.0, 3.0};
  for (int b = 0; b + 1 < 8; ++b) {
    double energy = 0.0;
    const int from = static_cast<int>(std::ceil(bounds[b] * wp * length_s / (2 * M_PI)));
    const int to = static_cast<int>(std::ceil(bounds[b + 1] * wp * length_s / (2 * M_PI)));
    for (int k = from; k < to; ++k) {
      const std::complex<double> turn = std::polar(1.0, -2.0 * M_PI * k / samples);
      std::complex<double> sum = 0.0, phase = 1.0;
      for (int i = 0; i < samples; ++i, phase *= turn) sum += eta[i] * phase;
      energy += 2.0 * std::norm(sum / static_cast<double>(samples));
    }
    const double target = spectrum.variance(bounds[b] * wp, bounds[b + 1] * wp);
    // The bounds are those of the components' bands. The difference is the leakage of the
    // transform.
    EXPECT_NEAR(energy, target, 0.05 * target + 0.002) << bounds[b];
  }
}

// The motion of the water obeys its laws. It has no divergence, the surface moves with it, and the
// acceleration is the derivative of the velocity.
TEST(Waves, ObeyTheLawsOfWater) {
  for (const double depth_m : {0.0, 15.0}) {
    SeaState s = sea();
    s.water_depth_m = depth_m;
    const Waves waves(s, 0.0);
    testing::Random random;
    const double h = 1e-4;
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d p(random.uniform(-50, 50), random.uniform(-50, 50),
                              random.uniform(-14, -1));
      const double t = random.uniform(0, 100);
      double divergence = 0.0;
      Eigen::Matrix3d gradient;
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(axis);
        gradient.col(axis) = (waves.at(t, p + e).velocity - waves.at(t, p - e).velocity) / (2 * h);
        divergence += gradient(axis, axis);
      }
      EXPECT_NEAR(divergence, 0.0, 1e-8);
      EXPECT_NEAR((gradient - gradient.transpose()).norm(), 0.0, 1e-8);  // no vorticity
      const Eigen::Vector3d rate =
          (waves.at(t + h, p).velocity - waves.at(t - h, p).velocity) / (2 * h);
      EXPECT_NEAR((rate - waves.at(t, p).acceleration).norm(), 0.0, 1e-7);

      const Eigen::Vector3d surface(p.x(), p.y(), 0.0);
      const double rises =
          (waves.elevation(t + h, p.x(), p.y()) - waves.elevation(t - h, p.x(), p.y())) / (2 * h);
      EXPECT_NEAR(waves.at(t, surface).velocity.z(), rises, 1e-7);
      const double slope =
          (waves.elevation(t, p.x() + h, p.y()) - waves.elevation(t, p.x() - h, p.y())) / (2 * h);
      EXPECT_NEAR(waves.at(t, surface).slope.x(), slope, 1e-7);
      // Euler's equation: the pressure gradient accelerates the water.
      EXPECT_NEAR(-9.806 * waves.at(t, p).slope.x(), waves.at(t, p).acceleration.x(), 1e-9);
    }
  }
}

TEST(Waves, DecayWithDepth) {
  SeaState s = sea();
  s.components = 1;
  const Waves waves(s, 0.0);
  const double k = waves.components().front().wave_number_rad_m;
  for (const double z : {-1.0, -10.0, -30.0}) {
    const double ratio = waves.at(2.0, Eigen::Vector3d(0, 0, z)).velocity.norm() /
                         waves.at(2.0, Eigen::Vector3d::Zero()).velocity.norm();
    EXPECT_NEAR(ratio, std::exp(k * z), 1e-12);
  }
  // A sea of 8 s, integrated with NumPy from 0.5 to 3 ω_p, keeps 0.3973 of its speed at 10 m.
  const auto speed = [&](double depth_m) {
    const SampledSpectrum a = acceleration_spectrum(sea(), depth_m, 0.5, 3.0, 2000);
    double sum = 0.0;
    for (std::size_t i = 0; i < a.density.size(); ++i) {
      sum += a.density[i] / (a.omega_rad_s[i] * a.omega_rad_s[i]);
    }
    return std::sqrt(sum);
  };
  EXPECT_NEAR(speed(10.0) / speed(0.0), 0.3973, 5e-5);
}

TEST(Waves, DispersionHoldsInFiniteDepth) {
  for (const double depth_m : {0.5, 5.0, 50.0, 5000.0}) {
    for (const double omega : {0.3, 1.0, 3.0}) {
      const double k = wave_number(omega, depth_m, 9.806);
      EXPECT_NEAR(9.806 * k * std::tanh(k * depth_m), omega * omega, 1e-12 * omega * omega);
    }
  }
  // No vertical motion at the bottom.
  SeaState s = sea();
  s.water_depth_m = 15.0;
  EXPECT_NEAR(Waves(s, 0.0).at(1.0, Eigen::Vector3d(0, 0, -15)).velocity.z(), 0.0, 1e-14);
}

// The low-pass filtered slope equals a filter over the slope's samples.
TEST(Waves, LowPassOnTheSlope) {
  const double tau = 0.32, step = 1e-3;
  const Waves raw(sea(), 0.0);
  const Waves filtered(sea(), tau);
  const Eigen::Vector3d p(3.0, -2.0, -5.0);
  double value = filtered.at(0.0, p).slope.x();
  for (int i = 0; i < 5000; ++i) {
    value += -std::expm1(-step / tau) * (raw.at(step * (i + 0.5), p).slope.x() - value);
    if (i % 500 == 499) {
      EXPECT_NEAR(filtered.at(step * (i + 1), p).slope.x(), value, 1e-6);
    }
  }
}

TEST(Waves, StillWater) {
  const Waves waves(sea(0.0), 0.3);
  EXPECT_EQ(waves.elevation(1.0, 2.0, 3.0), 0.0);
  EXPECT_EQ(waves.at(1.0, Eigen::Vector3d(1, 2, -3)).velocity.norm(), 0.0);
}

TEST(Waves, RefuseNonsense) {
  EXPECT_REFUSED(Waves(sea(-1.0), 0.0));
  EXPECT_REFUSED(Waves(sea(1.0, 0.0), 0.0));
  EXPECT_REFUSED(Waves(sea(), -1.0));
  SeaState s = sea();
  s.gamma = 0.5;
  EXPECT_REFUSED(Waves(s, 0.0));
  s = sea();
  s.components = 0;
  EXPECT_REFUSED(Waves(s, 0.0));
}

}  // namespace breakwater::waves_test
