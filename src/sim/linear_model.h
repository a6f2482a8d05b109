// A model linearised about a pose at rest, and the apparent mass of a mechanism at a point.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <span>
#include <string>
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
  ExternalForce* force;
  int joint;  ///< the joint that moves to load the spring at the pose
};

/// Linearises a model about a pose by central differences of the acceleration. Limits of joints,
/// contacts and Coulomb friction have no part in it. `joints` and `actuators` are ids. The springs
/// should have no play. Throws std::invalid_argument if a joint of the model is no hinge or slide.
LinearModel linearise(Model model, std::span<const double> qpos, const std::vector<int>& joints,
                      const std::vector<int>& actuators,
                      const std::vector<SpringOnJoint>& springs = {});

/// The apparent mass at a site for a short force along a direction e of the world; joints are free:
///     m = 1 / (eᵀ J M⁻¹ Jᵀ e)    [kg]
/// J (3 × n): translational Jacobian of the site; M (n × n): joint-space inertia with armatures.
///
/// Source: O. Khatib, Int. J. Robotics Research 14 (1995) 19–36.
class ApparentMass {
 public:
  /// `direction` is a unit vector. Throws std::invalid_argument if the site or a joint is missing.
  ApparentMass(const Model& model, const std::string& site, const Eigen::Vector3d& direction);

  /// The value for the last configuration that the engine computed; infinite if the site cannot
  /// move along e. Does not allocate.
  double operator()(const Model& model, const mjData& data);

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  int site_;
  Eigen::Vector3d direction_;
  RowMajor jacobian_;
  RowMajor inertia_;
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
  Eigen::VectorXd along_;   // Jᵀ e
  Eigen::VectorXd recoil_;  // M⁻¹ Jᵀ e
};

}  // namespace breakwater
