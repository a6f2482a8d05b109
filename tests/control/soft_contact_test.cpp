// Torque-limited soft contact: its formulas against integration, its estimators against true
// values, and the law against a simple wall.
#include <breakwater/control/soft_contact.h>

#include <cmath>
#include <utility>

#include "control/wall_arm.h"

namespace breakwater::soft_contact_test {
namespace {

// The largest force behind a lag while x = v t − ½ a t² presses a spring, by small steps.
double peak_by_integration(double speed, double stiffness, double braking, double lag) {
  constexpr double kStep = 1e-6;
  double filtered = 0.0, largest = 0.0;
  for (double t = 0.0; t < 2.0 * speed / braking; t += kStep) {
    const double force = stiffness * (speed * t - 0.5 * braking * t * t);
    filtered = lag > 0.0 ? filtered + kStep / lag * (force - filtered) : force;
    largest = std::max(largest, filtered);
  }
  return largest;
}

TEST(ContactPeak, MatchesTheIntegratedMotion) {
  for (const double speed : {0.02, 0.2, 0.6}) {
    for (const double braking : {0.3, 4.0, 20.0}) {
      for (const double lag : {0.0, 0.01, 0.05}) {
        const double expected = peak_by_integration(speed, 1000.0, braking, lag);
        EXPECT_NEAR(contact_peak_N(speed, 1000.0, braking, lag), expected, 2e-4 * expected)
            << speed << " " << braking << " " << lag;
      }
    }
  }
  // Without a lag all kinetic energy goes into the depth ½v²/a_b.
  EXPECT_NEAR(contact_peak_N(0.2, 1000.0, 4.0, 0.0), 1000.0 * 0.04 / 8.0, 1e-9);
}

TEST(ContactSpeed, IsTheLargestAllowedSpeed) {
  for (const double allowed : {0.5, 4.2, 7.2}) {
    for (const double braking : {0.5, 4.0}) {
      const double v = contact_speed(1000.0, braking, 0.05, 0.005, allowed);
      const auto worst = [&](double speed) {
        return contact_peak_N(speed, 1000.0, braking, 0.05) + 1000.0 * speed * 0.005;
      };
      EXPECT_LE(worst(v), allowed);
      EXPECT_GT(worst(v + 1e-6), allowed);
    }
  }
  EXPECT_LT(contact_speed(1000.0, 4.0, 0.05, 0.005, 1e-9), 1e-4);
}

TEST(ServoSpeed, HasAContinuousSlopeAndCanBrake) {
  constexpr double kLambda = 18.0, kA = 3.0, kStep = 1e-9;
  const double near = kA / (2.0 * kLambda * kLambda);
  const auto slope = [&](double way) {
    return (servo_speed(way + kStep, kA, kLambda) - servo_speed(way, kA, kLambda)) / kStep;
  };
  EXPECT_NEAR(servo_speed(near, kA, kLambda), kLambda * near, 1e-15);
  EXPECT_NEAR(slope(near - 2.0 * kStep), slope(near), 1e-4);
  // Along the curve it brakes with v dv/dway: a far away, less when near.
  for (const double way : {near, 0.01, 0.1, 1.0}) {
    EXPECT_LE(servo_speed(way, kA, kLambda) * slope(way), kA) << way;
  }
}

// The servo in contact as a double integrator with bounds and a wrong stiffness K-hat. V = v²/2 +
// (K-hat/K) ∫ sat(k_d w) never rises while the direction stays the same. The motion ends at the
// reference (docs/explanation/methods/soft-contact.md, "Stability").
TEST(ServoSpeed, LyapunovFunctionFallsWithinBounds) {
  constexpr double kStep = 1e-5, kRise = 1e-4, kAtRest = 1e-7;
  constexpr double kKp = 35.0 * 35.0, kKd = 70.0;
  testing::Random random(7);
  for (int i = 0; i < 60; ++i) {
    const double brake = std::pow(10.0, random.uniform(-0.5, 1.5));
    const double drive = i % 2 == 0 ? brake : std::pow(10.0, random.uniform(-0.5, 1.5));
    const double ratio = std::pow(10.0, random.uniform(-0.7, 0.7));  // K/K-hat
    const double cap = i % 3 == 0 ? INFINITY : 0.05;
    const double furthest = 0.05;
    double way = random.uniform(-furthest, furthest), speed = random.uniform(-0.3, 0.3);
    const auto acceleration = [&](double v, bool is_forwards, double of) {
      const double a = 0.85 * (is_forwards ? brake : drive);
      const double wanted = std::min(servo_speed(std::abs(of), a, kKp / kKd), cap);
      return std::clamp(kKd * (std::copysign(wanted, of) - v), -brake, drive);
    };
    double function = INFINITY;
    bool was_forwards = speed >= 0.0;
    double potential = 0.0;  // since the last change of direction, by the trapezoidal rule
    for (int k = 0; k < 2'000'000; ++k) {
      if (std::abs(way) < kAtRest && std::abs(speed) < kAtRest) break;
      const bool is_forwards = speed >= 0.0;
      if (is_forwards != was_forwards && drive != brake) function = INFINITY;
      was_forwards = is_forwards;
      const double now = 0.5 * speed * speed + potential;
      ASSERT_LE(now, function + kRise * kStep * (brake + drive)) << i << " at " << k * kStep;
      function = now;
      const double force = acceleration(0.0, is_forwards, way);
      const double a = acceleration(speed, is_forwards, way);
      const double last = way;
      way -= ratio * kStep * (speed + 0.5 * kStep * a);
      speed += kStep * a;
      potential += 0.5 * (force + acceleration(0.0, is_forwards, way)) * (way - last) / ratio;
    }
    EXPECT_NEAR(way, 0.0, kAtRest) << i;
    EXPECT_NEAR(speed, 0.0, kAtRest) << i;
  }
}

// A contact with known K and B under some motion. The force has a lag and noise.
TEST(ContactStiffness, FindsStiffnessAndUndoesTheLag) {
  constexpr double kLag = 0.05, kPeriod = 1e-3;
  const double forget = std::exp(-kPeriod / kLag);
  testing::Random random(3);
  for (const double K : {300.0, 1000.0, 1e4, 1e5}) {
    for (const double B : {0.0, 20.0}) {
      SCOPED_TRACE(K);
      ContactStiffness contact(kLag, kPeriod);
      contact.reset();
      double filtered = 0.0, force = 0.0;
      for (int k = 0; k < 400; ++k) {
        const double t = k * kPeriod;
        const double depth = 3.0 / K * (1.0 - std::cos(20.0 * t));
        const double rate = 60.0 / K * std::sin(20.0 * t);
        force = K * depth + B * rate;
        filtered += (1.0 - forget) * (force - filtered);
        contact.update(depth, rate, filtered + 0.02 * random.uniform(-1.7, 1.7));
      }
      EXPECT_NEAR(contact.stiffness_N_m(), K, 0.03 * K);
      if (B == 0.0) {
        EXPECT_NEAR(contact.force_N(), force, 0.1);
      }
      EXPECT_GT(std::abs(force - filtered), 0.4) << "else the lag would not matter";
    }
  }
  // Walls outside of its range are at the end of the range.
  for (const auto& [K, expected] : {std::pair(20.0, 200.0), std::pair(1e7, 2e5)}) {
    ContactStiffness contact(0.0, kPeriod);
    for (int k = 0; k < 100; ++k) contact.update(3.0 / K * k, 0.0, 3.0 * k);
    EXPECT_EQ(contact.stiffness_N_m(), expected);
  }
  ContactStiffness contact(kLag, kPeriod);
  EXPECT_EQ(contact.stiffness_N_m(), 1000.0);
  EXPECT_THROW(ContactStiffness(-1.0, kPeriod), std::invalid_argument);
  EXPECT_THROW(ContactStiffness(kLag, 0.0), std::invalid_argument);
}

class SoftContactLaw : public ::testing::Test, public testing::WallArm {
 protected:
  SoftContactLaw() {
    design_.path = path_;
    design_.approach = approach_;
    design_.contact.target_response_time_s = 0.08;
  }

