// A realisation of a sea, and how the water below it moves.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/world/jonswap.h>

namespace breakwater {

/// The water at one point and time, in the world's axes (z up, the still surface at z = 0).
struct WaterMotion {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      ///< [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< ∂u/∂t [m/s²]
  /// Horizontal gradient of the waves' pressure head p/(ρ g), behind a first-order low-pass in
  /// time: near the surface the slope of the waves.
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
};

/// Linear (Airy) waves: N components of the spectrum over 0.5 … 3 ω_p,
///     η = Σ a_i cos(θ_i),  θ_i = k_i (x cos β + y sin β) − ω_i t + ε_i,
/// one in each of N equal bands, its frequency anywhere in the band so that the sea does not
/// repeat, a_i²/2 the band's share of m0; scaled together so that Σ a_i²/2 = H_s²/16. With h the
/// water's depth and ω² = g k tanh(k h),
///     u = Σ a ω cosh k(z+h)/sinh kh cos θ,  w = Σ a ω sinh k(z+h)/sinh kh sin θ,
/// which in deep water both decay as e^{kz}. Above z = 0 the water moves as at z = 0, below the
/// bottom as at the bottom.
class Waves {
 public:
  /// `slope_low_pass_s`: time constant of the low-pass on the slope. Throws std::invalid_argument
  /// as check(SeaState), or if the time constant is negative.
  Waves(const SeaState& sea, double slope_low_pass_s);

  /// η [m].
  double elevation(double time_s, double x_m, double y_m) const;
  WaterMotion at(double time_s, const Eigen::Ref<const Eigen::Vector3d>& position_m) const;

  struct Component {
    double amplitude_m;
    double omega_rad_s;
    double wave_number_rad_m;
    double phase_rad;
  };
  const std::vector<Component>& components() const { return components_; }
  /// Where they all run, a unit vector: (cos β, sin β).
  Eigen::Vector2d direction() const { return {cos_heading_, sin_heading_}; }

 private:
  double cos_heading_;
  double sin_heading_;
  double depth_m_;  // 0: deep
  double slope_low_pass_s_;
  std::vector<Component> components_;
};

/// A spectrum over a band: densities at equally spaced frequencies, each the middle of its
/// interval.
struct SampledSpectrum {
  std::vector<double> omega_rad_s;
  std::vector<double> density;
};

/// The spectrum of the water's vertical acceleration at a depth below the surface [(m/s²)² s/rad],
/// G = ω⁴ (sinh k(h−d)/sinh kh)² S, from `lowest` to `highest` times ω_p. Errors as
/// mean_acceleration_frequency().
SampledSpectrum acceleration_spectrum(const SeaState& sea, double depth_m, double lowest,
                                      double highest, int intervals);

/// The mean frequency of the water's vertical acceleration at a depth below the surface, over the
/// components' band [rad/s]: ∫ ω G dω / ∫ G dω of its spectrum G = ω⁴ (sinh k(h−d)/sinh kh)² S,
/// which at moderate depths lies above the waves' peak. Throws std::invalid_argument as
/// check(SeaState), or if the depth is negative.
double mean_acceleration_frequency(const SeaState& sea, double depth_m);

/// k of ω² = g k tanh(k h) [rad/m]; h = 0 stands for deep water.
double wave_number(double omega_rad_s, double water_depth_m, double gravity_m_s2);

}  // namespace breakwater
