// The binaries: help, cases, invalid input, failures, and the files that they leave.
#include <sys/stat.h>
#include <csignal>

#include <nlohmann/json.hpp>

#include <breakwater/record/hdf5_log.h>
#include "cli/program.h"

namespace breakwater::command_line_test {
namespace fs = std::filesystem;
using testing::line_of;
using testing::ProgramResult;
using testing::repeated;

class CommandLine : public testing::ProgramTest {
 protected:
  // A copy of a project's file with one text replaced.
  void copy_with(const std::string& source, const std::string& name, const std::string& from,
                 const std::string& to) const {
    write(name, testing::replaced(testing::text_of(testing::source_file(source)), from, to));
  }
};

// ---- invalid input: one line, exit 2, at once, nothing left behind -----------------------------

// The others are in refusals.txt. A sanitizer's operator new ends the program in place of
// bad_alloc.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(CommandLine, RefusesALogThatDoesNotFitInMemory) {
  expect_refused(
      "arm_wall_contact --duration 1e7",
      "run.duration_s: the log of so long a run does not fit in memory: set record.stream=true");
}
#endif

// ---- runs that fail ----------------------------------------------------------------------------

// DRAC compensates J̇q̇ and gives its observer the commanded torque, not the applied one. With a
// ten times longer sampling period it becomes unstable.
TEST_F(CommandLine, ADivergingRunNamesTimeAndSignal) {
  const ProgramResult result =
      run("arm_wall_contact --case drac-2N --set control.period_s=0.02 --duration 30 --out run");
  EXPECT_EQ(result.status, 3);
  const auto manifest = json("run/manifest.json");
  EXPECT_EQ(manifest["status"], "failed");
  EXPECT_EQ(manifest["reason"], "command of actuator 1 is not finite");
  const double time_s = manifest["time_s"];
  std::ostringstream time_text;
  time_text << time_s;
  EXPECT_TRUE(has(result.err, "failed at t = " + time_text.str() + " s: "));
  EXPECT_FALSE(fs::exists(folder_ / "run/metrics.json"));
  const auto torque =
      read_hdf5_signal((folder_ / "run/log.h5").string(), "control/torque_command_Nm");
  EXPECT_EQ(torque.rows, static_cast<std::size_t>(std::lround(time_s / 0.02)));
  EXPECT_GT(*std::max_element(torque.values.begin(), torque.values.end()), 1e3);
}

TEST_F(CommandLine, AKilledRunLeavesNoFolderAndTheNextOneClearsUp) {
  const auto killed =
      run("arm_wall_contact --duration 100 --out run", has_made_something(), SIGKILL);
  EXPECT_EQ(killed.status, 128 + SIGKILL);
  EXPECT_FALSE(fs::exists(folder_ / "run"));
  ran("arm_wall_contact --duration 0.1 --out run");
  for (const std::string& name : entries()) {
    EXPECT_TRUE(lacks(name, "partial"));
  }
}

TEST_F(CommandLine, AnInterruptedRunLeavesNothing) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto result = run("arm_wall_contact --case all", has_made_something(), signal);
    EXPECT_EQ(result.status, 130);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(entries().empty());
  }
}

TEST_F(CommandLine, ANewProjectPrintsItsBuildCommands) {
  const ProgramResult result = ran("breakwater new controller mine");
  const std::vector<std::string> said = testing::lines_of(result.out);
  ASSERT_EQ(said.size(), 6U) << result.out;
  const std::string prefix = said[2].substr(said[2].find(" --prefix ") + 10);
  const std::string build = prefix.substr(0, prefix.rfind("/installed"));
  EXPECT_TRUE(fs::exists(build + "/CMakeCache.txt")) << build;
  EXPECT_EQ(said[2], "cmake --install " + build + " --prefix " + prefix);
  EXPECT_EQ(said[3], "cd mine && CMAKE_PREFIX_PATH=" + prefix +
                         " cmake --preset release && cmake --build --preset release && ctest "
                         "--preset release");
}

// Measured times differ from run to run: they are in the manifest and not among the metrics.
TEST_F(CommandLine, CostsAreInTheManifestAndNotAmongTheMetrics) {
  const ProgramResult result =
      ran("cart_constrained --case proposed-idob --duration 0.1 --out run");
  EXPECT_TRUE(lacks(result.out, "_us"));
  const auto costs = json("run/manifest.json")["costs"];
  EXPECT_EQ(costs.size(), 2U);
  EXPECT_GT(costs["qp_time_mean_us"].get<double>(), 0.0);
  EXPECT_GE(costs["qp_time_max_us"].get<double>(), costs["qp_time_mean_us"].get<double>());
  const auto metrics = json("run/metrics.json");
  EXPECT_TRUE(metrics.contains("qp_iterations_mean"));
  for (const auto& [name, value] : metrics.items()) EXPECT_FALSE(name.ends_with("_us")) << name;
}

// A motor model with additional elements, and optionally a higher limit of elements.
class LargeModels : public CommandLine {
 protected:
  void motor_with(const std::string& part) const {
    copy_with("models/motor.xml", "motor.xml", "<worldbody>", part + "<worldbody>");
  }
  const std::string run_ =
      "breakwater run motor_estimation --duration 0.01 --out run --quiet --set "
      "model.mjcf=motor.xml";
};

TEST_F(LargeModels, RefusesMoreElementsThanTheKeyAllows) {
  motor_with(
      "<worldbody><body><composite type='particle' count='3000 3000 1' spacing='1'>"
      "<geom size='.1'/></composite></body></worldbody>");
  const ProgramResult composite = run(run_);
  EXPECT_EQ(composite.status, 2);
  EXPECT_LT(composite.seconds, 5.0 * testing::kSlowness);
  EXPECT_TRUE(has(composite.err, "<composite>: here the model has 90000",
                  " elements: model.most_elements allows 20000\n"));
  motor_with("<worldbody>" + repeated("<site/>", 30000) + "</worldbody>");
  expect_refused(
      run_, "HERE/motor.xml:" + line_of(read("motor.xml"), "<site/>") +
                ": <site>: here the model has 20001 elements: model.most_elements allows 20000");
  motor_with("");
  expect_refused(
      run_ + " model.most_elements=9",
      "HERE/motor.xml:58: <body>: here the model has 10 elements: model.most_elements allows 9");
  ran(run_ + " model.most_elements=100");
}

TEST_F(LargeModels, ASignalEndsACompilationSoon) {
  motor_with("<worldbody>" + repeated("<geom size='1'/>", 60000) + "</worldbody>");
  const ProgramResult result =
      run(run_ + " model.most_elements=1000000", testing::worked_for(1.0), SIGTERM);
  EXPECT_EQ(result.status, 130);
  EXPECT_LT(result.seconds, 6.0 * testing::kSlowness) << "without the signal it is minutes";
  EXPECT_EQ(result.err, "interrupted while a model was compiled\n");
  EXPECT_EQ(entries(), std::vector<std::string>{"motor.xml"});
}

}  // namespace breakwater::command_line_test
