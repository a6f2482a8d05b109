// A hand at the end of a link of a planar chain.
#pragma once

#include <span>
#include <vector>

#include <breakwater/plants/planar_chain.h>
#include <breakwater/sim/external_force.h>
#include <breakwater/sim/model.h>
#include <breakwater/world/hand.h>

namespace breakwater {

/// The force of a Hand on a link's end, perpendicular to the line from the link's joint to it.
class HandOnLink final : public ExternalForce {
 public:
  /// Grips link `link` (1, 2, …) of a chain in a posture (one angle [rad] per joint). Throws
  /// std::invalid_argument if the model lacks the chain's joints or the site linkN_end.
  HandOnLink(const Hand& hand, const Model& model, const PlanarChain& chain,
             const Eigen::VectorXd& gripped_angles_rad, int link);

  void apply(double time_s, const mjModel& model, mjData& data) override;

  /// Rotation of the link since the grip [rad].
  double turned_rad(std::span<const double> qpos) const;
  /// The hand's moment about the link's joint [N m].
  double moment_Nm(double time_s, std::span<const double> qpos, std::span<const double> qvel) const;

 private:
  Hand hand_;
  int joint_;
  int body_;
  int end_;
  std::vector<double> senses_;
  std::vector<std::size_t> qpos_;
  std::vector<std::size_t> dofs_;
  double gripped_angle_rad_ = 0.0;
};

}  // namespace breakwater
