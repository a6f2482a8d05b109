#include <Eigen/LU>
#include <cmath>

#include <breakwater/linear/state_space.h>
#include <breakwater/observers/idob.h>

// A sampled double integrator, and an observer with the pole 0.9.
int main() {
  breakwater::StateSpace plant;
  plant.A = (Eigen::Matrix2d() << 0, 1, 0, 0).finished();
  plant.B = Eigen::Vector2d(0, 1);
  plant.C = Eigen::RowVector2d(1, 0);
  const breakwater::StateSpace sampled = breakwater::zero_order_hold(plant, 0.1);
  const breakwater::Idob idob(plant, {{-1.0, -2.0, -3.0}}, 0.1);
  Eigen::MatrixXd F(3, 3);
  idob.pole_matrix(F);
  const bool is_right =
      std::abs(sampled.B(0) - 0.005) < 1e-12 && std::abs(F.determinant() - std::exp(-0.6)) < 1e-9;
  return is_right ? 0 : 1;
}
