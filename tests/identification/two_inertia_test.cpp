// Identification of simulated motors with a spring and a load. Their simulator has its own small
// steps.
#include <breakwater/identification/axis_model.h>
#include <breakwater/identification/identified_axis.h>
#include <breakwater/identification/two_inertia_axis.h>
#include <breakwater/statistics/quantile.h>
#include "identification/bench.h"
#include "support.h"

namespace breakwater::two_inertia_test {

using testing::normal;
using testing::of;

struct Bench {
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
  Side side = Side::motor;
  double substeps = 200.0;  // steps of a row; their first-order error must be below the noise

  double quantum() const { return 2.0 * std::numbers::pi / std::ldexp(1.0, bits); }
  double resonance() const {
    return std::sqrt(stiffness * (1.0 / motor_inertia + 1.0 / load_inertia));
  }

  AxisValues values() const {
    AxisValues all{};
    all[kMotorInertia] = motor_inertia;
    all[kLoadInertia] = load_inertia;
    all[kStiffness] = stiffness;
    all[kDamping] = damping;
    all[kBacklash] = backlash;
    all[kMotorViscous] = motor_viscous;
    all[kLoadViscous] = load_viscous;
    all[kMotorCoulomb] = motor_coulomb;
    all[kLoadCoulomb] = load_coulomb;
    all[kOffset] = offset;
    all[kDelay] = delay_s;
    all[kTorqueConstant] = 1.0;
    return all;
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
    testing::Random random(seed);
    const double T = 1.0 / rate_Hz;
    std::vector<double> frequencies = {0.7, 1.9, 4.1};
    for (const double share : {0.45, 0.6, 0.8, 1.0, 1.25, 1.6}) {
      frequencies.push_back(share * resonance() / (2.0 * std::numbers::pi));
    }
    RecordedAxis record =
        testing::sines(random, rate_Hz, duration_s, mean_input, swing * 0.25, frequencies);
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
      const double q = side == Side::motor ? qm : ql;
      record.positions.push_back(quantum() * std::round((q + phase + noise) / quantum()));
    }
    return record;
  }
};

IdentificationSettings settings_of(const Bench& bench) {
  IdentificationSettings settings;
  settings.model = &two_inertia_axis(bench.side);
  return settings;
}

double end_of(const AxisValues& values, const AxisStart& start, double input, double duration) {
  AxisStretch stretch{{0.0}, {input}, {}, {}};
  for (int k = 0; k <= 400; ++k) stretch.times_s.push_back(duration * k / 400.0);
  std::vector<double> positions(stretch.times_s.size());
  move_two_inertias(Side::motor, values, start, stretch, positions);
  return positions.back();
}

TEST(TwoInertiaAxis, MovesAsInClosedForm) {
  AxisValues values{};
  values[kMotorInertia] = 0.01;
  values[kLoadInertia] = 0.02;
  values[kStiffness] = 50.0;
  values[kTorqueConstant] = 1.0;
  // A torque u: q_m = u t²/(2 J) + u J_l/(J_m J ω²) (1 − cos ω t).
  const double w = std::sqrt(50.0 * (100.0 + 50.0));
  const double t = 0.3;
  const double vibration = 0.02 / (0.01 * 0.03 * w * w) * (1.0 - std::cos(w * t));
  EXPECT_NEAR(end_of(values, {}, 1.0, t), t * t / 0.06 + vibration, 1e-9);
  // In its play the motor moves alone, until it meets the flank at 0.5 b = u t²/(2 J_m).
  values[kBacklash] = 0.4;
  EXPECT_NEAR(end_of(values, {}, 1.0, 0.06), 0.06 * 0.06 / 0.02, 1e-12);
  // A spring that the static friction of the load holds.
  values[kBacklash] = 0.0;
  values[kLoadCoulomb] = 100.0;
  EXPECT_NEAR(end_of(values, {}, 1.0, t), 0.02 * (1.0 - std::cos(std::sqrt(5000.0) * t)), 1e-9);
}

