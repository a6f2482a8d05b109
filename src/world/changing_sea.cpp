#include <breakwater/world/changing_sea.h>

#include <algorithm>

namespace breakwater {

ChangingSea::ChangingSea(const SeaState& sea, double slope_low_pass_s, const Change& change)
    : change_(change), first_(sea, slope_low_pass_s) {
  if (change.at_s > 0.0) {
    SeaState other = sea;
    other.peak_period_s = change.period_s;
    second_.emplace(other, slope_low_pass_s);
  }
}

double ChangingSea::changed(double time_s) const {
  if (!second_) return 0.0;
  return std::clamp((time_s - change_.at_s) / change_.within_s, 0.0, 1.0);
}

WaterMotion ChangingSea::water(double time_s, const Eigen::Vector3d& position) const {
  const double share = changed(time_s);
  WaterMotion motion = share < 1.0 ? first_.at(time_s, position) : WaterMotion{};
  if (share > 0.0) {
    const WaterMotion other = second_->at(time_s, position);
    motion.velocity += share * (other.velocity - motion.velocity);
    motion.acceleration += share * (other.acceleration - motion.acceleration);
    motion.slope += share * (other.slope - motion.slope);
    if (share == 1.0) motion = other;
  }
  return motion;
}

double ChangingSea::elevation(double time_s, double x_m, double y_m) const {
  const double share = changed(time_s);
  double eta = (1.0 - share) * first_.elevation(time_s, x_m, y_m);
  if (share > 0.0) eta += share * second_->elevation(time_s, x_m, y_m);
  return eta;
}

}  // namespace breakwater
