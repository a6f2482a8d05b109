// The floor of estimation behind an encoder: Bayes' estimate for a known generator of the
// disturbance.
#pragma once

#include <cstdint>

extern "C" {

/// x(k+1) = A x(k) + B u(k) + walk, x = [q; v; …], d = D x. A jump redraws one state.
struct GeneratedMotion {
  int states;       ///< n, from 3 to 5
  const double* A;  ///< n × n, row by row
  const double* B;  ///< n
  const double* D;  ///< n
  const double*
      initial_std;  ///< n; that of q has no effect: q(0) is uniform in the first code's interval
  int jumping;      ///< index of the state that is redrawn from N(0, jump_std²); −1: none
  double jump_std;
  double jump_probability;  ///< per sample
  int walking;              ///< index of the state with white noise; −1: none
  double walk_std;          ///< per sample
};

/// E[v(k) | y(0…k)] and E[d(k) | y(0…k)] by a particle filter.
///
/// A code gives each particle the weight 1 or 0. If fewer than half of the particles remain (by
/// their effective number), the particles of the last sample become Gaussian kernels. The kernels
/// have the shrunk covariance of the particles that jumped at about the same time, and the
/// bandwidth of Silverman. A kernel's weight and its new particle then have the position truncated
/// by the codes of both samples. So the filter does not collapse behind a fine encoder, and a
/// change of the code leaves the position within the way of one sample.
///
/// @param u      samples inputs; u[k] acts from sample k on
/// @param lower,upper  samples limits of the position by the code [rad]
/// @param noise_std  if positive, the position is measured as `lower` with this white noise
/// instead,
///               and q(0) is N(lower[0], noise_std²)
/// @param v,d    samples results each
/// @return number of samples that no particle explained; their particles were moved into the
/// interval
///
/// Sources: N. J. Gordon, D. J. Salmond, A. F. M. Smith, IEE Proc. F 140 (1993) 107–113; C. Musso,
/// N. Oudjane, F. Le Gland, in Sequential Monte Carlo Methods in Practice (2001) 247–271; J. Liu,
/// M. West, ibid. 197–223 (shrinkage).
int breakwater_particle_filter(const GeneratedMotion* motion, int samples, const double* u,
                               const double* lower, const double* upper, double noise_std,
                               int particles, std::uint64_t seed, double* v, double* d);
}
