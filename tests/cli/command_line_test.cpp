// The binaries: help, cases, invalid input, failures, and the files that they leave.
#include <sys/stat.h>
#include <csignal>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include <breakwater/record/hdf5_log.h>
#include "cli/program.h"
#include "environment.h"
#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;
using testing::line_of;
using testing::ProgramResult;
using testing::repeated;
using testing::run_program;

constexpr const char* kWallFile = "scenarios/arm_wall_contact/arm_wall_contact.toml";

class CommandLine : public testing::ProgramTest {
 protected:
  // A copy of a project's file with one text replaced.
  void copy_with(const std::string& source, const std::string& name, const std::string& from,
                 const std::string& to) const {
    write(name, testing::replaced(testing::text_of(testing::source_file(source)), from, to));
  }
};

TEST_F(CommandLine, HelpExplainsTheUse) {
  const ProgramResult help = ran("arm_wall_contact --help");
  EXPECT_TRUE(has(help.out, "--case", "--config", "--set", "--seed", "--duration", "--out", "--csv",
                  "--quiet", "--list-cases", "--print-config"));
  EXPECT_TRUE(help.err.empty());
  EXPECT_EQ(ran("breakwater --help").out, ran("breakwater").out);
  ran("arm_wall_contact --version");
}

TEST_F(CommandLine, ListsScenariosAndCases) {
  const ProgramResult list = ran("breakwater list");
  EXPECT_TRUE(has(list.out, "arm_wall_contact ", "arm_push "));
  EXPECT_EQ(run("arm_wall_contact --list-cases").out,
            "proposed-2N\nhpfc-2N\ndrac-2N\nproposed-5N\nhpfc-5N\ndrac-5N\ntuned-2N\ntuned-5N\n"
            "tlsc-2N\ntlsc-5N\nenergy-2N\nenergy-5N\nimpact-qp-2N\nimpact-qp-5N\n"
            "contact-mpc-2N\ncontact-mpc-5N\n");
  EXPECT_TRUE(has(run("breakwater estimate --list-cases").out, "stf\nqvff\n"));
  EXPECT_EQ(run("breakwater run arm_push --list-cases").out,
            "proposed-link1\nproposed-link2\nproposed-link3\nhpfc-link1\nhpfc-link2\nhpfc-link3\n"
            "drac-link1\ndrac-link2\ndrac-link3\ntlsc-link1\ntlsc-link2\ntlsc-link3\n");
}

TEST_F(CommandLine, ARunLeavesItsFolder) {
  const ProgramResult result = ran("arm_wall_contact --duration 0.5 --csv --seed 3");
  EXPECT_TRUE(result.err.empty()) << "progress belongs on a terminal: " << result.err;
  const std::string run = "runs/arm_wall_contact/proposed-2N-seed3";
  for (const char* file : {"config.toml", "metrics.json", "manifest.json", "log.h5", "log.csv"}) {
    EXPECT_TRUE(fs::exists(folder_ / run / file)) << file;
  }
  EXPECT_EQ(entries().size(), 3U + 5U) << "something else was left";
  const auto manifest = json(run + "/manifest.json");
  EXPECT_EQ(manifest["scenario"], "arm_wall_contact");
  EXPECT_EQ(manifest["case"], "proposed-2N");
  EXPECT_EQ(manifest["seed"], 3);
  EXPECT_EQ(manifest["status"], "complete");
  EXPECT_EQ(manifest["state_hash"].get<std::string>().size(), 16U);
  EXPECT_EQ(manifest["versions"]["mujoco"], "2.2.2");
  // A run that ends before force control has no force metrics.
  EXPECT_TRUE(json(run + "/metrics.json").empty());
  const LoggedSignal qpos = read_hdf5_signal((folder_ / run / "log.h5").string(), "control/qpos");
  EXPECT_EQ(qpos.rows, 500U);
  EXPECT_EQ(qpos.width, 3U);
}

TEST_F(CommandLine, QuietIsQuiet) {
  const ProgramResult result = ran("arm_wall_contact --duration 0.1 --quiet");
  EXPECT_TRUE(result.out.empty());
  EXPECT_TRUE(result.err.empty());
}

