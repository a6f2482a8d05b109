// Sampling plans: points in the unit cube for the samples of a study.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

namespace breakwater {

/// How the values of the varied keys are combined. The first four draw samples.
enum class Method {
  random,           ///< independent draws
  latin_hypercube,  ///< random, with one draw in each equal part of a key's range
  sobol,            ///< a low-discrepancy sequence
  saltelli,         ///< design for sensitivity indices
  grid,             ///< every combination of the values
  list              ///< the first values of all keys, the second, …
};

/// The points u₀, u₁, … of a plan in the open unit cube (0, 1)ᵈ. No coordinate is 0 or 1, so every
/// distribution has a value there. A point depends only on the seed and its number. It costs O(d),
/// may be computed on any thread, and has the same bits on every processor.
struct Sampler {
  std::uint64_t size = 0;                                 ///< number of points
  std::function<Eigen::VectorXd(std::uint64_t i)> point;  ///< point i < size
};

/// Makes a plan of n samples of d quantities:
/// - random: independent uniform points. A larger n keeps the first points.
/// - latin_hypercube: u_ij = (π_j(i) + r_ij)/n with random permutations π_j of 0 … n − 1 and
///   uniform r_ij. Each of the n equal intervals of a coordinate has exactly one point
///   (M. D. McKay, R. J. Beckman, W. J. Conover, Technometrics 21 (1979) 239–245).
/// - sobol: Sobol' points (sobol_points()) with a digital shift: the bits of each coordinate are
///   XORed with random bits. The points stay evenly spread, and none is at the cube's corner
///   (P. L'Ecuyer, C. Lemieux, in: Modeling Uncertainty, 2002, 419–474). The first 2ᵏ points hit
///   each interval of length 2⁻ᵏ of a coordinate exactly once, so n should be a power of two.
///   A larger n keeps the first points.
/// - saltelli: the design for first-order and total sensitivity indices. A_j and B_j are the two
///   halves of a shifted Sobol' point of 2d dimensions. AB_j⁽ⁱ⁾ is A_j with coordinate i of B_j.
///   The n (d + 2) points are in the order A₀, AB₀⁽¹⁾ … AB₀⁽ᵈ⁾, B₀, A₁, …: the n × (d + 2) rows
///   that sensitivity_indices() takes. n should be a power of two. A larger n keeps the first rows
///   (A. Saltelli et al., Comput. Phys. Commun. 181 (2010) 259–270).
///
/// Throws std::invalid_argument if n or d is 0, there are more than 2⁴⁰ points, or d is larger than
/// 3667 (sobol) or 1833 (saltelli).
Sampler make_sampler(Method method, std::uint64_t n, Eigen::Index d, std::uint64_t seed);

/// Sobol' points in the order of the Gray code, with the directions of Joe and Kuo for good
/// two-dimensional projections:
///     x_i = ⊕_k g_k v_k,  g = i ⊕ ⌊i/2⌋        (g_k: bit k of g; v_k: the k-th direction)
/// x₀ = 0. The points 0 … 2ᵐ − 1 are a digital net. The function returns point i < 2⁴⁰, times 2⁶⁴.
/// Throws std::invalid_argument unless 1 ≤ dimension ≤ 3667.
///
/// Sources: I. M. Sobol', USSR Comput. Math. Math. Phys. 7 (1967) 86–112; I. A. Antonov, V. M.
/// Saleev, ibid. 19 (1979) 252–256; S. Joe, F. Y. Kuo, SIAM J. Sci. Comput. 30 (2008) 2635–2654.
std::function<std::vector<std::uint64_t>(std::uint64_t i)> sobol_points(Eigen::Index dimension);

}  // namespace breakwater