  // The result, and the estimated stiffness.
  std::pair<Course, double> run(double stiffness, double duration_s) {
    SoftContact law(chain_, acceleration_, task_, design_);
    const Course course = WallArm::run(law, stiffness, duration_s);
    EXPECT_EQ(signal(law, "phase"), 3.0);
    return {course, signal(law, "contact_stiffness_hat_N_m")};
  }

  SoftContactDesign design_;
};

TEST_F(SoftContactLaw, MeetsAWallOnceAndPressesWithTheReference) {
  for (const double stiffness : {500.0, 1000.0, 5000.0}) {
    SCOPED_TRACE(stiffness);
    const auto [course, found_N_m] = run(stiffness, 3.0);
    EXPECT_EQ(course.onsets, 1);
    EXPECT_NEAR(course.last_N, 2.0, 0.01);
    EXPECT_NEAR(found_N_m, stiffness, 0.1 * stiffness);
    EXPECT_LT(course.across, 5e-4);
    if (stiffness <= 1000.0) {
      EXPECT_LT(course.peak_N, task_.force_reference_N + design_.peak_margin_N);
    }
  }
}

TEST_F(SoftContactLaw, WithAHigherLimitIsFasterAndHitsHarder) {
  const Course soft = run(1000.0, 2.0).first;
  design_.peak_margin_N = 5.0;
  const Course hard = run(1000.0, 2.0).first;
  EXPECT_LT(hard.free_s, 0.9 * soft.free_s);
  EXPECT_GT(hard.peak_N, 1.2 * soft.peak_N);
}

TEST_F(SoftContactLaw, HoldsItsPoseBeforeForceControl) {
  task_.force_control_from_s = 10.0;
  SoftContact law(chain_, acceleration_, task_, design_);
  Sample sample;
  sample.y.resize(5);
  sample.y << task_.start_angles_rad, 0.0, 0.0;
  law.reset(sample);
  Eigen::VectorXd u(3);
  law.update(sample, u);
  EXPECT_LT(u.norm(), 1e-9);
  EXPECT_EQ(signal(law, "phase"), 1.0);
}

TEST_F(SoftContactLaw, RefusesInvalidParameters) {
  design_.wall_stiffness_N_m = 0.0;
  EXPECT_THROW(SoftContact(chain_, acceleration_, task_, design_), std::invalid_argument);
  design_.wall_stiffness_N_m = 1000.0;
  design_.peak_margin_N = 0.0;
  EXPECT_THROW(SoftContact(chain_, acceleration_, task_, design_), std::invalid_argument);
  design_.peak_margin_N = 2.2;
  design_.path.joints.pop_back();
  EXPECT_THROW(SoftContact(chain_, acceleration_, task_, design_), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater::soft_contact_test
