// A model linearised about a pose at rest.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include <breakwater/linear/state_space.h>
#include <breakwater/sim/external_force.h>
#include <breakwater/sim/model.h>

namespace breakwater {

/// M(q) of a pose: the joints' inertia, with armatures, over all degrees of freedom.
Eigen::MatrixXd joint_inertia(const Model& model, std::span<const double> qpos);

struct LinearModel {
  StateSpace plant;  ///< continuous: x = [Δq; q̇], u of the chosen actuators less held_input,
                     ///< y = Δq of the chosen joints
  Eigen::VectorXd held_input;  ///< the actuators' values that hold the pose, by least squares
  Eigen::VectorXd qpos;        ///< the pose, with the springs twisted by its load
  double acceleration = 0.0;   ///< the largest acceleration that remains [rad/s² or m/s²]
};

/// A force between joints that a model lacks.
struct SpringOnJoint {
  const ExternalForce* force;
  int joint;  ///< the joint that moves to load the spring at the pose
};

/// Linearises a model about a pose by central differences of the acceleration. Limits of joints,
/// contacts and Coulomb friction have no part in it. `joints` and `actuators` are ids. The springs
/// should have no play. Throws std::invalid_argument if a joint of the model is no hinge or slide.
LinearModel linearise(Model model, std::span<const double> qpos, const std::vector<int>& joints,
                      const std::vector<int>& actuators,
                      const std::vector<SpringOnJoint>& springs = {});

}  // namespace breakwater
