// The wall that a mechanism strikes: contact law, motion, tilt.
#pragma once

#include <memory>
#include <string>

#include <breakwater/experiment/settings.h>
#include <breakwater/rigs/contact_parts.h>
#include <breakwater/sim/wall_contact.h>

namespace breakwater {

/// Keys of the contact and of the wall's motion, and what they make.
class WallSettings {
 public:
  explicit WallSettings(const Catalogue& catalogue)
      : law_(catalogue, "contact.law", "kelvin_voigt") {}

  void bind_wall(Fields& fields);
  void bind_law(Fields& fields) { law_.bind(fields); }
  /// Throws std::invalid_argument `ORIGIN: KEY: reason` if there is no such law or motion. A free
  /// wall must also be stable with the timestep.
  void check(const Config& config, const PhysicsSettings& physics) const;
  /// Refuses a timestep at which an impact of a mass would not be stable, blaming
  /// physics.timestep_s. Throws std::invalid_argument.
  void check_impact(const Config& config, const PhysicsSettings& physics, double mass_kg,
                    double speed_m_s) const;

  /// Whether MuJoCo's own contact is the law: then the wall collides, and stands.
  bool is_of_engine() const;
  /// Puts the plane `wall` and the geoms that belong to it at x, and tilts them. Compiles the law
  /// into the model if it is MuJoCo's.
  void prepare(Model& model, const std::string& sphere, const std::string& wall, double x_m) const;
  /// Moves them to where they are at a time; a free wall stays where it rests.
  void animate(Model& model, const std::string& wall, double x_m, double time_s) const;
  std::unique_ptr<WallContact> make(const Model& model, const std::string& sphere,
                                    const std::string& wall) const;
  double angle_rad() const { return angle_rad_; }

 private:
  std::unique_ptr<ContactForceLaw> make_law() const;
  WallMotion motion() const;

  PartChoice<ContactLawKind> law_;
  double angle_rad_ = 0.0;
  WallMotion motion_;  // without the table
  std::string file_;   // the table
};

}  // namespace breakwater
