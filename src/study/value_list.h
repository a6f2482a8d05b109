// Lists of values given by a rule, such as "lin(0.06, 0.12, 4)".
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace breakwater {

/// Whether a text begins with "lin(" or "log(".
bool is_value_list(const std::string& text);

/// n values from a to b, with exact ends:
///     "lin(a,b,n)"    xᵢ = a + (b − a) i/(n − 1)      evenly
///     "log(a,b,n)"    xᵢ = a (b/a)^(i/(n − 1))        evenly in the logarithm; 0 < a
/// The values have the same bits on every processor. A value that differs from a number of at most
/// 12 digits only by rounding becomes this number: lin(0.06,0.12,4) contains 0.08, not
/// 0.07999999999999999.
///
/// Throws std::invalid_argument if the text is not valid, an end is not finite, a ≥ b, or a ≤ 0 for
/// log. Also if b − a or b/a is too large for a double, or n is not an integer of 2 … 10 000 000.
std::vector<double> value_list(const std::string& text);

/// Reads ranges of points such as "0-99,120", sorted and without repetition. Throws
/// std::invalid_argument if the text is not valid or a point is not below `size`.
std::vector<std::size_t> parse_points(const std::string& text, std::size_t size);
std::string print_points(const std::vector<std::size_t>& points);

}  // namespace breakwater