TEST_F(CommandLine, ConfigOfARunGivesTheSameBits) {
  ran("arm_wall_contact --case drac-5N --duration 1 --set sensor.angle_noise_rad=1e-6 run.seed=9 "
      "--out a");
  ran("arm_wall_contact --config a/config.toml --out b");
  EXPECT_EQ(read("a/config.toml"), read("b/config.toml"));
  EXPECT_EQ(state_hash("a"), state_hash("b"));
  EXPECT_EQ(json("b/manifest.json")["case"], "drac-5N");
  // The printed configuration is the same.
  EXPECT_EQ(run("arm_wall_contact --config a/config.toml --print-config").out,
            read("a/config.toml"));
  // Another seed gives other bits.
  ran("arm_wall_contact --config a/config.toml --seed 10 --out b");
  EXPECT_NE(state_hash("a"), state_hash("b"));
}

// Early enough for the impact, and so the contact solver, in a short run.
TEST_F(CommandLine, AllCasesOnTwoThreadsGiveTheBitsOfOne) {
  const auto early = [this](const std::string& words) {
    return ran("arm_wall_contact " + words +
               " --set run.duration_s=6 wall.solid_from_s=4 "
               "force.from_s=4.5 metrics.from_s=5")
        .out;
  };
  EXPECT_TRUE(has(early("--case all --out all"), "tuned-5N"));
  for (const std::string name : {"proposed-2N", "hpfc-5N", "tuned-2N"}) {
    early("--out one --case " + name);
    EXPECT_TRUE(json("one/metrics.json").contains("peak_force_raw_N")) << name;
    EXPECT_EQ(state_hash("one"), state_hash("all/" + name)) << name;
  }
  // A second call replaces a run's folder.
  const std::string two = early("--case hpfc-5N,drac-5N --out all");
  EXPECT_TRUE(has(two, "hpfc-5N") && has(two, "drac-5N") && !has(two, "tuned-5N")) << two;
  EXPECT_EQ(state_hash("one"), state_hash("all/tuned-2N"));
}

TEST_F(CommandLine, FindsItsModelsFromAnyFolder) {
  fs::create_directories(folder_ / "deep/down");
  done(run_program({"arm_push", "--duration", "0.1", "--quiet"}, folder_ / "deep/down"));
}

TEST_F(CommandLine, TakesModelsFromTheUsersFolder) {
  copy_with("models/arm.xml", "heavy.xml", "mass=\"0.02\"", "mass=\"0.2\"");
  ran("arm_wall_contact --set model.mjcf=heavy.xml --duration 0.5 --out heavy");
  ran("arm_wall_contact --duration 0.5 --out light");
  EXPECT_NE(state_hash("heavy"), state_hash("light"));
  // Its own config finds the model from another folder.
  fs::create_directories(folder_ / "elsewhere");
  done(run_program({"arm_wall_contact", "--config", "../heavy/config.toml", "--out", "again"},
                   folder_ / "elsewhere"));
  EXPECT_EQ(state_hash("elsewhere/again"), state_hash("heavy"));
}

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

TEST_F(CommandLine, TakesMjcfsNamesOfIntegrators) {
  for (const auto& [theirs, ours] : {std::pair{"RK4", "rk4"}, std::pair{"Euler", "euler"}}) {
    const ProgramResult result =
        ran("arm_wall_contact --print-config --set " + std::string("physics.integrator=") + theirs);
    EXPECT_TRUE(has(result.out, "integrator = \"" + std::string(ours) + "\""));
  }
}

TEST_F(CommandLine, WarnsOfIneffectiveKeys) {
  const std::string why = "controller.k_force: has an effect only where controller.name is hpfc\n";
  const auto brief = [this](const std::string& words) {
    const ProgramResult result = ran("arm_wall_contact --duration 0.01 --out run " + words);
    fs::remove_all(folder_ / "run");
    return result.err;
  };
  EXPECT_EQ(brief("--set controller.k_force=1"), "arm_wall_contact: warning: --set: " + why);
  EXPECT_EQ(brief("--set controller.k_force=1 --quiet"), "");
  EXPECT_EQ(brief("--set controller.k_force=1 --case hpfc-2N"), "");
  EXPECT_EQ(
      brief("--set fault.sensor=q1 fault.at_s=0.011"),
      "arm_wall_contact: warning: --set: fault.at_s: has an effect only where it is not after "
      "run.duration_s\n");
  EXPECT_EQ(brief("--set fault.kind=stuck"),
            "arm_wall_contact: warning: --set: fault.kind: has an effect only where fault.sensor "
            "names a channel\n");
  // Some cases use it.
  EXPECT_EQ(brief("--set controller.k_force=1 --case all"), "");
  copy_with(kWallFile, "ineffective.toml", "[case.drac-2N]",
            "[case.drac-2N]\ncontroller.k_force = 1");
  EXPECT_TRUE(brief("--config ineffective.toml --case drac-2N")
                  .starts_with("arm_wall_contact drac-2N: warning: "));
  EXPECT_TRUE(brief("--config ineffective.toml --case drac-2N").ends_with(": " + why));
  EXPECT_EQ(brief("--config ineffective.toml"), "");
}

