#include <breakwater/control/pfc.h>

#include <cmath>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr double kMostSamples = 1e6;  // upper bound of the last coincidence point

// Eq. 2.76. The small factor makes 1 s/1 ms give 1000 samples in spite of rounding.
std::vector<int> coincidence_points(const PfcDesign& design) {
  std::vector<int> points;
  for (int j = 1; j <= design.coincidence_points; ++j) {
    const double samples =
        design.target_response_time_s / (design.period_s * (design.coincidence_points - j + 1));
    refuse_unless(!(samples > kMostSamples),
                  "PFC: the target response time is too long for the period");
    points.push_back(static_cast<int>(std::floor(samples * (1.0 + 1e-12))));
    // The response of a double integrator sampled as in Eq. 2.72 begins after two samples.
    refuse_unless(points.back() >= 2 && (j <= 1 || points[j - 1] > points[j - 2]),
                  "PFC: the target response time is too short for so many coincidence points");
  }
  return points;
}

// Row j: the responses at h_j to the basis functions, Σ_i C_q A_q^{h−1−i} B_q (i T_s)^l.
Eigen::MatrixXd basis_responses(const std::vector<int>& points, int bases, double period_s) {
  Eigen::MatrixXd y_b = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(points.size()), bases);
  for (Eigen::Index j = 0; j < y_b.rows(); ++j) {
    const int h = points[static_cast<std::size_t>(j)];
    for (int i = 0; i < h; ++i) {
      const double response = (h - 1 - i) * period_s * period_s;
      double basis = 1.0;
      for (int l = 0; l < bases; ++l) {
        y_b(j, l) += response * basis;
        basis *= i * period_s;
      }
    }
  }
  return y_b;
}

}  // namespace

Pfc::Pfc(const PfcDesign& design) {
  refuse_unless(is_positive(design.target_response_time_s) && is_positive(design.period_s),
                "PFC: target response time and period must be positive");
  refuse_unless(design.basis_functions >= 1 && design.basis_functions <= 3 &&
                    design.coincidence_points >= design.basis_functions,
                "PFC: needs 1 to 3 basis functions and at least as many coincidence points");
  alpha_ = math::exp(-3.0 * design.period_s / design.target_response_time_s);
  points_ = breakwater::coincidence_points(design);

  // μ_1 needs only the first row of the (pseudo-)inverse of y_b. The scale of the other columns
  // does not affect this row.
  Eigen::MatrixXd y_b = basis_responses(points_, design.basis_functions, design.period_s);
  const Eigen::RowVectorXd scale = y_b.colwise().norm();
  for (Eigen::Index l = 0; l < y_b.cols(); ++l) y_b.col(l) /= scale(l);
  const Eigen::RowVectorXd first_row = left_inverse(y_b).row(0) / scale(0);

  for (std::size_t j = 0; j < points_.size(); ++j) {
    const double weight = first_row(static_cast<Eigen::Index>(j));
    k_p_ += weight * (1.0 - math::pow(alpha_, points_[j]));
    k_d_ += weight * points_[j] * design.period_s;
  }
}

}  // namespace breakwater
