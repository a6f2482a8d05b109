// Predictive control of a contact: the place and the stiffness of the wall are known.
#pragma once

#include <breakwater/control/lmpc.h>
#include <breakwater/control/path_control.h>

namespace breakwater {

struct ContactMpcDesign {
  PathDesign path;
  double period_s = 0.01;              ///< from one optimisation to the next
  int prediction_steps = 40;           ///< N_p = N_u
  double q_position = 1e6;             ///< weight on the depth's error [1/m²]
  double q_velocity = 0.0;             ///< weight on the speed [s²/m²]
  double r = 1.0;                      ///< weight on a_x [s⁴/m²]
  double acceleration_m_s2 = 2.5;      ///< bound of |a_x|
  double wall_error_m = 0.0;           ///< the told place minus the true one
  double wall_correction_per_s = 5.0;  ///< γ of the correction of the wall's place [1/s]
};

/// Linear predictive control along the path. The model is the double integrator that the observer
/// makes of the path, and a spring K at the known place x_w of the wall:
///     δ̈ = a_x,   δ = x − x_w,   F = max(0, K δ).
/// It minimises Σ q (δ − F^ref/K)² + q_v δ̇² + r a_x². The last weight is the Riccati solution. The
/// bounds are |a_x| ≤ a_max and K δ ≤ F_peak, which is softened if impossible. Without active
/// bounds it is the linear quadratic regulator a_x = −k [δ − F^ref/K; δ̇].
///
/// In contact, or behind the told place, the measured force corrects x_w: ẋ_w = −γ (F_f/K − δ_f),
/// with the sensor's lag on max(0, δ). So the force has no steady error.
///
/// docs/explanation/methods/published-impact-control.md.
class ContactMpc final : public PathControl {
 public:
  /// Throws std::invalid_argument as the parts do. The task needs a wall, the numbers the right
  /// sign, and the period must be a multiple of the sampling period.
  ContactMpc(const ArmSetup& arm, const ContactMpcDesign& design);

 private:
  void restart() override;
  double path_acceleration() override;
  void correct_wall(double depth_m);

  ContactMpcDesign design_;
  int samples_per_move_;
  std::int64_t sample_ = 0;
  Lmpc lmpc_;
  double forget_;  // memory of the sensor's lag in one sample
  double wall_x_m_;
  double depth_f_m_ = 0.0;  // max(0, δ) behind the lag
};

/// The problem of a ContactMpc for a path with this period. Throws std::invalid_argument as dlqr().
LmpcDesign contact_problem(const ContactMpcDesign& design, double reference_N);

}  // namespace breakwater
