// Impacts by Simbody. Apart from Breakwater, because Simbody 3.7 is no C++20.
#pragma once

#include <array>

namespace simbody_bench {

constexpr double kRadius_m = 0.01;
constexpr double kStep_s = 1e-5;
constexpr std::array<double, 3> kAngles_rad = {0.8956647938578649, -1.7913295877157298,
                                               0.8956647938578649};
constexpr std::array<double, 3> kTorques_Nm = {0.2, 0.8, -0.1};

// F = k x^1.5 (1 + α ẋ)
struct Material {
  double stiffness;        // k [N/m^1.5]
  double dissipation_s_m;  // α
};

// The first contact, seen at each step.
struct Pulse {
  double peak_N = 0.0;
  double duration_s = 0.0;
  bool has_ended = false;

  void add(double force_N) {
    if (has_ended) return;
    if (force_N > 0.0) duration_s += kStep_s;
    if (force_N <= 0.0 && duration_s > 0.0) has_ended = true;
    if (force_N > peak_N) peak_N = force_N;
  }
};

// A sphere of 1 kg strikes a half space.
Pulse sphere_by_simbody(const Material& material, double speed_m_s);
// The three-link arm is driven against it by constant torques.
Pulse arm_by_simbody(const Material& material, double distance_m);

}  // namespace simbody_bench
