// The violations of the rows of a quadratic program, in one pass.
#pragma once

#include <Eigen/Core>
#include <limits>

namespace breakwater {

/// Violations t_i = share_i max(v_i − upper_i, lower_i − v_i) of rows i with values v_i.
struct RowScan {
  double violation = 0.0;    ///< the largest t_i, or 0
  double worst_score = 0.0;  ///< the largest weight_i (t_i − tolerance), or 0
};

/// Computes Ω z from N columns (N < 0: `values` already has it) and returns its RowScan. All arrays
/// have m entries, and columns the length `stride`. Every vector length gives the same bits.
template <int N>
RowScan scan_rows(const double* columns, Eigen::Index stride, const double* z, Eigen::Index m,
                  const double* lower, const double* upper, const double* share,
                  const double* weight, double tolerance, double* values, double* scores) {
  using namespace Eigen::internal;  // NOLINT(google-build-using-namespace): its packets
  using Packet = packet_traits<double>::type;
  constexpr Eigen::Index kLanes = packet_traits<double>::size;
  const auto of_rows = [&]<typename P>(Eigen::Index i, P& violation, P& worst) {
    P value;
    if constexpr (N >= 0) {
      value = pmul(ploadu<P>(columns + i), pset1<P>(z[0]));
      for (int j = 1; j < N; ++j) {
        value = padd(value, pmul(ploadu<P>(columns + j * stride + i), pset1<P>(z[j])));
      }
      pstoreu(values + i, value);
    } else {
      value = ploadu<P>(values + i);
    }
    const P beyond =
        pmul(pmax(psub(value, ploadu<P>(upper + i)), psub(ploadu<P>(lower + i), value)),
             ploadu<P>(share + i));
    const P score = pmul(psub(beyond, pset1<P>(tolerance)), ploadu<P>(weight + i));
    pstoreu(scores + i, score);
    violation = pmax(violation, beyond);
    worst = pmax(worst, score);
  };
  // Two of each: independent maxima do not wait for each other.
  Packet violation[2] = {pset1<Packet>(0.0), pset1<Packet>(0.0)};
  Packet worst[2] = {violation[0], violation[0]};
  Eigen::Index i = 0;
  for (; i + 2 * kLanes <= m; i += 2 * kLanes) {
    of_rows(i, violation[0], worst[0]);
    of_rows(i + kLanes, violation[1], worst[1]);
  }
  RowScan scan{predux_max(pmax(violation[0], violation[1])), predux_max(pmax(worst[0], worst[1]))};
  for (; i < m; ++i) of_rows(i, scan.violation, scan.worst_score);
  return scan;
}

/// The largest share_i |bound_i| of the finite bounds. Negative unless lower ≤ upper for all rows,
/// without NaN, a lower bound of ∞ or an upper one of −∞.
inline double largest_bound(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                            const Eigen::VectorXd& share) {
  using namespace Eigen::internal;  // NOLINT(google-build-using-namespace): its packets
  using Packet = packet_traits<double>::type;
  constexpr Eigen::Index kLanes = packet_traits<double>::size;
  const auto of_rows = [&]<typename P>(Eigen::Index i, P& crossed, P& largest) {
    const P infinite = pset1<P>(std::numeric_limits<double>::infinity());
    const P l = ploadu<P>(lower.data() + i);
    const P u = ploadu<P>(upper.data() + i);
    const P own = ploadu<P>(share.data() + i);
    crossed = por(crossed, por(pcmp_lt_or_nan(u, l),
                               por(pcmp_eq(l, infinite), pcmp_eq(u, pnegate(infinite)))));
    for (const P size : {pabs(l), pabs(u)}) {
      largest = pmax(largest, pmul(pand(size, pcmp_lt(size, infinite)), own));
    }
  };
  Packet crossed = pset1<Packet>(0.0);
  Packet largest = crossed;
  Eigen::Index i = 0;
  for (; i + kLanes <= lower.size(); i += kLanes) of_rows(i, crossed, largest);
  double last_crossed = 0.0;
  double last = predux_max(largest);
  for (; i < lower.size(); ++i) of_rows(i, last_crossed, last);
  return predux_any(crossed) || predux_any(last_crossed) ? -1.0 : last;
}

}  // namespace breakwater
