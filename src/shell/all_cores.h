// Work in pieces on several cores.
#pragma once

#include <cstddef>
#include <functional>

namespace breakwater {

/// The number of cores that a scheduler or taskset lets this process use.
std::size_t usable_cores();

/// Calls work(i) for i = 0 … count − 1, started in this order, on at most `threads` threads. These
/// include the calling thread; 0 means usable_cores(). If fewer threads can be started, they do all
/// the work. After an exception no new piece begins. It is thrown again when the running pieces
/// have ended.
void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& work,
                  std::size_t threads = 0);

}  // namespace breakwater
