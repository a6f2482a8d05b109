#include <breakwater/linear/riccati.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr int kMostDoublings = 60;
constexpr int kMostNewtonSteps = 60;  // the first steps may only halve P
constexpr double kConverged = 1e-14;  // change of P, relative to its diagonal
constexpr double kNewtonConverged = 1e-11;
constexpr double kSymmetric = 1e-12;     // asymmetry, relative to the diagonal
constexpr double kExact = 1e-11;         // error of P that needs no other method
constexpr double kSmallestError = 1e-5;  // error of P above which there is no solution
constexpr double kStable = 1.0 - 1e-9;   // largest magnitude of an eigenvalue of the closed loop
constexpr double kOnCircle = 1e-6;       // distance of a mode from the unit circle, or of a mode
                                         // from one that B does not reach, or Q does not weigh

using Matrix = Eigen::MatrixXd;

struct Plant {
  Matrix A, B, Q, R;
};

Matrix symmetric_part(const Matrix& matrix) {
  return 0.5 * (matrix + matrix.transpose());
}

// Judged by the diagonal, because rows and columns may have different units.
bool is_symmetric(const Matrix& matrix) {
  if (matrix.rows() != matrix.cols() || !matrix.allFinite()) return false;
  const Eigen::VectorXd root = matrix.diagonal().cwiseAbs().cwiseSqrt();
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    for (Eigen::Index i = 0; i < j; ++i) {
      if (std::abs(matrix(i, j) - matrix(j, i)) > kSymmetric * root(i) * root(j)) return false;
    }
  }
  return true;
}

// Whether a positive semidefinite change is small: its diagonal bounds all its entries.
bool is_small(const Matrix& change, double share, const Matrix& P) {
  return (change.diagonal().array().abs() <= share * P.diagonal().array()).all();
}

// G = B R⁻¹ Bᵀ
Matrix input_weight(const Plant& plant) {
  return symmetric_part(plant.B * plant.R.llt().solve(plant.B.transpose()));
}

// K = (R + Bᵀ P B)⁻¹ Bᵀ P A
Matrix feedback(const Plant& plant, const Matrix& P) {
  const Matrix PB = P * plant.B;
  return (plant.R + plant.B.transpose() * PB).llt().solve(PB.transpose() * plant.A);
}

Matrix by_doubling(const Plant& plant) {
  const Matrix identity = Matrix::Identity(plant.A.rows(), plant.A.rows());
  Matrix transition = plant.A;
  Matrix G = input_weight(plant);
  Matrix P = plant.Q;
  for (int k = 0; k < kMostDoublings; ++k) {
    // (I + G P) is invertible, because G and P are positive semidefinite.
    const Eigen::PartialPivLU<Matrix> lu(identity + G * P);
    const Matrix to_transition = lu.solve(transition);  // (I + G P)⁻¹ A_k
    const Matrix to_G = lu.solve(G);
    const Matrix growth = symmetric_part(transition.transpose() * P * to_transition);
    G = symmetric_part(G + transition * to_G * transition.transpose());
    P += growth;
    transition = transition * to_transition;
    if (!P.allFinite() || is_small(growth, kConverged, P)) break;
  }
  return P;
}

// The cost of one step of the closed loop, and of all later ones by P:
//     (A − B K)ᵀ P (A − B K) + Q + Kᵀ R K.
Matrix cost(const Plant& plant, const Matrix& closed, const Matrix& K, const Matrix& P) {
  return symmetric_part(closed.transpose() * P * closed + plant.Q + K.transpose() * plant.R * K);
}

// Newton's method from a P with stabilising feedback. Each step's P is the cost of that feedback,
// computed by doubling.
Matrix by_newton(const Plant& plant, Matrix P) {
  const Matrix none = Matrix::Zero(P.rows(), P.rows());
  const Matrix no_input = Matrix::Zero(plant.B.rows(), plant.B.cols());
  for (int step = 0; step < kMostNewtonSteps && P.allFinite(); ++step) {
    const Matrix last = P;
    const Matrix K = feedback(plant, P);
    const Matrix closed = plant.A - plant.B * K;
    P = by_doubling({closed, no_input, cost(plant, closed, K, none), plant.R});
    if (is_small(P - last, kNewtonConverged, P)) break;
  }
  return P;
}

