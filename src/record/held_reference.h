// Whether a run holds its reference, told sample by sample.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/record/window_metrics.h>

namespace breakwater {

/// Watches the error e = reference − what follows it, from the reference's last change to the run's
/// end, in eight equal parts of that time. Not held: the last part's root mean square is half of
/// what was asked for, or more. Growing: each of the last three parts has a peak of |e| 1.5 times
/// that of the part before, or more. That is growth by a power of the time; a ramp's lag is none.
class HeldReference {
 public:
  /// `what` follows the reference ("the position"), in `unit`. A window that no run covers is no
  /// window: nothing is said.
  HeldReference(const TimeWindow& window, std::string what, std::string unit)
      : window_(window), what_(std::move(what)), unit_(std::move(unit)) {}

  /// How far the reference is from where the plant was when it was given; of several the largest.
  /// Without it only growth is watched for.
  void ask(double distance) { asked_ = std::max(asked_, std::abs(distance)); }
  void add(double time_s, double error);

  /// Appends one line on what is wrong, if anything is.
  void warn(std::vector<std::string>& warnings) const;

 private:
  static constexpr std::size_t kParts = 8;
  static constexpr std::size_t kGrowing = 4;

  bool grows() const;

  TimeWindow window_;
  std::string what_;
  std::string unit_;
  double asked_ = 0.0;
  std::array<double, kParts> peaks_{};
  std::array<std::int64_t, kParts> samples_{};
  double last_sum_of_squares_ = 0.0;
};

}  // namespace breakwater
