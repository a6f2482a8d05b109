// Laws that meet a wall: closed forms, optimality, true values, and the laws against a simple wall.
#include <Eigen/LU>

#include <breakwater/control/contact_mpc.h>
#include <breakwater/control/energy_admittance.h>
#include <breakwater/control/impact_qp.h>
#include <breakwater/control/implicit_force_pfc.h>
#include <breakwater/control/soft_contact.h>
#include <breakwater/control/workspace_control.h>
#include "control/wall_arm.h"
#include "support.h"

namespace breakwater::published_impact_control_test {
namespace {

// The largest force on a free mass that meets a spring, by small steps.
double peak_by_integration(double mass, double stiffness, double speed) {
  constexpr double kStep = 1e-5;
  double depth = 0.0, largest = 0.0;
  while (depth >= 0.0) {
    speed -= kStep * stiffness * depth / mass;
    depth += kStep * speed;
    largest = std::max(largest, stiffness * depth);
  }
  return largest;
}

TEST(EnergySpeed, AFreeMassMeetsTheSpringWithTheAllowedPeak) {
  for (const double mass : {2.0, 80.0}) {
    for (const double stiffness : {300.0, 1e4}) {
      for (const double allowed_N : {0.5, 7.2}) {
        const double speed = allowed_N / peak_per_speed_Ns_m(stiffness, mass);
        EXPECT_NEAR(peak_by_integration(mass, stiffness, speed), allowed_N, 1e-3 * allowed_N);
      }
    }
  }
}

class PublishedImpactControl : public ::testing::Test, public testing::WallArm {
 protected:
  EnergyAdmittanceDesign energy() const { return {path_, {}}; }
  ImpactQpDesign qp() const { return {.path = path_}; }
  ContactMpcDesign mpc() const { return {.path = path_}; }

  template <typename Law, typename Design>
  Course run(const Design& design, double stiffness, double duration_s) const {
    Law law(arm(), design);
    return WallArm::run(law, stiffness, duration_s);
  }
};

// As an admittance without damper, with the mass of the arm, the tip is the free mass under F^ref.
// Its peak is F^ref + √(F^ref² + K m v²).
TEST_F(PublishedImpactControl, TheEnergyControllerAsAFreeMassHasTheClosedFormsPeak) {
  task_.force_reference_N = 0.05;
  task_.force_lag_s = 1e-3;
  acceleration_.torque_limit_Nm *= 100.0;
  EnergyAdmittanceDesign design = energy();
  double mass = 0.0, speed = 0.0;
  {
    EnergyAdmittance law(arm(), design);
    WallArm::run(law, 1000.0, 0.01);
    mass = signal(law, "effective_mass_kg");
    speed = signal(law, "speed_cap_m_s");
  }
  EXPECT_NEAR(speed, 2.25 / std::sqrt(1000.0 * mass), 1e-12);
  EXPECT_NEAR(
      mass,
      1.0 /
          [&] {
            TaskJacobian J(3, 3);
            chain_.tip_jacobian(task_.start_angles_rad, J);
            const Eigen::RowVectorXd x = J.row(0);
            return x.cwiseAbs2()
                .cwiseQuotient(acceleration_.nominal_inertia_kgm2.transpose())
                .sum();
          }(),
      0.01 * mass);
  design.admittance = {mass, 0.0};
  EnergyAdmittance law(arm(), design);
  const Course course = WallArm::run(law, 1000.0, 6.0);
  const double v = signal(law, "speed_cap_m_s");
  const double expected = 0.05 + std::sqrt(0.05 * 0.05 + 1000.0 * mass * v * v);
  // The wall of the test has a damper of 10 N s/m, ζ = 0.018: e^{−πζ/2} = 0.97.
  EXPECT_NEAR(course.raw_peak_N, 0.97 * expected, 0.06 * expected);
}

TEST_F(PublishedImpactControl, AllMeetTheWallOnceBelowTheAllowedPeakAndPressWithTheReference) {
  const double allowed_N = task_.force_reference_N + ImpactModel{}.peak_margin_N;
  const Course courses[] = {run<EnergyAdmittance>(energy(), 1000.0, 8.0),
                            run<ImpactQp>(qp(), 1000.0, 8.0), run<ContactMpc>(mpc(), 1000.0, 8.0)};
  for (const Course& course : courses) {
    EXPECT_EQ(course.onsets, 1);
    EXPECT_LT(course.peak_N, allowed_N);
    EXPECT_LT(course.raw_peak_N, 1.05 * allowed_N) << "the wall's damper is not modelled";
    EXPECT_NEAR(course.last_N, 2.0, 0.02);
    EXPECT_LT(course.across, 2e-3);
  }
  EXPECT_LT(courses[2].free_s, 0.2 * courses[0].free_s) << "the place of the wall is known";
}

TEST_F(PublishedImpactControl, TheForceCorrectsAWrongPlaceAndAWrongStiffness) {
  for (const double error_m : {-0.004, 0.004}) {
    ContactMpcDesign design = mpc();
    design.wall_error_m = error_m;
    EXPECT_NEAR(run<ContactMpc>(design, 1500.0, 8.0).last_N, 2.0, 0.02) << error_m;
  }
}

// The depth has the lag of the force's filter, so a right wall and stiffness are hardly corrected.
// The wall of the test has a damper of 10 N s/m: its impulse is that of 20 um.
TEST_F(PublishedImpactControl, TheForcesLagDoesNotMoveAWallThatIsRight) {
  ContactMpc law(arm(), mpc());
  EXPECT_GT(WallArm::run(law, 1000.0, 0.5).peak_N, 1.0);
  EXPECT_NEAR(signal(law, "wall_hat_m"), task_.wall_x_m, 2e-5);
}

// The law forgets its contact and the corrected place of the wall.
TEST_F(PublishedImpactControl, AResetStartsTheTaskAnew) {
  ContactMpcDesign design = mpc();
  design.wall_error_m = 0.004;
  ContactMpc law(arm(), design);
  const Course first = WallArm::run(law, 1000.0, 1.0);
  const Course second = WallArm::run(law, 1000.0, 1.0);
  EXPECT_GT(first.peak_N, 0.5);
  EXPECT_EQ(second.free_s, first.free_s);
  EXPECT_EQ(second.peak_N, first.peak_N);
  EXPECT_EQ(second.last_N, first.last_N);
}

// One program of the arm at the start pose.
class Program : public PublishedImpactControl {
 protected:
  Program() : J_(3, 3), mass_(80.0) { chain_.tip_jacobian(task_.start_angles_rad, J_); }