// The largest error of P in its equation, relative to its diagonal. Infinite unless the closed
// loop is stable.
double error_of(const Plant& plant, const Matrix& P) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  if (!P.allFinite()) return kNone;
  const Matrix K = feedback(plant, P);
  const Matrix closed = plant.A - plant.B * K;
  const Matrix next = cost(plant, closed, K, P);
  if (!next.allFinite() || !(spectral_radius(closed) < kStable)) return kNone;
  const Eigen::VectorXd root = next.diagonal().cwiseMax(P.diagonal()).cwiseSqrt();
  double error = 0.0;
  for (Eigen::Index j = 0; j < P.cols(); ++j) {
    for (Eigen::Index i = 0; i < P.rows(); ++i) {
      const double off = std::abs(next(i, j) - P(i, j));
      if (off > 0.0) error = std::max(error, off / root(i) / root(j));
    }
  }
  return error;
}

// Powers of two d such that the plant of x' = x/d has entries of similar size in A, and in Q and
// B R⁻¹ Bᵀ. This is the balancing of the symplectic matrix with these blocks.
Eigen::VectorXd balance(const Plant& plant) {
  constexpr int kMostSweeps = 100;
  const Eigen::Index n = plant.A.rows();
  const auto logarithms = [](const Matrix& matrix) -> Matrix {
    return matrix.unaryExpr(
        [](double entry) { return math::log(std::abs(entry)) * std::numbers::log2e; });
  };
  const Matrix A = logarithms(plant.A);
  const Matrix Q = logarithms(plant.Q);
  const Matrix G = logarithms(input_weight(plant));
  Eigen::VectorXd exponent = Eigen::VectorXd::Zero(n);
  bool is_changed = true;
  for (int sweep = 0; sweep < kMostSweeps && is_changed; ++sweep) {
    is_changed = false;
    for (Eigen::Index i = 0; i < n; ++i) {
      double rising = -std::numeric_limits<double>::infinity();  // with d_i
      double falling = rising;
      for (Eigen::Index j = 0; j < n; ++j) {
        rising = std::max(rising, Q(i, j) + exponent(i) + exponent(j));
        falling = std::max(falling, G(i, j) - exponent(i) - exponent(j));
        if (j == i) continue;
        rising = std::max(rising, A(j, i) + exponent(i) - exponent(j));
        falling = std::max(falling, A(i, j) - exponent(i) + exponent(j));
      }
      const double change = std::round(0.25 * (falling - rising));  // a diagonal changes by d_i²
      if (!std::isfinite(change) || change == 0.0) continue;
      exponent(i) += change;
      is_changed = true;
    }
  }
  return exponent.unaryExpr([](double power) { return std::ldexp(1.0, static_cast<int>(power)); });
}

Plant scaled(const Plant& plant, const Eigen::VectorXd& d) {
  const auto to = d.asDiagonal();
  const auto from = d.cwiseInverse().asDiagonal();
  return {from * plant.A * to, from * plant.B, to * plant.Q * to, plant.R};
}

// The smallest pivot of [A − λ I, B], relative to its largest. It is 0 if B does not reach the
// mode λ.
double reach(const Matrix& A, const Matrix& B, std::complex<double> mode) {
  const Eigen::Index n = A.rows();
  const Eigen::Index width = n + B.cols();
  Matrix real = Matrix::Zero(2 * n, 2 * width);  // [Re, −Im; Im, Re]
  for (const Eigen::Index block : {Eigen::Index{0}, Eigen::Index{1}}) {
    real.block(block * n, block * width, n, n) = A;
    real.block(block * n, block * width + n, n, B.cols()) = B;
    real.block(block * n, block * width, n, n).diagonal().array() -= mode.real();
    real.block(block * n, (1 - block) * width, n, n).diagonal().array() =
        block == 0 ? mode.imag() : -mode.imag();
  }
  const Eigen::ColPivHouseholderQR<Matrix> qr(real);
  return qr.maxPivot() > 0.0 ? std::abs(qr.matrixQR()(2 * n - 1, 2 * n - 1)) / qr.maxPivot() : 0.0;
}

