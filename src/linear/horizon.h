// Quadratic programs of predictive control: products with their matrices in a time that is linear
// in the horizon.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace breakwater {

/// What a quadratic program over input changes ΔU = [Δu_0; …; Δu_{N_u − 1}] is made of, for
/// x_{i+1} = A x_i + B u_i and u_i = u_{i−1} + Δu_i, of which Δu_i = 0 from i = N_u on:
///     ½ ΔUᵀ H ΔU = ½ Σ_{i=1}^{N_p − 1} ‖x_i‖²_Q + ½ ‖x_{N_p}‖²_{Q_last}
///                  + ½ Σ_{i=0}^{N_u − 1} ‖Δu_i‖²_R + ‖u_i‖²_S   from x_0 = 0 and u_{−1} = 0,
/// and Ω ΔU its rows.
struct Horizon {
  enum class RowKind { change, input, state };
  struct Row {
    RowKind kind;
    int step;                ///< i of Δu_i or u_i, from 0 on; of x_i, from 1 on
    Eigen::Index component;  ///< of it
  };

  Eigen::MatrixXd A;  ///< n×n
  Eigen::MatrixXd B;  ///< n×m
  int prediction_steps = 0;
  int control_steps = 0;
  Eigen::MatrixXd Q;       ///< n×n
  Eigen::MatrixXd Q_last;  ///< n×n
  Eigen::MatrixXd R;       ///< m×m
  Eigen::MatrixXd S;       ///< m×m
  std::vector<Row> rows;
};

/// Products with H and Ω by rolling the plant out, forwards, and its adjoint, backwards: some
/// N_p (n² + n m) multiplications instead of (N_u m)² and more. They differ from the dense ones by
/// rounding. Nothing is allocated after the construction.
class HorizonSweeps {
 public:
  HorizonSweeps() = default;
  HorizonSweeps(const HorizonSweeps&) = delete;
  HorizonSweeps& operator=(const HorizonSweeps&) = delete;
  virtual ~HorizonSweeps() = default;

  /// values = Ω ΔU.
  virtual void rows(const Eigen::VectorXd& changes, Eigen::VectorXd& values) = 0;

  /// gradient = H ΔU + Ωᵀ μ.
  virtual void gradient(const Eigen::VectorXd& changes, const Eigen::VectorXd& mu,
                        Eigen::VectorXd& gradient) = 0;

  /// The states [x_1; …; x_{N_p}] from x_0 and u_{−1} on without any change of the input.
  virtual void free_response(const Eigen::Ref<const Eigen::VectorXd>& x,
                             const Eigen::Ref<const Eigen::VectorXd>& u,
                             Eigen::VectorXd& states) = 0;

  /// The slope at ΔU = 0 of the cost of states that are off by `errors` (N_p n) and of inputs u:
  /// with Z = Θ ΔU and U = C_2 ΔU, Θᵀ Q̅ errors + C_2ᵀ S̅ [u; …; u].
  virtual void slope(const Eigen::VectorXd& errors, const Eigen::Ref<const Eigen::VectorXd>& u,
                     Eigen::VectorXd& g) = 0;
};

/// nullptr where there is none: it is made for plants of up to 4 states and one input. Throws
/// std::invalid_argument if the shapes do not fit, a horizon is none, or a row is not there.
std::unique_ptr<HorizonSweeps> make_horizon_sweeps(const Horizon& horizon);

}  // namespace breakwater
