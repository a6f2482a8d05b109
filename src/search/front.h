// Sets of points none of which is worse than another in all.
#pragma once

#include <cstddef>
#include <vector>

#include <breakwater/search/search.h>

namespace breakwater {

/// The numbers of the points that no other dominates (is as small in every coordinate and smaller
/// in one), in their order; of equal points the first.
std::vector<std::size_t> front_of(const Vectors& points);

/// The volume that the points dominate below the reference: what lies beyond it in any coordinate
/// does not count. 0 of no points. pagmo's algorithms for 2, 3 and more dimensions.
double hypervolume_below(const Vectors& points, const std::vector<double>& reference);

/// At most `count` numbers of 0 … size − 1 with equal distances, ends included.
std::vector<std::size_t> evenly_spaced(std::size_t size, std::size_t count);

}  // namespace breakwater
