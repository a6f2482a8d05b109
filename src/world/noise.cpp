#include "world/noise.h"

#include <Random123/philox.h>

#include <Random123/boxmuller.hpp>

namespace breakwater {
namespace {

// FNV-1a: std::hash promises no value, and a stream must be the same on every machine.
std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const unsigned char c : text) hash = (hash ^ c) * 1099511628211ULL;
  return hash;
}

}  // namespace

Noise::Noise(std::uint64_t seed, std::string_view channel) : seed_(seed), stream_(fnv1a(channel)) {}

double Noise::operator()(std::uint64_t sample) const {
  using Generator = r123::Philox2x64;
  const Generator::ctr_type counter = {{sample, stream_}};
  const Generator::key_type key = {{seed_}};
  const Generator::ctr_type bits = Generator()(counter, key);
  return r123::boxmuller(bits[0], bits[1]).x;
}

}  // namespace breakwater
