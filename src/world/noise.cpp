#include <breakwater/world/noise.h>

#include <Random123/philox.h>

#include <Random123/uniform.hpp>
#include <cmath>
#include <numbers>

#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

// FNV-1a gives the same stream on every machine, unlike std::hash.
std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const unsigned char c : text) hash = (hash ^ c) * 1099511628211ULL;
  return hash;
}

}  // namespace

Noise::Noise(std::uint64_t seed, std::string_view channel) : seed_(seed), stream_(fnv1a(channel)) {}

Noise::Bits Noise::bits(std::uint64_t sample) const {
  using Generator = r123::Philox2x64;
  const Generator::ctr_type counter = {{sample, stream_}};
  const Generator::key_type key = {{seed_}};
  const Generator::ctr_type drawn = Generator()(counter, key);
  return {drawn[0], drawn[1]};
}

double Noise::operator()(std::uint64_t sample) const {
  const Bits drawn = bits(sample);
  // Box–Muller transform; r123::boxmuller() uses the functions of <cmath>. u01 is never 0.
  const double radius = std::sqrt(-2.0 * math::log(r123::u01<double>(drawn.second)));
  return radius * math::sin(std::numbers::pi * r123::uneg11<double>(drawn.first));
}

double Noise::uniform(std::uint64_t sample) const {
  return r123::u01<double>(bits(sample).first);
}

}  // namespace breakwater
