// Parts with their own keys: required keys, readers, printed files. Also external parts in
// Breakwater's experiments.
#include <breakwater/experiment/parts.h>

#include <breakwater/experiment/runner.h>
#include <breakwater/program/program.h>
#include <breakwater/rigs/arm_parts.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/rigs/quadrotor_parts.h>
#include "support.h"
#include "tables.h"

namespace breakwater::parts_test {

// The product of the toy parts: their name and setting.
struct Product {
  std::string text;
};

struct ToyKind : PartKind<Product, int> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "toy";
};

struct Number {
  double value = 0.0;
};

void bind_small(Fields& fields, Number& number) {
  fields.number("toy.size", number.value, between(0, 1), "its size");
}
void bind_large(Fields& fields, Number& number) {
  fields.number("toy.size", number.value, between(10, 20), "its size");
  fields.standard("toy.size", {15.0});
}
void bind_named(Fields& fields, std::string& name) {
  fields.text("toy.label", name, "what stands on it");
}
template <char initial>
std::unique_ptr<Product> make_number(const Number& number, int factor) {
  if (number.value == 0.5) throw WrongKey("toy.size", "must not be a half");
  return std::make_unique<Product>(Product{initial + std::to_string(factor * number.value)});
}
std::unique_ptr<Product> make_named(const std::string& name, int) {
  if (name.empty()) throw std::invalid_argument("nothing stands on it");
  return std::make_unique<Product>(Product{name});
}

class PartsTest : public ::testing::Test {
 protected:
  PartsTest() {
    catalogue_.add(ToyKind("small", "a small one", bind_small, make_number<'s'>));
    catalogue_.add(ToyKind("large", "a large one", bind_large, make_number<'l'>));
    catalogue_.add(ToyKind("named", "one with a name", bind_named, make_named));
  }

  // The product of a case, or the error message without the file's name. `print` gets the config
  // file.
  std::string make(const std::string& keys, const std::string& case_name = "one",
                   const std::string& standard = "") {
    std::ofstream(path_) << "scenario = \"test\"\ndefault_case = \"one\"\n" << keys;
    PartChoice<ToyKind> choice(catalogue_, "toy.name", standard);
    Fields fields;
    choice.bind(fields);
    try {
      const ScenarioFile file(path_.string(), "test");
      const Config config = file.config(case_name);
      fields.check(file);
      fields.read(config);
      choice.check(config, 2);
    } catch (const std::invalid_argument& error) {
      std::string what = error.what();
      const auto at = what.find(path_.string());
      return at == std::string::npos ? what : what.replace(at, path_.string().size(), "FILE");
    }
    printed_ = fields.print("test", case_name);
    unused_ = fields.unused();
    return choice.make(2)->text;
  }

  Catalogue catalogue_;
  const testing::TemporaryPath path_{"parts.toml"};
  std::string printed_;
  std::vector<UnusedKey> unused_;
};

// Keys are required for the chosen part only, and checked in every case.
TEST_F(PartsTest, AreMadeOrRefusedByTheirKeys) {
  for (const auto& row : testing::rows_of("Parts")) {
    EXPECT_EQ(make(row.at(0), row.at(1), row.at(2)), row.at(3)) << row.at(0);
  }
}

TEST_F(PartsTest, ReportsAKeyOfAnotherPartAsUnused) {
  ASSERT_EQ(make("toy.label = \"x\"\ntoy.size = 0.25\n[case.one]\ntoy.name = \"named\"\n"), "x");
  ASSERT_EQ(unused_.size(), 1U);
  EXPECT_EQ(unused_[0].key, "toy.size");
  EXPECT_EQ(unused_[0].reason, "has an effect only where toy.name is small or large");
  EXPECT_EQ(unused_[0].choice, "toy.name");
}

TEST_F(PartsTest, ThePrintedFileIsCompleteAndRoundTrips) {
  ASSERT_EQ(make("toy.name = \"large\"\ntoy.label = \"x\"\n[case.one]\n"), "l30.000000");
  EXPECT_EQ(printed_, R"(scenario = "test"
default_case = "one"

[toy]
# toy: small, large, named
name = "large"
# small, large: its size
size = 15.0
# named: what stands on it
label = "x"

[case.one]
)");
  const std::string once = printed_.substr(printed_.find("\n[toy]"));
  ASSERT_EQ(make(once), "l30.000000");
  EXPECT_EQ(printed_.substr(printed_.find("\n[toy]")), once);
}

