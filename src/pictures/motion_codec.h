// Numbers over time in few bytes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace breakwater {

/// Appends a channel: the values as multiples of `unit`, rounded, each less the one before it (the
/// first less 0), as an integer of variable length, low seven bits first, sign in the lowest bit
/// (zigzag). Smooth motion takes one or two bytes a value, standing still one that deflates to next
/// to nothing. What is not finite repeats the value before it.
void append_channel(std::span<const double> values, double unit, std::vector<std::uint8_t>& bytes);

/// The values of a channel of `count` values that begins at `at`, which is moved behind it. Throws
/// std::invalid_argument if the bytes end before.
std::vector<double> read_channel(std::span<const std::uint8_t> bytes, std::size_t& at,
                                 std::size_t count, double unit);

}  // namespace breakwater