TEST_F(CommandLine, TheMatrixAcceptsKeysOfAllCases) {
  const std::string matrix = "cart_constrained --matrix ";
  EXPECT_EQ(ran(matrix + "--duration 0.02 --set observer.alpha=2").err,
            "cart_constrained: warning: --set: observer.alpha: has an effect only where "
            "observer.name is vfakfd\n");
}

// A user's program in a folder without data.
TEST_F(CommandLine, AnExternalProgramListsTheSearchedFolders) {
  fs::copy_file(testing::bin_folder() / "arm_wall_contact", folder_ / "mine");
  const std::string mine =
      fs::canonical(folder_ / "mine").lexically_relative(testing::bin_folder());
  const auto list = [&] { return run(mine + " --list-cases"); };
  ProgramResult result = list();
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_TRUE(has(result.err, folder_.string() + "/share/breakwater, " + folder_.string() + ", ",
                  "BREAKWATER_PATH"));
  const testing::Environment path("BREAKWATER_PATH", "/nowhere::" + testing::source_file(""));
  result = list();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(result.out.starts_with("proposed-2N\n"));
}

TEST_F(CommandLine, NewMakesAProject) {
  ran("breakwater new observer own --out folder");
  EXPECT_TRUE(fs::exists(folder_ / "folder/own.cpp"));
}

TEST_F(CommandLine, WarnsOfAPathEntryThatIsNotAFolder) {
  const testing::Environment path("BREAKWATER_PATH", "/nowhere");
  const ProgramResult result = run("arm_wall_contact --list-cases");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "warning: BREAKWATER_PATH: /nowhere is no folder\n");
}

// ---- runs that fail ----------------------------------------------------------------------------

TEST_F(CommandLine, ABrokenSensorEndsTheRun) {
  const ProgramResult result =
      run("arm_wall_contact --duration 1 --set fault.sensor=force fault.at_s=0.2345 --out run");
  EXPECT_EQ(result.status, 3);
  EXPECT_TRUE(has(result.err, "failed at t = 0.235 s: sensor force is not finite"));
  const auto manifest = json("run/manifest.json");
  EXPECT_EQ(manifest["status"], "failed");
  EXPECT_EQ(manifest["reason"], "sensor force is not finite");
  EXPECT_EQ(manifest["time_s"], 0.235);
  EXPECT_FALSE(fs::exists(folder_ / "run/metrics.json"));
  // Its log is readable up to the previous sample.
  EXPECT_EQ(read_hdf5_signal((folder_ / "run/log.h5").string(), "control/time_s").rows, 235U);
}

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

TEST_F(CommandLine, ADroppedSampleIsCounted) {
  ran("arm_wall_contact --duration 1 --set fault.sensor=q2 fault.at_s=0.5 sensor.nan_policy=drop "
      "--out run");
  EXPECT_EQ(json("run/manifest.json")["dropped_samples"], 1);
  EXPECT_EQ(
      run("arm_wall_contact --duration 1 --set fault.sensor=q2 fault.at_s=0.5 fault.samples=3 "
          "sensor.nan_policy=drop --out run")
          .status,
      3);
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

TEST_F(LargeModels, EndlessFilesAreRefusedInOneLine) {
  ASSERT_EQ(mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  for (const std::string file : {"/dev/zero", "HERE/fifo"}) {
    const std::string path = file[0] == '/' ? file : (folder_ / "fifo").string();
    for (const std::string& part :
         {"<include file='" + path + "'/>", "<asset><mesh name='m' file='" + path + "'/></asset>",
          "<asset><hfield name='h' file='" + path + "' size='1 1 1 1'/></asset>"}) {
      motor_with(part);
      expect_refused(run_, file + ": is no regular file: it may never end");
    }
  }
  expect_refused("breakwater run motor_estimation --out run --config fifo",
                 "fifo: cannot be read (it is not a regular file)");
  expect_refused("breakwater estimate --set plant.inertia=1 encoder.quantum=1 --csv fifo",
                 "--set: csv.file: fifo: cannot be read (it is not a regular file)");
  expect_refused("breakwater sweep fifo", "fifo: cannot be read (it is not a regular file)");
}

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

}  // namespace
}  // namespace breakwater
