// Drives, the timing of commands, contact laws and disturbances. tests/python/logs_test.py has the
// responses of a drive.
#include <breakwater/world/command_timing.h>
#include <breakwater/world/contact_law.h>
#include <breakwater/world/delay_line.h>
#include <breakwater/world/disturbance.h>
#include <breakwater/world/encoder.h>
#include <breakwater/world/motor_drive.h>
#include <breakwater/world/wall_motion.h>
#include "support.h"

namespace breakwater::motor_drive_test {

constexpr double kMotorStep_s = 1e-4;

TEST(MotorDrive, AVoltageLimitGivesTheCurrentOfTheWinding) {
  // At a constant velocity, L di/dt = U − R i − k v from i = 0.
  const double U = 24.0, R = 2.0, L = 0.01, k = 0.5, v = 10.0;
  MotorDrive motor(
      {.torque_constant = k, .voltage_limit_V = U, .resistance_ohm = R, .inductance_H = L},
      kMotorStep_s);
  for (int n = 0; n < 200; ++n) {
    motor.update(100.0, v);
    ASSERT_NEAR(motor.current_A(), -(U - k * v) / R * std::expm1(-R / L * n * kMotorStep_s), 1e-12);
  }
}

TEST(MotorDrive, BrakesBeyondTheSpeedOfItsVoltage) {
  MotorDrive motor({.torque_constant = 0.5, .voltage_limit_V = 10.0, .resistance_ohm = 2.0},
                   kMotorStep_s);
  motor.update(1.0, 30.0);
  EXPECT_DOUBLE_EQ(motor.force(0.0), 0.5 * (10.0 - 15.0) / 2.0);
}

TEST(MotorDrive, RefusesWhatIsNoMotor) {
  const std::vector<ElectricDrive> wrong = {
      {.bandwidth_rad_s = -1.0},
      {.bandwidth_rad_s = 1.0, .damping_ratio = -1.0},
      {.torque_constant = 0.0},
      {.current_limit_A = -1.0},
      {.voltage_limit_V = std::nan("")},
      {.voltage_limit_V = 1.0},
      {.voltage_limit_V = 1.0, .resistance_ohm = -1.0},
      {.voltage_limit_V = 1.0, .resistance_ohm = 1.0, .inductance_H = -1.0}};
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    EXPECT_REFUSED(MotorDrive(wrong[i], kMotorStep_s)) << i;
  }
}

TEST(Encoder, TheErrorsOfItsScaleAreSinesOfTheTruePosition) {
  Encoder encoder{.quantum = 1e-4};
  encoder.eccentricity = {.amplitude = 2e-3, .periods = 1.0};
  encoder.interpolation = {.amplitude = 5e-4, .periods = 1024.0};
  for (double angle = -4.0; angle < 4.0; angle += 0.0137) {
    const double error = 2e-3 * std::sin(angle) + 5e-4 * std::sin(1024.0 * angle);
    EXPECT_NEAR(encoder.error(angle), error, 1e-15);
  }
  PositionSine scale{.amplitude = 1e-6, .periods = 50.0, .length = 1.0};  // 50 periods in a metre
  EXPECT_NEAR(scale.value(0.005), 1e-6 * std::sin(0.5 * std::numbers::pi), 1e-18);
}

constexpr double kTick_s = 1e-3;

// The output over each step where sample k sends k + 1.
std::vector<double> outputs(const CommandDelays& delays, int steps, int steps_per_sample = 1,
                            std::uint64_t seed = 1) {
  CommandTiming timing(delays, seed, kTick_s, steps_per_sample, 1);
  std::vector<double> result;
  for (int step = 0; step < steps; ++step) {
    if (step % steps_per_sample == 0) {
      const double command = step / steps_per_sample + 1;
      timing.send(step / steps_per_sample, {&command, 1});
    }
    double output = -1.0;
    timing.receive(step, {&output, 1});
    result.push_back(output);
  }
  return result;
}

