// Pareto fronts and their hypervolume.
#pragma once

#include <cstddef>
#include <vector>

#include <breakwater/search/search.h>

namespace breakwater {

/// The indices of the points that no other point dominates, in ascending order. A point dominates
/// another one if no coordinate is larger and one is smaller. Only the first of equal points
/// counts.
std::vector<std::size_t> front_of(const Vectors& points);

/// The volume that the points dominate below the reference. Points beyond the reference in a
/// coordinate do not count. 0 without points. It uses pagmo's algorithms for 2, 3 and more
/// dimensions.
double hypervolume_below(const Vectors& points, const std::vector<double>& reference);

/// At most `count` numbers of 0 … size − 1 with equal distances, including both ends.
std::vector<std::size_t> evenly_spaced(std::size_t size, std::size_t count);

}  // namespace breakwater
