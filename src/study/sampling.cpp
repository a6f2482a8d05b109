#include <breakwater/study/sampling.h>

#include <fmt/format.h>

#include <array>
#include <bit>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <stdexcept>
#include <string>

#include <breakwater/world/noise.h>

namespace breakwater {
namespace {

constexpr int kMostPointsLog2 = 40;
constexpr std::uint64_t kMostPoints = std::uint64_t{1} << kMostPointsLog2;

// The middle of one of 2⁵² equal intervals of (0, 1): exact, and never 0 or 1.
double open_unit(std::uint64_t bits) {
  return std::ldexp(static_cast<double>(bits >> 12) + 0.5, -52);
}

// Random bits for each coordinate.
std::vector<Noise> streams(std::uint64_t seed, const std::string& name, Eigen::Index d) {
  std::vector<Noise> all;
  for (Eigen::Index j = 0; j < d; ++j) all.emplace_back(seed, name + " " + std::to_string(j));
  return all;
}

// A random permutation of 0 … n − 1 without a table. A Feistel network permutes the least 4ʰ ≥ n
// numbers. It is applied again while the result is n or more. With 16 numbers or more it makes only
// even permutations, so a random bit also decides whether 0 and 1 are swapped.
//
// Sources: M. Luby, C. Rackoff, SIAM J. Comput. 17 (1988) 373–386; J. Black, P. Rogaway, Ciphers
// with arbitrary finite domains, CT-RSA 2002.
class Permutation {
 public:
  Permutation(std::uint64_t n, const Noise& keys)
      : n_(n),
        half_bits_((static_cast<int>(std::bit_width(n - 1)) + 1) / 2),
        half_((std::uint64_t{1} << half_bits_) - 1) {
    for (std::size_t round = 0; round < keys_.size(); ++round) {
      keys_[round] = keys.bits(round).first;
    }
    swap_ = n > 1 ? keys.bits(keys_.size()).first >> 63 : 0;
  }

  std::uint64_t operator()(std::uint64_t i) const {
    do {
      std::uint64_t left = i >> half_bits_, right = i & half_;
      for (const std::uint64_t key : keys_) {
        left ^= mixed(right ^ key) & half_;
        std::swap(left, right);
      }
      i = left << half_bits_ | right;
    } while (i >= n_);
    return i < 2 ? i ^ swap_ : i;
  }

 private:
  // SplitMix64's output function: G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014.
  static std::uint64_t mixed(std::uint64_t bits) {
    bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9ULL;
    bits = (bits ^ bits >> 27) * 0x94d049bb133111ebULL;
    return bits ^ bits >> 31;
  }

  std::uint64_t n_;
  int half_bits_;
  std::uint64_t half_;
  std::array<std::uint64_t, 8> keys_{};
  std::uint64_t swap_;
};

// Coordinate j for each of d from coordinate(j).
template <typename Coordinate>
Eigen::VectorXd point_of(std::size_t d, const Coordinate& coordinate) {
  Eigen::VectorXd u(static_cast<Eigen::Index>(d));
  for (std::size_t j = 0; j < d; ++j) u(static_cast<Eigen::Index>(j)) = coordinate(j);
  return u;
}

// Sobol' points with a digital shift.
auto shifted_sobol(Eigen::Index dimension, std::uint64_t seed) {
  std::vector<std::uint64_t> shifts;
  for (const Noise& noise : streams(seed, "Sobol' shift", dimension)) {
    shifts.push_back(noise.bits(0).first);
  }
  return [points = sobol_points(dimension), shifts](std::uint64_t i) {
    const std::vector<std::uint64_t> bits = points(i);
    return point_of(bits.size(), [&](std::size_t j) { return open_unit(bits[j] ^ shifts[j]); });
  };
}

decltype(Sampler::point) point_by(Method method, std::uint64_t n, Eigen::Index d,
                                  std::uint64_t seed) {
  switch (method) {
    case Method::random:
      return [streams = streams(seed, "random points", d)](std::uint64_t i) {
        return point_of(streams.size(),
                        [&](std::size_t j) { return open_unit(streams[j].bits(i).first); });
      };
    case Method::latin_hypercube: {
      std::vector<Permutation> permutations;
      for (const Noise& keys : streams(seed, "latin hypercube's permutation", d)) {
        permutations.emplace_back(n, keys);
      }
      // The jitter r has so few bits that π + r is exact: the point stays in its interval.
      const int bits = 50 - static_cast<int>(std::bit_width(n));
      return [=, jitters = streams(seed, "latin hypercube", d)](std::uint64_t i) {
        return point_of(jitters.size(), [&](std::size_t j) {
          const auto jitter = static_cast<double>(jitters[j].bits(i).first >> (64 - bits));
          return (static_cast<double>(permutations[j](i)) + std::ldexp(jitter + 0.5, -bits)) /
                 static_cast<double>(n);
        });
      };
    }
    case Method::sobol:
      return shifted_sobol(d, seed);
    case Method::saltelli:
      return [d, halves = shifted_sobol(2 * d, seed)](std::uint64_t i) {
        const auto columns = static_cast<std::uint64_t>(d) + 2;
        const auto column = static_cast<Eigen::Index>(i % columns);
        const Eigen::VectorXd both = halves(i / columns);
        Eigen::VectorXd u = column == d + 1 ? both.tail(d) : both.head(d);
        if (column >= 1 && column <= d) u(column - 1) = both(d + column - 1);
        return u;
      };
    case Method::grid:
    case Method::list:
      break;
  }
  throw std::logic_error("no such method");
}

}  // namespace

Sampler make_sampler(Method method, std::uint64_t n, Eigen::Index d, std::uint64_t seed) {
  if (n < 1) throw std::invalid_argument("there must be at least one sample");
  if (d < 1) throw std::invalid_argument("nothing is varied by a distribution");
  const std::uint64_t points_a_sample =
      method == Method::saltelli ? static_cast<std::uint64_t>(d) + 2 : 1;
  if (n > kMostPoints / points_a_sample) {
    throw std::invalid_argument(fmt::format("more than 2^{} points", kMostPointsLog2));
  }
  return {n * points_a_sample, point_by(method, n, d, seed)};
}

std::function<std::vector<std::uint64_t>(std::uint64_t i)> sobol_points(Eigen::Index dimension) {
  constexpr Eigen::Index kMost = boost::random::default_sobol_table::max_dimension;
  if (dimension < 1 || dimension > kMost) {
    throw std::invalid_argument(
        fmt::format("Sobol' points have 1 to {} dimensions, not {}", kMost, dimension));
  }
  return [first = boost::random::sobol(static_cast<std::size_t>(dimension))](std::uint64_t i) {
    std::vector<std::uint64_t> point(first.dimension());
    if (i == 0) return point;  // the engine begins with number 1
    boost::random::sobol engine = first;
    engine.seed(i - 1);
    engine.generate(point.begin(), point.end());
    return point;
  };
}

}  // namespace breakwater
