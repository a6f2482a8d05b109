// Moving-horizon estimation with the encoder code's interval as constraints (MHE).
#pragma once

#include <memory>
#include <vector>

#include <breakwater/linear/qp.h>
#include <breakwater/observers/guarded_kalman.h>
#include <breakwater/observers/kalman_estimator.h>
#include <breakwater/observers/sensor_error.h>

namespace breakwater {

/// The state x̄ of the sample k − M and the changes w of the disturbance since then minimise
///     ‖x̄_{k−M} − x̄_{k−M|k−M−1}‖²_{P⁻¹} + Σ w_i²/q + Σ (y_i + m_i − C̅ x̄_i)²/R
/// over the model x̄_{i+1} = A̅ x̄_i + B̅ u_i + e_d w_i, subject to the codes' intervals
///     y_i + lower_i − 3σ ≤ C̅ x̄_i ≤ y_i + upper_i + 3σ,
/// for the M + 1 ≤ horizon samples since k − M, with the middle m_i of an interval. P is the
/// steady-state covariance of the Kalman filter, and x̄_{k−M|k−M−1} its prediction from the
/// estimate of the sample before. Without the constraints, every horizon gives the Kalman filter in
/// steady state. The rows are soft, since a mismatch of the plant can make the codes contradict
/// the model. A missing measurement counts as its prediction. At each sample an active-set solver
/// solves the quadratic program.
///
/// Sources: C. V. Rao, J. B. Rawlings, J. H. Lee, Automatica 37 (2001) 1619–1628; the covariance of
/// a fixed filter keeps the matrices of the program constant.
class Mhe final : public Guarded<> {
 public:
  /// The design has one input, one output and process noise on the highest derivative of d alone.
  /// P0 is not used. Throws std::invalid_argument if it is invalid or the horizon is not from 1 to
  /// 50, and as solve_dare() does.
  Mhe(const KalmanDesign& design, const SensorError& sensor, int horizon, bool has_constraints);

  void reset(const Vector& x) override;
  View state() const override { return {estimate_.data(), plant_states_}; }
  View disturbance() const override { return {estimate_.data() + plant_states_, 1}; }

 private:
  struct Window {
    std::unique_ptr<QpSolver> solver;
    QpInput input;
    QpSolution solution;
  };
  struct Sample {
    double u = 0.0;  // since the sample before
    double y = 0.0;
    CodeRange range{};
    Eigen::VectorXd prior = {};  // x̄ from the estimate of the sample before
    Eigen::VectorXd free = {};   // x̄ without changes since the oldest sample's prior
  };

  void step(const Vector& held_input, const Vector& y) override;
  void solve(Window& window);

  StateSpace plant_;  // A̅, B̅, C̅
  Eigen::Index plant_states_;
  SensorError sensor_;
  bool has_constraints_;
  double root_R_;
  Eigen::VectorXd changed_;      // √q e_d
  Eigen::MatrixXd root_P_;       // P = root_P_ root_P_ᵀ
  std::vector<Window> windows_;  // for 1, 2, … samples
  std::vector<Sample> samples_;  // the oldest first
  std::size_t count_ = 0;        // samples since the reset, at most the horizon
  Eigen::VectorXd estimate_;
  double innovation_ = 0.0;
};

}  // namespace breakwater
