#include <breakwater/statistics/sensitivity.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

namespace breakwater {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Outputs with a smaller relative difference differ only by rounding.
constexpr double kRounding = 1e-12;

RowMajor without_missing(const Eigen::MatrixXd& f) {
  RowMajor kept(f.rows(), f.cols());
  Eigen::Index rows = 0;
  for (Eigen::Index j = 0; j < f.rows(); ++j) {
    if (f.row(j).allFinite()) kept.row(rows++) = f.row(j);
  }
  return kept.topRows(rows);
}

// The terms of the estimators, in the rows of f: f_A + f_B, f_A² + f_B², for each i f_B (f_AB −
// f_A), f_AB − f_A and (f_A − f_AB)²/2. Scaling and centring the outputs against overflow and loss
// of digits does not change the indices.
RowMajor summands(RowMajor f) {
  const Eigen::Index d = f.cols() - 2;
  f /= f.cwiseAbs().maxCoeff();
  f.array() -= 0.5 * (f.col(0).mean() + f.col(d + 1).mean());
  RowMajor terms(f.rows(), 2 + 3 * d);
  for (Eigen::Index j = 0; j < f.rows(); ++j) {
    const double f_A = f(j, 0), f_B = f(j, d + 1);
    terms(j, 0) = f_A + f_B;
    terms(j, 1) = f_A * f_A + f_B * f_B;
    for (Eigen::Index i = 0; i < d; ++i) {
      const double change = f(j, 1 + i) - f_A;
      terms(j, 2 + 3 * i) = f_B * change;
      terms(j, 3 + 3 * i) = change;
      terms(j, 4 + 3 * i) = 0.5 * change * change;
    }
  }
  return terms;
}

// S_1, T_1, S_2, T_2 … from the means of the terms; nothing without variance.
std::optional<Eigen::VectorXd> indices_of(const Eigen::VectorXd& means) {
  const double mu = 0.5 * means(0), square = 0.5 * means(1);
  const double variance = square - mu * mu;
  if (!(variance > kRounding * square)) return std::nullopt;
  const Eigen::Index d = (means.size() - 2) / 3;
  Eigen::VectorXd indices(2 * d);
  for (Eigen::Index i = 0; i < d; ++i) {
    indices(2 * i) = (means(2 + 3 * i) - mu * means(3 + 3 * i)) / variance;
    indices(2 * i + 1) = means(4 + 3 * i) / variance;
  }
  return indices;
}

bool varies(const RowMajor& f) {
  const Eigen::VectorXd A = f.leftCols(1), B = f.rightCols(1);
  const double lower = std::min(A.minCoeff(), B.minCoeff());
  const double upper = std::max(A.maxCoeff(), B.maxCoeff());
  return upper - lower > kRounding * std::max(std::abs(lower), std::abs(upper));
}

// The indices of each replicate with variance, one per column.
Eigen::MatrixXd replicate(const RowMajor& terms, int count) {
  std::mt19937_64 draw(1);
  const auto rows = static_cast<std::uint64_t>(terms.rows());
  Eigen::MatrixXd replicates(2 * (terms.cols() - 2) / 3, count);
  Eigen::Index defined = 0;
  for (int r = 0; r < count; ++r) {
    Eigen::VectorXd times = Eigen::VectorXd::Zero(terms.rows());
    // The numbers of std::uniform_int_distribution depend on the library.
    for (std::uint64_t k = 0; k < rows; ++k) {
      times(static_cast<Eigen::Index>(draw() % rows)) += 1.0;
    }
    // Summed in the order of the rows: Eigen's product has an order that depends on the cache.
    Eigen::RowVectorXd sums = Eigen::RowVectorXd::Zero(terms.cols());
    for (Eigen::Index j = 0; j < terms.rows(); ++j) {
      if (times(j) != 0.0) sums += times(j) * terms.row(j);
    }
    const auto indices = indices_of(sums.transpose() / static_cast<double>(rows));
    if (indices) replicates.col(defined++) = *indices;
  }
  return replicates.leftCols(defined);
}

// The interval of an index from its replicates, of which `drawn` were drawn.
std::optional<ConfidenceInterval> interval_of(const Eigen::MatrixXd& replicates, Eigen::Index index,
                                              int drawn) {
  const auto defined = static_cast<double>(replicates.cols());
  if (defined < 1.0 || defined < 0.95 * drawn) return std::nullopt;
  const auto row = replicates.row(index);
  std::vector<double> sorted(row.begin(), row.end());
  std::sort(sorted.begin(), sorted.end());
  constexpr double kTail = 0.5 * (1.0 - 0.95);
  return ConfidenceInterval{quantile(sorted, kTail), quantile(sorted, 1.0 - kTail)};
}

}  // namespace

SensitivityIndices sensitivity_indices(const Eigen::MatrixXd& f, int replicates) {
  const RowMajor kept = without_missing(f);
  SensitivityIndices result;
  result.rows = kept.rows();
  result.dropped_rows = f.rows() - kept.rows();
  if (kept.rows() < 2 || !varies(kept)) return result;

  const RowMajor terms = summands(kept);
  const auto indices = indices_of(terms.colwise().mean().transpose());
  if (!indices) return result;
  const Eigen::MatrixXd drawn = replicate(terms, replicates);
  for (Eigen::Index i = 0; i < indices->size(); ++i) {
    (i % 2 == 0 ? result.first_order : result.total)
        .push_back({(*indices)(i), interval_of(drawn, i, replicates)});
  }
  return result;
}

}  // namespace breakwater
