#include <breakwater/linear/pole_placement.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

constexpr long double kSmallestPivot = 1e-13L;  // relative, for the eigenvectors' matrix
constexpr long double kObservable = 1e-16L;     // relative, for the observability matrix
constexpr double kAgreement = 1e-9;             // relative, between two methods

void check_group(const PoleGroup& group) {
  for (const auto& pole : group) {
    if (!std::isfinite(pole.real()) || !std::isfinite(pole.imag())) {
      throw std::invalid_argument("pole placement: a pole is not finite");
    }
    if (std::count(group.begin(), group.end(), pole) !=
        std::count(group.begin(), group.end(), std::conj(pole))) {
      throw std::invalid_argument("pole placement: a complex pole lacks its conjugate");
    }
  }
}

[[noreturn]] void fail_as_not_observable() {
  throw std::invalid_argument(
      "pole placement: the poles cannot be placed (not observable, or the gain overflows)");
}

}  // namespace

ObserverPlacement::ObserverPlacement(Eigen::Index states, Eigen::Index outputs)
    : shifted_(states, states),
      lu_(states, states),
      W_(states, states),
      V_(Matrix::Zero(outputs, states)),
      vector_(states),
      permuted_vector_(states),
      row_scale_(states),
      column_scale_(states),
      rows_scaled_(states, states),
      balanced_(states, states),
      scaled_V_(states, outputs),
      permuted_(states, outputs),
      solved_(states, outputs) {
  group_.reserve(static_cast<std::size_t>(states));
}

// Replaces FullPivLU::solve(), which allocates.
template <typename Rhs>
void ObserverPlacement::solve(const Rhs& rhs, Rhs& permuted, Rhs& solution) const {
  permuted = lu_.permutationP() * rhs;
  lu_.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(permuted);
  lu_.matrixLU().triangularView<Eigen::Upper>().solveInPlace(permuted);
  const auto& places = lu_.permutationQ().indices();
  for (Eigen::Index i = 0; i < places.size(); ++i) solution.row(places(i)) = permuted.row(i);
}

void ObserverPlacement::place(const Eigen::Ref<const Eigen::MatrixXd>& A,
                              const Eigen::Ref<const Eigen::MatrixXd>& C,
                              const std::vector<PoleGroup>& groups, Eigen::MatrixXd& H) {
  if (!find(A, C, groups, H)) fail_as_not_observable();
}

bool ObserverPlacement::find(const Eigen::Ref<const Eigen::MatrixXd>& A,
                             const Eigen::Ref<const Eigen::MatrixXd>& C,
                             const std::vector<PoleGroup>& groups, Eigen::MatrixXd& H) {
  const Eigen::Index n = W_.rows();
  const Eigen::Index p = V_.rows();
  std::size_t count = 0;
  for (const auto& group : groups) count += group.size();
  if (A.rows() != n || A.cols() != n || C.rows() != p || C.cols() != n ||
      static_cast<Eigen::Index>(groups.size()) != p || static_cast<Eigen::Index>(count) != n) {
    throw std::invalid_argument("pole placement: needs one group of poles per output, " +
                                std::to_string(n) + " poles in all");
  }

  V_.setZero();
  Eigen::Index column = 0;
  for (Eigen::Index output = 0; output < p; ++output) {
    check_group(groups[output]);
    // Equal poles are neighbours, so that the second one continues the Jordan chain of the first.
    group_ = groups[output];
    std::sort(group_.begin(), group_.end(), [](const auto& a, const auto& b) {
      return std::pair(a.real(), a.imag()) < std::pair(b.real(), b.imag());
    });
    for (std::size_t i = 0; i < group_.size(); ++i, ++column) {
      shifted_ = A.transpose().cast<Scalar>() - Scalar(group_[i]) * Matrix::Identity(n, n);
      lu_.compute(shifted_);
      if (!lu_.isInvertible()) return false;  // the pole is an eigenvalue of A
      if (i > 0 && group_[i] == group_[i - 1]) {
        vector_ = W_.col(column - 1);
      } else {
        V_(output, column) = 1.0L;
        vector_ = C.row(output).transpose().cast<Scalar>();
      }
      solve(vector_, permuted_vector_, vector_);
      W_.col(column) = vector_;
    }
  }

  // Wᵀ H = Vᵀ, solved with balanced rows and columns: the states differ in scale by powers of T_s.
  row_scale_ = W_.rowwise().norm().array().max(1e-300L);
  rows_scaled_ = row_scale_.inverse().matrix().cast<Scalar>().asDiagonal() * W_;
  column_scale_ = rows_scaled_.colwise().norm().transpose().array();
  balanced_ = rows_scaled_ * column_scale_.inverse().matrix().cast<Scalar>().asDiagonal();
  shifted_ = balanced_.transpose();
  lu_.compute(shifted_);
  if (!lu_.isInvertible()) return false;
  scaled_V_ = column_scale_.inverse().matrix().cast<Scalar>().asDiagonal() * V_.transpose();
  solve(scaled_V_, permuted_, solved_);
  scaled_V_ = row_scale_.inverse().matrix().cast<Scalar>().asDiagonal() * solved_;
  H = scaled_V_.real().cast<double>();
  return true;
}

