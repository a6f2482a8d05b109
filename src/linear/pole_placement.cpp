#include <breakwater/linear/pole_placement.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr long double kSmallestPivot = 1e-13L;  // relative, for the eigenvectors' matrix
constexpr long double kObservable = 1e-16L;     // relative, for the observability matrix
constexpr double kAgreement = 1e-9;             // relative, between two methods

void check_group(const PoleGroup& group) {
  for (const auto& pole : group) {
    refuse_unless(std::isfinite(pole.real()) && std::isfinite(pole.imag()),
                  "pole placement: a pole is not finite");
    refuse_unless(std::count(group.begin(), group.end(), pole) ==
                      std::count(group.begin(), group.end(), std::conj(pole)),
                  "pole placement: a complex pole lacks its conjugate");
  }
}

[[noreturn]] void fail_as_not_observable() {
  throw std::invalid_argument(
      "pole placement: the poles cannot be placed (not observable, or the gain overflows)");
}

// Extended precision: the poles of a fast observer are all close to 1, which makes the matrix of
// eigenvectors badly conditioned.
using Precise = std::complex<long double>;
using PreciseMatrix = Eigen::Matrix<Precise, Eigen::Dynamic, Eigen::Dynamic>;
using PreciseVector = Eigen::Matrix<Precise, Eigen::Dynamic, 1>;
using Scale = Eigen::Array<long double, Eigen::Dynamic, 1>;
using Factor = Eigen::FullPivLU<PreciseMatrix>;

Eigen::DiagonalMatrix<Precise, Eigen::Dynamic> inverse_of(const Scale& scale) {
  return PreciseVector(scale.inverse().matrix().cast<Precise>()).asDiagonal();
}

// The smallest pivot, relative to the largest.
long double pivot_ratio(const Factor& lu) {
  return lu.matrixLU().diagonal().cwiseAbs().minCoeff() / lu.maxPivot();
}

// The gain by the eigenvectors; none if they are badly conditioned.
std::optional<Eigen::MatrixXd> by_eigenvectors(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C,
                                               const std::vector<PoleGroup>& groups) {
  const Eigen::Index n = A.rows();
  const Eigen::Index p = C.rows();
  PreciseMatrix W(n, n), V = PreciseMatrix::Zero(p, n);
  Eigen::Index column = 0;
  for (Eigen::Index output = 0; output < p; ++output) {
    // Equal poles are neighbours, so that the second one continues the Jordan chain of the first.
    PoleGroup group = groups[static_cast<std::size_t>(output)];
    std::sort(group.begin(), group.end(), [](const auto& a, const auto& b) {
      return std::pair(a.real(), a.imag()) < std::pair(b.real(), b.imag());
    });
    for (std::size_t i = 0; i < group.size(); ++i, ++column) {
      const Factor lu(A.transpose().cast<Precise>() -
                      Precise(group[i]) * PreciseMatrix::Identity(n, n));
      if (!lu.isInvertible()) return std::nullopt;  // the pole is an eigenvalue of A
      if (i > 0 && group[i] == group[i - 1]) {
        W.col(column) = lu.solve(PreciseVector(W.col(column - 1)));
      } else {
        V(output, column) = 1.0L;
        W.col(column) = lu.solve(PreciseVector(C.row(output).transpose().cast<Precise>()));
      }
    }
  }

  // Wᵀ H = Vᵀ, solved with balanced rows and columns: the states differ in scale by powers of T_s.
  const Scale row_scale = W.rowwise().norm().array().max(1e-300L);
  const PreciseMatrix rows_scaled = inverse_of(row_scale) * W;
  const Scale column_scale = rows_scaled.colwise().norm().transpose().array();
  const PreciseMatrix balanced = rows_scaled * inverse_of(column_scale);
  const Factor lu(balanced.transpose());
  if (!lu.isInvertible() || !(pivot_ratio(lu) > kSmallestPivot)) return std::nullopt;
  const PreciseMatrix solved = lu.solve(PreciseMatrix(inverse_of(column_scale) * V.transpose()));
  const PreciseMatrix H = inverse_of(row_scale) * solved;
  return H.real().cast<double>();
}