// A file from before `small` and `large` existed.
TEST_F(PartsTest, AFileStaysValidWhenOtherPartsAreAdded) {
  const std::string old = "toy.name = \"named\"\ntoy.label = \"x\"\n[case.one]\n";
  ASSERT_EQ(make(old), "x");
  EXPECT_TRUE(lacks(printed_, "size"));
}

TEST_F(PartsTest, ReadsARunOfAnUnknownPartPartially) {
  std::ofstream(path_) << "scenario = \"test\"\ndefault_case = \"one\"\nspeed = 3\n"
                          "toy.name = \"theirs\"\ntoy.colour = \"red\"\n[case.one]\n";
  PartChoice<ToyKind> choice(catalogue_, "toy.name");
  Fields fields;
  double speed = 0.0;
  double mass = 0.0;
  fields.number("speed", speed, positive(), "how fast");
  fields.number("mass", mass, positive(), "how heavy");
  choice.bind(fields);
  const Config config = ScenarioFile(path_.string(), "test").config("one");
  EXPECT_THROW(fields.read(config), std::invalid_argument);
  EXPECT_EQ(fields.read_finished(config), std::vector<std::string>{"mass"});
  EXPECT_EQ(speed, 3.0);
}

TEST_F(PartsTest, TheCatalogueListsThem) {
  ASSERT_EQ(catalogue_.parts().size(), 3U);
  EXPECT_EQ(catalogue_.parts()[1].what, "toy");
  EXPECT_EQ(catalogue_.parts()[1].name, "large");
  EXPECT_EQ(catalogue_.parts()[1].help, "a large one");
  EXPECT_TRUE(catalogue_.has<ToyKind>("small"));
  EXPECT_FALSE(catalogue_.has<ToyKind>("Small"));
  EXPECT_THROW(catalogue_.add(ToyKind("large", "another", bind_large, make_number<'l'>)),
               std::invalid_argument);
}

// --- External parts in Breakwater's experiments. ---

// A stub with its own key: the true disturbance times a factor.
class Constant final : public DisturbanceEstimator {
 public:
  explicit Constant(double value) { disturbance_(0) = value; }
  void reset(const Vector& x) override { state_ = x; }
  void update(const Vector&, const Vector& y) override { state_(0) = y(0); }
  View state() const override { return {state_.data(), 2}; }
  View disturbance() const override { return {disturbance_.data(), 1}; }
  std::span<const Signal> signals() const override { return {}; }

 private:
  Eigen::Vector2d state_ = Eigen::Vector2d::Zero();
  Eigen::VectorXd disturbance_ = Eigen::VectorXd::Zero(1);
};

void bind_constant(Fields& fields, Number& number) {
  fields.number("observer.constant_value", number.value, any(), "what it says");
}
std::unique_ptr<DisturbanceEstimator> make_constant(const Number& number, const NominalAxis&) {
  return std::make_unique<Constant>(number.value);
}

// Proportional feedback of the measurement only.
class Spring final : public Controller {
 public:
  explicit Spring(double k) : k_(k) {}
  void reset(const Sample&) override {}
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override {
    pull_N_ = -k_ * y.y(0);
    u.setConstant(pull_N_);
  }
  std::span<const Signal> signals() const override { return signals_; }

 private:
  double k_;
  double pull_N_ = 0.0;
  std::vector<Signal> signals_ = {{"pull_N", "N", "-k times the measurement", view(pull_N_)}};
};

void bind_spring(Fields& fields, Number& number) {
  fields.number("controller.spring_constant", number.value, any(), "its stiffness");
}
std::unique_ptr<Controller> make_axis_spring(const Number& number, const AxisTask&,
                                             std::shared_ptr<DisturbanceEstimator>) {
  return std::make_unique<Spring>(number.value);
}
std::unique_ptr<Controller> make_arm_spring(const Number& number, const ArmSetup&) {
  return std::make_unique<Spring>(number.value);
}
std::unique_ptr<Controller> make_quadrotor_spring(const Number& number, const QuadrotorTask&,
                                                  std::shared_ptr<QuadrotorEstimator>) {
  return std::make_unique<Spring>(number.value);
}

Recording run_with_theirs(const std::string& scenario, const std::vector<std::string>& sets) {
  Catalogue catalogue = standard_catalogue();
  catalogue.add(AxisEstimatorKind("constant", "always the same", bind_constant, make_constant));
  catalogue.add(AxisControllerKind("spring", "pulls back", bind_spring, make_axis_spring));
  catalogue.add(ArmControllerKind("spring", "pulls back", bind_spring, make_arm_spring));
  catalogue.add(
      QuadrotorControllerKind("spring", "pulls back", bind_spring, make_quadrotor_spring));
  const ScenarioKind& kind = catalogue.get<ScenarioKind>(scenario);
  const ScenarioFile file(kind.file().string(), scenario);
  return prepare_run(catalogue, scenario, file, file.default_case(), sets).scenario->run({});
}