bool ObserverPlacement::is_well_conditioned() const {
  return smallest_pivot() > kSmallestPivot;
}

// The smallest pivot of the last factor, relative to the largest.
long double ObserverPlacement::smallest_pivot() const {
  const auto pivots = lu_.matrixLU().diagonal().cwiseAbs();
  return pivots.minCoeff() / lu_.maxPivot();
}

// Ackermann's formula h = φ(A) O⁻¹ e_n for one output. The rows of O are
// c (A − s_1) … (A − s_i) with the poles' real parts s. They cancel less than c Aⁱ. Needs no
// eigenvalue of A and no distance between the poles.
bool ObserverPlacement::find_for_one_output(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C,
                                            const PoleGroup& poles, Eigen::MatrixXd& H) {
  const Eigen::Index n = A.rows();
  balanced_ = A.cast<Scalar>();
  shifted_.row(0) = C.row(0).cast<Scalar>();
  for (Eigen::Index i = 1; i < n; ++i) {
    const Scalar shift(poles[static_cast<std::size_t>(i - 1)].real());
    shifted_.row(i) = shifted_.row(i - 1) * balanced_ - shift * shifted_.row(i - 1);
  }
  // The states and the powers of A have different units.
  column_scale_ = shifted_.colwise().norm().transpose().array().max(1e-4000L);
  rows_scaled_ = shifted_ * column_scale_.inverse().matrix().cast<Scalar>().asDiagonal();
  row_scale_ = rows_scaled_.rowwise().norm().array().max(1e-4000L);
  lu_.compute(row_scale_.inverse().matrix().cast<Scalar>().asDiagonal() * rows_scaled_);
  if (!(smallest_pivot() > kObservable)) return false;
  vector_.setZero();
  vector_(n - 1) = 1.0L / row_scale_(n - 1);
  solve(vector_, permuted_vector_, vector_);
  vector_.array() /= column_scale_.cast<Scalar>();
  for (const std::complex<double>& pole : poles) {
    permuted_vector_ = balanced_ * vector_ - Scalar(pole) * vector_;
    vector_ = permuted_vector_;
  }
  H = vector_.real().cast<double>();
  return H.allFinite();
}

Eigen::MatrixXd place_observer_poles(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C,
                                     const std::vector<PoleGroup>& groups) {
  ObserverPlacement placement(A.rows(), C.rows());
  Eigen::MatrixXd H(A.rows(), C.rows());
  const bool is_found = placement.find(A, C, groups, H) && placement.is_well_conditioned();
  if (C.rows() == 1) {
    // Both methods agree where the poles and the eigenvalues of A are apart. The goldens have the
    // last bits of the eigenvectors.
    Eigen::MatrixXd exact(A.rows(), 1);
    if (!placement.find_for_one_output(A, C, groups[0], exact)) fail_as_not_observable();
    const bool agrees = ((H - exact).array().abs() <= kAgreement * exact.array().abs()).all();
    return is_found && agrees ? H : exact;
  }
  if (is_found && H.allFinite()) return H;
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
    Eigen::MatrixXd first(A.rows(), C.rows());
    if (placement.find(A, C, others, first) && placement.is_well_conditioned() &&
        placement.find(A - first * C, C, groups, H) && placement.is_well_conditioned()) {
      H += first;
      if (H.allFinite()) return H;
    }
  }
  fail_as_not_observable();
}

std::vector<PoleGroup> sample_poles(const std::vector<PoleGroup>& continuous, double period_s) {
  std::vector<PoleGroup> sampled;
  sample_poles(continuous, period_s, sampled);
  return sampled;
}

void sample_poles(const std::vector<PoleGroup>& continuous, double period_s,
                  std::vector<PoleGroup>& sampled) {
  sampled = continuous;
  for (auto& group : sampled) {
    for (auto& pole : group) {
      if (!(pole.real() < 0.0)) {
        throw std::invalid_argument(
            "pole placement: the poles must lie left of the imaginary axis");
      }
      pole = math::exp(pole * period_s);
    }
  }
}

}  // namespace breakwater
