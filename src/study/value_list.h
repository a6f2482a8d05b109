// Values of a key that are written as a rule: "lin(0.06, 0.12, 4)".
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// Whether a text is meant as a rule: it begins with "lin(" or "log(".
bool is_value_list(const std::string& text);

/// n values from a to b, the ends exactly so:
///     "lin(a,b,n)"    xᵢ = a + (b − a) i/(n − 1)      evenly
///     "log(a,b,n)"    xᵢ = a (b/a)^(i/(n − 1))        evenly in the logarithm; 0 < a
/// The same bits on every processor. A value that is a number of at most 12 digits but for
/// rounding is that number: lin(0.06,0.12,4) has the 0.08 that one would write, not
/// 0.07999999999999999.
///
/// Throws std::invalid_argument if the text is neither, an end is not finite, a ≥ b, a ≤ 0 in a
/// logarithm, b − a or b/a is too large for a double, or n is not an integer of 2 … 10 000 000.
std::vector<double> value_list(const std::string& text);

}  // namespace breakwater
