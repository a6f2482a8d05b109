// Work in pieces on all cores.
#pragma once

#include <cstddef>
#include <functional>

namespace breakwater {

/// Calls work(i) for i = 0 … count − 1, in that order of starting, on as many threads as there are
/// cores, this one included. After the first exception no piece is begun; once those under way have
/// ended, it is thrown.
void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& work);

}  // namespace breakwater