TEST(TwoInertiaIdentification, AStartIsFoundOnEitherFlankOfThePlay) {
  Bench bench;
  bench.backlash = 0.04;
  bench.duration_s = 0.6;
  const RecordedAxis record = bench.record(4);
  AxisFit truth{.values = bench.values(), .noise_std = bench.noise_counts * bench.quantum()};
  for (int n = 1; n <= 12; ++n) {
    AxisData data = axis_data({record}, false, 0.02 * n);
    data.model = &two_inertia_axis(bench.side);
    data.quantum = bench.quantum();
    const std::vector<double> fitted = fitted_positions(data, fit_starts(data, truth));
    double squares = 0.0;
    for (std::size_t k = 0; k < fitted.size(); ++k) {
      squares += std::pow(fitted[k] - data.stretches[0].positions[k], 2.0);
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(fitted.size())), bench.quantum()) << n;
  }
}

TEST(TwoInertiaIdentification, FindsInertiasStiffnessAndBacklash) {
  Bench bench;
  bench.duration_s = 1.2;
  Bench short_one = bench;
  short_one.duration_s = 0.6;
  const Identification found =
      identify_axis({bench.record(1)}, {short_one.record(2)}, settings_of(bench));
  EXPECT_TRUE(found.is_converged);
  EXPECT_TRUE(found.holds()) << found.held_out->normalised;
  EXPECT_NEAR(found.errors.normalised, 1.0, 0.1);
  EXPECT_TRUE(found.whiteness.is_white()) << found.whiteness.statistic;
  EXPECT_NEAR(of(found, kMotorInertia).value, bench.motor_inertia, 1e-3 * bench.motor_inertia);
  EXPECT_NEAR(of(found, kLoadInertia).value, bench.load_inertia, 1e-3 * bench.load_inertia);
  EXPECT_NEAR(of(found, kStiffness).value, bench.stiffness, 1e-3 * bench.stiffness);
  EXPECT_NEAR(of(found, kBacklash).value, bench.backlash, 0.01 * bench.backlash);
  EXPECT_NEAR(of(found, kDelay).value, bench.delay_s, 0.25 / bench.rate_Hz);
  EXPECT_NEAR(of(found, kLoadCoulomb).value, bench.load_coulomb, 0.03 * bench.load_coulomb);
  EXPECT_GT(found.held_out->plain_rms, 10.0 * found.held_out->rms);
}

// The motion has a part that no model explains.
TEST(TwoInertiaIdentification, SaysThatABadFitIsBad) {
  Bench bench;
  bench.backlash = 0.0;
  bench.duration_s = 0.4;
  RecordedAxis record = bench.record(1);
  for (std::size_t i = 0; i < record.positions.size(); ++i) {
    record.positions[i] += 0.5 * std::sin(40.0 * record.times_s[i]);
  }
  const Identification found = identify_axis({record}, {}, settings_of(bench));
  EXPECT_GT(found.errors.rms, 0.02);
  EXPECT_GT(found.errors.normalised, 20.0);
  EXPECT_FALSE(found.whiteness.is_white());
}

TEST(TwoInertiaIdentification, AConstantSpeedShowsNoInertiaNoSpringAndNoBacklash) {
  Bench bench;
  bench.mean_input = 0.5;
  bench.swing = 0.0;
  bench.duration_s = 0.5;
  bench.starts_at_speed = true;
  const Identification found = identify_axis({bench.record(3)}, {}, settings_of(bench));
  for (const AxisParameter parameter : {kMotorInertia, kLoadInertia, kStiffness, kBacklash}) {
    EXPECT_FALSE(of(found, parameter).is_identifiable) << parameter_key(parameter);
  }
  EXPECT_NE(of(found, kStiffness).excitation.find("resonance"), std::string::npos);
  EXPECT_NE(of(found, kBacklash).excitation.find("reverse"), std::string::npos);
}

