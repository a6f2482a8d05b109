// The resolution of an encoder, found in its positions.
#pragma once

#include <span>

namespace breakwater {

/// The largest Δ with which all differences between successive positions are whole counts, within
/// 5 % of a count. 0 if there is none, or if the position never moves.
///
/// The first guesses are the least difference, and the gaps between sorted differences. A line
/// through (count, position) removes the rounding of printed digits.
double encoder_quantum(std::span<const double> positions);

}  // namespace breakwater
