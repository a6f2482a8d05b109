#include <breakwater/control/disturbance_cancelling_pd.h>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

ResonanceRatioGains resonance_ratio(const TwoInertia& plant, double damping_ratio) {
  check(plant);
  refuse_unless(damping_ratio > 0.0, "resonance ratio control: the damping ratio must be positive");
  const double omega = antiresonance_rad_s(plant);
  const double load_at_motor = plant.load_inertia / (plant.ratio * plant.ratio);
  return {.k_p = plant.motor_inertia * omega * omega,
          .k_d = 4.0 * damping_ratio * plant.motor_inertia * omega,
          .reaction = 4.0 * damping_ratio * damping_ratio * plant.motor_inertia / load_at_motor};
}

}  // namespace breakwater
