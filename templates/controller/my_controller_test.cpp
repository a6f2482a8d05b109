// Tests the controller alone, with joints that match the nominal model: q̈ = J_n⁻¹ u.
#include "my_controller.h"

#include <cmath>
#include <cstdio>

namespace {

int failures = 0;

void expect_near(const char* what, double value, double expected, double tolerance) {
  if (std::abs(value - expected) <= tolerance) return;
  std::printf("%s is %.12g, and not %.12g\n", what, value, expected);
  ++failures;
}

breakwater::PlanarJoint joint(double offset_m) {
  breakwater::PlanarJoint joint;
  joint.offset_m = {offset_m, 0.0};
  joint.effort_limit_Nm = 100.0;
  joint.velocity_limit_rad_s = 10.0;
  joint.link_mass_kg = 1.0;
  joint.link_inertia_kgm2 = 0.01;
  return joint;
}

// Three links of 0.2 m. `load_planar_chain(FILE)` would read a URDF.
breakwater::ArmSetup setup() {
  const breakwater::PlanarChain chain({joint(0.0), joint(0.2), joint(0.2)}, {0.2, 0.0}, 0.0);

  breakwater::AccelerationControlDesign acceleration;
  acceleration.nominal_inertia_kgm2 = Eigen::Vector3d(2.0, 1.5, 1.0);
  acceleration.torque_limit_Nm = chain.effort_limits_Nm();
  acceleration.observer = breakwater::joint_idobs(
      acceleration.nominal_inertia_kgm2, {{-40, -43, -46}, {-41, -44, -47}, {-42, -45, -48}}, 1e-3);

  breakwater::ArmTask task;
  task.start_angles_rad = Eigen::Vector3d(0.9, -1.8, 0.9);
  task.start_pose = chain.tip_pose(task.start_angles_rad);
  task.force_control_from_s = 6.0;
  task.force_reference_N = 2.0;
  return {chain, acceleration, task, 1e-3};
}

// The arm goes from the stretched pose to the start angles, and then moves in free space.
void bends_its_elbow_and_approaches() {
  const breakwater::ArmSetup arm = setup();
  const my_controller_lab::MyControllerDesign design;
  my_controller_lab::MyController controller(arm, design);
  Eigen::Vector3d q = Eigen::Vector3d::Zero(), dq = Eigen::Vector3d::Zero();
  Eigen::VectorXd u(3);
  breakwater::Sample sample;
  sample.y.resize(5);
  const double T = arm.period_s;
  for (int k = 0; k < 8000; ++k) {
    sample.time_s = k * T;
    sample.y << q, 0.0, 0.0;  // angles and force, before and after its low-pass
    if (k == 0) controller.reset(sample);
    if (k == 6000) {
      for (int i = 0; i < 3; ++i) {
        expect_near("a start angle", q[i], arm.task.start_angles_rad[i], 1e-4);
      }
    }
    controller.update(sample, u);
    const Eigen::Vector3d ddq = u.cwiseQuotient(arm.acceleration.nominal_inertia_kgm2);
    q += T * dq + 0.5 * T * T * ddq;
    dq += T * ddq;
  }
  // After 100 M/D the speed is F^ref/D.
  breakwater::TaskJacobian J(3, 3);
  arm.chain->tip_jacobian(q, J);
  const Eigen::Vector3d velocity = J * dq;
  const double speed_m_s = arm.task.force_reference_N / design.virtual_damping_Ns_m;
  expect_near("the tip's speed in x", velocity[0], speed_m_s, 1e-4);
  expect_near("the tip's way in y", arm.chain->tip_pose(q)[1], arm.task.start_pose[1], 1e-3);
  if (!(q[1] < 0.0)) {
    std::printf("the elbow is at %.3g rad, bent the other way\n", q[1]);
    ++failures;
  }
}

}  // namespace

int main() {
  bends_its_elbow_and_approaches();
  return failures == 0 ? 0 : 1;
}
