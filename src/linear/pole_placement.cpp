#include <breakwater/linear/pole_placement.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

constexpr long double kSmallestRcond = 1e-16L;

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
      "pole placement: the poles cannot be placed (not observable, poles too close, or the gain "
      "overflows)");
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
      if (!lu_.isInvertible()) {
        throw std::invalid_argument("pole placement: a pole already is an eigenvalue of the plant");
      }
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
  if (!lu_.isInvertible()) fail_as_not_observable();
  scaled_V_ = column_scale_.inverse().matrix().cast<Scalar>().asDiagonal() * V_.transpose();
  solve(scaled_V_, permuted_, solved_);
  scaled_V_ = row_scale_.inverse().matrix().cast<Scalar>().asDiagonal() * solved_;
  H = scaled_V_.real().cast<double>();
}

bool ObserverPlacement::is_well_conditioned() const {
  return lu_.rcond() > kSmallestRcond;
}

Eigen::MatrixXd place_observer_poles(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C,
                                     const std::vector<PoleGroup>& groups) {
  ObserverPlacement placement(A.rows(), C.rows());
  Eigen::MatrixXd H(A.rows(), C.rows());
  placement.place(A, C, groups, H);
  if (!placement.is_well_conditioned() || !H.allFinite()) fail_as_not_observable();
  return H;
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

PoleGroup eigenvalues(const Eigen::MatrixXd& A) {
  const Eigen::VectorXcd values = A.eigenvalues();
  return {values.begin(), values.end()};
}

double spectral_radius(const Eigen::MatrixXd& A) {
  return A.eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace breakwater
