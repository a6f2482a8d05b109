// Parts of a plant with named axes besides the axes: forces on bodies, contacts, the tip's sensor.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/control/reference.h>
#include <breakwater/rigs/disturbance_settings.h>
#include <breakwater/rigs/force_sensor_settings.h>
#include <breakwater/rigs/wall_settings.h>

namespace breakwater {

/// A force on a body: keys push.NAME.….
struct PushSettings {
  std::string name;
  std::string body;
  std::vector<double> along;  ///< direction in the world, of any length
  DisturbanceSettings disturbance;

  std::string prefix() const { return "push." + name + "."; }
  void bind(Fields& fields);
};

/// Two geoms whose contact force is logged: keys contact.NAME.…. Without a law they touch as in the
/// model file. kelvin_voigt sets the parameters of both geoms, for their other contacts too. A law
/// that is a force needs a sphere and a plane of the world.
struct ContactSettings {
  ContactSettings(std::string its_name, const Catalogue& catalogue)
      : name(std::move(its_name)), wall(catalogue, prefix()) {}

  std::string name;
  std::string geom_1;
  std::string geom_2;
  WallSettings wall;

  std::string prefix() const { return "contact." + name + "."; }
  /// The name of its signal `what`.
  std::string signal(const std::string& what = "N") const { return "contact_" + name + "_" + what; }
  void bind(Fields& fields);
  /// The names of the geoms. The plane comes last, if there is one.
  std::pair<std::string, std::string> geoms(const Model& model) const;
  /// Makes the model's contact that of the law. Throws std::invalid_argument if it cannot.
  void prepare(Model& model) const;
  /// The contact as a force; null: it is the engine's.
  std::unique_ptr<WallContact> make(const Model& model) const;
};

/// The force sensor of the tip and the reference of its force: keys tip.…, sensor.force_…, force.….
struct TipSettings {
  static constexpr const char* kNone = "none";

  std::string contact = kNone;  ///< its force is the true one
  std::string sensor = kNone;   ///< kNone: the force of the contact is measured itself
  int component = 0;
  ForceSensorSettings chain;
  Reference reference;  ///< 0 until it begins

  void bind(Fields& fields);
  /// Puts the tool's mass before the sensor.
  void add_tool(Model& model) const;
};

}  // namespace breakwater
