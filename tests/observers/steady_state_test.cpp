// The steady states of the filters against SciPy's Riccati solutions.

#include <breakwater/linear/pole_placement.h>
#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/kfd.h>
#include "linear/scipy_riccati.h"
#include "observers/random_plant.h"

namespace breakwater {
namespace {

using testing::Random;
using testing::random_plant;

// P(k|k) of the converged filter, compared with the Riccati solution X = P(k+1|k). A factor Γ makes
// it the solution for A √Γ, with P(k|k) = √Γ (X − X Cᵀ (C X Cᵀ + R)⁻¹ C X) √Γ.
TEST(KalmanEstimators, ConvergeToTheSolutionOfTheRiccatiEquation) {
  Random random(21);
  std::vector<testing::RiccatiProblem> problems;  // dual problem: Aᵀ, Cᵀ
  std::vector<Eigen::MatrixXd> settled, roots;
  for (int trial = 0; trial < 12; ++trial) {
    const Eigen::Index n = 1 + trial % 3, p = 1 + trial % 2;
    KalmanDesign design;
    design.plant =
        extend_by_disturbance_model(random_plant(random, n, 1, p), p == 1 ? trial % 3 : 0, 1.0);
    const Eigen::Index N = design.plant.states();
    design.Q = uniform_noise(design.plant, random.uniform(0.01, 1.0));
    design.R = random.uniform(0.1, 2.0) * Eigen::MatrixXd::Identity(p, p);
    design.P0 = Eigen::MatrixXd::Identity(N, N);
    for (const Eigen::VectorXd& gamma :
         {scalar_gamma(design.plant, 1.0), scalar_gamma(design.plant, 1.05),
          diagonal_gamma(design.plant, 1.1)}) {
      Fakfd filter(design, gamma);
      for (int k = 0; k < 5000; ++k) {
        filter.update(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(p));
      }
      roots.emplace_back(gamma.cwiseSqrt().asDiagonal());
      problems.push_back({(design.plant.sampled.A * roots.back()).transpose(),
                          design.plant.sampled.C.transpose(), design.Q, design.R});
      settled.emplace_back(filter.P());
    }
  }
  const std::vector<testing::RiccatiSolution> solutions = testing::solve_with_scipy(problems);
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const Eigen::MatrixXd C = problems[i].B.transpose();
    const Eigen::MatrixXd& R = problems[i].R;
    const Eigen::MatrixXd& X = solutions[i].P;
    const Eigen::MatrixXd D = C * X * C.transpose() + R;
    const Eigen::MatrixXd posterior = X - X * C.transpose() * D.ldlt().solve(C * X);
    const Eigen::MatrixXd expected = roots[i] * posterior * roots[i];
    EXPECT_LT((settled[i] - expected).norm(), 1e-7 * expected.norm()) << i;
  }
}

// The error of an IDOB has exactly the placed poles, also on random plants.
TEST(Idob, ErrorOfRandomPlantsHasThePlacedPoles) {
  Random random(22);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Index n = 1 + trial % 3;
    const StateSpace plant{random.matrix(n, n), random.matrix(n, 1), random.matrix(1, n)};
    const double period = random.uniform(0.05, 0.3);
    PoleGroup continuous, sampled;
    for (Eigen::Index i = 0; i <= n; ++i) {
      continuous.emplace_back(-2.0 - 1.5 * static_cast<double>(i), 0.0);
      sampled.push_back(std::exp(continuous.back() * period));
    }
    const Idob observer(plant, {continuous}, period);
    // By Cayley and Hamilton the product of all F − z I is 0 if the z are the eigenvalues of F.
    // This test stays accurate for a plant that is hard to observe.
    Eigen::MatrixXd F(n + 1, n + 1);
    observer.pole_matrix(F);
    const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(F.rows(), F.cols());
    Eigen::MatrixXd product = I;
    double scale = 1.0;
    for (const auto& z : sampled) {
      product = product * (F - z.real() * I);
      scale *= (F - z.real() * I).norm();
    }
    EXPECT_LT(product.norm(), 1e-11 * scale) << trial;
  }
}

}  // namespace
}  // namespace breakwater