// With a step of 10 N m and an estimate of 6 the error is 4, and the PD control yields by 4/K_p.
TEST(OwnParts, TheMotorTakesAnExternalEstimator) {
  const Recording run =
      run_with_theirs("motor_estimation",
                      {"observer.name=constant", "observer.constant_value=6", "run.duration_s=10",
                       "encoder.bits=0", "controller.kd=0", "plant.viscous_friction_Nms_rad=20"});
  ASSERT_FALSE(run.failure) << run.failure->reason;
  EXPECT_NEAR(run.metric("rmse_disturbance_Nm").value(), 4.0, 1e-9);
  EXPECT_NEAR(std::abs(run.track("control").values("position_true_rad").back()), 0.4, 0.02);
}

// A mass on a spring from its controller: ω = √(k/m), without an estimate.
TEST(OwnParts, EachAxisExperimentTakesAnExternalController) {
  for (const char* scenario : {"motor_estimation", "cart_estimation", "cart_position",
                               "cart_offset_free", "cart_constrained"}) {
    const Recording run = run_with_theirs(
        scenario, {"controller.name=spring", "controller.spring_constant=4", "run.duration_s=5"});
    ASSERT_FALSE(run.failure) << scenario << ": " << run.failure->reason;
    for (const Metric& metric : run.metrics) {
      const bool is_of_estimate = metric.name.find("disturbance") != std::string::npos ||
                                  metric.name.find("estimate") != std::string::npos;
      EXPECT_FALSE(is_of_estimate) << scenario << " " << metric.name;
    }
    EXPECT_EQ(run.track("control").values("pull_N").size(), run.track("control").rows());
  }
}

TEST(OwnParts, ArmAndQuadrotorTakeAnExternalController) {
  for (const char* scenario : {"arm_wall_contact", "arm_push", "quadrotor_waves"}) {
    const Recording run = run_with_theirs(
        scenario, {"controller.name=spring", "controller.spring_constant=0.1", "run.duration_s=1"});
    ASSERT_FALSE(run.failure) << scenario << ": " << run.failure->reason;
    EXPECT_GT(run.track("control").rows(), 99U) << scenario;
  }
}

// Each joint has 80 % of its friction as a load, and so has a shelf that is no joint of the chain.
// By the formula of friction.h the shelf creeps 0.2 µm in 2 s, and the joints less than 0.1 µrad.
// Beyond its friction a joint moves.
TEST(OwnParts, FrictionHoldsEachJointOfTheArm) {
  std::string mjcf = testing::text_of(testing::source_file("models/arm.xml"));
  mjcf = testing::replaced(mjcf, "<worldbody>", R"(<worldbody><body name="shelf">
    <inertial pos="0 0 0" mass="2" diaginertia="0.01 0.01 0.01"/>
    <joint name="lift" type="slide" axis="0 0 1" armature="0" frictionloss="24.525"/></body>)");
  mjcf = testing::replaced(mjcf, "qpos=\"0 0 0\"", "qpos=\"0 0 0 0\"");
  const testing::TemporaryPath model("shelf.xml", mjcf);
  // How far the shelf and the joints move under a torque on each joint.
  const auto moved_by = [&](double torque_Nm) {
    const double start_rad = 0.8956647938578649;  // the first of task.start_angles_rad
    const Recording run = run_with_theirs(
        "arm_push", {"controller.name=spring", "run.duration_s=2", "model.mjcf=" + model.string(),
                     "controller.spring_constant=" + std::to_string(-torque_Nm / start_rad)});
    const Track& track = run.track("control");
    EXPECT_NEAR(track.values("torque_applied_Nm").front(), torque_Nm, 1e-3 * torque_Nm);
    const std::vector<double> q = track.values("qpos");
    std::vector<double> moved;
    for (std::size_t i = 0; i < 4; ++i) moved.push_back(std::abs(q[q.size() - 4 + i] - q[i]));
    return moved;
  };
  const std::vector<double> crept = moved_by(3.2);
  EXPECT_NEAR(crept[0], 1.962e-7, 1e-9);
  for (std::size_t i = 1; i < crept.size(); ++i) EXPECT_LT(crept[i], 1e-7);
  EXPECT_GT(moved_by(4.2)[1], 0.01);
}

}  // namespace breakwater::parts_test