  ImpactProgram::State state(bool foresees) const {
    return {.J = J_,
            .dq = dq_,
            .wanted = wanted_,
            .lower = lower_,
            .upper = upper_,
            .recoil = none_,
            .mass_kg = mass_,
            .foresees_impact = foresees};
  }

  TaskJacobian J_;
  Eigen::Vector3d motion_{-0.01, 0.02, -0.01};  // fixed size: dq_ keeps its address
  Eigen::Ref<const Eigen::VectorXd> dq_{motion_};
  TipVector wanted_ = Eigen::Vector3d(20.0, 1.0, -2.0);
  Eigen::VectorXd lower_ = Eigen::Vector3d::Constant(-1e3);
  Eigen::VectorXd upper_ = Eigen::Vector3d::Constant(1e3);
  Eigen::VectorXd none_;
  double mass_;
};

TEST_F(Program, WithoutAForeseenImpactItIsResolvedAcceleration) {
  ImpactProgram program(arm(), qp());
  const Eigen::Vector3d expected = J_.inverse() * wanted_;
  EXPECT_LT((program.solve(state(false)) - expected).norm(), 1e-3 * expected.norm());
  wanted_[0] = -1.0;  // away from the wall: the impact's rows are idle
  const Eigen::Vector3d back = J_.inverse() * wanted_;
  EXPECT_LT((program.solve(state(true)) - back).norm(), 1e-3 * back.norm());
}

TEST_F(Program, SolutionsAreOptimalAndKeepTheForce) {
  ImpactProgram program(arm(), qp());
  testing::Random random(5);
  int limited = 0;
  for (int i = 0; i < 500; ++i) {
    motion_ = random.vector(3, i % 2 == 0 ? 0.02 : 1.0);
    wanted_ = random.vector(3, 30.0);
    lower_ = Eigen::Vector3d::Constant(random.uniform(-400.0, -5.0));
    upper_ = -lower_;
    const Eigen::VectorXd q = task_.start_angles_rad + 0.3 * random.vector(3);
    chain_.tip_jacobian(q, J_);
    program.solve(state(true));
    const QpSolution& solution = program.solution();
    ASSERT_EQ(solution.status, QpStatus::solved) << i;
    const QpModel& model = program.solver().model();
    const QpInput& input = program.input();
    const Eigen::VectorXd pull = model.Omega.transpose() * solution.mu;
    ASSERT_LE((model.H * solution.z + input.g + pull).norm(),
              1e-8 * (input.g.norm() + pull.norm()));
    const Eigen::ArrayXd mu = solution.mu;
    const Eigen::ArrayXd values = (model.Omega * solution.z).array() - input.softness.array() * mu;
    const Eigen::ArrayXd above = values - input.upper.array(), below = input.lower.array() - values;
    ASSERT_LE(above.max(below).maxCoeff(), 1e-8 * (1.0 + values.abs().maxCoeff()));
    ASSERT_LE((mu != 0.0).select((mu > 0.0).select(above, below).abs(), 0.0).maxCoeff(),
              1e-8 * (1.0 + values.abs().maxCoeff()));
    ASSERT_GE((solution.z - lower_).minCoeff(), -1e-8);
    ASSERT_LE((solution.z - upper_).maxCoeff(), 1e-8);
    if (solution.mu(6) > 0.0 && solution.mu.head(3).isZero()) {
      ++limited;
      ASSERT_NEAR(program.foreseen_force_N(), 4.2, 0.1);
    }
  }
  EXPECT_GT(limited, 5);
}

TEST_F(Program, YAndPhiKeepTheirAccelerationsWhereTheForceIsLimited) {
  ImpactProgram program(arm(), qp());
  motion_.setZero();
  wanted_[0] = 200.0;
  const TipVector got = J_ * program.solve(state(true));
  EXPECT_NEAR(program.foreseen_force_N(), 4.2, 0.06) << "the row is soft";
  EXPECT_LT(got[0], 100.0);
  EXPECT_NEAR(got[1], wanted_[1], 0.01);
  EXPECT_NEAR(got[2], wanted_[2], 0.01);
}

// q̇⁺ = (I − (1 + e) J_n⁻¹ J_xᵀ (J_x J_n⁻¹ J_xᵀ)⁻¹ J_x) q̇, with all inverses dense.
TEST_F(Program, TheVelocityAfterTheImpactIsThatOfARigidOne) {
  const Eigen::MatrixXd inertia = acceleration_.nominal_inertia_kgm2.asDiagonal();
  const Eigen::RowVector3d J_x = J_.row(0);
  const Eigen::MatrixXd recoil = J_x * inertia.inverse() * J_x.transpose();
  mass_ = 1.0 / recoil(0, 0);
  for (const double restitution : {0.0, 0.4, 1.0}) {
    ImpactQpDesign design = qp();
    design.restitution = restitution;
    ImpactProgram program(arm(), design);
    program.solve(state(true));
    const Eigen::Matrix3d rows = program.solver().model().Omega.middleRows(3, 3);
    const Eigen::Matrix3d textbook =
        Eigen::Matrix3d::Identity() -
        (1.0 + restitution) * inertia.inverse() * J_x.transpose() * recoil.inverse() * J_x;
    EXPECT_LT((rows - textbook).norm(), 1e-12 * textbook.norm()) << restitution;
    const Eigen::Vector3d before = motion_, after = rows * before;
    EXPECT_NEAR(J_x.dot(after), -restitution * J_x.dot(before), 1e-14);
    const double energy = before.dot(inertia * before), rest = after.dot(inertia * after);
    if (restitution == 1.0) {
      EXPECT_NEAR(rest, energy, 1e-12 * energy);
    } else {
      EXPECT_LT(rest, energy);
    }
    // The rows bound q̇⁺ from q̇ + T_p q̈.
    const Eigen::Vector3d bound = program.input().upper.segment(3, 3) * design.preview_s + after;
    EXPECT_LT((bound - chain_.velocity_limits_rad_s()).norm(), 1e-9);
  }
}

TEST_F(PublishedImpactControl, RefuseInvalidParameters) {
  const auto refuses = [&]<typename Law>(auto design, auto&& spoil) {
    spoil(design);
    EXPECT_REFUSED(Law(arm(), design));
  };
  const auto energy_refuses = [&](auto&& spoil) {
    refuses.operator()<EnergyAdmittance>(energy(), spoil);
  };
  energy_refuses([](auto& d) { d.admittance.mass_kg = 0.0; });
  energy_refuses([](auto& d) { d.admittance.damping_Ns_m = -1.0; });
  energy_refuses([](auto& d) { d.path.impact.stiffness_N_m = 0.0; });
  energy_refuses([](auto& d) { d.path.impact.peak_margin_N = 0.0; });
  const auto program_refuses = [&](auto&& spoil) { refuses.operator()<ImpactQp>(qp(), spoil); };
  program_refuses([](auto& d) { d.restitution = 1.5; });
  program_refuses([](auto& d) { d.restitution = -0.1; });
  program_refuses([](auto& d) { d.approach_speed_m_s = 0.0; });
  program_refuses([](auto& d) { d.posture_weight = 0.0; });
  program_refuses([](auto& d) { d.preview_s = 0.0; });
  const auto mpc_refuses = [&](auto&& spoil) { refuses.operator()<ContactMpc>(mpc(), spoil); };
  mpc_refuses([](auto& d) { d.period_s = 1.5e-3; });
  mpc_refuses([](auto& d) { d.acceleration_m_s2 = 0.0; });
  mpc_refuses([](auto& d) { d.wall_correction_per_s = -1.0; });
  task_.convert_gain_N_m = 20.0;
  EXPECT_NO_THROW(WorkspaceControl(arm(), {}));
  const auto gains_refuse = [&](auto&& spoil) {
    refuses.operator()<WorkspaceControl>(WorkspaceControlDesign{}, spoil);
  };
  gains_refuse([](auto& d) { d.k_p = -1.0; });
  gains_refuse([](auto& d) { d.k_f = -1.0; });
  gains_refuse([](auto& d) { d.singular_value_floor = -0.02; });
  EXPECT_REFUSED(ImplicitForcePfc(arm(), {std::vector<Pfc>(2)}));
  task_.convert_gain_N_m = 0.0;
  EXPECT_REFUSED(WorkspaceControl(arm(), {}));
  task_.convert_gain_N_m = 20.0;
  task_.wall_x_m = INFINITY;
  mpc_refuses([](auto&) {});
  task_.start_angles_rad = Eigen::Vector2d(0, 0);
  EXPECT_REFUSED(WorkspaceControl(arm(), {}));
}

// Torque-limited soft contact: its formulas against integration, its estimators against true
// values, and the law against a simple wall.

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
  EXPECT_REFUSED(ContactStiffness(-1.0, kPeriod));
  EXPECT_REFUSED(ContactStiffness(kLag, 0.0));
}

class SoftContactLaw : public ::testing::Test, public testing::WallArm {
 protected:
  SoftContactLaw() {
    design_.path = path_;
    design_.contact = Pfc({.target_response_time_s = 0.08});
  }

