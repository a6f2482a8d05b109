// A robot before a wall, from its model file.
#pragma once

#include <string>
#include <vector>

#include <breakwater/plants/mjcf_tree.h>

namespace breakwater {

struct RobotScene {
  static constexpr const char* kTip = "robot_tip";
  static constexpr const char* kWall = "robot_wall";
  static constexpr const char* kStart = "robot_start";

  MjcfElement root;                 ///< the model with the three elements of these names
  std::vector<std::string> joints;  ///< from the base to the tip
  std::string tip;                  ///< which one it is, and its axis that faces the wall
};

/// Adds a ball at the tip, a plane before it, and a keyframe to a model of any MuJoCo. `tip` is a
/// site or a body; empty: the only site, or the only last body. The tip faces the wall with its
/// z axis, or with x or y if it cannot move along z. The pose is that of a keyframe "home". If
/// there is none, it is the one with the largest manipulability of many in the middle half of the
/// ranges. Throws std::invalid_argument as convert_mjcf() and Model::load(), or if there is no such
/// tip, no joint moves it, or a joint of it has no name.
RobotScene robot_before_wall(const std::string& file, const std::string& tip);

}  // namespace breakwater