TEST(CommandTiming, DelaysByWholeSteps) {
  for (const int late : {0, 1, 3, 17}) {
    const std::vector<double> found = outputs({.delay_s = late * kTick_s}, 60, 4);
    for (int step = 0; step < 60; ++step) {
      ASSERT_EQ(found[static_cast<std::size_t>(step)], step < late ? 0 : (step - late) / 4 + 1);
    }
  }
}

TEST(CommandTiming, APartOfAStepGivesTheMeanOverTheStep) {
  // 2.25 steps: in step 2 + 4 k the new command has 0.75 of the step.
  const std::vector<double> found = outputs({.delay_s = 2.25 * kTick_s}, 20, 4);
  for (std::size_t step = 0; step < 20; ++step) {
    const double before = step < 3 ? 0.0 : std::floor((static_cast<double>(step) - 3) / 4) + 1;
    const double mean = step % 4 == 2 ? before + 0.75 : before;
    EXPECT_NEAR(found[step], mean, 1e-12) << step;
  }
}

TEST(CommandTiming, JitterIsUniformAndOfTheSeed) {
  // One sample in 10 steps: the mean over these steps shows the delay.
  const double jitter_s = 8e-3;
  const int samples = 20000;
  const std::vector<double> found = outputs({.jitter_s = jitter_s}, 10 * samples, 10);
  double sum = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < samples; ++k) {
    double output = 0.0;
    for (std::size_t i = 0; i < 10; ++i) output += found[10 * k + i];
    const double delay = (10.0 * static_cast<double>(k + 1) - output) * kTick_s;
    ASSERT_GT(delay, 0.0);
    ASSERT_LT(delay, jitter_s);
    sum += delay;
    squares += delay * delay;
  }
  const double mean = sum / samples, variance = squares / samples - mean * mean;
  // Four standard errors.
  EXPECT_NEAR(mean, jitter_s / 2.0, 4.0 * jitter_s / std::sqrt(12.0 * samples));
  EXPECT_NEAR(variance, jitter_s * jitter_s / 12.0,
              4.0 * jitter_s * jitter_s / std::sqrt(180.0 * samples));
  EXPECT_EQ(outputs({.jitter_s = jitter_s}, 100, 10, 7),
            outputs({.jitter_s = jitter_s}, 100, 10, 7));
  EXPECT_NE(outputs({.jitter_s = jitter_s}, 100, 10, 7),
            outputs({.jitter_s = jitter_s}, 100, 10, 8));
}

TEST(CommandTiming, RepeatsTheDelaysOfATable) {
  const std::vector<double> found = outputs({.jitters_s = {0.0, 2e-3, 1e-3}}, 24, 4);
  for (std::size_t step = 0; step < 24; ++step) {
    const std::size_t k = step / 4;
    const std::size_t late = std::vector<std::size_t>{0, 2, 1}[k % 3];
    EXPECT_EQ(found[step], static_cast<double>(step % 4 < late ? k : k + 1)) << step;
  }
}

TEST(CommandTiming, AnOvertakenCommandIsLost) {
  // Command 1 would arrive at step 6, command 2 at step 1.
  EXPECT_EQ(outputs({.jitters_s = {6e-3, 0.0, 0.0}}, 4), (std::vector<double>{0, 2, 3, 3}));
}

TEST(CommandTiming, HoldsTheLastCommandWhereOneIsDropped) {
  const double probability = 0.3;
  const int samples = 20000;
  const std::vector<double> found = outputs({.drop_probability = probability}, samples);
  int dropped = 0;
  for (std::size_t k = 0; k < samples; ++k) {
    const double before = k == 0 ? 0.0 : found[k - 1];
    const bool is_new = found[k] == static_cast<double>(k + 1);
    ASSERT_TRUE(is_new || found[k] == before);
    dropped += is_new ? 0 : 1;
  }
  EXPECT_NEAR(dropped / double(samples), probability,
              4.0 * std::sqrt(probability * (1.0 - probability) / samples));
}