// Names the mode that allows no stabilising solution.
[[noreturn]] void refuse(const Plant& plant) {
  const Matrix G = input_weight(plant);
  const Matrix transposed = plant.A.transpose();
  double least = std::numeric_limits<double>::infinity();
  std::string why = "the numbers are too large";
  for (const std::complex<double>& mode : eigenvalues(plant.A)) {
    const double magnitude = std::abs(mode);
    if (!(magnitude >= kStable - kOnCircle) || mode.imag() < 0.0) continue;
    char name[64];
    std::snprintf(name, sizeof name, mode.imag() == 0.0 ? "%.6g" : "%.6g ± %.6gi", mode.real(),
                  mode.imag());
    const auto consider = [&](double share, const char* what) {
      if (!(share <= least)) return;
      least = share;
      why = std::string(what) + (share < kOnCircle ? " no" : " too little") +
            " effect on the mode with the eigenvalue " + name + " of A";
    };
    consider(reach(plant.A, G, mode), "the input has");
    // A mode on the unit circle moves only if it costs something.
    if (magnitude < 1.0 + kOnCircle) consider(reach(transposed, plant.Q, mode), "Q has");
  }
  throw std::invalid_argument("Riccati: there is no stabilising solution: " + why);
}

}  // namespace

bool is_positive_definite(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0 || !is_symmetric(matrix)) return false;
  const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  if (factor.info() != Eigen::Success) return false;
  // The pivots of a singular matrix may be rounding errors of its diagonal.
  const double rounding =
      static_cast<double>(matrix.rows()) * std::numeric_limits<double>::epsilon();
  const Eigen::ArrayXd root = factor.matrixLLT().diagonal().array();
  return (root.square() > rounding * matrix.diagonal().array()).all();
}

bool is_positive_semidefinite(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0 || !is_symmetric(matrix)) return false;
  if (matrix.diagonal().minCoeff() < 0.0) return false;
  const Eigen::VectorXd root = matrix.diagonal().cwiseSqrt();
  Eigen::MatrixXd scaled = matrix;  // with a diagonal of ones
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
      if (scaled(i, j) == 0.0) continue;
      if (root(i) == 0.0) return false;
      scaled(i, j) = scaled(i, j) / root(i) / root(j);
    }
  }
  const double rounding = kSymmetric * static_cast<double>(matrix.size());
  if (!(scaled.cwiseAbs().maxCoeff() <= 1.0 + rounding)) return false;
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(scaled, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().minCoeff() >= -rounding;
}

Eigen::MatrixXd solve_dare(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                           const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R) {
  const Eigen::Index n = A.rows();
  const Eigen::Index m = B.cols();
  refuse_unless(n != 0 && m != 0 && A.cols() == n && B.rows() == n && Q.rows() == n &&
                    Q.cols() == n && R.rows() == m && R.cols() == m,
                "Riccati: A and Q must be n×n, B n×m and R m×m");
  refuse_unless(A.allFinite() && B.allFinite(), "Riccati: A and B must be finite");
  refuse_unless(is_positive_semidefinite(Q), "Riccati: Q must be symmetric positive semidefinite");
  refuse_unless(is_positive_definite(R), "Riccati: R must be symmetric positive definite");

  const Plant plant{A, B, Q, R};
  const Eigen::VectorXd d = balance(plant);
  const Plant balanced = scaled(plant, d);
  Matrix P = by_doubling(plant);
  if (error_of(balanced, d.asDiagonal() * P * d.asDiagonal()) <= kExact) return P;
  // The other methods work on the balanced plant. The doubling may have lost digits, and Newton's
  // method finds them. It may also leave an unstable mode without weight in Q as it is, because
  // this is cheapest. With a Q that weighs all modes it stabilises.
  Matrix best;
  double least = kSmallestError;
  const auto consider = [&](const Matrix& candidate) {
    const double error = error_of(balanced, candidate);
    if (!(error <= least)) return error <= kExact;
    least = error;
    best = candidate;
    return error <= kExact;
  };
  P = by_doubling(balanced);
  if (!consider(P) && !consider(by_newton(balanced, P))) {
    Plant weighed = balanced;
    const double scale =
        std::max(balanced.Q.cwiseAbs().maxCoeff(), input_weight(balanced).cwiseAbs().maxCoeff());
    weighed.Q.diagonal().array() += scale > 0.0 ? scale : 1.0;
    consider(by_newton(balanced, by_doubling(weighed)));
  }
  if (best.size() == 0) refuse(balanced);
  P = d.cwiseInverse().asDiagonal() * best * d.cwiseInverse().asDiagonal();
  if (!P.allFinite()) throw std::invalid_argument("Riccati: the solution is too large");
  return P;
}

LqrDesign dlqr(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& Q,
               const Eigen::MatrixXd& R) {
  const Matrix P = solve_dare(A, B, Q, R);
  return {feedback({A, B, Q, R}, P), P};
}

}  // namespace breakwater
