// Parts of a plant with named axes besides the axes: forces on bodies, and contacts to watch.
#pragma once

#include <string>
#include <vector>

#include <breakwater/rigs/disturbance_settings.h>

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

/// Two geoms whose contact force is logged: keys contact.NAME.….
struct ContactSettings {
  std::string name;
  std::string geom_1;
  std::string geom_2;

  std::string prefix() const { return "contact." + name + "."; }
  /// The name of its signal.
  std::string signal() const { return "contact_" + name + "_N"; }
  void bind(Fields& fields);
};

}  // namespace breakwater