TEST(CommandTiming, RefusesWhatIsNoDelay) {
  const std::vector<CommandDelays> wrong = {{.delay_s = -1.0},          {.delay_s = std::nan("")},
                                            {.delay_s = 2e3},           {.jitter_s = -1.0},
                                            {.jitters_s = {0.0, -1.0}}, {.drop_probability = 1.0},
                                            {.drop_probability = -0.1}, {.jitter_s = HUGE_VAL}};
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    EXPECT_REFUSED(CommandTiming(wrong[i], 1, kTick_s, 1, 1)) << i;
  }
}

TEST(ContactLaw, ForcesAreThoseOfTheirEquations) {
  ContactState none;
  EXPECT_DOUBLE_EQ(KelvinVoigt(1e3, 20.0, KelvinVoigt::By::force).force(2e-3, 0.1, none), 4.0);
  EXPECT_NEAR(HuntCrossley(1e5, 1.5, 0.8).force(4e-4, 0.5, none), 1e5 * 8e-6 * 1.4, 1e-12);
  const LayeredContact layers({{1e-3, 1.0}, {2e-3, 11.0}}, 2.0);
  EXPECT_NEAR(layers.force(5e-4, 0.0, none), 0.5, 1e-12);
  EXPECT_NEAR(layers.force(1.5e-3, 0.25, none), 6.0 * 1.5, 1e-12);
  EXPECT_NEAR(layers.force(3e-3, 0.0, none), 21.0, 1e-12);
}

TEST(ContactLaw, AStandardLinearSolidRelaxesToItsSpring) {
  const StandardLinearSolid solid(1e3, 2e3, 0.01);
  ContactState state;
  const double depth_m = 1e-3, step_s = 1e-6;
  EXPECT_NEAR(solid.force(depth_m, 0.0, state), 3.0, 1e-12);
  for (int k = 0; k < 20000; ++k) {
    const double force_N = solid.force(depth_m, 0.0, state);
    ASSERT_NEAR(force_N, 1.0 + 2.0 * std::exp(-k * step_s / 0.01), 2e-4);
    state.value[0] += step_s * state.rate[0];
  }
  // The dent of a free surface goes back by K/(K + K1) of that rate.
  solid.force(0.0, 0.0, state);
  EXPECT_NEAR(state.rate[0], -state.value[0] / 3.0 / 0.01, 1e-9);
}

TEST(ContactLaw, DissipationGivesTheRestitution) {
  EXPECT_EQ(dissipation_of_restitution(1.0, 0.3), 0.0);
  for (const double e : {0.05, 0.5, 0.99}) {
    for (const double v : {0.01, 2.0}) {
      const double beta = dissipation_of_restitution(e, v) * v;
      EXPECT_NEAR(beta * (1.0 + e), std::log((1.0 + beta) / (1.0 - e * beta)), 1e-9 * beta);
      EXPECT_GT(beta, 0.0);
    }
  }
}

TEST(ContactLaw, RefusesWhatIsNoLaw) {
  using Make = std::function<void()>;
  const std::vector<Make> wrong = {[] { KelvinVoigt(0.0, 1.0, KelvinVoigt::By::force); },
                                   [] { KelvinVoigt(1.0, -1.0, KelvinVoigt::By::force); },
                                   [] { HuntCrossley(1.0, 0.9, 0.0); },
                                   [] { HuntCrossley(1.0, 1.5, -1.0); },
                                   [] { HuntCrossley(std::nan(""), 1.5, 0.0); },
                                   [] { dissipation_of_restitution(0.0, 1.0); },
                                   [] { dissipation_of_restitution(1.1, 1.0); },
                                   [] { dissipation_of_restitution(0.5, 0.0); },
                                   [] { LayeredContact({}, 0.0); },
                                   [] {
                                     LayeredContact({{1.0, 1.0}, {1.0, 2.0}}, 0.0);
                                   },
                                   [] {
                                     LayeredContact({{1.0, 1.0}, {2.0, 1.0}}, 0.0);
                                   },
                                   [] {
                                     LayeredContact({{1.0, 1.0}}, -1.0);
                                   },
                                   [] { StandardLinearSolid(1.0, 1.0, 0.0); }};
  for (std::size_t i = 0; i < wrong.size(); ++i) EXPECT_REFUSED(wrong[i]()) << i;
}

