// Matrix products for predictive control, in a time that is linear in the horizon.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include <breakwater/math/interface.h>

namespace breakwater {

/// The data of a quadratic program over input changes ΔU = [Δu_0; …; Δu_{N_u − 1}]. The plant is
/// x_{i+1} = A x_i + B u_i with u_i = u_{i−1} + Δu_i, and Δu_i = 0 from i = N_u on:
///     ½ ΔUᵀ H ΔU = ½ Σ_{i=1}^{N_p − 1} ‖x_i‖²_Q + ½ ‖x_{N_p}‖²_{Q_last}
///                  + ½ Σ_{i=0}^{N_u − 1} ‖Δu_i‖²_R + ‖u_i‖²_S   from x_0 = 0 and u_{−1} = 0,
/// and Ω ΔU has the rows.
struct Horizon {
  enum class RowKind { change, input, state };
  struct Row {
    RowKind kind;
    int step;                ///< i of Δu_i or u_i, from 0 on, or of x_i, from 1 on
    Eigen::Index component;  ///< index in Δu_i, u_i or x_i
  };

  Eigen::MatrixXd A;         ///< n×n, of the sampled model
  Eigen::MatrixXd B;         ///< n×m
  int prediction_steps = 0;  ///< N_p
  int control_steps = 0;     ///< N_u ≤ N_p: after them the input is constant
  Eigen::MatrixXd Q;         ///< n×n, positive semidefinite: weight on the states
  Eigen::MatrixXd Q_last;    ///< n×n, the same at step N_p: terminal weight (Eq. 2.49)
  Eigen::MatrixXd R;         ///< m×m, positive semidefinite: weight on Δu
  Eigen::MatrixXd S;         ///< m×m, positive semidefinite: weight on u
  std::vector<Row> rows;
};

/// Products with H and Ω by simulation of the plant forwards and of its adjoint backwards. They
/// take about N_p (n² + n m) multiplications instead of (N_u m)² or more. They differ from the
/// dense products by rounding. Nothing is allocated after construction.
class HorizonSweeps : public Interface {
 public:
  /// values = Ω ΔU.
  virtual void rows(const Eigen::VectorXd& changes, Eigen::VectorXd& values) = 0;

  /// gradient = H ΔU + Ωᵀ μ.
  virtual void gradient(const Eigen::VectorXd& changes, const Eigen::VectorXd& mu,
                        Eigen::VectorXd& gradient) = 0;

  /// The states [x_1; …; x_{N_p}] from x_0 with the constant input u_{−1}.
  virtual void free_response(const Eigen::Ref<const Eigen::VectorXd>& x,
                             const Eigen::Ref<const Eigen::VectorXd>& u,
                             Eigen::VectorXd& states) = 0;

  /// Gradient of the cost at ΔU = 0, for state errors `errors` (N_p n) and inputs u. With Z = Θ ΔU
  /// and U = C_2 ΔU it is Θᵀ Q̅ errors + C_2ᵀ S̅ [u; …; u].
  virtual void slope(const Eigen::VectorXd& errors, const Eigen::Ref<const Eigen::VectorXd>& u,
                     Eigen::VectorXd& g) = 0;
};

/// Returns nullptr unless the plant has up to 4 states and one input. Throws std::invalid_argument
/// if the shapes do not fit, a horizon is invalid, or a row does not exist.
std::unique_ptr<HorizonSweeps> make_horizon_sweeps(const Horizon& horizon);

}  // namespace breakwater
