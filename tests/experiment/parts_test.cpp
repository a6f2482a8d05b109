// Parts with their own keys: required keys, readers, printed files. Also external parts in
// Breakwater's experiments.
#include <breakwater/experiment/parts.h>

#include <breakwater/experiment/runner.h>
#include <breakwater/program/program.h>
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

// Feedback of the first measurement.
class Spring final : public Controller {
 public:
  explicit Spring(double k) : k_(k) {
    publish({"pull_N", "N", "-k times the measurement", view(pull_N_)});
  }
  void reset(const Sample&) override {}
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override {
    pull_N_ = -k_ * y.y(0);
    u.setConstant(pull_N_);
  }

 private:
  double k_;
  double pull_N_ = 0.0;
};

void bind_spring(Fields& fields, Number& number) {
  fields.number("controller.spring_constant", number.value, any(), "its stiffness");
}
std::unique_ptr<Controller> make_axis_spring(const Number& number, const AxisTask&,
                                             std::shared_ptr<DisturbanceEstimator>) {
  return std::make_unique<Spring>(number.value);
}
std::unique_ptr<Controller> make_quadrotor_spring(const Number& number, const QuadrotorTask&,
                                                  std::shared_ptr<QuadrotorEstimator>) {
  return std::make_unique<Spring>(number.value);
}

TEST(OwnParts, AnAxisAndTheQuadrotorTakeAnExternalController) {
  Catalogue catalogue = standard_catalogue();
  catalogue.add(AxisControllerKind("spring", "pulls back", bind_spring, make_axis_spring));
  catalogue.add(
      QuadrotorControllerKind("spring", "pulls back", bind_spring, make_quadrotor_spring));
  for (const char* scenario : {"motor_estimation", "quadrotor_waves"}) {
    const ScenarioFile file(catalogue.get<ScenarioKind>(scenario).file().string(), scenario);
    const Recording run = prepare_run(catalogue, scenario, file, file.default_case(),
                                      {"controller.name=spring", "controller.spring_constant=0.1",
                                       "run.duration_s=1"})
                              .scenario->run({});
    ASSERT_FALSE(run.failure) << scenario << ": " << run.failure->reason;
    EXPECT_GT(run.track("control").rows(), 99U) << scenario;
    EXPECT_EQ(run.track("control").values("pull_N").size(), run.track("control").rows());
  }
}

}  // namespace breakwater::parts_test
