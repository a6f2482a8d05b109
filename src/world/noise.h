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

  /// A deviate of one sample that is uniform in (0, 1), drawn from the same bits.
  double uniform(std::uint64_t sample) const;

  /// The random bits of one sample.
  struct Bits {
    std::uint64_t first, second;
  };
  Bits bits(std::uint64_t sample) const;

 private:
  std::uint64_t seed_;
  std::uint64_t stream_;
};

}  // namespace breakwater
