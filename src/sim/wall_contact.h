// The contact of a sphere with a wall that moves, by any contact law.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/sim/contact.h>
#include <breakwater/sim/external_force.h>
#include <breakwater/sim/model.h>
#include <breakwater/world/contact_law.h>
#include <breakwater/world/wall_motion.h>

namespace breakwater {

/// Dry friction of a contact: −μ N v/√(|v|² + v_s²), with v the sliding velocity and N the normal
/// force. Below v_s it is a damper: the contact creeps where it would stick.
struct ContactFriction {
  double coefficient = 0.0;  ///< μ; 0: none
  double stick_m_s = 1e-3;   ///< v_s > 0
};

/// A contact law's force on a sphere at a plane of the world body, at the contact point. It is
/// along the plane's normal, with the friction across it. The engine's own contact of the two must
/// be off. The state of the law and a free wall are integrated with the plant.
///
/// If the law is MuJoCo's own (for_engine()), it applies nothing and only measures. Then the
/// engine's contact of the two is on, the wall stands, and nothing else constrains the sphere.
///
/// In contact it checks each step, at its first stage with a contact, whether the integrator is
/// stable (contact.h). It uses the law's local stiffness and damping, and the mass that the contact
/// meets. If it is not stable, it throws RunFailure, which names the longest stable timestep. The
/// friction is a damper of at most m/(h n). h is the timestep and n the number of contacts with
/// friction. m is at least half of the smallest mass across the normal, and at most all of it.
class WallContact final : public ExternalForce {
 public:
  /// Throws std::invalid_argument if the model has no such sphere, or no such plane of the world.
  WallContact(const Model& model, const std::string& sphere, const std::string& plane,
              std::unique_ptr<ContactForceLaw> law, WallMotion motion,
              const ContactFriction& friction = {});

  /// Switches the contact on or off; it begins off.
  void set_solid(bool is_solid) { is_solid_ = is_solid; }
  /// How many contacts with friction the model has: n ≥ 1. They may act on one body.
  void set_contacts_with_friction(int number) { contacts_with_friction_ = number; }

  void begin_step() override;
  void apply(double time_s, const mjModel& model, mjData& data) override;
  void end_step(const mjModel& model, const mjData& data) override;

  /// Values at the beginning of the last step. The force is 0 if the law is the engine's. A
  /// negative penetration is a gap.
  const double& force_N() const { return first_.force_N; }
  const double& penetration_m() const { return first_.penetration_m; }
  const double& friction_N() const { return first_.friction_N; }
  bool has_friction() const { return friction_.coefficient > 0.0; }
  const double& approach_m_s() const { return first_.approach_m_s; }
  const double& wall_m() const { return first_.wall.position_m; }
  /// The effective mass that the contact met at its last step with a force, with every joint free
  /// to recoil; 0: there was none yet.
  const double& mass_kg() const { return mass_kg_; }
  /// F = v √(k m) at the beginning of the last contact: the peak of the force if nothing else acts.
  /// k is the local stiffness, and v the approach velocity. 0: there was no contact yet.
  ///
  /// Source: ISO/TS 15066:2016, A.3.6.
  const double& transient_N() const { return transient_N_; }
  /// Integral of the force over the last step, by the integrator's own stages [N s].
  const double& impulse_Ns() const { return impulse_Ns_; }

  /// The law's slopes at a penetration and a speed, and the mass that the contact meets in the
  /// data's configuration.
  ContactSlopes slopes(const mjModel& model, const mjData& data, double penetration_m,
                       double speed_m_s);

 private:
  static constexpr std::size_t kMostStages = 4;

  // The values of one stage.
  struct Stage {
    double penetration_m = 0.0;
    double approach_m_s = 0.0;
    double force_N = 0.0;
    Eigen::Vector3d sliding_m_s = Eigen::Vector3d::Zero();  // across the normal
    double drag_Ns_m = 0.0;                                 // friction over sliding velocity
    double friction_N = 0.0;
    WallPosition wall;
    double wall_acceleration_m_s2 = 0.0;
    ContactState state;
  };

  void find_normal(const mjData& data);
  void find_geometry(double time_s, const mjModel& model, const mjData& data, Stage& stage);
  void find_mass(double time_s, const mjModel& model, const mjData& data, const Stage& stage);
  void check_stability(double time_s, const ContactSlopes& found) const;
  WallPosition wall_at_stage() const;
  ContactState state_at_stage() const;
  double force_of_law(Stage& stage) const;
  double engine_force_N(const mjData& data) const;
  void find_mass_across(const mjModel& model, const mjData& data);
  double mass_along(const mjModel& model, const mjData& data, const Eigen::Vector3d& direction);
  void find_friction(const mjModel& model, const mjData& data, Stage& stage);
  void add_wrench(mjData& data, const Stage& stage) const;

  int sphere_;
  int plane_;
  int body_;
  double radius_m_;
  Integrator integrator_;
  double timestep_s_;
  std::size_t stages_;
  std::unique_ptr<ContactForceLaw> law_;
  WallMotion motion_;
  ContactFriction friction_;
  bool is_solid_ = false;
  int contacts_with_friction_ = 1;

  // At the beginning of the step.
  WallPosition wall_;
  ContactState state_;

  std::array<Stage, kMostStages> stage_;
  std::size_t number_ = 0;  // the next stage
  Stage first_;
  double impulse_Ns_ = 0.0;
  double mass_kg_ = 0.0;
  double mass_across_kg_ = 0.0;
  double transient_N_ = 0.0;
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();  // out of the wall
  std::vector<double> jacobian_;                      // 3 × n, of a point of the sphere
  std::vector<double> along_;                         // Jᵀ times a direction
  std::vector<double> recoil_;                        // M⁻¹ times that
};

}  // namespace breakwater
