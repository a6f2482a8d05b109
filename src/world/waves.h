// A sea state, a realisation of it, and the motion of the water below it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace breakwater {

/// A long-crested wind sea.
struct SeaState {
  double significant_height_m = 0.0;  ///< H_s, 0 or more
  double peak_period_s = 8.0;         ///< T_p
  double gamma = 3.3;                 ///< γ, peak enhancement, 1 or more
  double heading_rad = 0.0;           ///< direction of propagation, from x towards y
  double water_depth_m = 0.0;         ///< 0: deep water
  double gravity_m_s2 = 9.806;
  int components = 40;     ///< number of components of a realisation
  std::uint64_t seed = 1;  ///< seed of its phases and frequencies
};

/// Throws std::invalid_argument `KEY: reason` if a value is out of range.
void check(const SeaState& sea);

/// S(ω) = A ω⁻⁵ exp(−(5/4) (ω_p/ω)⁴) γ^exp(−(ω − ω_p)²/(2 σ² ω_p²)). σ is 0.07 up to ω_p and 0.09
/// above. A gives H_s = 4 √m0 with m0 = ∫ S dω over all ω.
///
/// Source: K. Hasselmann et al., Deutsche Hydrographische Zeitschrift A8 (1973) no. 12; the thesis'
/// [108].
class JonswapSpectrum {
 public:
  explicit JonswapSpectrum(const SeaState& sea);

  /// S(ω) [m² s/rad]; 0 for ω <= 0.
  double density(double omega_rad_s) const;
  /// ∫ S dω between two frequencies [m²].
  double variance(double from_rad_s, double to_rad_s) const;
  double peak_rad_s() const { return peak_rad_s_; }

 private:
  double peak_rad_s_;
  double gamma_;
  double scale_ = 1.0;  // A
};

/// The water at a point and time, in the world frame (z up, z = 0 at the still surface).
struct WaterMotion {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      ///< [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< ∂u/∂t [m/s²]
  /// Horizontal gradient of the waves' pressure head p/(ρ g), after a first-order low-pass in time.
  /// Near the surface it is the slope of the waves.
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
};

/// Linear (Airy) waves: N components of the spectrum over 0.5 … 3 ω_p,
///     η = Σ a_i cos(θ_i),  θ_i = k_i (x cos β + y sin β) − ω_i t + ε_i,
/// with one component in each of N equal bands. Its frequency is random within the band, so that
/// the sea does not repeat. a_i²/2 is the band's share of m0, scaled so that Σ a_i²/2 = H_s²/16.
/// With the water depth h and ω² = g k tanh(k h),
///     u = Σ a ω cosh k(z+h)/sinh kh cos θ,  w = Σ a ω sinh k(z+h)/sinh kh sin θ,
/// In deep water both decay as e^{kz}. Above z = 0 the motion is that at z = 0, and below the
/// bottom that at the bottom.
class Waves {
 public:
  /// `slope_low_pass_s`: time constant of the slope's low-pass. Throws std::invalid_argument as
  /// check(SeaState) does, or if the time constant is negative.
  Waves(const SeaState& sea, double slope_low_pass_s);

  /// The elevation η [m].
  double elevation(double time_s, double x_m, double y_m) const;
  WaterMotion at(double time_s, const Eigen::Ref<const Eigen::Vector3d>& position_m) const;

  struct Component {
    double amplitude_m;
    double omega_rad_s;
    double wave_number_rad_m;
    double phase_rad;
  };
  /// Waves with given components; `water_depth_m` is 0 in deep water.
  Waves(std::vector<Component> components, double heading_rad, double water_depth_m);

  /// Changes amplitude and phase of one component.
  void set(std::size_t component, double amplitude_m, double phase_rad) {
    components_[component].amplitude_m = amplitude_m;
    components_[component].phase_rad = phase_rad;
  }
  const std::vector<Component>& components() const { return components_; }
  /// Unit vector of the propagation: (cos β, sin β).
  Eigen::Vector2d direction() const { return {cos_heading_, sin_heading_}; }

 private:
  double cos_heading_;
  double sin_heading_;
  double depth_m_;  // 0: deep water
  double slope_low_pass_s_;
  std::vector<Component> components_;
};

/// Densities of a spectrum at equally spaced frequencies, each in the middle of its interval.
struct SampledSpectrum {
  std::vector<double> omega_rad_s;
  std::vector<double> density;
};

/// Spectrum G = ω⁴ (sinh k(h−d)/sinh kh)² S of the water's vertical acceleration at the depth d
/// [(m/s²)² s/rad]. The band is from `lowest` to `highest` times ω_p. Throws as
/// mean_acceleration_frequency() does.
SampledSpectrum acceleration_spectrum(const SeaState& sea, double depth_m, double lowest,
                                      double highest, int intervals);

/// The mean frequency ∫ ω G dω / ∫ G dω [rad/s] of this spectrum over the components' band. At
/// moderate depths it is above the waves' peak frequency. Throws std::invalid_argument as
/// check(SeaState) does, or if the depth is negative.
double mean_acceleration_frequency(const SeaState& sea, double depth_m);

/// The solution k of ω² = g k tanh(k h) [rad/m]; h = 0: deep water.
double wave_number(double omega_rad_s, double water_depth_m, double gravity_m_s2);

/// Waves whose peak period changes from one value to another. During the change the motions of both
/// seas are mixed.
class ChangingSea {
 public:
  struct Change {
    double at_s = 0.0;      ///< 0: never
    double period_s = 0.0;  ///< the new peak period
    double within_s = 0.0;  ///< duration of the change
  };

  /// Throws std::invalid_argument as Waves does.
  ChangingSea(const SeaState& sea, double slope_low_pass_s, const Change& change);

  WaterMotion water(double time_s, const Eigen::Vector3d& position) const;
  /// The elevation η at a position [m].
  double elevation(double time_s, double x_m, double y_m) const;

  const Waves& first() const { return first_; }
  /// The plane waves w(t) a cos(k_x x + k_y y − ω t + φ), whose sum is η. A row has a, k_x, k_y, ω
  /// and φ. It ends with the weight w before and after the change, and with the times of the
  /// change, during which w is linear.
  std::vector<std::array<double, 9>> plane_waves() const;

 private:
  // Share of the second sea at a time, 0 … 1.
  double changed(double time_s) const;

  Change change_;
  Waves first_;
  std::optional<Waves> second_;
};

}  // namespace breakwater
