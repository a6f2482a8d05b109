// Points of a study as ranges: "0-99,120".
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace breakwater {

/// Reads ranges of points such as "0-99,120", sorted and without repetition. Throws
/// std::invalid_argument if the text is not valid or a point is not below `size`.
std::vector<std::size_t> parse_points(const std::string& text, std::size_t size);
std::string print_points(const std::vector<std::size_t>& points);

}  // namespace breakwater
