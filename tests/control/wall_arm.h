// The arm of the URDF against a wall, for controllers that reach it on a path.
#pragma once

#include <breakwater/control/path_control.h>
#include "control/controller_signal.h"
#include "support.h"

namespace breakwater::testing {

/// A task of 2 N, and a wall 50 mm from the start pose.
class WallArm {
 public:
  WallArm() : chain_(load_planar_chain(source_file("models/arm.urdf"))) {
    acceleration_.nominal_inertia_kgm2 = Eigen::Vector3d(1.0, 0.87, 0.82);
    acceleration_.torque_limit_Nm = chain_.effort_limits_Nm();
    acceleration_.observer =
        joint_idobs(acceleration_.nominal_inertia_kgm2,
                    std::vector<PoleGroup>(3, {-150.0, -157.5, -165.0}), kPeriod);
    const double bend = std::acos(0.625);
    task_.start_angles_rad = Eigen::Vector3d(bend, -2 * bend, bend);
    task_.start_pose = chain_.tip_pose(task_.start_angles_rad);
    task_.force_control_from_s = 0.0;
    task_.force_reference_N = 2.0;
    task_.force_lag_s = 0.05;
    task_.wall_x_m = task_.start_pose[0] + 0.05;
    path_.positioning = Positioning::workspace;
    path_.joints.assign(3, Pfc());
    path_.across = Pfc({.target_response_time_s = 0.2});
    path_.approach = Pfc({.target_response_time_s = 0.1});
  }

  ArmSetup arm() const { return {chain_, acceleration_, task_, kPeriod}; }

  static double signal(const Controller& controller, const std::string& name) {
    return testing::signal(controller, name)(0);
  }

  struct Course {
    double free_s = -1.0;     // until the first contact
    double peak_N = 0.0;      // largest force behind the lag
    double raw_peak_N = 0.0;  // largest force
    double last_N = 0.0;
    double across = 0.0;  // largest |y|
    int onsets = 0;
  };

  // An arm with three independent inertias J_n without friction, and a wall, by Euler's method.
  Course run(Controller& law, double stiffness, double duration_s) const {
    Eigen::Vector3d q = task_.start_angles_rad, dq = Eigen::Vector3d::Zero();
    constexpr int kSubsteps = 20;
    const double h = kPeriod / kSubsteps;
    Sample sample;
    sample.y.resize(5);
    Eigen::VectorXd u(3);
    TaskJacobian J(3, 3);
    Course course;
    double force = 0.0, filtered = 0.0;
    for (int k = 0; k * kPeriod < duration_s; ++k) {
      sample.time_s = k * kPeriod;
      sample.y << q, filtered, force;
      if (k == 0) law.reset(sample);
      law.update(sample, u);
      EXPECT_TRUE(u.allFinite());
      EXPECT_TRUE((u.cwiseAbs() - acceleration_.torque_limit_Nm).maxCoeff() < 1e-9);
      for (int i = 0; i < kSubsteps; ++i) {
        const TipVector tip = chain_.tip_pose(q);
        chain_.tip_jacobian(q, J);
        const double depth = tip[0] - task_.wall_x_m;
        const double before = force;
        force = depth > 0.0 ? std::max(0.0, stiffness * depth + 10.0 * (J * dq)[0]) : 0.0;
        if (before == 0.0 && force > 0.0) ++course.onsets;
        if (course.free_s < 0.0 && force > 0.0) course.free_s = k * kPeriod;
        filtered += h / task_.force_lag_s * (force - filtered);
        course.peak_N = std::max(course.peak_N, filtered);
        course.raw_peak_N = std::max(course.raw_peak_N, force);
        course.across = std::max(course.across, std::abs(tip[1] - task_.start_pose[1]));
        const Eigen::Vector3d torque = u - J.row(0).transpose() * force;
        dq += h * torque.cwiseQuotient(acceleration_.nominal_inertia_kgm2);
        q += h * dq;
      }
    }
    course.last_N = filtered;
    return course;
  }

  static constexpr double kPeriod = 1e-3;
  PlanarChain chain_;
  AccelerationControlDesign acceleration_;
  ArmTask task_;
  PathDesign path_;
};

}  // namespace breakwater::testing
