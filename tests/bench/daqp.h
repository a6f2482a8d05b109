// DAQP (https://github.com/darnstrom/daqp) with persistent workspace, working set and factor. It
// needs its sources (-DBREAKWATER_DAQP=DIR).
#pragma once

#include <api.h>
#include <constants.h>
#include <utils.h>

#include <breakwater/linear/qp.h>

namespace breakwater {

constexpr double kPrimalTolerance = 5e-9;  // allowed violation of a constraint, as in our solver

// The number of leading constraints that bound one variable each, in order. DAQP may take them as
// simple bounds.
inline int leading_unit_rows(const QpModel& model) {
  Eigen::Index count = 0;
  while (count < std::min(model.H.rows(), model.Omega.rows()) &&
         model.Omega.row(count) == Eigen::RowVectorXd::Unit(model.H.rows(), count)) {
    ++count;
  }
  return static_cast<int>(count);
}

class Daqp {
 public:
  Daqp(const QpModel& model, int simple)
      : H_(model.H),
        general_(model.Omega.bottomRows(model.Omega.rows() - simple)),
        f_(Eigen::VectorXd::Zero(model.H.rows())),
        lower_(Eigen::VectorXd::Constant(model.Omega.rows(), -DAQP_INF)),
        upper_(Eigen::VectorXd::Constant(model.Omega.rows(), DAQP_INF)),
        solution_(model.H.rows(), model.Omega.rows()) {
    problem_.n = static_cast<int>(model.H.rows());
    problem_.m = static_cast<int>(model.Omega.rows());
    problem_.ms = simple;
    problem_.H = H_.data();
    problem_.f = f_.data();
    problem_.A = general_.data();
    problem_.bupper = upper_.data();
    problem_.blower = lower_.data();
    result_.x = solution_.z.data();
    result_.lam = solution_.mu.data();
    setup_daqp(&problem_, &workspace_, nullptr);
    workspace_.settings->primal_tol = kPrimalTolerance;
  }
  Daqp(const Daqp&) = delete;
  Daqp& operator=(const Daqp&) = delete;
  ~Daqp() {
    free_daqp_workspace(&workspace_);
    free_daqp_ldp(&workspace_);
  }

  void prepare(const QpInput& input) {
    f_ = input.g;
    lower_ = input.lower.cwiseMax(-DAQP_INF);
    upper_ = input.upper.cwiseMin(DAQP_INF);
  }
  void solve() {
    result_.exitflag = daqp_update_ldp(DAQP_UPDATE_v | DAQP_UPDATE_d, &workspace_, &problem_);
    if (result_.exitflag >= 0) daqp_solve(&result_, &workspace_);
  }
  const QpSolution& solution() {
    solution_.status =
        result_.exitflag == DAQP_EXIT_OPTIMAL ? QpStatus::solved : QpStatus::iteration_cap;
    solution_.iterations = result_.iter;
    return solution_;
  }

 private:
  Eigen::MatrixXd H_;
  QpModel::RowMajor general_;
  Eigen::VectorXd f_, lower_, upper_;
  QpSolution solution_;
  DAQPProblem problem_{};
  DAQPWorkspace workspace_{};
  DAQPResult result_{};
};

}  // namespace breakwater
