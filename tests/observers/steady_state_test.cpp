// The filters' steady states against SciPy's solutions of the Riccati equation.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "linear/pole_placement.h"
#include "observers/fakfd.h"
#include "observers/idob.h"
#include "observers/kfd.h"
#include "support.h"

namespace breakwater {
namespace {

using testing::Random;

struct Problem {
  Eigen::MatrixXd A, C, Q, R;
};

void write(std::ostream& out, const Eigen::MatrixXd& matrix) {
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) out << ' ' << matrix(i, j);
  }
}

std::vector<Eigen::MatrixXd> solve_with_scipy(const std::vector<Problem>& problems) {
  const auto input = testing::temporary_path("dare_in.txt");
  const auto output = testing::temporary_path("dare_out.txt");
  const testing::Removed removed_input(input), removed_output(output);
  {
    std::ofstream file(input);
    file.precision(17);
    for (const Problem& p : problems) {
      file << p.A.rows() << ' ' << p.C.rows();
      for (const auto* matrix : {&p.A, &p.C, &p.Q, &p.R}) write(file, *matrix);
      file << '\n';
    }
  }
  const std::string command = "/usr/bin/python3 " +
                              testing::source_file("tests/observers/dare.py") + " < " +
                              input.string() + " > " + output.string();
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::vector<Eigen::MatrixXd> solutions;
  std::ifstream file(output);
  std::string line;
  for (const Problem& p : problems) {
    std::getline(file, line);
    std::istringstream numbers(line);
    Eigen::MatrixXd X(p.A.rows(), p.A.rows());
    for (Eigen::Index i = 0; i < X.size(); ++i) numbers >> X(i);
    EXPECT_TRUE(numbers) << "SciPy gave no solution";
    solutions.push_back(X);  // symmetric, so by rows or columns is the same
  }
  return solutions;
}

StateSpace random_plant(Random& random, Eigen::Index n, Eigen::Index p) {
  Eigen::MatrixXd A = random.matrix(n, n);
  A *= random.uniform(0.5, 0.98) / A.eigenvalues().cwiseAbs().maxCoeff();
  return {A, random.matrix(n, 1), random.matrix(p, n)};
}

// P(k|k) of the filter after it has settled, and what the Riccati solution X = P(k+1|k) says of it.
// A factor Γ makes it the solution for A √Γ, with P(k|k) = √Γ (X − X Cᵀ (C X Cᵀ + R)⁻¹ C X) √Γ.
TEST(KalmanEstimators, SettleAtTheSolutionOfTheRiccatiEquation) {
  Random random(21);
  std::vector<Problem> problems;
  std::vector<Eigen::MatrixXd> settled, roots;
  for (int trial = 0; trial < 12; ++trial) {
    const Eigen::Index n = 1 + trial % 3, p = 1 + trial % 2;
    KalmanDesign design;
    design.plant =
        extend_by_disturbance_model(random_plant(random, n, p), p == 1 ? trial % 3 : 0, 1.0);
    const Eigen::Index N = design.plant.states();
    design.Q = uniform_noise(design.plant, random.uniform(0.01, 1.0));
    design.R = random.uniform(0.1, 2.0) * Eigen::MatrixXd::Identity(p, p);
    design.P0 = Eigen::MatrixXd::Identity(N, N);
    for (const Eigen::VectorXd& gamma :
         {scalar_gamma(design.plant, 1.0), scalar_gamma(design.plant, 1.05),
          diagonal_gamma(design.plant, 1.1)}) {
      Fakfd<> filter(design, gamma);
      for (int k = 0; k < 5000; ++k) {
        filter.update(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(p));
      }
      roots.emplace_back(gamma.cwiseSqrt().asDiagonal());
      problems.push_back(
          {design.plant.sampled.A * roots.back(), design.plant.sampled.C, design.Q, design.R});
      settled.emplace_back(filter.P());
    }
  }
  const std::vector<Eigen::MatrixXd> solutions = solve_with_scipy(problems);
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const auto& [A, C, Q, R] = problems[i];
    const Eigen::MatrixXd& X = solutions[i];
    const Eigen::MatrixXd D = C * X * C.transpose() + R;
    const Eigen::MatrixXd posterior = X - X * C.transpose() * D.ldlt().solve(C * X);
    const Eigen::MatrixXd expected = roots[i] * posterior * roots[i];
    EXPECT_LT((settled[i] - expected).norm(), 1e-7 * expected.norm()) << i;
  }
}

// The error of an IDOB has exactly the poles that were placed, on random plants too.
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
    // By Cayley and Hamilton: the product of all F − z I is 0 if the z are F's eigenvalues. Unlike
    // these, it does not suffer where the plant is hard to observe.
    const Eigen::MatrixXd F = observer.error_dynamics();
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
