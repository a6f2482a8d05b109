#include <breakwater/observers/mhe.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include <breakwater/linear/riccati.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr int kLongestHorizon = 50;
constexpr double kNoiseMargin = 3.0;
constexpr double kSoftness = 1e-3;  // each row's, in standard deviations

}  // namespace

// The variables are z = [p; w₁/√q; …], with x̄_{k−M} = prior + root_P p. The rows are C̅ x̄_i/√R.
Mhe::Mhe(const KalmanDesign& design, const SensorError& sensor, int horizon, bool has_constraints)
    : plant_(design.plant.sampled),
      plant_states_(design.plant.plant_states),
      sensor_(sensor),
      has_constraints_(has_constraints) {
  check(design);
  check(sensor, 1);
  refuse_unless(plant_.inputs() == 1 && plant_.outputs() == 1,
                "MHE: needs one input and one output");
  refuse_unless(horizon >= 1 && horizon <= kLongestHorizon,
                "MHE: the horizon must be from 1 to 50 samples");
  const Eigen::Index N = plant_.states();
  root_R_ = std::sqrt(design.R(0, 0));
  changed_ = std::sqrt(design.Q(N - 1, N - 1)) * Eigen::VectorXd::Unit(N, N - 1);
  const Eigen::MatrixXd P =
      solve_dare(plant_.A.transpose(), plant_.C.transpose(), design.Q, design.R);
  root_P_ = P.llt().matrixL();

  // states: x̄_i from z, for the newest sample of a window.
  const auto samples = static_cast<Eigen::Index>(horizon);
  Eigen::MatrixXd states = Eigen::MatrixXd::Zero(N, N + samples - 1);
  states.leftCols(N) = root_P_;
  QpModel::RowMajor rows = QpModel::RowMajor::Zero(samples, N + samples - 1);
  for (Eigen::Index i = 0; i < samples; ++i) {
    if (i > 0) {
      states = (plant_.A * states).eval();
      states.col(N + i - 1) = changed_;
    }
    rows.row(i) = plant_.C * states / root_R_;
    const Eigen::Index variables = N + i;
    QpModel model;
    model.Omega = rows.topLeftCorner(i + 1, variables);
    model.H =
        Eigen::MatrixXd::Identity(variables, variables) + model.Omega.transpose() * model.Omega;
    windows_.push_back({make_qp_solver(QpSolverKind::active_set, model, 1),
                        QpInput(variables, i + 1), QpSolution(variables, i + 1)});
    windows_.back().input.softness.setConstant(kSoftness);
  }
  samples_.resize(static_cast<std::size_t>(horizon));
  for (Sample& sample : samples_) sample.prior = sample.free = Eigen::VectorXd::Zero(N);
  estimate_ = Eigen::VectorXd::Zero(N);
  signals_ = {{"innovation", "", "e = y - q(k|k-1)", view(innovation_)}};
}

void Mhe::reset(const Vector& x) {
  count_ = 0;
  estimate_.setZero();
  estimate_.head(x.size()) = x;
  innovation_ = 0.0;
  for (Window& window : windows_) window.solver->reset();
}

void Mhe::step(const Vector& held_input, const Vector& y) {
  const bool begins = count_ == 0;
  if (count_ < samples_.size()) {
    ++count_;
  } else {
    std::rotate(samples_.begin(), samples_.begin() + 1, samples_.end());
  }
  Sample& newest = samples_[count_ - 1];
  newest.u = held_input(0);
  newest.prior = estimate_;
  if (!begins) {
    newest.prior.noalias() = plant_.A * estimate_;
    newest.prior += plant_.B.col(0) * newest.u;
  }
  const double predicted = plant_.C.row(0).dot(newest.prior);
  newest.y = is_measured_ ? y(0) : predicted;
  newest.range = {-kNoBound, kNoBound};
  if (is_measured_) newest.range = code_range(newest.y, sensor_.quantum(0), sensor_.rounding);
  innovation_ = newest.y - predicted;
  solve(windows_[count_ - 1]);
}

void Mhe::solve(Window& window) {
  const QpModel& model = window.solver->model();
  const double margin = kNoiseMargin * sensor_.noise_std(0);
  QpInput& input = window.input;
  input.g.setZero();
  for (std::size_t i = 0; i < count_; ++i) {
    Sample& sample = samples_[i];
    if (i == 0) {
      sample.free = sample.prior;
    } else {
      sample.free.noalias() = plant_.A * samples_[i - 1].free;
      sample.free += plant_.B.col(0) * sample.u;
    }
    const auto row = static_cast<Eigen::Index>(i);
    const double free = plant_.C.row(0).dot(sample.free);
    const bool is_code = std::isfinite(sample.range.lower);
    const double middle = is_code ? sample.range.middle() : 0.0;
    input.g += model.Omega.row(row).transpose() * ((free - sample.y - middle) / root_R_);
    const bool is_bounded = has_constraints_ && is_code && sensor_.quantum(0) > 0.0;
    input.lower(row) =
        is_bounded ? (sample.y + sample.range.lower - margin - free) / root_R_ : -kNoBound;
    input.upper(row) =
        is_bounded ? (sample.y + sample.range.upper + margin - free) / root_R_ : kNoBound;
  }
  window.solver->solve(input, window.solution);
  const Eigen::VectorXd& z = window.solution.z;
  const Eigen::Index N = plant_.states();
  // The newest state, from the oldest one on. The free responses are not needed any more.
  samples_[0].free.noalias() += root_P_ * z.head(N);
  for (std::size_t i = 1; i < count_; ++i) {
    Sample& sample = samples_[i];
    sample.free.noalias() = plant_.A * samples_[i - 1].free;
    sample.free += plant_.B.col(0) * sample.u + changed_ * z(N + static_cast<Eigen::Index>(i) - 1);
  }
  estimate_ = samples_[count_ - 1].free;
}

}  // namespace breakwater
