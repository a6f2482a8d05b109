// A sparse square matrix, such as the linear part of a process.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace breakwater::detail {

/// An N×N matrix in compressed rows. Products sum in the order of the columns. They skip the zeros
/// of the matrix, also when the other factor is not finite. Allocates nothing.
template <int N>
class SparseSquare {
 public:
  void assign(const Eigen::Matrix<double, N, N>& matrix) {
    std::size_t count = 0;
    for (int i = 0; i < N; ++i) {
      for (int k = 0; k < N; ++k) {
        if (matrix(i, k) != 0.0) entries_[count++] = {k, matrix(i, k)};
      }
      row_ends_[static_cast<std::size_t>(i)] = count;
    }
  }

  /// result = A x.
  void times(const Eigen::Matrix<double, N, 1>& x, Eigen::Matrix<double, N, 1>& result) const {
    std::size_t e = 0;
    for (int i = 0; i < N; ++i) {
      double sum = 0.0;
      for (; e < row_ends_[static_cast<std::size_t>(i)]; ++e) {
        sum += entries_[e].value * x(entries_[e].column);
      }
      result(i) = sum;
    }
  }

  /// result = X Aᵀ. X and result must not overlap.
  void transposed_times(const Eigen::Matrix<double, N, N>& X,
                        Eigen::Matrix<double, N, N>& result) const {
    std::size_t e = 0;
    for (int i = 0; i < N; ++i) {
      result.col(i).setZero();
      for (; e < row_ends_[static_cast<std::size_t>(i)]; ++e) {
        result.col(i) += entries_[e].value * X.col(entries_[e].column);
      }
    }
  }

 private:
  struct Entry {
    int column;
    double value;
  };
  std::array<Entry, static_cast<std::size_t>(N* N)> entries_{};
  std::array<std::size_t, N> row_ends_{};
};

}  // namespace breakwater::detail