TEST(WallMotion, SpeedIsTheDerivativeOfThePosition) {
  std::vector<WallMotion> motions = {{},
                                     {.kind = WallMotionKind::ramp},
                                     {.kind = WallMotionKind::sine},
                                     {.kind = WallMotionKind::csv}};
  motions[1].ramp.amplitude = -0.02;
  motions[1].ramp.start_s = motions[2].sine.start_s = 0.1;
  motions[2].sine.amplitude = 1e-3;
  motions[2].sine.frequency_rad_s = 30.0;
  motions[3].csv.table = {{0.1, 0.3, 0.4}, {0.0, 0.1, 0.05}};
  const double d = 1e-7;
  for (const WallMotion& motion : motions) {
    for (const double t : {0.05, 0.15, 0.25, 0.35, 0.5}) {
      const double rate = (motion.at(t + d).position_m - motion.at(t - d).position_m) / (2.0 * d);
      EXPECT_NEAR(motion.at(t).speed_m_s, rate, 1e-6) << t;
    }
  }
  EXPECT_NEAR(motions[3].at(0.35).position_m, 0.075, 1e-12);
  EXPECT_EQ(motions[3].at(0.5).position_m, 0.05);
  EXPECT_NEAR(motions[1].at(0.6).position_m, -0.01, 1e-12);
}

constexpr DisturbanceKind kKinds[] = {DisturbanceKind::none,      DisturbanceKind::step,
                                      DisturbanceKind::ramp,      DisturbanceKind::sine,
                                      DisturbanceKind::two_sines, DisturbanceKind::chirp};

// A disturbance from 1 s on, with the parameters of all kinds; the chirp goes from 2 to 5 rad/s in
// 2 s.
Disturbance of_kind(DisturbanceKind kind) {
  return {kind, 3.0, 2.0, 1.0, 0.7, 6.0, 5.0, 2.0};
}

TEST(Disturbance, ItsRateIsTheSlopeOfItsValue) {
  constexpr double kStep_s = 1e-5;
  for (const auto kind : kKinds) {
    const Disturbance disturbance = of_kind(kind);
    for (const double t : {0.5, 1.1, 2.0, 3.7}) {
      const double slope =
          (disturbance.value(t + kStep_s) - disturbance.value(t - kStep_s)) / (2.0 * kStep_s);
      EXPECT_NEAR(disturbance.rate(t), slope, 2e-8) << t;
    }
    Disturbance pulse = disturbance;
    pulse.end_s = 2.0;
    EXPECT_EQ(pulse.rate(2.0), 0.0);
  }
}

TEST(Pwm, RoundsToItsSteps) {
  const Pwm pwm{0.25};
  EXPECT_EQ(pwm.output(0.6), 0.5);
  EXPECT_EQ(pwm.output(-0.7), -0.75);
  EXPECT_EQ(pwm.output(0.1), 0.0);  // a dead zone of half a step
  EXPECT_EQ(Pwm{}.output(0.123), 0.123);
}

TEST(DelayLine, DelaysItsInputByAFixedNumberOfCalls) {
  for (int delay = 0; delay < 4; ++delay) {
    DelayLine line(delay);
    for (int k = 0; k < 20; ++k) EXPECT_EQ(line.update(k), std::max(k - delay, 0)) << delay;
  }
  EXPECT_REFUSED(DelayLine(-1));
}

}  // namespace breakwater::motor_drive_test
