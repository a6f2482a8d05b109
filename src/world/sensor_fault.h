// A sensor that breaks.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include <breakwater/math/refuse_unless.h>
#include <breakwater/world/delay_line.h>

namespace breakwater {

/// The readings of a broken sensor, from the reading y of the whole one.
enum class FaultKind {
  nan,       ///< not a number
  infinity,  ///< +∞
  frozen,    ///< the last reading before the fault
  dropped,   ///< the same, for SensorFault::kDropped_s: no reading arrives
  spike,     ///< y + size, −size at the next sample, and so on
  bias,      ///< y + size
  delay,     ///< the reading of `delay_samples` samples before
  stuck      ///< y towards 0 in multiples of size: the quantiser's lower bits are stuck at 0
};

/// A fault of one channel. It ends, and the sensor is whole again.
struct SensorFault {
  static constexpr double kDropped_s = 0.05;

  std::string channel;  ///< empty: no fault
  double at_s = 0.0;    ///< starts at the first sample at or after this time
  int samples = 1;      ///< number of samples, except for FaultKind::dropped
  FaultKind kind = FaultKind::nan;
  double size = 0.0;      ///< in the channel's unit: spike, bias and stuck
  int delay_samples = 1;  ///< delay
};

/// Applies a fault to the readings of its channel. Allocates nothing.
class FaultySensor {
 public:
  /// `step_s` is the physics step. Throws std::invalid_argument if delay_samples is negative, the
  /// size is not finite, or that of a stuck quantiser is not positive.
  FaultySensor(const SensorFault& fault, double step_s)
      : fault_(fault), from_s_(fault.at_s - 0.5 * step_s), delay_(fault.delay_samples) {
    refuse_unless(
        std::isfinite(fault.size) && (fault.kind != FaultKind::stuck || fault.size > 0.0),
        "sensor fault: the size must be finite, and a stuck quantiser's must be positive");
  }

  /// The reading at a sampling instant, from the one `y` of the whole sensor. Call it for each
  /// sample, also before the fault.
  double update(double time_s, double y) {
    const double delayed = delay_.update(y);
    if (!is_broken(time_s)) return last_ = y;
    ++broken_;
    switch (fault_.kind) {
      case FaultKind::nan:
        return std::numeric_limits<double>::quiet_NaN();
      case FaultKind::infinity:
        return std::numeric_limits<double>::infinity();
      case FaultKind::spike:
        return broken_ % 2 == 1 ? y + fault_.size : y - fault_.size;
      case FaultKind::bias:
        return y + fault_.size;
      case FaultKind::delay:
        return delayed;
      case FaultKind::stuck:
        return fault_.size * std::trunc(y / fault_.size);
      case FaultKind::frozen:
      case FaultKind::dropped:
        break;
    }
    return std::isnan(last_) ? last_ = y : last_;
  }

 private:
  bool is_broken(double time_s) const {
    if (time_s < from_s_) return false;
    return fault_.kind == FaultKind::dropped ? time_s < from_s_ + SensorFault::kDropped_s
                                             : broken_ < fault_.samples;
  }

  SensorFault fault_;
  double from_s_;
  DelayLine delay_;
  std::int64_t broken_ = 0;  // samples of the fault so far
  double last_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace breakwater
