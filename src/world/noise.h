// Counter-based Gaussian noise (Random123's Philox).
#pragma once

#include <cstdint>
#include <string_view>

namespace breakwater {

/// White Gaussian noise as a pure function of seed, channel and sample. Threads, order of calls and
/// the case do not affect it, so cases with the same seed have the same noise.
class Noise {
 public:
  /// `channel` names the stream, for example a sensor.
  Noise(std::uint64_t seed, std::string_view channel);

  /// The standard normal number of one sample.
  double operator()(std::uint64_t sample) const;

  /// A number of one sample that is uniform in (0, 1), from the same bits.
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
