// Kalman filters with one input, one output and two to six states. Loops of fixed length take a
// seventh to a half of the time of matrix products.
#pragma once

#include <Eigen/Core>

namespace breakwater::one_output {

/// The operations on matrices that are stored by columns. P is symmetric, before and after.
struct Kernel {
  /// x ← A x + b u, P ← A P Aᵀ + Q.
  void (*predict)(const double* A, const double* b, const double* Q, double u, double* x,
                  double* P);
  /// cᵀ x.
  double (*output)(const double* c, const double* x);
  /// h ← P c, variance ← cᵀ P c. Returns cᵀ x. If `is_first`, c = (1, 0, …).
  double (*measure)(const double* P, const double* x, const double* c, bool is_first, double* h,
                    double* variance);
  /// K ← h/D, x ← x + K e. Replaces P(k|k−1) by P(k|k), multiplied by `inflation`, for h = P c and
  /// the noise variance R.
  void (*correct)(const double* h, const double* c, bool is_first, double e, double R,
                  double D_inverse, double inflation, double* K, double* x, double* P);
};

/// The operations for `states`; nullptr if there are none for this number.
const Kernel* kernel(Eigen::Index states);

}  // namespace breakwater::one_output
