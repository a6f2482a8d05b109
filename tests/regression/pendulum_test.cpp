// An inverted pendulum on a cart as a plant: the template of `breakwater new plant`.
#include <breakwater/rigs/axis_scenario.h>
#include <breakwater/rigs/plant_parts.h>

#include <Eigen/LU>
#include <cmath>

#include "catalogue.h"

namespace breakwater {
namespace {

using Sets = std::vector<std::string>;

PreparedRun prepare_pendulum(const std::string& case_name, const Sets& sets = {}) {
  static const ScenarioFile file(testing::source_file("templates/plant/my_plant.toml"), "plant");
  return prepare_run(testing::catalogue(), "plant", file, case_name, sets);
}

// The warnings of a run, in one text.
std::string warnings_of(const std::string& case_name, const Sets& sets) {
  std::string text;
  for (const std::string& line : prepare_pendulum(case_name, sets).scenario->run({}).warnings) {
    text += line + "\n";
  }
  return text;
}

struct HoldingRun {
  std::string case_name;
  Sets sets;
  bool pole_is_lost;
};

// The pole has no actuator.
TEST(PendulumTest, AnAxisThatLeavesThePoseItHoldsIsReported) {
  const std::string lost = "the position of axis pole does not hold its reference";
  const HoldingRun rows[] = {
      {"lqr", {}, false},
      {"kfd", {}, false},
      {"lqr", {"axis.pole.start.position_rad=0.0"}, false},
      {"lqr", {"axis.pole.encoder.bits=6"}, true},
      {"lqr", {"axis.pole.encoder.bits=6", "axis.pole.start.position_rad=0.01"}, true},
      // A force throws it over.
      {"lqr",
       {"axis.pole.start.position_rad=0.0", "push.hit.body=\"pole\"", "push.hit.along=[1, 0, 0]",
        "push.hit.disturbance.kind=\"step\"", "push.hit.disturbance.amplitude_N=50",
        "push.hit.disturbance.start_s=8"},
       true},
      // No controller has the pole's reference.
      {"lqr", {"controller.name=\"axes\""}, false},
      {"lqr", {"controller.name=\"axes\"", "axis.cart.reference.kind=\"hold\""}, false}};
  for (const HoldingRun& row : rows) {
    const std::string said = warnings_of(row.case_name, row.sets);
    EXPECT_EQ(static_cast<bool>(has(said, lost)), row.pole_is_lost)
        << row.case_name << " " << ::testing::PrintToString(row.sets) << "\n"
        << said;
  }
}

// The models that controllers get.
PlantTask task_of(const Sets& sets) {
  Sets all = {"controller.name=\"axes\"", "axis.cart.controller.name=\"pd\"",
              "axis.cart.controller.kp=1.0", "axis.cart.controller.kd=1.0"};
  all.insert(all.end(), sets.begin(), sets.end());
  const PreparedRun run = prepare_pendulum("lqr", all);
  return plant_task(dynamic_cast<const LoopScenario&>(*run.scenario).loops().front().plant);
}

TEST(PendulumTest, TheTruePlantChangesNoNominalModel) {
  const PlantTask nominal = task_of({});
  for (const char* set :
       {"plant.inertia_ratio=1.5", "axis.cart.plant.viscous_friction_Ns_m=3.0",
        "axis.pole.plant.viscous_friction_Nms_rad=0.1", "axis.cart.plant.coulomb_friction_N=1.0"}) {
    const PlantTask task = task_of({set});
    EXPECT_EQ(task.whole.plant.A, nominal.whole.plant.A) << set;
    EXPECT_EQ(task.whole.plant.B, nominal.whole.plant.B) << set;
    EXPECT_EQ(task.held_input, nominal.held_input) << set;
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(task.axes[i].axis.plant.A, nominal.axes[i].axis.plant.A) << set;
      EXPECT_EQ(task.axes[i].axis.plant.B, nominal.axes[i].axis.plant.B) << set;
    }
    EXPECT_NE(prepare_pendulum("lqr", {set, "run.duration_s=2.0"}).scenario->run({}).state_hash,
              prepare_pendulum("lqr", {"run.duration_s=2.0"}).scenario->run({}).state_hash)
        << set;
  }
}

// M q̈ = [u - c ẋ; m g l θ - b θ̇] with M = [J_cart, m l; m l, J_pole] about the upright pose.
TEST(PendulumTest, TheKeysOfAnAxisSetItsPartOfTheLinearModel) {
  constexpr double kInertia = 3.0, kFriction = 2.0;
  constexpr double kMass = 0.2, kLength = 0.3, kPole = 6e-3 + kMass * kLength * kLength;
  const PlantTask task =
      task_of({"axis.cart.nominal.from=\"keys\"", "axis.cart.nominal.mass_kg=3.0",
               "axis.cart.nominal.viscous_friction_Ns_m=2.0"});
  Eigen::Matrix2d M;
  M << kInertia, kMass * kLength, kMass * kLength, kPole;
  const Eigen::Matrix2d inverse = M.inverse();
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  A.topRightCorner<2, 2>().setIdentity();
  A.block<2, 1>(2, 1) = inverse.col(1) * kMass * 9.81 * kLength;
  A.block<2, 1>(2, 2) = -inverse.col(0) * kFriction;
  A.block<2, 1>(2, 3) = -inverse.col(1) * 1e-3;
  EXPECT_TRUE(task.whole.plant.A.isApprox(A, 1e-6)) << task.whole.plant.A << "\n\n" << A;
  EXPECT_TRUE(task.whole.plant.B.bottomRows(2).isApprox(inverse.col(0), 1e-6));
}

TEST(PendulumTest, ADisturbanceEndsAtItsTime) {
  const auto largest_after = [](const char* end) {
    const Sets sets = {"axis.cart.disturbance.start_s=0.5",
                       end,
                       "run.duration_s=1.5",
                       "metric.left.of=\"cart_d_true_N\"",
                       "metric.left.kind=\"max\"",
                       "metric.left.from_s=1.01"};
    return prepare_pendulum("lqr", sets).scenario->run({}).metric("left_N").value_or(std::nan(""));
  };
  EXPECT_EQ(largest_after("axis.cart.disturbance.end_s=0.0"), 2.0);
  EXPECT_EQ(largest_after("axis.cart.disturbance.end_s=1.0"), 0.0);
}

TEST(PendulumTest, ObserversWithPlacedPolesTakeARowForEachAxis) {
  const Sets rows[] = {
      {"observer.name=\"idob\"", "observer.poles_rad_s=[[-20, -25, -30], [-40, -50]]"},
      {"observer.name=\"state_observer\"", "observer.poles_rad_s=[[-40, -45], [-50, -55]]"}};
  for (const Sets& sets : rows) EXPECT_EQ(warnings_of("lqr", sets), "") << sets.front();
}

TEST(PendulumTest, NominalInertiasBelowTheCouplingHaveNoLinearModel) {
  EXPECT_TRUE(has(task_of({"axis.cart.nominal.from=\"keys\"", "axis.cart.nominal.mass_kg=0.01",
                           "axis.cart.nominal.viscous_friction_Ns_m=0.0"})
                      .why_not_linear,
                  "the nominal inertias are too small"));
}

}  // namespace
}  // namespace breakwater
