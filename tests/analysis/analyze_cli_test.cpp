#include "cli/program.h"

namespace breakwater {
namespace {

class Analyze : public testing::ProgramTest {};

TEST_F(Analyze, LeavesATableAPageAndTheNumbers) {
  const testing::ProgramResult result =
      ran("breakwater analyze motor_estimation --case idob,vfakfd --points 3 --from 5 --to 50 "
          "--settle 1");
  EXPECT_TRUE(has(result.out, "idob measured", "vfakfd measured", "phase margin [deg]"));
  EXPECT_TRUE(has(result.err, "vfakfd: only measured"));
  const std::filesystem::path out = "runs/analyze/motor_estimation";
  EXPECT_EQ(entries(out), (std::vector<std::string>{"analysis.csv", "margins.csv", "report.html"}));
  EXPECT_TRUE(has(read(out / "report.html"), "Loop gain"));
  EXPECT_TRUE(lacks(read(out / "report.html"), "{{"));
  EXPECT_EQ(lines(out / "analysis.csv").size(), 1U + 1200 + 3 + 3);
}

TEST_F(Analyze, EachAxisOfAPlantHasALoop) {
  const testing::ProgramResult result = ran("breakwater analyze plant --design-only");
  EXPECT_TRUE(has(result.out, "idob, shoulder", "idob, elbow"));
  EXPECT_TRUE(has(result.err, "plant idob, elbow: designed with the other joints held\n"));
  EXPECT_EQ(lines("runs/analyze/plant/margins.csv").at(1).substr(0, 14), "idob,shoulder,");
  EXPECT_TRUE(
      lacks(ran("breakwater analyze plant --axis elbow --design-only").out, "idob, shoulder"));
  EXPECT_TRUE(lacks(ran("breakwater analyze plant --design-only --set "
                        "axis.elbow.controller.name=none")
                        .out,
                    "elbow"));
}

TEST_F(Analyze, TheSineFitsDriveAndFriction) {
  const std::string elbow =
      "breakwater analyze plant --axis elbow --points 2 --from 20 --to 50 --settle 1 --set ";
  // A sine near the limit would not be linear.
  const std::string weak = elbow + "axis.elbow.drive.limit_Nm=0.8";
  EXPECT_TRUE(lacks(ran(weak).err, "not linear"));
  EXPECT_TRUE(has(ran(weak + " --amplitude 0.79").err, "not linear at these amplitudes",
                  "the drive is at its limit for up to"));
  EXPECT_TRUE(has(ran(elbow + "axis.elbow.plant.coulomb_friction_Nm=0.8").err,
                  "plant idob, elbow: the sine of 1 N m is less than 3 times the Coulomb friction "
                  "at the drive, 0.8 N m"));
  EXPECT_TRUE(has(ran(elbow + "axis.elbow.drive.limit_Nm=4 "
                              "axis.elbow.plant.coulomb_friction_Nm=0.8")
                      .err,
                  "elbow: the sine of 0.4 N m is less than"));
  // The friction of the model file counts too.
  std::string model = read(testing::source_file("models/scara.xml"));
  const std::string joint = "<joint name=\"elbow\"";
  model.insert(model.find(joint) + joint.size(), " frictionloss=\"0.7\"");
  const testing::TemporaryPath file("sticking.xml", model);
  EXPECT_TRUE(has(ran(elbow + "model.mjcf=" + file.string()).err,
                  "3 times the Coulomb friction at the drive, 0.7 N m"));
}

TEST_F(Analyze, AnUnstableLoopIsAFailedRun) {
  const testing::ProgramResult result =
      run("breakwater analyze motor_estimation --case idob --set sensor.delay_samples=1000 "
          "--points 2 --from 1 --to 50 --settle 60");
  EXPECT_EQ(result.status, 3) << result.out << result.err;
  EXPECT_TRUE(has(result.err,
                  "motor_estimation idob: the loop is not stable: its response to a "
                  "pulse grows without bound. It has no margins"));
  EXPECT_TRUE(entries().empty());
}

TEST_F(Analyze, AnUnstableLoopLeavesTheOthers) {
  const testing::ProgramResult result =
      ran("breakwater analyze two_inertia --case rrc,pd --set nominal.motor_inertia_kgm2=0.03 "
          "--design-only");
  EXPECT_TRUE(has(result.err, "two_inertia rrc: the loop is not stable"));
  EXPECT_TRUE(has(result.out, "pd", "phase margin [deg]"));
  EXPECT_TRUE(lacks(result.out, "rrc"));
}

}  // namespace
}  // namespace breakwater
