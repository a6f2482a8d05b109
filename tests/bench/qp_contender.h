// The interface for qp_bench: any solver of quadratic programs with constant H and Ω.
#pragma once

#include <memory>

#include <breakwater/linear/qp.h>

namespace breakwater {

/// A solver with its state from the last program. Only solve() is measured.
class QpContender {
 public:
  QpContender() = default;
  QpContender(const QpContender&) = delete;
  QpContender& operator=(const QpContender&) = delete;
  virtual ~QpContender() = default;

  /// Converts the next program to the solver's form. Its data are then in the cache.
  virtual void prepare(const QpInput& input) = 0;
  virtual void solve() = 0;
  /// z, μ and the status of the last program, and other results of the solver.
  virtual const QpSolution& solution() = 0;
};

/// A solver with the interface of qp.h.
class OwnQpContender final : public QpContender {
 public:
  explicit OwnQpContender(std::unique_ptr<QpSolver> solver)
      : solver_(std::move(solver)),
        input_(solver_->model().H.rows(), solver_->model().Omega.rows()),
        solution_(solver_->model().H.rows(), solver_->model().Omega.rows()) {}

  void prepare(const QpInput& input) override { input_ = input; }
  void solve() override { solver_->solve(input_, solution_); }
  const QpSolution& solution() override { return solution_; }

 private:
  std::unique_ptr<QpSolver> solver_;
  QpInput input_;
  QpSolution solution_;
};

}  // namespace breakwater
