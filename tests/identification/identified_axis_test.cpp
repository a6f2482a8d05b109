// Identification of simulated axes. Their simulator has its own small steps.

#include <cmath>
#include <numbers>

#include <breakwater/identification/identified_axis.h>
#include "support.h"

namespace breakwater::identified_axis_test {
namespace {

AxisValues axis(double inertia, double viscous, double coulomb) {
  AxisValues values{};
  values[kInertia] = inertia;
  values[kViscous] = viscous;
  values[kCoulomb] = coulomb;
  values[kStribeckSpeed] = 1.0;
  values[kTorqueConstant] = 1.0;
  return values;
}

double end_of(const AxisValues& values, const AxisStart& start, double input, double duration) {
  const AxisStretch stretch{{0.0}, {input}, {0.0, 0.3 * duration, duration}, {0.0, 0.0, 0.0}};
  std::vector<double> positions(3);
  move_axis(values, start, stretch, positions);
  return positions.back();
}

TEST(FrictionAxis, MovesAsInClosedForm) {
  // Under viscous friction: q = v₀ (1 − e^(−c t/J)) J/c.
  EXPECT_NEAR(end_of(axis(2.0, 0.5, 0.0), {1.0, 3.0}, 0.0, 4.0),
              1.0 + 12.0 * (1.0 - std::exp(-1.0)), 1e-12);
  // Without friction: q = u t²/(2 J).
  EXPECT_NEAR(end_of(axis(2.0, 0.0, 0.0), {0.0, 0.0}, 3.0, 4.0), 12.0, 1e-12);
  // Coulomb friction stops it after J v₀²/(2 F), and it stays there.
  EXPECT_NEAR(end_of(axis(2.0, 0.0, 0.5), {0.0, 1.0}, 0.0, 4.0), 2.0, 1e-12);
  EXPECT_NEAR(end_of(axis(2.0, 0.0, 0.5), {0.0, 1.0}, 0.0, 40.0), 2.0, 1e-12);
  // It sticks below the friction, and moves on in the other direction above it.
  EXPECT_EQ(end_of(axis(2.0, 0.1, 0.5), {7.0, 0.0}, 0.499, 4.0), 7.0);
  EXPECT_NEAR(end_of(axis(2.0, 0.0, 0.5), {0.0, 1.0}, -1.5, 3.0), 0.5 - 0.5 * 0.5 * 4.0, 1e-12);
  AxisValues with_offset = axis(2.0, 0.0, 0.0);
  with_offset[kOffset] = 1.0;
  EXPECT_NEAR(end_of(with_offset, {}, 4.0, 4.0), 12.0, 1e-12);
}

TEST(FrictionAxis, BreakawayFrictionHoldsAndThenFalls) {
  AxisValues values = axis(1.0, 0.0, 0.5);
  values[kBreakaway] = 0.3;
  values[kStribeckSpeed] = 0.01;
  EXPECT_EQ(end_of(values, {}, 0.79, 4.0), 0.0);
  // Far above v_s it is Coulomb friction.
  EXPECT_NEAR(end_of(values, {0.0, 2.0}, 0.5, 4.0), 8.0, 1e-9);
  // Breakaway ends within 10 ms at a velocity near 0.01, so the rest is almost Coulomb friction.
  EXPECT_NEAR(end_of(values, {}, 1.5, 4.0), 0.5 * 16.0, 0.05);
}

TEST(FrictionAxis, TheDelayShiftsTheInput) {
  AxisValues values = axis(1.0, 0.0, 0.0);
  values[kDelay] = 0.25;
  const AxisStretch stretch{{0.0, 1.0}, {0.0, 2.0}, {0.0, 1.25, 2.25}, {0.0, 0.0, 0.0}};
  std::vector<double> positions(3);
  move_axis(values, {}, stretch, positions);
  EXPECT_NEAR(positions[1], 0.0, 1e-15);
  EXPECT_NEAR(positions[2], 1.0, 1e-12);
}

double normal(testing::Random& random) {
  return std::sqrt(-2.0 * std::log(random.uniform(1e-300, 1.0))) *
         std::cos(random.uniform(0.0, 2.0 * std::numbers::pi));
}

// A bench with a jittering clock, an encoder, and noise before it.
struct Bench {
  double inertia = 1.5e-3;
  double viscous = 4e-3;
  double coulomb = 0.08;
  double offset = 0.02;
  double delay_s = 1.7e-3;
  double rate_Hz = 1000.0;
  double duration_s = 3.0;
  int bits = 12;
  double noise_counts = 0.5;
  double mean_input = 0.0;
  double swing = 1.0;
  bool starts_at_speed = false;