// A study: the number of benches is that of BREAKWATER_BENCHES (tests/CMakeLists.txt).
TEST(TwoInertiaIdentification, IntervalsCoverTheTruth) {
  const char* const asked = std::getenv("BREAKWATER_BENCHES");
  if (asked == nullptr) GTEST_SKIP() << "a study";
  const int benches = std::atoi(asked);
  int covered = 0, intervals = 0;
  std::vector<double> inertia_errors, stiffness_errors, backlash_errors;
  for (int n = 0; n < benches; ++n) {
    testing::Random random(1000 + static_cast<unsigned>(n));
    Bench bench;
    bench.duration_s = 2.0;
    bench.motor_inertia = std::pow(10.0, random.uniform(-3.3, -2.3));
    bench.load_inertia = bench.motor_inertia * std::pow(10.0, random.uniform(-0.4, 0.7));
    const double both = bench.motor_inertia + bench.load_inertia;
    const double reduced = bench.motor_inertia * bench.load_inertia / both;
    const double resonance = 2.0 * std::numbers::pi * random.uniform(8.0, 25.0);
    bench.stiffness = resonance * resonance * reduced;
    bench.damping = 2.0 * random.uniform(0.005, 0.04) * resonance * reduced;
    bench.swing = std::pow(10.0, random.uniform(-0.2, 0.3));
    bench.motor_viscous = both * random.uniform(0.2, 2.0);
    bench.load_viscous = both * random.uniform(0.2, 2.0);
    bench.motor_coulomb = bench.swing * random.uniform(0.01, 0.06);
    bench.load_coulomb = bench.swing * random.uniform(0.01, 0.06);
    bench.offset = bench.swing * random.uniform(-0.03, 0.03);
    bench.delay_s = random.uniform(0.0, 4e-3);
    bench.bits = static_cast<int>(random.uniform(12.0, 18.99));
    bench.noise_counts = random.uniform(0.2, 1.5);
    bench.substeps = 40000.0;
    // Each fourth bench has no play.
    bench.backlash = n % 4 == 3 ? 0.0 : bench.swing / bench.stiffness * random.uniform(0.05, 0.6);
    const Identification found =
        identify_axis({bench.record(5000 + static_cast<unsigned>(n))}, {}, settings_of(bench));
    const AxisValues truths = bench.values();
    for (const AxisParameter parameter :
         {kMotorInertia, kLoadInertia, kStiffness, kDamping, kBacklash, kMotorViscous, kLoadViscous,
          kMotorCoulomb, kLoadCoulomb, kOffset, kDelay}) {
      const double truth = truths[parameter];
      const ParameterEstimate& estimate = of(found, parameter);
      const bool holds = estimate.low <= truth && truth <= estimate.high;
      const double error = std::abs(estimate.value - truth) / truth;
      if (parameter == kMotorInertia || parameter == kLoadInertia) inertia_errors.push_back(error);
      if (parameter == kStiffness) stiffness_errors.push_back(error);
      if (parameter == kBacklash && truth > 0.0) backlash_errors.push_back(error);
      covered += holds ? 1 : 0;
      ++intervals;
      std::printf("bench %d %s %.9g %.9g %.9g %.9g %d %d\n", n, parameter_key(parameter), truth,
                  estimate.value, estimate.low, estimate.high, holds, estimate.is_identifiable);
    }
  }
  EXPECT_LE(sample_median(inertia_errors), 0.01);
  EXPECT_LE(sample_median(stiffness_errors), 0.01);
  EXPECT_LE(sample_median(backlash_errors), 0.05);
  const double share = static_cast<double>(covered) / intervals;
  EXPECT_GE(share, 0.92);
  EXPECT_LE(share, 0.98);
}

}  // namespace breakwater::two_inertia_test
