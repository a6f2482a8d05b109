// Records of simulated benches. Their simulators have their own small steps.
#pragma once

#include <breakwater/identification/axis_model.h>
#include <breakwater/recorded/recorded_axis.h>
#include "support.h"

namespace breakwater::testing {

inline double normal(Random& random) {
  return std::sqrt(-2.0 * std::log(random.uniform(1e-300, 1.0))) *
         std::cos(random.uniform(0.0, 2.0 * std::numbers::pi));
}

/// A record's times, which jitter, and its inputs: a mean, and sines of one amplitude.
inline RecordedAxis sines(Random& random, double rate_Hz, double duration_s, double mean,
                          double amplitude, std::span<const double> frequencies_Hz) {
  RecordedAxis record;
  const auto rows = static_cast<std::size_t>(duration_s * rate_Hz);
  std::vector<double> phases;
  for (std::size_t i = 0; i < frequencies_Hz.size(); ++i) {
    phases.push_back(random.uniform(0.0, 2.0 * std::numbers::pi));
  }
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = (static_cast<double>(k) + random.uniform(-0.05, 0.05)) * (1.0 / rate_Hz);
    record.times_s.push_back(t);
    double u = mean;
    for (std::size_t i = 0; i < phases.size(); ++i) {
      u += amplitude * std::sin(2.0 * std::numbers::pi * frequencies_Hz[i] * t + phases[i]);
    }
    record.inputs.push_back(u);
  }
  return record;
}

// A bench with a jittering clock, an encoder, and noise before it.
struct AxisBench {
  double inertia = 1.5e-3;
  double viscous = 4e-3;
  double coulomb = 0.08;
  double breakaway = 0.0;  // Stribeck
  double stribeck_speed = 1.0;
  double offset = 0.02;
  double delay_s = 1.7e-3;
  double rate_Hz = 1000.0;
  double duration_s = 3.0;
  int bits = 12;
  double noise_counts = 0.5;
  double mean_input = 0.0;
  double swing = 1.0;
  bool starts_at_speed = false;
  double stamp_s = 0.0;    // the table's times are multiples of it
  double substeps = 50.0;  // steps of a row

  double quantum() const { return 2.0 * std::numbers::pi / std::ldexp(1.0, bits); }

  RecordedAxis record(unsigned seed) const {
    Random random(seed);
    const double T = 1.0 / rate_Hz;
    const double frequencies[] = {0.7, 1.3, 2.9, 4.1, 7.3, 11.9};
    RecordedAxis record = sines(random, rate_Hz, duration_s, mean_input, swing * 0.3, frequencies);
    const std::size_t rows = record.times_s.size();
    const double phase = random.uniform(0.0, quantum());
    double q = 0.0;
    double v = starts_at_speed ? (mean_input - offset - coulomb) / viscous : 0.0;
    double now = record.times_s.front();
    std::size_t i = 0;
    const double step = T / substeps;
    for (const double t : record.times_s) {
      while (now < t - 1e-15) {
        while (i + 1 < rows && record.times_s[i + 1] + delay_s <= now + 1e-15) ++i;
        double h = std::min(step, t - now);
        if (i + 1 < rows) h = std::min(h, std::max(record.times_s[i + 1] + delay_s - now, 1e-12));
        const double torque = record.inputs[i] - offset - viscous * v;
        const double sign = v != 0.0 ? std::copysign(1.0, v) : std::copysign(1.0, torque);
        const auto friction_at = [&](double speed) {
          return coulomb + breakaway * std::exp(-speed * speed / (stribeck_speed * stribeck_speed));
        };
        const bool sticks = v == 0.0 && std::abs(torque) <= friction_at(v);
        // With the friction in the middle of the step.
        const double first_a = sticks ? 0.0 : (torque - sign * friction_at(v)) / inertia;
        const double friction = friction_at(v + 0.5 * h * first_a);
        const double a = sticks ? 0.0 : (torque - sign * friction) / inertia;
        // To standstill at most, and with half the viscous friction's change.
        const double mean_a = a / (1.0 + 0.5 * viscous * h / inertia);
        if (v != 0.0 && (v + mean_a * h) * v < 0.0) h = -v / mean_a;
        q += (v + 0.5 * mean_a * h) * h;
        v = v != 0.0 && h == -v / mean_a ? 0.0 : v + mean_a * h;
        now += h;
      }
      const double noise = noise_counts * quantum() * normal(random);
      record.positions.push_back(quantum() * std::round((q + phase + noise) / quantum()));
    }
    if (stamp_s > 0.0) {
      for (double& t : record.times_s) t = stamp_s * std::round(t / stamp_s);
    }
    return record;
  }
};

