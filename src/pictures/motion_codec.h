// A compact code for numbers over time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace breakwater {

/// Appends a channel: the differences of successive values (the first one from 0), rounded to
/// multiples of `unit`. Each is an integer of variable length, low seven bits first, with the sign
/// in the lowest bit (zigzag). A smooth motion takes one or two bytes per value, and a standstill
/// compresses to almost nothing. A value that is not finite repeats the value before it.
void append_channel(std::span<const double> values, double unit, std::vector<std::uint8_t>& bytes);

/// Reads a channel of `count` values that begins at `at`, and moves `at` behind it. Throws
/// std::invalid_argument if the bytes end too early.
std::vector<double> read_channel(std::span<const std::uint8_t> bytes, std::size_t& at,
                                 std::size_t count, double unit);

}  // namespace breakwater
