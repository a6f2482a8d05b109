// The wall that a mechanism strikes: contact laws, motion, tilt.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/experiment/parts.h>
#include <breakwater/experiment/settings.h>
#include <breakwater/sim/wall_contact.h>
#include <breakwater/world/contact_law.h>

namespace breakwater {

/// A contact law by its name: key contact.law, or contact.NAME.law of a plant. Its keys are bound
/// without that prefix.
struct ContactLawKind : PartKind<ContactForceLaw> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "contact law";
};

/// Breakwater's own.
std::vector<ContactLawKind> contact_laws();

/// Keys of the contact and of the wall's motion, and what they make.
class WallSettings {
 public:
  /// The keys contact.… and wall.…
  explicit WallSettings(const Catalogue& catalogue)
      : WallSettings(catalogue, "", "contact.", "kelvin_voigt") {}
  /// The keys contact.NAME.… and contact.NAME.wall.… of a plant. The default law leaves the
  /// engine's contact as the model file has it.
  WallSettings(const Catalogue& catalogue, const std::string& contact)
      : WallSettings(catalogue, contact, contact, kOfModel) {}

  void bind(Fields& fields);
  /// Throws std::invalid_argument `ORIGIN: KEY: reason` if there is no such law or motion. A free
  /// wall must also be stable with the timestep.
  void check(const Config& config, const PhysicsSettings& physics) const;
  /// Refuses a timestep at which an impact of a mass would not be stable, blaming
  /// physics.timestep_s. Throws std::invalid_argument.
  void check_impact(const Config& config, const PhysicsSettings& physics, double mass_kg,
                    double speed_m_s) const;

  /// Whether the contact is MuJoCo's own: then the wall collides, and stands.
  bool is_of_engine() const;
  /// Whether it is that of the model file.
  bool is_of_file() const { return law_->chosen() == kOfModel; }
  /// Puts the plane `wall` and the geoms that belong to it at x, and tilts them. Compiles the law
  /// into the model if it is MuJoCo's.
  void prepare(Model& model, const std::string& sphere, const std::string& wall, double x_m) const;
  /// The same where the model has them, also for two geoms of any shape under the engine's law.
  void prepare(Model& model, const std::string& geom, const std::string& wall) const;
  /// Moves them to where they are at a time; a free wall stays where it rests.
  void animate(Model& model, const std::string& wall, double x_m, double time_s) const;
  std::unique_ptr<WallContact> make(const Model& model, const std::string& sphere,
                                    const std::string& wall) const;
  double angle_rad() const { return angle_rad_; }
  bool has_friction() const { return friction_.coefficient > 0.0; }

  static constexpr const char* kOfModel = "model";

 private:
  WallSettings(const Catalogue& catalogue, std::string wall, std::string contact,
               const std::string& standard_law)
      : wall_(std::move(wall)),
        contact_(std::move(contact)),
        law_(std::make_shared<PartChoice<ContactLawKind>>(catalogue, "law", standard_law)) {}

  void bind_wall(Fields& fields);
  std::unique_ptr<ContactForceLaw> make_law() const;  // null: that of the model file
  WallMotion motion() const;

  std::string wall_;     // prefix of the keys wall.…
  std::string contact_;  // prefix of those of the law
  // Shared by copies of the settings, which are equal once they are read.
  std::shared_ptr<PartChoice<ContactLawKind>> law_;
  double angle_rad_ = 0.0;
  WallMotion motion_;  // without the table
  ContactFriction friction_;
  std::string file_;  // the table
};

}  // namespace breakwater
