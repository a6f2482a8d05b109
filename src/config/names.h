// The names of an enumeration's members in files and options.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace breakwater {

template <typename Enum>
using Names = std::vector<std::pair<std::string, Enum>>;

/// The names of such a list, or of a map.
template <typename Pairs>
std::vector<std::string> names_of(const Pairs& pairs) {
  std::vector<std::string> all;
  for (const auto& [name, value] : pairs) all.push_back(name);
  return all;
}

/// The name of a value that has one.
template <typename Enum>
std::string name_of(const Names<Enum>& names, Enum value) {
  return std::find_if(names.begin(), names.end(), [&](const auto& n) { return n.second == value; })
      ->first;
}

}  // namespace breakwater