// The same with a spring and a load.
struct TwoInertiaBench {
  double motor_inertia = 1.5e-3;
  double load_inertia = 3e-3;
  double stiffness = 12.0;
  double damping = 3e-3;
  double backlash = 0.01;
  double motor_viscous = 2e-3;
  double load_viscous = 3e-3;
  double motor_coulomb = 0.03;
  double load_coulomb = 0.05;
  double offset = 0.02;
  double delay_s = 1.3e-3;
  double rate_Hz = 1000.0;
  double duration_s = 3.0;
  int bits = 14;
  double noise_counts = 0.5;
  double mean_input = 0.0;
  double swing = 1.0;
  bool starts_at_speed = false;
  double substeps = 200.0;  // steps of a row; their first-order error must be below the noise

  double quantum() const { return 2.0 * std::numbers::pi / std::ldexp(1.0, bits); }
  double resonance() const {
    return std::sqrt(stiffness * (1.0 / motor_inertia + 1.0 / load_inertia));
  }

  double torque(double twist, double rate) const {
    if (backlash == 0.0) return stiffness * twist + damping * rate;
    const double z = std::abs(twist) - 0.5 * backlash;
    if (z <= 0.0) return 0.0;
    const double sign = std::copysign(1.0, twist);
    return sign * std::max(0.0, stiffness * z + damping * rate * sign);
  }

  // The velocity after h under a torque and a friction that stops it at most.
  static double pushed(double v, double torque, double coulomb, double inertia, double h) {
    const double free = v + h * torque / inertia;
    const double most = h * coulomb / inertia;
    return std::abs(free) <= most ? 0.0 : free - std::copysign(most, free);
  }

  RecordedAxis record(unsigned seed) const {
    Random random(seed);
    const double T = 1.0 / rate_Hz;
    std::vector<double> frequencies = {0.7, 1.9, 4.1};
    for (const double share : {0.45, 0.6, 0.8, 1.0, 1.25, 1.6}) {
      frequencies.push_back(share * resonance() / (2.0 * std::numbers::pi));
    }
    RecordedAxis record = sines(random, rate_Hz, duration_s, mean_input, swing * 0.25, frequencies);
    const std::size_t rows = record.times_s.size();
    const double phase = random.uniform(0.0, quantum());
    double qm = 0.0, vm = 0.0, ql = 0.0, vl = 0.0;
    if (starts_at_speed) {
      vm = vl =
          (mean_input - offset - motor_coulomb - load_coulomb) / (motor_viscous + load_viscous);
      qm = 0.5 * backlash + (load_viscous * vl + load_coulomb) / stiffness;
    }
    double now = record.times_s.front();
    std::size_t i = 0;
    const double step = std::min(T, 1.0 / resonance()) / substeps;
    for (const double t : record.times_s) {
      while (now < t - 1e-15) {
        while (i + 1 < rows && record.times_s[i + 1] + delay_s <= now + 1e-15) ++i;
        double h = std::min(step, t - now);
        if (i + 1 < rows) h = std::min(h, std::max(record.times_s[i + 1] + delay_s - now, 1e-12));
        // Störmer and Verlet: the positions to the middle, the velocities, the positions to the
        // end.
        qm += 0.5 * h * vm;
        ql += 0.5 * h * vl;
        const double between = torque(qm - ql, vm - vl);
        const double drive = record.inputs[i] - offset;
        vm = pushed(vm, drive - motor_viscous * vm - between, motor_coulomb, motor_inertia, h);
        vl = pushed(vl, between - load_viscous * vl, load_coulomb, load_inertia, h);
        qm += 0.5 * h * vm;
        ql += 0.5 * h * vl;
        now += h;
      }
      const double noise = noise_counts * quantum() * normal(random);
      record.positions.push_back(quantum() * std::round((qm + phase + noise) / quantum()));
    }
    return record;
  }
};

}  // namespace breakwater::testing
