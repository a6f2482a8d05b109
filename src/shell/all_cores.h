// Work in pieces on all cores.
#pragma once

#include <cstddef>
#include <functional>

namespace breakwater {

/// How many this process may use: fewer than there are where a scheduler or taskset gave it some.
std::size_t usable_cores();

/// Calls work(i) for i = 0 … count − 1, in that order of starting, on at most `threads` threads,
/// this one included; 0: as many as usable_cores(). Where the machine gives fewer threads, those
/// that it gives do all the work. After the first exception no piece is begun; once those under way
/// have ended, it is thrown.
void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& work,
                  std::size_t threads = 0);

}  // namespace breakwater
