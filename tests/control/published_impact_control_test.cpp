// The published candidates at the wall: closed forms, optimality, and the laws against a simple
// wall.
#include <breakwater/control/contact_mpc.h>
#include <breakwater/control/energy_admittance.h>
#include <breakwater/control/impact_qp.h>

#include <Eigen/LU>
#include <cmath>

#include <breakwater/linear/riccati.h>
#include "control/wall_arm.h"
#include "linear/random_qp.h"

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
  EnergyAdmittanceDesign energy() const { return {path_, approach_, {}, {}}; }
  ImpactQpDesign qp() const { return {.path = path_, .approach = approach_}; }
  ContactMpcDesign mpc() const { return {.path = path_}; }

  template <typename Law, typename Design>
  Course run(const Design& design, double stiffness, double duration_s) const {
    Law law(chain_, acceleration_, task_, design);
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
    EnergyAdmittance law(chain_, acceleration_, task_, design);
    WallArm::run(law, 1000.0, 0.01);
    mass = signal(law, "effective_mass_kg");
    speed = signal(law, "speed_cap_m_s");
  }
  EXPECT_NEAR(speed, 2.25 / std::sqrt(1000.0 * mass), 1e-12);
  EXPECT_NEAR(
      mass,
      1.0 /
          [&] {
            TipJacobian J(3, 3);
            chain_.tip_jacobian(task_.start_angles_rad, J);
            const Eigen::RowVectorXd x = J.row(0);
            return x.cwiseAbs2()
                .cwiseQuotient(acceleration_.nominal_inertia_kgm2.transpose())
                .sum();
          }(),
      0.01 * mass);
  design.admittance = {mass, 0.0};
  EnergyAdmittance law(chain_, acceleration_, task_, design);
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
  ContactMpc law(chain_, acceleration_, task_, mpc());
  EXPECT_GT(WallArm::run(law, 1000.0, 0.5).peak_N, 1.0);
  EXPECT_NEAR(signal(law, "wall_hat_m"), task_.wall_x_m, 2e-5);
}

// The law forgets its contact and the corrected place of the wall.
TEST_F(PublishedImpactControl, AResetStartsTheTaskAnew) {
  ContactMpcDesign design = mpc();
  design.wall_error_m = 0.004;
  ContactMpc law(chain_, acceleration_, task_, design);
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
            .inertia = acceleration_.nominal_inertia_kgm2,
            .velocity_limit = chain_.velocity_limits_rad_s(),
            .torque_limit = acceleration_.torque_limit_Nm,
            .lower = lower_,
            .upper = upper_,
            .mass_kg = mass_,
            .force_limit_N = 4.2,
            .foresees_impact = foresees,
            .period_s = kPeriod};
  }

  TipJacobian J_;
  Eigen::Vector3d motion_{-0.01, 0.02, -0.01};  // fixed size: dq_ keeps its address
  Eigen::Ref<const Eigen::VectorXd> dq_{motion_};
  TipPose wanted_{20.0, 1.0, -2.0};
  Eigen::VectorXd lower_ = Eigen::Vector3d::Constant(-1e3);
  Eigen::VectorXd upper_ = Eigen::Vector3d::Constant(1e3);
  double mass_;
};

TEST_F(Program, WithoutAForeseenImpactItIsResolvedAcceleration) {
  ImpactProgram program(3, qp());
  const Eigen::Vector3d expected = J_.inverse() * wanted_;
  EXPECT_LT((program.solve(state(false)) - expected).norm(), 1e-3 * expected.norm());
  wanted_[0] = -1.0;  // away from the wall: the impact's rows are idle
  const Eigen::Vector3d back = J_.inverse() * wanted_;
  EXPECT_LT((program.solve(state(true)) - back).norm(), 1e-3 * back.norm());
}

TEST_F(Program, SolutionsAreOptimalAndKeepTheForce) {
  ImpactProgram program(3, qp());
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
    ASSERT_LT(testing::optimality_error(program.solver().model(), program.input(), solution), 1e-7);
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
  ImpactProgram program(3, qp());
  motion_.setZero();
  wanted_[0] = 200.0;
  const TipPose got = J_ * program.solve(state(true));
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
    ImpactProgram program(3, design);
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

// Without bounds the first input is that of the linear quadratic regulator.
TEST(ContactProblem, WithoutBoundsItIsTheRegulator) {
  ContactMpcDesign design;
  design.q_velocity = 50.0;
  LmpcDesign problem = contact_problem(design, 2.0);
  problem.input_bounds.clear();
  problem.state_bounds.clear();
  Lmpc lmpc(problem);
  const Eigen::RowVector2d K =
      dlqr(problem.A, problem.B, problem.Q, Eigen::MatrixXd::Constant(1, 1, design.r)).K;
  const Eigen::Vector2d target(0.002, 0.0);
  const Eigen::VectorXd trajectory = target.replicate(design.prediction_steps, 1);
  const Eigen::VectorXd last = Eigen::VectorXd::Constant(1, 3.0), none = Eigen::VectorXd::Zero(1);
  for (const Eigen::Vector2d& x : {Eigen::Vector2d(-0.09, 0.0), Eigen::Vector2d(0.001, -0.2)}) {
    const double expected = -K * (x - target);
    EXPECT_NEAR(last(0) + lmpc.optimise(x, last, trajectory, none)(0), expected,
                1e-6 * std::abs(expected));
  }
}

TEST(ContactProblem, ThePredictedForceStaysBelowThePeak) {
  const ContactMpcDesign design;
  const LmpcDesign problem = contact_problem(design, 2.0);
  Lmpc lmpc(problem);
  const Eigen::VectorXd trajectory =
      Eigen::Vector2d(0.002, 0.0).replicate(design.prediction_steps, 1);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(1);
  Eigen::Vector2d x(-0.089, 0.0);
  Eigen::VectorXd u = none;
  double deepest = -1.0;
  for (int k = 0; k < 200; ++k) {
    u += lmpc.optimise(x, u, trajectory, none);
    ASSERT_LE(std::abs(u(0)), design.acceleration_m_s2 + 1e-8);
    x = problem.A * x + problem.B * u;
    deepest = std::max(deepest, x[0]);
  }
  EXPECT_LE(1000.0 * deepest, 4.2 + 1e-3);
  EXPECT_NEAR(1000.0 * x[0], 2.0, 1e-3);
}

TEST_F(PublishedImpactControl, RefuseInvalidParameters) {
  const auto refuses = [&]<typename Law>(auto design, auto&& spoil) {
    spoil(design);
    EXPECT_THROW(Law(chain_, acceleration_, task_, design), std::invalid_argument);
  };
  const auto energy_refuses = [&](auto&& spoil) {
    refuses.operator()<EnergyAdmittance>(energy(), spoil);
  };
  energy_refuses([](auto& d) { d.admittance.mass_kg = 0.0; });
  energy_refuses([](auto& d) { d.admittance.damping_Ns_m = -1.0; });
  energy_refuses([](auto& d) { d.impact.stiffness_N_m = 0.0; });
  energy_refuses([](auto& d) { d.impact.peak_margin_N = 0.0; });
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
  task_.wall_x_m = INFINITY;
  mpc_refuses([](auto&) {});
}

}  // namespace
}  // namespace breakwater::published_impact_control_test
