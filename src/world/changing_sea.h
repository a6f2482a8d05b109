// A sea whose peak period may change during a run.
#pragma once

#include <Eigen/Core>
#include <optional>

#include <breakwater/world/waves.h>

namespace breakwater {

/// Waves whose peak period changes from one value to another. During the change the motions of both
/// seas are mixed.
class ChangingSea {
 public:
  struct Change {
    double at_s = 0.0;      ///< 0: never
    double period_s = 0.0;  ///< the new peak period
    double within_s = 0.0;  ///< duration of the change
  };

  /// Throws std::invalid_argument as Waves does.
  ChangingSea(const SeaState& sea, double slope_low_pass_s, const Change& change);

  WaterMotion water(double time_s, const Eigen::Vector3d& position) const;
  /// The elevation η at a position [m].
  double elevation(double time_s, double x_m, double y_m) const;

  const Waves& first() const { return first_; }
  const std::optional<Waves>& second() const { return second_; }

 private:
  // Share of the second sea at a time, 0 … 1.
  double changed(double time_s) const;

  Change change_;
  Waves first_;
  std::optional<Waves> second_;
};

}  // namespace breakwater