  // The result, and the estimated stiffness.
  std::pair<Course, double> run(double stiffness, double duration_s) {
    SoftContact law(arm(), design_);
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
      EXPECT_LT(course.peak_N, task_.force_reference_N + design_.path.impact.peak_margin_N);
    }
  }
}

TEST_F(SoftContactLaw, WithAHigherLimitIsFasterAndHitsHarder) {
  const Course soft = run(1000.0, 2.0).first;
  design_.path.impact.peak_margin_N = 5.0;
  const Course hard = run(1000.0, 2.0).first;
  EXPECT_LT(hard.free_s, 0.9 * soft.free_s);
  EXPECT_GT(hard.peak_N, 1.2 * soft.peak_N);
}

TEST_F(SoftContactLaw, HoldsItsPoseBeforeForceControl) {
  task_.force_control_from_s = 10.0;
  SoftContact law(arm(), design_);
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
  design_.path.impact.stiffness_N_m = 0.0;
  EXPECT_REFUSED(SoftContact(arm(), design_));
  design_.path.impact.stiffness_N_m = 1000.0;
  design_.path.impact.peak_margin_N = 0.0;
  EXPECT_REFUSED(SoftContact(arm(), design_));
  design_.path.impact.peak_margin_N = 2.2;
  design_.path.joints.pop_back();
  EXPECT_REFUSED(SoftContact(arm(), design_));
}

}  // namespace
}  // namespace breakwater::published_impact_control_test
