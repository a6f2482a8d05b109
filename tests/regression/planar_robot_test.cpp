// The planar arm, whose controllers know it as a chain in space.
#include <breakwater/plants/tip_chain.h>
#include <breakwater/rigs/arm_parts.h>
#include "regression/run_case.h"

namespace breakwater::planar_robot_test {
namespace {

constexpr const char* kInSpace = "_in_space";

// A controller of the arm that gets three parallel hinges in place of the planar chain.
class InSpace final : public ArmControllerKind::Part {
 public:
  explicit InSpace(std::unique_ptr<ArmControllerKind::Part> own) : own_(std::move(own)) {}
  void bind(Fields& fields) override { own_->bind(fields); }

  std::unique_ptr<Controller> make(const ArmSetup& planar) const override {
    const PlanarChain& chain = *planar.chain.planar();
    Eigen::Isometry3d next = Eigen::Isometry3d::Identity();
    std::vector<SpatialJoint> joints;
    for (int i = 0; i < chain.joints(); ++i) {
      joints.push_back({.frame = next, .effort_limit = chain.effort_limits_Nm()(i)});
      next.translation().x() = 0.2;
    }
    ArmSetup setup = planar;
    setup.chain = TipChain(std::make_shared<SpatialChain>(
        joints, next, Eigen::Isometry3d::Identity(), planar.task.start_angles_rad));
    return own_->make(setup);
  }

 private:
  std::unique_ptr<ArmControllerKind::Part> own_;
};

const Catalogue& catalogue_with_space() {
  static const Catalogue all = [] {
    Catalogue catalogue = standard_catalogue();
    for (const ArmControllerKind& kind : testing::catalogue().all<ArmControllerKind>()) {
      catalogue.add(ArmControllerKind(kind.name + kInSpace, kind.help, [kind] {
        return std::make_unique<InSpace>(kind.settings());
      }));
    }
    return catalogue;
  }();
  return all;
}

class PlanarArm : public ::testing::TestWithParam<const char*> {};

TEST_P(PlanarArm, HasTheSameMetricsAsAChainInSpace) {
  const std::string case_name = GetParam() + std::string("-2N");
  const auto metrics = [&](const std::string& suffix) {
    std::vector<std::string> sets = {"run.duration_s=17", "wall.solid_from_s=6",
                                     "force.from_s=7",    "metrics.from_s=12",
                                     "metrics.to_s=17",   "sensor.encoder_counts_per_turn=0"};
    if (!suffix.empty()) sets.push_back("controller.name=\"" + (GetParam() + suffix) + '"');
    const PreparedRun run =
        prepare_run(catalogue_with_space(), "arm_wall_contact",
                    testing::scenario_file("arm_wall_contact"), case_name, sets);
    return run.scenario->run(testing::kWithoutLog).metrics;
  };
  const std::vector<Metric> planar = metrics(""), space = metrics(kInSpace);
  ASSERT_GT(planar.size(), 10U);
  ASSERT_EQ(space.size(), planar.size());
  for (std::size_t i = 0; i < planar.size(); ++i) {
    EXPECT_NEAR(space[i].value, planar[i].value, 1e-6 * std::max(1.0, std::abs(planar[i].value)))
        << planar[i].name;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, PlanarArm, ::testing::Values("proposed", "hpfc", "drac", "tlsc"),
                         [](const auto& method) { return std::string(method.param); });

}  // namespace
}  // namespace breakwater::planar_robot_test