// Ackermann's formula h = φ(A) O⁻¹ e_n for one output. The rows of O are
// c (A − s_1) … (A − s_i) with the poles' real parts s. They cancel less than c Aⁱ. Needs no
// eigenvalue of A and no distance between the poles.
Eigen::MatrixXd by_ackermann(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C,
                             const PoleGroup& poles) {
  const Eigen::Index n = A.rows();
  const PreciseMatrix exact = A.cast<Precise>();
  PreciseMatrix O(n, n);
  O.row(0) = C.row(0).cast<Precise>();
  for (Eigen::Index i = 1; i < n; ++i) {
    const Precise shift(poles[static_cast<std::size_t>(i - 1)].real());
    O.row(i) = O.row(i - 1) * exact - shift * O.row(i - 1);
  }
  // The states and the powers of A have different units.
  const Scale column_scale = O.colwise().norm().transpose().array().max(1e-4000L);
  const PreciseMatrix scaled = O * inverse_of(column_scale);
  const Scale row_scale = scaled.rowwise().norm().array().max(1e-4000L);
  const Factor lu(inverse_of(row_scale) * scaled);
  if (!(pivot_ratio(lu) > kObservable)) fail_as_not_observable();
  PreciseVector h = lu.solve(PreciseVector(PreciseVector::Unit(n, n - 1) / row_scale(n - 1)));
  h.array() /= column_scale.cast<Precise>();
  for (const std::complex<double>& pole : poles) h = (exact * h - Precise(pole) * h).eval();
  const Eigen::MatrixXd H = h.real().cast<double>();
  if (!H.allFinite()) fail_as_not_observable();
  return H;
}

}  // namespace

Eigen::MatrixXd place_observer_poles(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C,
                                     const std::vector<PoleGroup>& groups) {
  const Eigen::Index n = A.rows();
  const Eigen::Index p = C.rows();
  std::size_t count = 0;
  for (const PoleGroup& group : groups) count += group.size();
  if (A.cols() != n || C.cols() != n || static_cast<Eigen::Index>(groups.size()) != p ||
      static_cast<Eigen::Index>(count) != n) {
    throw std::invalid_argument("pole placement: needs one group of poles per output, " +
                                std::to_string(n) + " poles in all");
  }
  for (const PoleGroup& group : groups) check_group(group);
  const std::optional<Eigen::MatrixXd> H = by_eigenvectors(A, C, groups);
  if (p == 1) {
    // Both methods agree where the poles and the eigenvalues of A are apart. The goldens have the
    // last bits of the eigenvectors.
    const Eigen::MatrixXd exact = by_ackermann(A, C, groups[0]);
    const bool agrees = H && ((*H - exact).array().abs() <= kAgreement * exact.array().abs()).all();
    return agrees ? *H : exact;
  }
  if (H && H->allFinite()) return *H;
  // A pole may be an eigenvalue of A. A first gain moves all eigenvalues to other places.
  double scale = spectral_radius(A);
  for (const PoleGroup& group : groups) {
    for (const std::complex<double>& pole : group) scale = std::max(scale, std::abs(pole));
  }
  for (const double shift : {0.37, -0.61, 0.83}) {
    std::vector<PoleGroup> others = groups;
    for (PoleGroup& group : others) {
      for (std::complex<double>& pole : group) pole += shift * scale;
    }
    const auto first = by_eigenvectors(A, C, others);
    const auto second = first ? by_eigenvectors(A - *first * C, C, groups) : std::nullopt;
    if (second && (*first + *second).allFinite()) return *first + *second;
  }
  fail_as_not_observable();
}

std::vector<PoleGroup> sample_poles(const std::vector<PoleGroup>& continuous, double period_s) {
  std::vector<PoleGroup> sampled = continuous;
  for (auto& group : sampled) {
    for (auto& pole : group) {
      refuse_unless(pole.real() < 0.0,
                    "pole placement: the poles must lie left of the imaginary axis");
      pole = math::exp(pole * period_s);
    }
  }
  return sampled;
}

}  // namespace breakwater