  double quantum() const { return 2.0 * std::numbers::pi / std::ldexp(1.0, bits); }

  RecordedAxis record(unsigned seed) const {
    testing::Random random(seed);
    RecordedAxis record;
    const double T = 1.0 / rate_Hz;
    const auto rows = static_cast<std::size_t>(duration_s * rate_Hz);
    std::vector<double> phases;
    const double frequencies[] = {0.7, 1.3, 2.9, 4.1, 7.3, 11.9};
    for (std::size_t i = 0; i < std::size(frequencies); ++i) {
      phases.push_back(random.uniform(0.0, 2.0 * std::numbers::pi));
    }
    for (std::size_t k = 0; k < rows; ++k) {
      const double t = (static_cast<double>(k) + random.uniform(-0.05, 0.05)) * T;
      record.times_s.push_back(t);
      double u = mean_input;
      for (std::size_t i = 0; i < phases.size(); ++i) {
        u += swing * 0.3 * std::sin(2.0 * std::numbers::pi * frequencies[i] * t + phases[i]);
      }
      record.inputs.push_back(u);
    }
    const double phase = random.uniform(0.0, quantum());
    double q = 0.0;
    double v = starts_at_speed ? (mean_input - offset - coulomb) / viscous : 0.0;
    double now = record.times_s.front();
    std::size_t i = 0;
    const double step = T / 50.0;
    for (const double t : record.times_s) {
      while (now < t - 1e-15) {
        while (i + 1 < rows && record.times_s[i + 1] + delay_s <= now + 1e-15) ++i;
        double h = std::min(step, t - now);
        if (i + 1 < rows) h = std::min(h, std::max(record.times_s[i + 1] + delay_s - now, 1e-12));
        const double torque = record.inputs[i] - offset - viscous * v;
        const double sign = v != 0.0 ? std::copysign(1.0, v) : std::copysign(1.0, torque);
        const bool sticks = v == 0.0 && std::abs(torque) <= coulomb;
        const double a = sticks ? 0.0 : (torque - sign * coulomb) / inertia;
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
    return record;
  }
};

const ParameterEstimate& of(const Identification& identification, AxisParameter parameter) {
  for (const ParameterEstimate& estimate : identification.parameters) {
    if (estimate.parameter == parameter) return estimate;
  }
  throw std::logic_error("no such parameter");
}

TEST(Identification, FindsTheParametersOfABench) {
  const Bench bench;
  const Identification found = identify_axis({bench.record(1)}, {bench.record(2)}, {});
  EXPECT_TRUE(found.is_converged);
  EXPECT_FALSE(found.is_bootstrapped);
  EXPECT_NEAR(found.data.quantum, bench.quantum(), 1e-9);
  EXPECT_NEAR(of(found, kInertia).value, bench.inertia, 1e-3 * bench.inertia);
  EXPECT_NEAR(of(found, kCoulomb).value, bench.coulomb, 3e-3 * bench.coulomb);
  EXPECT_NEAR(of(found, kOffset).value, bench.offset, 3e-4);
  EXPECT_NEAR(of(found, kDelay).value, bench.delay_s, 0.25 / bench.rate_Hz);
  EXPECT_NEAR(found.fit.noise_std, 0.5 * bench.quantum(), 0.05 * bench.quantum());
  EXPECT_TRUE(found.whiteness.is_white()) << found.whiteness.statistic;
  EXPECT_NEAR(found.errors.normalised, 1.0, 0.1);
  EXPECT_NEAR(found.held_out->normalised, 1.0, 0.1);
  EXPECT_TRUE(found.holds());
  EXPECT_GT(found.held_out->plain_rms, 10.0 * found.held_out->rms);
  for (const ParameterEstimate& estimate : found.parameters) {
    EXPECT_TRUE(estimate.is_identifiable);
    EXPECT_LT(estimate.low, estimate.value);
    EXPECT_GT(estimate.high, estimate.value);
    EXPECT_GE(estimate.profile.size(), 3U);
  }
}

TEST(Identification, WithoutNoiseTheIntervalsComeFromABootstrap) {
  Bench bench;
  bench.noise_counts = 0.0;
  bench.duration_s = 1.5;
  const Identification found = identify_axis({bench.record(3)}, {}, {});
  EXPECT_TRUE(found.is_bootstrapped);
  EXPECT_NEAR(of(found, kInertia).value, bench.inertia, 1e-3 * bench.inertia);
  EXPECT_LT(of(found, kInertia).low, of(found, kInertia).high);
}

TEST(Identification, TheTorqueConstantFollowsFromAKnownInertia) {
  const Bench bench;
  RecordedAxis record = bench.record(4);
  for (double& u : record.inputs) u /= 0.07;  // now in A
  IdentificationSettings settings;
  settings.known_inertia = bench.inertia;
  const Identification found = identify_axis({record}, {}, settings);
  EXPECT_NEAR(of(found, kTorqueConstant).value, 0.07, 1e-4);
  EXPECT_NEAR(of(found, kCoulomb).value, bench.coulomb, 3e-3 * bench.coulomb);
}

void leave_out(RecordedAxis& record, std::size_t from, std::size_t count) {
  for (std::vector<double>* column : {&record.times_s, &record.inputs, &record.positions}) {
    column->erase(column->begin() + static_cast<std::ptrdiff_t>(from),
                  column->begin() + static_cast<std::ptrdiff_t>(from + count));
  }
}

TEST(Identification, AGapBeginsANewStretchAndManyShortOnesAreBridged) {
  const Bench bench;
  RecordedAxis record = bench.record(5);
  leave_out(record, 2000, 200);
  leave_out(record, 700, 2);
  const Identification found = identify_axis({record}, {}, {});
  EXPECT_EQ(found.data.stretches.size(), 3U);
  EXPECT_NEAR(of(found, kInertia).value, bench.inertia, 2e-3 * bench.inertia);
  EXPECT_TRUE(found.whiteness.is_white()) << found.whiteness.statistic;

  for (std::size_t from = 100; from < 2500; from += 150) leave_out(record, from, 2);
  const AxisData bridged = axis_data({record}, false, 0.0);
  EXPECT_EQ(bridged.stretches.size(), 2U);
  EXPECT_GT(bridged.stretches.front().inputs.size(), bridged.stretches.front().times_s.size() + 20);
}

TEST(Identification, InputsOfRowsWithoutAPositionStillAct) {
  const Bench bench;
  RecordedAxis record = bench.record(5);
  record.input_times_s = record.times_s;
  record.all_inputs = record.inputs;
  for (std::size_t from = 100; from < 2500; from += 150) leave_out(record, from, 2);
  const Identification found = identify_axis({record}, {}, {});
  EXPECT_EQ(found.data.stretches.size(), 1U);
  EXPECT_TRUE(found.whiteness.is_white()) << found.whiteness.statistic;
}

TEST(Identification, SaysWhatARecordCannotShow) {
  Bench constant;
  constant.mean_input = 0.5;
  constant.swing = 0.0;
  constant.starts_at_speed = true;
  const Identification steady = identify_axis({constant.record(6)}, {}, {});
  EXPECT_FALSE(of(steady, kInertia).is_identifiable);
  EXPECT_NE(of(steady, kInertia).reason.find("speed is almost constant"), std::string::npos);
  EXPECT_FALSE(of(steady, kDelay).is_identifiable);

  Bench one_way;
  one_way.mean_input = 1.0;
  one_way.swing = 0.5;
  const Identification forward = identify_axis({one_way.record(7)}, {}, {});
  EXPECT_TRUE(of(forward, kInertia).is_identifiable);
  EXPECT_TRUE(of(forward, kViscous).is_identifiable);
  for (const AxisParameter parameter : {kCoulomb, kOffset}) {
    EXPECT_FALSE(of(forward, parameter).is_identifiable);
    EXPECT_NE(of(forward, parameter).reason.find("never reverses"), std::string::npos);
    EXPECT_NE(of(forward, parameter).excitation.find("reverse"), std::string::npos);
  }
}

TEST(Identification, AHeldOutRecordOfAnotherAxisFails) {
  const Bench bench;
  Bench other = bench;
  other.inertia *= 1.1;
  EXPECT_FALSE(identify_axis({bench.record(8)}, {other.record(9)}, {}).holds());
}

TEST(Identification, RefusesRecordsWithoutMotionOrInput) {
  const Bench bench;
  RecordedAxis still = bench.record(10);
  std::fill(still.positions.begin(), still.positions.end(), 1.0);
  EXPECT_THROW(identify_axis({still}, {}, {}), std::invalid_argument);
  RecordedAxis without = bench.record(10);
  std::fill(without.inputs.begin(), without.inputs.end(), 0.0);
  EXPECT_THROW(identify_axis({without}, {}, {}), std::invalid_argument);
  EXPECT_THROW(identify_axis({}, {}, {}), std::invalid_argument);
}

// BREAKWATER_BENCHES sets the number for the study, whose shares docs/ has.
TEST(Identification, IntervalsCoverTheTruth) {
  const char* const asked = std::getenv("BREAKWATER_BENCHES");
  const int benches = asked == nullptr ? 16 : std::atoi(asked);
  int covered = 0;
  int intervals = 0;
  for (int n = 0; n < benches; ++n) {
    testing::Random random(1000 + static_cast<unsigned>(n));
    Bench bench;
    bench.inertia = std::pow(10.0, random.uniform(-3.2, -2.0));
    bench.viscous = bench.inertia * random.uniform(0.5, 5.0);
    bench.coulomb = random.uniform(0.02, 0.15);
    bench.offset = random.uniform(-0.05, 0.05);
    bench.rate_Hz = 500.0 * std::pow(8.0, random.uniform(0.0, 1.0));
    bench.delay_s = random.uniform(0.0, 4.0) / bench.rate_Hz;
    bench.bits = static_cast<int>(random.uniform(8.0, 20.99));
    bench.noise_counts = random.uniform(0.2, 2.0);
    const Identification found =
        identify_axis({bench.record(5000 + static_cast<unsigned>(n))}, {}, {});
    const std::pair<AxisParameter, double> truths[] = {{kInertia, bench.inertia},
                                                       {kViscous, bench.viscous},
                                                       {kCoulomb, bench.coulomb},
                                                       {kOffset, bench.offset},
                                                       {kDelay, bench.delay_s}};
    for (const auto& [parameter, truth] : truths) {
      const ParameterEstimate& estimate = of(found, parameter);
      const bool holds = estimate.low <= truth && truth <= estimate.high;
      covered += holds ? 1 : 0;
      ++intervals;
      if (asked != nullptr) {
        std::printf("bench %d %s %.9g %.9g %.9g %.9g %d %d %.4g\n", n, parameter_key(parameter),
                    truth, estimate.value, estimate.low, estimate.high, holds,
                    estimate.is_identifiable, 1.0 / bench.rate_Hz);
      }
    }
  }
  // Of 80 independent intervals, fewer than 68 cover the truth with a probability of 1e-4.
  EXPECT_GE(covered, static_cast<int>(0.85 * intervals)) << intervals;
}

}  // namespace
}  // namespace breakwater::identified_axis_test
