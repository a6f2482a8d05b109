// Riccati solutions by SciPy.
#pragma once

#include "python.h"

namespace breakwater::testing {

struct RiccatiProblem {
  Eigen::MatrixXd A, B, Q, R;
};

struct RiccatiSolution {
  Eigen::MatrixXd P, K;
};

/// The solution of each problem. Throws std::runtime_error if SciPy does not give them all.
inline std::vector<RiccatiSolution> solve_with_scipy(const std::vector<RiccatiProblem>& problems) {
  std::ostringstream input;
  input.precision(17);
  for (const auto& [A, B, Q, R] : problems) {
    input << A.rows() << ' ' << B.cols() << '\n'
          << A << '\n'
          << B << '\n'
          << Q << '\n'
          << R << '\n';
  }
  const std::vector<double> numbers = run_python("linear/scipy_riccati.py", input.str());
  std::size_t at = 0;
  const auto read = [&](Eigen::Index rows, Eigen::Index cols) {
    Eigen::MatrixXd matrix(rows, cols);
    for (Eigen::Index i = 0; i < rows; ++i) {
      for (Eigen::Index j = 0; j < cols; ++j) {
        if (at == numbers.size()) throw std::runtime_error("SciPy gave too few numbers");
        matrix(i, j) = numbers[at++];
      }
    }
    return matrix;
  };
  std::vector<RiccatiSolution> solutions;
  for (const RiccatiProblem& problem : problems) {
    const Eigen::Index n = problem.A.rows();
    RiccatiSolution solution;
    solution.P = read(n, n);
    solution.K = read(problem.B.cols(), n);
    solutions.push_back(solution);
  }
  return solutions;
}

}  // namespace breakwater::testing
