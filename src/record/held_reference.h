// Checks, sample by sample, whether a run follows its reference.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace breakwater {

/// An interval of time, both ends included.
struct TimeWindow {
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();

  bool contains(double time_s) const { return time_s >= from_s && time_s <= to_s; }
};

/// Splits the time from the reference's last change to the end of the run into eight equal parts,
/// and watches the error e = reference − response. The reference is not held if the root mean
/// square of e in the last part is at least half the distance to go. The error grows if each of the
/// last three parts has a peak of |e| at least 1.5 times that of the part before. A ramp's lag
/// grows more slowly.
class HeldReference {
 public:
  /// `what` follows the reference ("the position"), in `unit`. A window that no run covers gives no
  /// warning.
  HeldReference(const TimeWindow& window, std::string what, std::string unit)
      : window_(window), what_(std::move(what)), unit_(std::move(unit)) {}

  /// Gives the distance from the plant's position to the reference when the reference was set. The
  /// largest of several counts; one of rounding errors does not. Without it and stay_within(), only
  /// growth is checked.
  void ask(double distance) {
    constexpr double kRounding = 1e-12;  // m, rad, N
    if (std::abs(distance) > kRounding) asked_ = std::max(asked_, std::abs(distance));
  }
  /// Gives the error that is large without a distance to go.
  void stay_within(double error) { large_ = error; }
  void add(double time_s, double error);

  /// Appends a line for each problem.
  void warn(std::vector<std::string>& warnings) const;

 private:
  static constexpr std::size_t kParts = 8;
  static constexpr std::size_t kGrowing = 4;

  bool grows() const;

  TimeWindow window_;
  std::string what_;
  std::string unit_;
  double asked_ = 0.0;
  double large_ = std::numeric_limits<double>::infinity();
  std::array<double, kParts> peaks_{};
  std::array<std::int64_t, kParts> samples_{};
  double last_sum_of_squares_ = 0.0;
};

}  // namespace breakwater
