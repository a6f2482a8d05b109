// The JONSWAP spectrum of a wind sea.
#pragma once

#include <cstdint>

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

}  // namespace breakwater
