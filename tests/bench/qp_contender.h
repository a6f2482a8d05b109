// What qp_bench can measure: any solver of quadratic programs that keeps H and Ω.
#pragma once

#include <memory>
#include <string>

#include <breakwater/linear/qp.h>
#include "qp_sequence.h"

namespace breakwater {

/// One solver with its memory of the last program. Only solve() is measured.
class QpContender {
 public:
  QpContender() = default;
  QpContender(const QpContender&) = delete;
  QpContender& operator=(const QpContender&) = delete;
  virtual ~QpContender() = default;

  /// The next program, in whatever form the solver takes it: its data are in the cache after that.
  virtual void prepare(const QpInput& input) = 0;
  virtual void solve() = 0;
  /// z, μ and the status of the last program; whatever else of it the solver tells.
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

/// DAQP (https://github.com/darnstrom/daqp), where the build was given its sources
/// (-DBREAKWATER_DAQP=DIR), with its workspace, working set and factor kept. Leading rows that
/// bound one variable each are general rows, or `simple` bounds. nullptr without DAQP, or where
/// there is no such row.
std::unique_ptr<QpContender> make_daqp(const QpSequence& sequence, bool simple);

}  // namespace breakwater
