#include <breakwater/control/lmpc.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <breakwater/control/controller.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/math/refuse_unless.h>
#include <breakwater/signals/thread_time.h>

namespace breakwater {

Prediction predict(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, int prediction_steps,
                   int control_steps) {
  const Eigen::Index n = A.rows();
  const Eigen::Index m = B.cols();
  refuse_unless(n != 0 && m != 0 && A.cols() == n && B.rows() == n,
                "prediction: A must be n×n and B n×m");
  refuse_unless(1 <= control_steps && control_steps <= prediction_steps,
                "prediction: needs 1 <= control steps <= prediction steps");
  Prediction prediction{Eigen::MatrixXd(prediction_steps * n, n),
                        Eigen::MatrixXd(prediction_steps * n, m),
                        Eigen::MatrixXd::Zero(prediction_steps * n, control_steps * m)};
  Eigen::MatrixXd power = Eigen::MatrixXd::Identity(n, n);  // Aⁱ
  Eigen::MatrixXd response = Eigen::MatrixXd::Zero(n, m);   // S_i
  for (int i = 0; i < prediction_steps; ++i) {
    response += power * B;
    power = A * power;
    prediction.Psi.middleRows(i * n, n) = power;
    prediction.Gamma.middleRows(i * n, n) = response;
  }
  for (int i = 0; i < prediction_steps; ++i) {
    for (int j = 0; j <= std::min(i, control_steps - 1); ++j) {
      prediction.Theta.block(i * n, j * m, n, m) = prediction.Gamma.middleRows((i - j) * n, n);
    }
  }
  return prediction;
}
namespace {

// U = C_1 u + C_2 ΔU, where C_1 is the first block column of C_2.
Eigen::MatrixXd sums(int steps, Eigen::Index inputs) {
  Eigen::MatrixXd C2 = Eigen::MatrixXd::Zero(steps * inputs, steps * inputs);
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j <= i; ++j) C2.block(i * inputs, j * inputs, inputs, inputs).setIdentity();
  }
  return C2;
}

}  // namespace

int samples_per_move(double period_s, double sampling_s) {
  constexpr double kWhole = 1e-9;  // relative error of a whole multiple
  const double samples = std::round(period_s / sampling_s);
  refuse_unless(samples >= 1.0 && !(std::abs(period_s - samples * sampling_s) > kWhole * samples),
                "predictive control: the period must be a whole multiple of the sampling period");
  return static_cast<int>(samples);
}

std::vector<int> first_steps(int count) {
  std::vector<int> steps(static_cast<std::size_t>(count));
  std::iota(steps.begin(), steps.end(), 0);
  return steps;
}

std::vector<int> spread_steps(int count, int last) {
  std::vector<int> steps;
  for (int i = 1; i <= count; ++i) {
    steps.push_back(static_cast<int>(std::lround(static_cast<double>(i) * last / count)));
  }
  return steps;
}

Lmpc::Lmpc(const LmpcDesign& design)
    : design_(design),
      prediction_(predict(design.A, design.B, design.prediction_steps, design.control_steps)),
      solver_(make_qp_solver(design.solver, make_model(), design.max_iterations)),
      input_(solver_->model().H.rows(), solver_->model().Omega.rows()),
      solution_(solver_->model().H.rows(), solver_->model().Omega.rows()),
      u_(Eigen::VectorXd::Zero(inputs())),
      reserved_(u_),
      reference_(Eigen::VectorXd::Zero(prediction_.Psi.rows())),
      free_(reference_),
      errors_(reference_),
      change_(u_) {
  refuse_unless(design.on_infeasible != OnInfeasible::soften || design.softness > 0.0,
                "predictive control: the softness must be positive");
}

QpModel Lmpc::make_model() {
  const Eigen::Index n = states();
  const Eigen::Index m = inputs();
  const int N_p = design_.prediction_steps;
  const int N_u = design_.control_steps;
  if (design_.S.size() == 0) design_.S = Eigen::MatrixXd::Zero(m, m);
  add_rows(RowKind::change, design_.change_bounds, m);
  add_rows(RowKind::input, design_.input_bounds, m);
  add_rows(RowKind::state, design_.state_bounds, n);
  design_.rows.assign(rows_.begin(), rows_.end());
  QpModel model{{}, QpModel::RowMajor(rows_.size(), N_u * m), make_horizon_sweeps(design_)};
  refuse_unless(is_positive_semidefinite(design_.Q) && is_positive_semidefinite(design_.Q_last) &&
                    is_positive_semidefinite(design_.R) && is_positive_semidefinite(design_.S),
                "predictive control: the weights must be symmetric and positive semidefinite");

  weighted_ = prediction_.Theta.transpose();
  for (int i = 0; i < N_p; ++i) {
    const Eigen::MatrixXd& weight = i + 1 < N_p ? design_.Q : design_.Q_last;
    weighted_.middleCols(i * n, n) *= weight;
  }
  const Eigen::MatrixXd C2 = sums(N_u, m);
  Eigen::MatrixXd weighted_inputs = C2.transpose();
  Eigen::MatrixXd H = weighted_ * prediction_.Theta;
  for (int i = 0; i < N_u; ++i) {
    weighted_inputs.middleCols(i * m, m) *= design_.S;
    H.block(i * m, i * m, m, m) += design_.R;
  }
  H += weighted_inputs * C2;
  sums_ = weighted_inputs * C2.leftCols(m);

  model.H = 0.5 * (H + H.transpose());
  const Eigen::MatrixXd changes = Eigen::MatrixXd::Identity(N_u * m, N_u * m);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const RowKind kind = rows_[i].kind;
    const Eigen::MatrixXd& of_kind = kind == RowKind::change  ? changes
                                     : kind == RowKind::input ? C2
                                                              : prediction_.Theta;
    model.Omega.row(static_cast<Eigen::Index>(i)) = of_kind.row(rows_[i].at);
  }
  return model;
}

