// Counter-based Gaussian noise (Random123's Philox).
#pragma once

#include <cstdint>
#include <string_view>

namespace breakwater {

/// White Gaussian noise that is a pure function of (seed, channel, sample): it depends on no
/// thread, order of calls or case, so cases of one seed share it.
class Noise {
 public:
  /// `channel` names the stream, for example a sensor.
  Noise(std::uint64_t seed, std::string_view channel);

  /// The standard normal deviate of one sample.
  double operator()(std::uint64_t sample) const;

 private:
  std::uint64_t seed_;
  std::uint64_t stream_;
};

}  // namespace breakwater
