// A contact of a mechanism: its law, and the wall's motion and tilt.
#pragma once

#include <functional>
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

/// Two geoms that touch: keys contact.NAME.… and contact.NAME.wall.… of a plant. Without a law they
/// touch as in the model file. kelvin_voigt sets the parameters of both geoms, for their other
/// contacts too. A law that is a force needs a sphere and a plane of the world.
class ContactSettings {
 public:
  ContactSettings(std::string its_name, const Catalogue& catalogue)
      : name(std::move(its_name)), law_(catalogue, "law", kOfModel) {}
  /// The contact of a scenario that names the geoms itself: keys contact.… and wall.…. It begins
  /// off.
  ContactSettings(const Catalogue& catalogue, std::string geom, std::string plane)
      : geom_1(std::move(geom)), geom_2(std::move(plane)), law_(catalogue, "law", "kelvin_voigt") {}

  std::string name;
  std::string geom_1;
  std::string geom_2;

  std::string prefix() const { return name.empty() ? "contact." : "contact." + name + "."; }
  /// The name of its signal `what`.
  std::string signal(const std::string& what) const { return "contact_" + name + "_" + what; }
  bool begins_solid() const { return !name.empty(); }
  double solid_from_s = 0.0;                ///< when it is switched on
  bool is_measured = false;                 ///< by its geometry too, if it is the engine's
  std::function<double(const Model&)> x_m;  ///< where the plane stands; null: as in the file
  /// Whether the contact is MuJoCo's own: then the wall collides, and stands.
  bool is_of_engine() const;
  /// Whether it is that of the model file.
  bool is_of_file() const { return law_.chosen() == kOfModel; }
  double angle_rad() const { return angle_rad_; }
  bool has_friction() const { return friction_.coefficient > 0.0; }

  void bind(Fields& fields);
  /// Throws std::invalid_argument `ORIGIN: KEY: reason` if there is no such law or motion. A free
  /// wall must also be stable with the timestep.
  void check(const Config& config, const PhysicsSettings& physics) const;
  /// The names of the geoms. The plane comes last, if there is one.
  std::pair<std::string, std::string> geoms(const Model& model) const;
  /// Makes the model's contact that of the law, and places and tilts the wall with the geoms that
  /// belong to it. Throws std::invalid_argument if it cannot.
  void prepare(Model& model) const;
  /// Moves them from x_m() to where they are at a time; a free wall stays where it rests.
  void animate(Model& model, double time_s) const;
  /// The contact as a force, or as it is measured; null: it is the engine's alone.
  std::unique_ptr<WallContact> make(const Model& model) const;

  static constexpr const char* kOfModel = "model";

 private:
  std::string wall() const { return name.empty() ? "" : prefix(); }  // prefix of the keys wall.…
  void bind_wall(Fields& fields);
  std::unique_ptr<ContactForceLaw> make_law() const;  // null: that of the model file
  WallMotion motion() const;

  PartChoice<ContactLawKind> law_;
  double angle_rad_ = 0.0;
  WallMotion motion_;  // without the table
  ContactFriction friction_;
  std::string file_;  // the table
};

}  // namespace breakwater
