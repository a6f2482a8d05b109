// The direction in which a metric is better.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace breakwater {

enum class Goal { none, min, max };

/// Names in files; `none` has no name.
inline const std::vector<std::pair<std::string, Goal>>& goal_names() {
  static const std::vector<std::pair<std::string, Goal>> names = {{"min", Goal::min},
                                                                  {"max", Goal::max}};
  return names;
}

}  // namespace breakwater
