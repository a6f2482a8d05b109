#include <breakwater/plants/motor_and_load.h>

#include <cmath>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

void check(const TwoInertia& plant) {
  refuse_unless(
      is_positive(plant.motor_inertia) && is_positive(plant.load_inertia) &&
          is_positive(plant.stiffness) && is_positive(plant.ratio) &&
          is_not_negative(plant.damping) && is_not_negative(plant.motor_friction) &&
          is_not_negative(plant.load_friction),
      "two inertias: need inertias, a stiffness and a ratio > 0, and damping and friction >= 0");
}

StateSpace motor_and_load(const TwoInertia& p, Side measured) {
  check(p);
  const Eigen::Index motor = measured == Side::motor ? 0 : 2, load = 2 - motor;
  StateSpace plant{Eigen::Matrix4d::Zero(), Eigen::Vector4d::Zero(), Eigen::RowVector4d::Unit(0)};
  plant.A(0, 1) = plant.A(2, 3) = 1.0;
  // The torque T = twist · x.
  Eigen::RowVector4d twist;
  twist.segment<2>(motor) << p.stiffness / p.ratio, p.damping / p.ratio;
  twist.segment<2>(load) << -p.stiffness, -p.damping;
  plant.A.row(motor + 1) = -twist / (p.ratio * p.motor_inertia);
  plant.A(motor + 1, motor + 1) -= p.motor_friction / p.motor_inertia;
  plant.A.row(load + 1) = twist / p.load_inertia;
  plant.A(load + 1, load + 1) -= p.load_friction / p.load_inertia;
  plant.B(motor + 1, 0) = 1.0 / p.motor_inertia;
  return plant;
}

Eigen::VectorXd load_torque_input(const TwoInertia& plant, Side measured) {
  check(plant);
  return Eigen::Vector4d::Unit(measured == Side::motor ? 3 : 1) / plant.load_inertia;
}

double antiresonance_rad_s(const TwoInertia& plant) {
  return std::sqrt(plant.stiffness / plant.load_inertia);
}

double resonance_rad_s(const TwoInertia& plant) {
  return std::sqrt(plant.stiffness * (1.0 / (plant.ratio * plant.ratio * plant.motor_inertia) +
                                      1.0 / plant.load_inertia));
}

}  // namespace breakwater