void Lmpc::add_rows(RowKind kind, const std::vector<PredictedBound>& bounds, Eigen::Index width) {
  const int first_step = kind == RowKind::state ? 1 : 0;
  for (std::size_t b = 0; b < bounds.size(); ++b) {
    const PredictedBound& bound = bounds[b];
    refuse_unless(bound.lower <= bound.upper,
                  "predictive control: a lower bound is above its upper bound");
    for (const int step : bound.steps) {
      rows_.push_back({{kind, step, bound.component},
                       (step - first_step) * width + bound.component,
                       bound.lower,
                       bound.upper,
                       b});
    }
  }
}

void Lmpc::reset() {
  u_.setZero();
  solver_->reset();
  softened_bounds_ = 0.0;
  statistics_ = {};
}

const Eigen::VectorXd& Lmpc::optimise(const Eigen::Ref<const Eigen::VectorXd>& x) {
  set_slope(x);
  set_bounds();
  input_.softness.setZero();
  softened_bounds_ = iterations_ = elapsed_s_ = 0.0;

  solve();
  ++statistics_.optimisations;
  if (solution_.status != QpStatus::solved) ++statistics_.unsolved;
  if (solution_.status == QpStatus::infeasible && design_.on_infeasible == OnInfeasible::soften) {
    ++statistics_.softened;
    soften();
  }
  statistics_.most_iterations =
      std::max(statistics_.most_iterations, static_cast<int>(iterations_));
  statistics_.time_s += elapsed_s_;
  statistics_.longest_s = std::max(statistics_.longest_s, elapsed_s_);
  if (solution_.status == QpStatus::infeasible) {
    throw ControlFailure("no input satisfies the constraints");
  }
  if (solution_.status == QpStatus::not_finite) {
    throw ControlFailure("predictive control: the state is not finite");
  }
  change_ = solution_.z.head(inputs());
  if (solution_.status == QpStatus::iteration_cap || solution_.status == QpStatus::inaccurate) {
    ++statistics_.capped;
    // Keeps the violations of Hildreth's method visible.
    if (design_.solver == QpSolverKind::active_set) {
      clip(RowKind::change);
      clip(RowKind::input);
    }
  }
  u_ += change_;
  return change_;
}

// Moves Δu(k) into the rows of this kind at the first step.
void Lmpc::clip(RowKind kind) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (rows_[i].kind != kind || rows_[i].step != 0) continue;
    const auto row = static_cast<Eigen::Index>(i);
    double& change = change_(rows_[i].component);
    change = std::clamp(change, input_.lower(row), input_.upper(row));
  }
}

// g = Θᵀ Q̅ (Ψ x + Γ u − T_ref) + C_2ᵀ S̅ C_1 u.
void Lmpc::set_slope(const Eigen::Ref<const Eigen::VectorXd>& x) {
  if (HorizonSweeps* const sweeps = qp_model().sweeps.get()) {
    sweeps->free_response(x, u_, free_);
    errors_ = free_ - reference_;
    sweeps->slope(errors_, u_, input_.g);
    return;
  }
  free_.noalias() = prediction_.Psi * x;
  free_.noalias() += prediction_.Gamma * u_;
  errors_ = free_ - reference_;
  input_.g.noalias() = weighted_ * errors_;
  input_.g.noalias() += sums_ * u_;
}

void Lmpc::soften() {
  for (std::size_t bound = 0; bound < design_.state_bounds.size(); ++bound) {
    give_way(RowKind::state, bound);
    ++softened_bounds_;
    solve();
    if (solution_.status != QpStatus::infeasible) return;
  }
  if (design_.change_bounds.empty()) return;
  for (std::size_t bound = 0; bound < design_.change_bounds.size(); ++bound) {
    give_way(RowKind::change, bound);
  }
  ++softened_bounds_;
  solve();
}

void Lmpc::give_way(RowKind kind, std::size_t bound) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (rows_[i].kind == kind && rows_[i].bound == bound) {
      input_.softness(static_cast<Eigen::Index>(i)) = design_.softness;
    }
  }
}

void Lmpc::set_bounds() {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[i];
    double already = 0.0;  // value of the bounded quantity at ΔU = 0
    if (row.kind == RowKind::input) {
      already = u_(row.component) + reserved_(row.component);
    } else if (row.kind == RowKind::state) {
      already = free_(row.at);
    }
    input_.lower(static_cast<Eigen::Index>(i)) = row.lower - already;
    input_.upper(static_cast<Eigen::Index>(i)) = row.upper - already;
  }
}

void Lmpc::solve() {
  const double start_s = thread_time_s();
  solver_->solve(input_, solution_);
  elapsed_s_ += thread_time_s() - start_s;
  iterations_ += solution_.iterations;
  statistics_.iterations += solution_.iterations;
}

}  // namespace breakwater
