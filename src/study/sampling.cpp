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

// Random bits for one coordinate.
Noise stream(std::uint64_t seed, const std::string& name, Eigen::Index j) {
  return {seed, name + " " + std::to_string(j)};
}

std::vector<Noise> streams(std::uint64_t seed, const std::string& name, Eigen::Index d) {
  std::vector<Noise> all;
  for (Eigen::Index j = 0; j < d; ++j) all.push_back(stream(seed, name, j));
  return all;
}

class RandomPoints : public Sampler {
 public:
  RandomPoints(std::uint64_t n, Eigen::Index d, std::uint64_t seed)
      : Sampler(n, d), streams_(streams(seed, "random points", d)) {}

 private:
  void write(std::uint64_t i, Eigen::VectorXd& u) const override {
    for (Eigen::Index j = 0; j < u.size(); ++j) u(j) = open_unit(streams_[j].bits(i).first);
  }

  std::vector<Noise> streams_;
};

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

class LatinHypercube : public Sampler {
 public:
  LatinHypercube(std::uint64_t n, Eigen::Index d, std::uint64_t seed)
      : Sampler(n, d),
        jitter_bits_(50 - static_cast<int>(std::bit_width(n))),
        jitters_(streams(seed, "latin hypercube", d)) {
    for (Eigen::Index j = 0; j < d; ++j) {
      permutations_.emplace_back(n, stream(seed, "latin hypercube's permutation", j));
    }
  }

 private:
  void write(std::uint64_t i, Eigen::VectorXd& u) const override {
    for (Eigen::Index j = 0; j < u.size(); ++j) {
      // r has so few bits that π + r is exact: the point stays in its interval.
      const auto bits = static_cast<double>(jitters_[j].bits(i).first >> (64 - jitter_bits_));
      const double r = std::ldexp(bits + 0.5, -jitter_bits_);
      u(j) = (static_cast<double>(permutations_[j](i)) + r) / static_cast<double>(size());
    }
  }

  int jitter_bits_;
  std::vector<Noise> jitters_;
  std::vector<Permutation> permutations_;
};

// Sobol' points with a digital shift.
class ShiftedSobol {
 public:
  ShiftedSobol(Eigen::Index dimension, std::uint64_t seed) : sequence_(dimension) {
    for (Eigen::Index j = 0; j < dimension; ++j) {
      shifts_.push_back(stream(seed, "Sobol' shift", j).bits(0).first);
    }
  }

  double coordinate(std::uint64_t i, Eigen::Index j) const {
    return open_unit(sequence_.coordinate(i, j) ^ shifts_[j]);
  }

 private:
  SobolSequence sequence_;
  std::vector<std::uint64_t> shifts_;
};

class SobolPoints : public Sampler {
 public:
  SobolPoints(std::uint64_t n, Eigen::Index d, std::uint64_t seed)
      : Sampler(n, d), points_(d, seed) {}

 private:
  void write(std::uint64_t i, Eigen::VectorXd& u) const override {
    for (Eigen::Index j = 0; j < u.size(); ++j) u(j) = points_.coordinate(i, j);
  }

  ShiftedSobol points_;
};

class SaltelliDesign : public Sampler {
 public:
  SaltelliDesign(std::uint64_t n, Eigen::Index d, std::uint64_t seed)
      : Sampler(n * (static_cast<std::uint64_t>(d) + 2), d), points_(2 * d, seed) {}

 private:
  void write(std::uint64_t i, Eigen::VectorXd& u) const override {
    const Eigen::Index d = u.size();
    const auto columns = static_cast<std::uint64_t>(d) + 2;
    const std::uint64_t row = i / columns;
    const auto column = static_cast<Eigen::Index>(i % columns);
    const bool is_B = column == d + 1;
    for (Eigen::Index j = 0; j < d; ++j) {
      u(j) = points_.coordinate(row, is_B || column == j + 1 ? d + j : j);
    }
  }

  ShiftedSobol points_;
};

}  // namespace

Eigen::VectorXd Sampler::point(std::uint64_t i) const {
  if (i >= size_) throw std::out_of_range(fmt::format("point {} of {}", i, size_));
  Eigen::VectorXd u(dimension_);
  write(i, u);
  return u;
}

std::unique_ptr<const Sampler> make_sampler(SamplingMethod method, std::uint64_t n, Eigen::Index d,
                                            std::uint64_t seed) {
  if (n < 1) throw std::invalid_argument("there must be at least one sample");
  if (d < 1) throw std::invalid_argument("nothing is varied by a distribution");
  const std::uint64_t points_a_sample =
      method == SamplingMethod::saltelli ? static_cast<std::uint64_t>(d) + 2 : 1;
  if (n > kMostPoints / points_a_sample) {
    throw std::invalid_argument(fmt::format("more than 2^{} points", kMostPointsLog2));
  }
  switch (method) {
    case SamplingMethod::random:
      return std::make_unique<RandomPoints>(n, d, seed);
    case SamplingMethod::latin_hypercube:
      return std::make_unique<LatinHypercube>(n, d, seed);
    case SamplingMethod::sobol:
      return std::make_unique<SobolPoints>(n, d, seed);
    case SamplingMethod::saltelli:
      return std::make_unique<SaltelliDesign>(n, d, seed);
  }
  throw std::logic_error("no such method");
}

SobolSequence::SobolSequence(Eigen::Index dimension) : dimension_(dimension) {
  static_assert(kMostDimensions == boost::random::default_sobol_table::max_dimension);
  if (dimension < 1 || dimension > kMostDimensions) {
    throw std::invalid_argument(
        fmt::format("Sobol' points have 1 to {} dimensions, not {}", kMostDimensions, dimension));
  }
  boost::random::sobol engine(static_cast<std::size_t>(dimension));
  directions_.resize(static_cast<std::size_t>(kMostPointsLog2 * dimension));
  for (int k = 0; k < kMostPointsLog2; ++k) {
    // The Gray code of 2ᵏ⁺¹ − 1 is 2ᵏ, so that point is v_k itself. The engine begins with number
    // 1.
    engine.seed((std::uint64_t{2} << k) - 2);
    for (Eigen::Index j = 0; j < dimension; ++j) directions_[k * dimension + j] = engine();
  }
}

std::uint64_t SobolSequence::coordinate(std::uint64_t i, Eigen::Index j) const {
  std::uint64_t x = 0;
  for (std::uint64_t gray = i ^ i >> 1; gray != 0; gray &= gray - 1) {
    x ^= directions_[std::countr_zero(gray) * dimension_ + j];
  }
  return x;
}

}  // namespace breakwater
