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

/// The first name of a value; empty if it has none.
template <typename Enum>
std::string name_of(const Names<Enum>& names, const Enum& value) {
  const auto found = std::ranges::find(names, value, &std::pair<std::string, Enum>::second);
  return found != names.end() ? found->first : "";
}

}  // namespace breakwater
