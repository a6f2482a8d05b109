// The binaries as users call them: help, cases, nonsense, failures, what is left behind.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <csignal>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include <breakwater/record/hdf5_log.h>
#include "cli/program.h"
#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;
using testing::ProgramResult;
using testing::run_program;

class CommandLine : public ::testing::Test {
 protected:
  CommandLine() { fs::create_directories(folder_); }

  ProgramResult run(std::vector<std::string> arguments) { return run_program(arguments, folder_); }

  // arm_wall_contact with more arguments.
  ProgramResult wall(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "arm_wall_contact");
    return run(arguments);
  }

  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
  }

  std::string read(const fs::path& file) const { return testing::text_of(folder_ / file); }

  nlohmann::json json(const fs::path& file) const { return nlohmann::json::parse(read(file)); }

  // Everything in the folder, hidden files too.
  std::vector<std::string> entries() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      names.push_back(entry.path().lexically_relative(folder_).string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  // A copy of a project's file with one text replaced.
  void copy_with(const std::string& source, const std::string& name, const std::string& from,
                 const std::string& to) {
    std::string copy = testing::text_of(testing::source_file(source));
    const auto at = copy.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write(name, copy.replace(at, from.size(), to));
  }

  fs::path folder_ = testing::temporary_path("cli");
  testing::Removed removed_{folder_};
};

TEST_F(CommandLine, HelpSaysHow) {
  const ProgramResult help = wall({"--help"});
  EXPECT_EQ(help.status, 0);
  for (const char* option : {"--case", "--config", "--set", "--seed", "--duration", "--out",
                             "--csv", "--quiet", "--list-cases", "--print-config"}) {
    EXPECT_NE(help.out.find(option), std::string::npos) << option;
  }
  EXPECT_TRUE(help.err.empty());
  EXPECT_EQ(run({"breakwater", "--help"}).status, 0);
  EXPECT_EQ(wall({"--version"}).status, 0);
}

TEST_F(CommandLine, ListsScenariosAndCases) {
  const ProgramResult list = run({"breakwater", "list"});
  EXPECT_EQ(list.status, 0);
  EXPECT_NE(list.out.find("arm_wall_contact "), std::string::npos);
  EXPECT_NE(list.out.find("arm_push "), std::string::npos);
  EXPECT_EQ(wall({"--list-cases"}).out,
            "proposed-2N\nhpfc-2N\ndrac-2N\nproposed-5N\nhpfc-5N\ndrac-5N\ntuned-2N\ntuned-5N\n"
            "tlsc-2N\ntlsc-5N\n");
  EXPECT_EQ(run({"breakwater", "run", "arm_push", "--list-cases"}).out,
            "proposed-link1\nproposed-link2\nproposed-link3\nhpfc-link1\nhpfc-link2\nhpfc-link3\n"
            "drac-link1\ndrac-link2\ndrac-link3\ntlsc-link1\ntlsc-link2\ntlsc-link3\n");
}

TEST_F(CommandLine, ARunLeavesItsFolder) {
  const ProgramResult result = wall({"--duration", "0.5", "--csv", "--seed", "3"});
  EXPECT_EQ(result.status, 0) << result.err;
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
  // A run that ends before force control has nothing to say about it.
  EXPECT_TRUE(json(run + "/metrics.json").empty());
  const LoggedSignal qpos = read_hdf5_signal((folder_ / run / "log.h5").string(), "control/qpos");
  EXPECT_EQ(qpos.rows, 500U);
  EXPECT_EQ(qpos.width, 3U);
}

TEST_F(CommandLine, QuietIsQuiet) {
  const ProgramResult result = wall({"--duration", "0.1", "--quiet"});
  EXPECT_EQ(result.status, 0);
  EXPECT_TRUE(result.out.empty());
  EXPECT_TRUE(result.err.empty());
}

TEST_F(CommandLine, ConfigOfARunGivesTheSameBits) {
  EXPECT_EQ(wall({"--case", "drac-5N", "--duration", "1", "--set", "sensor.angle_noise_rad=1e-6",
                  "run.seed=9", "--out", "a"})
                .status,
            0);
  EXPECT_EQ(wall({"--config", "a/config.toml", "--out", "b"}).status, 0);
  EXPECT_EQ(read("a/config.toml"), read("b/config.toml"));
  EXPECT_EQ(json("a/manifest.json")["state_hash"], json("b/manifest.json")["state_hash"]);
  EXPECT_EQ(json("b/manifest.json")["case"], "drac-5N");
  // And the printed configuration is that configuration.
  EXPECT_EQ(wall({"--config", "a/config.toml", "--print-config"}).out, read("a/config.toml"));
  // Another seed gives other bits.
  EXPECT_EQ(wall({"--config", "a/config.toml", "--seed", "10", "--out", "b"}).status, 0);
  EXPECT_NE(json("a/manifest.json")["state_hash"], json("b/manifest.json")["state_hash"]);
}

// Early enough to have the impact, and the contact's solver, in a short run.
const std::vector<std::string> kEarlyImpact = {"--set", "run.duration_s=6", "wall.solid_from_s=4",
                                               "force.from_s=4.5", "metrics.from_s=5"};

TEST_F(CommandLine, AllCasesOnTwoThreadsGiveTheBitsOfOne) {
  const auto early = [this](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), kEarlyImpact.begin(), kEarlyImpact.end());
    return wall(arguments);
  };
  const ProgramResult all = early({"--case", "all", "--out", "all"});
  EXPECT_EQ(all.status, 0) << all.err;
  EXPECT_NE(all.out.find("tuned-5N"), std::string::npos);
  for (const char* name : {"proposed-2N", "hpfc-5N", "tuned-2N"}) {
    EXPECT_EQ(early({"--case", name, "--out", "one"}).status, 0);
    EXPECT_TRUE(json("one/metrics.json").contains("peak_force_raw_N")) << name;
    EXPECT_EQ(json("one/manifest.json")["state_hash"],
              json(std::string("all/") + name + "/manifest.json")["state_hash"])
        << name;
  }
  // Again into the same folder: replaced.
  EXPECT_EQ(early({"--case", "all", "--out", "all"}).status, 0);
}

TEST_F(CommandLine, FindsItsModelsFromAnyFolder) {
  fs::create_directories(folder_ / "deep/down");
  EXPECT_EQ(run_program({"arm_push", "--duration", "0.1", "--quiet"}, folder_ / "deep/down").status,
            0);
}

TEST_F(CommandLine, TakesModelsFromTheUsersFolder) {
  copy_with("models/arm.xml", "heavy.xml", "mass=\"0.02\"", "mass=\"0.2\"");
  EXPECT_EQ(wall({"--set", "model.mjcf=heavy.xml", "--duration", "0.5", "--out", "heavy"}).status,
            0);
  EXPECT_EQ(wall({"--duration", "0.5", "--out", "light"}).status, 0);
  EXPECT_NE(json("heavy/manifest.json")["state_hash"], json("light/manifest.json")["state_hash"]);
  // Its own config finds the model again from elsewhere.
  fs::create_directories(folder_ / "elsewhere");
  EXPECT_EQ(run_program({"arm_wall_contact", "--config", "../heavy/config.toml", "--out", "again"},
                        folder_ / "elsewhere")
                .status,
            0);
  EXPECT_EQ(json("elsewhere/again/manifest.json")["state_hash"],
            json("heavy/manifest.json")["state_hash"]);
}

// ---- nonsense in: one line, exit 2, at once, nothing left behind -------------------------------

struct Nonsense {
  std::string name;  // of the test
  std::vector<std::string> arguments;
  std::string message;  // must be in the line
};

void PrintTo(const Nonsense& nonsense, std::ostream* out) {
  *out << nonsense.name;
}

class NonsenseIn : public CommandLine {
 protected:
  NonsenseIn() {
    copy_with("scenarios/arm_wall_contact/arm_wall_contact.toml", "typo.toml", "distance_m = 0.089",
              "distnce_m = 0.089");
    copy_with("scenarios/arm_wall_contact/arm_wall_contact.toml", "text.toml", "distance_m = 0.089",
              "distance_m = \"far\"");
    copy_with("scenarios/arm_wall_contact/arm_wall_contact.toml", "truncated.toml",
              "distance_m = 0.089", "distance_m = ");
    std::string whole =
        read(testing::source_file("scenarios/arm_wall_contact/arm_wall_contact.toml"));
    write("half.toml", whole.substr(0, whole.find("distance_m")) + "[case.proposed-2N]\n");
    copy_with("models/arm.xml", "broken.xml", "<worldbody>", "<worldbody");
    copy_with("models/arm.xml", "odd.xml", "<joint name=\"joint2\"/>", "<joynt name=\"joint2\"/>");
    copy_with("models/arm.xml", "negative.xml", "timestep=\"0.0001\"", "timestep=\"-1\"");
    copy_with("models/arm.xml", "no_sensor.xml", "name=\"tip_force\"", "name=\"tip_farce\"");
    copy_with("models/arm.xml", "weak.xml", "ctrlrange=\"-20.7360 20.7360\"", "ctrlrange=\"-5 5\"");
    copy_with("models/arm.xml", "geared.xml", "<motor name=\"motor1\"",
              "<motor name=\"motor1\" gear=\"2\"");
    copy_with("models/arm.xml", "pair.xml", "<actuator>",
              "<contact><pair geom1=\"tip\" geom2=\"wall\"/></contact><actuator>");
    copy_with("models/arm.urdf", "no_limit.urdf",
              "<limit lower=\"-6.283\" upper=\"6.283\" effort=\"12.6720\" "
              "velocity=\"3.14159265358979\"/>",
              "");
    copy_with("scenarios/arm_wall_contact/arm_wall_contact.toml", "escape.toml", "[case.drac-2N]",
              "[case.\"../../escaped\"]");
    copy_with("scenarios/arm_wall_contact/arm_wall_contact.toml", "other.toml",
              "controller.k_position = 15.0", "controller.k_position = nan");
    write("file", "not a folder");
    fs::create_directory(folder_ / "thesis");
    write("thesis/chapter1", "years of work");
    before_ = entries();
  }

  std::vector<std::string> before_;
};

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

class EachNonsense : public NonsenseIn, public ::testing::WithParamInterface<Nonsense> {};

TEST_P(EachNonsense, IsOneLine) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  if (GetParam().name == "LogBeyondMemory") {
    GTEST_SKIP() << "a sanitizer's operator new ends the program where it should throw bad_alloc";
  }
#endif
  const ProgramResult result = wall(GetParam().arguments);
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_NE(result.err.find(GetParam().message), std::string::npos) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_LT(result.seconds, 1.0 * testing::kSlowness);
  EXPECT_EQ(entries(), before_) << "something was left behind";
}

INSTANTIATE_TEST_SUITE_P(
    Cli, EachNonsense,
    ::testing::Values(
        Nonsense{"UnknownOption", {"--caes", "all"}, "--caes"},
        Nonsense{"UnknownCase", {"--case", "propsed-2N"}, "(did you mean proposed-2N?)"},
        Nonsense{"UnknownKey",
                 {"--set", "contact.stifness_N_m=3"},
                 "--set: contact.stifness_N_m: unknown key (did you mean contact.stiffness_N_m?)"},
        Nonsense{"CaseOutside", {"--config", "escape.toml", "--case", "all"}, "a name is made of"},
        Nonsense{"NanInAnotherCase", {"--config", "other.toml"}, "controller.k_position: must be"},
        Nonsense{"DeepKey", {"--set", repeated("a.", 50000) + "a=1"}, "is no key"},
        Nonsense{"DeepValue", {"--set", "run.seed=" + repeated("[", 100000)}, "too deeply"},
        Nonsense{"LinesInACase", {"--case", "a\nb"}, "no case \"a\\nb\""},
        Nonsense{"KeyOfAnotherScenario",
                 {"--set", "noise.std_rad=1"},
                 "--set: noise.std_rad: unknown key (here it is sensor.angle_noise_rad)"},
        Nonsense{"UnknownKeyInFile", {"--config", "typo.toml"}, "wall.distnce_m: unknown key"},
        Nonsense{"StringForNumber",
                 {"--set", "wall.distance_m=far"},
                 "wall.distance_m: must be a number"},
        Nonsense{"StringForNumberInFile",
                 {"--config", "text.toml"},
                 "wall.distance_m: must be a number, is \"far\""},
        Nonsense{"NegativeTimestep",
                 {"--set", "physics.timestep_s=-1e-4"},
                 "physics.timestep_s: must be positive"},
        Nonsense{"PeriodNoMultiple",
                 {"--set", "control.period_s=0.00105"},
                 "control.period_s: must be a whole multiple of physics.timestep_s"},
        Nonsense{"PeriodBelowTimestep",
                 {"--set", "control.period_s=1e-5"},
                 "control.period_s: must be a whole multiple"},
        Nonsense{"NanGain",
                 {"--set", "controller.k_position=nan"},
                 "controller.k_position: must be finite"},
        Nonsense{"NanInArray",
                 {"--set", "controller.t_ref_s=[1,nan,1]"},
                 "controller.t_ref_s[2]: must be finite"},
        Nonsense{"TooFewJoints",
                 {"--set", "controller.t_ref_s=[1,1]"},
                 "controller.t_ref_s: must have one entry for each of the URDF's 3 joints"},
        Nonsense{"ResponseTooShort",
                 {"--set", "controller.t_ref_s=[1,1,0.002]"},
                 "controller.t_ref_s: PFC"},
        Nonsense{"UnstablePole",
                 {"--set", "observer.poles_rad_s=[[0,-1,-2],[-1,-2,-3],[-1,-2,-3]]"},
                 "observer.poles_rad_s: pole placement: the poles must lie"},
        Nonsense{"NegativeSeed", {"--seed", "-1"}, "--seed: must be 0 or more"},
        Nonsense{"SeedNoNumber", {"--seed", "x"}, "--seed: must be a number, is \"x\""},
        Nonsense{"SeedNotWhole", {"--seed", "1.5"}, "--seed: must be a whole number"},
        Nonsense{
            "SeedTwice", {"--seed", "2", "--set", "run.seed=1"}, "--seed: --set gives run.seed"},
        Nonsense{"EmptyCase", {"--case", ""}, "--case: must be a case's name"},
        Nonsense{"ZeroDuration", {"--duration", "0"}, "--duration: must be positive"},
        Nonsense{"MissingConfig", {"--config", "missing.toml"}, "missing.toml: cannot be read"},
        Nonsense{"ConfigIsFolder", {"--config", "thesis"}, "thesis: cannot be read"},
        Nonsense{"TruncatedToml", {"--config", "truncated.toml"}, "truncated.toml:"},
        Nonsense{"HalfAToml", {"--config", "half.toml"}, "is missing: "},
        Nonsense{"MissingModel",
                 {"--set", "model.mjcf=missing.xml"},
                 "--set: model.mjcf: there is no file"},
        Nonsense{"BrokenMjcf", {"--set", "model.mjcf=broken.xml"}, "broken.xml:"},
        Nonsense{"OddMjcf", {"--set", "model.mjcf=odd.xml"}, "odd.xml:"},
        Nonsense{"NegativeMjcfTimestep",
                 {"--set", "model.mjcf=negative.xml"},
                 "negative.xml: option timestep must be positive"},
        Nonsense{"MjcfWithoutSensor",
                 {"--set", "model.mjcf=no_sensor.xml"},
                 "no_sensor.xml: has no sensor named \"tip_force\""},
        Nonsense{"UrdfWithoutLimit", {"--set", "model.urdf=no_limit.urdf"}, "joint \"joint3\": "},
        Nonsense{"UrdfIsMjcf", {"--set", "model.urdf=odd.xml"}, "odd.xml:"},
        Nonsense{"UnknownFault",
                 {"--set", "fault.sensor=q9"},
                 "--set: fault.sensor: there is no channel \"q9\" (did you mean q1?)"},
        Nonsense{
            "OtherTorqueLimits", {"--set", "model.mjcf=weak.xml"}, "weak.xml: actuator 1 must"},
        Nonsense{"Geared", {"--set", "model.mjcf=geared.xml"}, "geared.xml: actuator 1 must"},
        Nonsense{"OverridingPair", {"--set", "model.mjcf=pair.xml"}, "pair.xml: a <pair>"},
        Nonsense{"NoStep", {"--duration", "1e-9"}, "--duration: must be at least one"},
        Nonsense{"EndlessRun", {"--duration", "1e300"}, "--duration: is too long"},
        Nonsense{"LogBeyondMemory", {"--duration", "1e7"}, "run.duration_s: the log of so long"},
        Nonsense{"SlowController", {"--set", "control.period_s=1e9"}, "control.period_s: is too"},
        Nonsense{"EndlessResponse",
                 {"--set", "controller.t_ref_s=[1e9,1,1]"},
                 "controller.t_ref_s: PFC: the target response time is too long"},
        Nonsense{"LongName", {"--config", std::string(300, 'x')}, "File name too long"},
        Nonsense{"PrintAll", {"--case", "all", "--print-config"}, "--print-config: prints one"},
        Nonsense{"WindowBackwards",
                 {"--set", "record.fine_from_s=5", "record.fine_to_s=1"},
                 "record.fine_to_s: must not be before"},
        Nonsense{"WindowTooEarly",
                 {"--set", "metrics.from_s=1"},
                 "metrics.from_s: must not be before force.from_s"},
        Nonsense{"OutHoldsSomethingElse", {"--out", "thesis"}, "thesis: holds "},
        Nonsense{"OutIsFile", {"--out", "file"}, "file: is a file"},
        Nonsense{"OutBelowFile", {"--out", "file/run"}, "file/run: cannot be made"},
        Nonsense{"OutUnwritable", {"--out", "/proc/run"}, "/proc/run: cannot be made"},
        Nonsense{"AllIntoSomethingElse",
                 {"--case", "all", "--out", "thesis"},
                 "thesis: holds something"},
        Nonsense{"SetWithoutValue", {"--set", "wall.distance_m"}, "must be of the form"},
        Nonsense{"WallTooLate",
                 {"--set", "wall.solid_from_s=31"},
                 "wall.solid_from_s: must not be after force.from_s"}),
    [](const auto& param) { return param.param.name; });

TEST_F(NonsenseIn, NamesTheLine) {
  const auto line_of = [this](const std::string& file, const std::string& text) {
    const std::string content = read(file);
    const auto at = content.begin() + static_cast<std::ptrdiff_t>(content.find(text));
    return ":" + std::to_string(1 + std::count(content.begin(), at, '\n')) + ": ";
  };
  EXPECT_TRUE(wall({"--config", "typo.toml"})
                  .err.starts_with("typo.toml" + line_of("typo.toml", "distnce_m")));
  EXPECT_TRUE(wall({"--config", "truncated.toml"})
                  .err.starts_with("truncated.toml" + line_of("truncated.toml", "distance_m = ")));
  for (const auto& [key, file, text] : std::vector<std::array<std::string, 3>>{
           {"model.mjcf", "odd.xml", "<joynt"},
           {"model.urdf", "no_limit.urdf", "<joint name=\"joint3\""}}) {
    const std::string err = wall({"--set", key + "=" + file}).err;
    EXPECT_NE(err.find(file + line_of(file, text)), std::string::npos) << err;
  }
}

TEST_F(CommandLine, UmbrellaRefusesNonsense) {
  EXPECT_EQ(run({"breakwater"}).status, 2);
  EXPECT_EQ(run({"breakwater", "lisst"}).status, 2);
  const ProgramResult unknown = run({"breakwater", "run", "arm_wal_contact"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_EQ(unknown.err,
            "there is no scenario \"arm_wal_contact\" (did you mean arm_wall_contact?)\n");
}

TEST_F(CommandLine, TakesMjcfsNamesOfIntegrators) {
  for (const auto& [theirs, ours] : {std::pair{"RK4", "rk4"}, std::pair{"Euler", "euler"}}) {
    const ProgramResult result =
        wall({"--print-config", "--set", std::string("physics.integrator=") + theirs});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("integrator = \"" + std::string(ours) + "\""), std::string::npos);
  }
}

TEST_F(CommandLine, SaysWhichKeysAreSetInVain) {
  const std::string why = "controller.k_force: has an effect only where controller.name is hpfc\n";
  const auto brief = [this](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--duration", "0.01", "--out", "run"});
    const ProgramResult result = wall(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    fs::remove_all(folder_ / "run");
    return result.err;
  };
  EXPECT_EQ(brief({"--set", "controller.k_force=1"}), "arm_wall_contact: warning: --set: " + why);
  EXPECT_EQ(brief({"--set", "controller.k_force=1", "--quiet"}), "");
  EXPECT_EQ(brief({"--set", "controller.k_force=1", "--case", "hpfc-2N"}), "");
  // Some of the cases use it.
  EXPECT_EQ(brief({"--set", "controller.k_force=1", "--case", "all"}), "");
  copy_with("scenarios/arm_wall_contact/arm_wall_contact.toml", "vain.toml", "[case.drac-2N]",
            "[case.drac-2N]\ncontroller.k_force = 1");
  EXPECT_TRUE(brief({"--config", "vain.toml", "--case", "drac-2N"})
                  .starts_with("arm_wall_contact drac-2N: warning: "));
  EXPECT_TRUE(brief({"--config", "vain.toml", "--case", "drac-2N"}).ends_with(": " + why));
  EXPECT_EQ(brief({"--config", "vain.toml"}), "");
}

TEST_F(CommandLine, TheMatrixTakesWhatAllCasesTake) {
  const auto matrix = [this](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"cart_constrained", "--matrix"});
    return run(arguments);
  };
  const ProgramResult printed = matrix({"--print-config"});
  EXPECT_EQ(printed.status, 2);
  EXPECT_EQ(printed.err, "--print-config: prints one case, not all of --matrix\n");
  const ProgramResult video = matrix({"--video", "one.mp4"});
  EXPECT_EQ(video.status, 2);
  EXPECT_EQ(video.err, "--video: one file cannot hold the videos of several runs\n");
  EXPECT_TRUE(entries().empty());
  const ProgramResult warned = matrix({"--duration", "0.02", "--set", "observer.alpha=2"});
  EXPECT_EQ(warned.status, 0) << warned.err;
  EXPECT_EQ(warned.err,
            "cart_constrained: warning: --set: observer.alpha: has an effect only where "
            "observer.name is vfakfd\n");
}

// A program of the user's own lies where no data is.
TEST_F(CommandLine, AForeignProgramIsToldWhereTheDataWasSought) {
  fs::copy_file(testing::bin_folder() / "arm_wall_contact", folder_ / "mine");
  const std::string mine =
      fs::canonical(folder_ / "mine").lexically_relative(testing::bin_folder());
  const auto list = [&] { return run({mine, "--list-cases"}); };
  ProgramResult result = list();
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_NE(result.err.find(folder_.string() + "/share/breakwater, " + folder_.string() + ", "),
            std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("BREAKWATER_PATH"), std::string::npos) << result.err;
  setenv("BREAKWATER_PATH", ("/nowhere::" + testing::source_file("")).c_str(), 1);
  result = list();
  unsetenv("BREAKWATER_PATH");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(result.out.starts_with("proposed-2N\n"));
}

TEST_F(CommandLine, NewMakesAProjectOrSaysWhyNotInOneLine) {
  const ProgramResult made = run({"breakwater", "new", "observer", "own", "--out", "folder"});
  EXPECT_EQ(made.status, 0) << made.err;
  EXPECT_TRUE(fs::exists(folder_ / "folder/own.cpp"));
  const auto refused = [&](const std::vector<std::string>& words) {
    std::vector<std::string> arguments = {"breakwater", "new"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const ProgramResult result = run(arguments);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    return result.err;
  };
  EXPECT_EQ(refused({"observer", "own", "--out", "folder"}), "folder: is there already\n");
  EXPECT_EQ(refused({"observr", "own"}),
            "new: KIND must be one of controller, observer, scenario, is \"observr\" (did you mean "
            "observer?)\n");
  EXPECT_EQ(refused({"observer", "stf"}),
            "new: NAME is taken: there is the estimator of an axis \"stf\"\n");
  refused({"observer", "Own"});
  refused({"observer"});
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(CommandLine, AnEntryOfThePathThatIsNoFolderIsWarnedOf) {
  setenv("BREAKWATER_PATH", "/nowhere", 1);
  const ProgramResult result = run({"arm_wall_contact", "--list-cases"});
  unsetenv("BREAKWATER_PATH");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "warning: BREAKWATER_PATH: /nowhere is no folder\n");
}

// ---- runs that fail ----------------------------------------------------------------------------

TEST_F(CommandLine, ABrokenSensorEndsTheRun) {
  const ProgramResult result =
      wall({"--duration", "1", "--set", "fault.sensor=force", "fault.at_s=0.2345", "--out", "run"});
  EXPECT_EQ(result.status, 3);
  EXPECT_NE(result.err.find("failed at t = 0.235 s: sensor force is not finite"), std::string::npos)
      << result.err;
  const auto manifest = json("run/manifest.json");
  EXPECT_EQ(manifest["status"], "failed");
  EXPECT_EQ(manifest["reason"], "sensor force is not finite");
  EXPECT_EQ(manifest["time_s"], 0.235);
  EXPECT_FALSE(fs::exists(folder_ / "run/metrics.json"));
  // Its log is readable, up to the sample before.
  EXPECT_EQ(read_hdf5_signal((folder_ / "run/log.h5").string(), "control/time_s").rows, 235U);
}

// DRAC cancels its Jacobian's rate by J̇q̇ and feeds its observer what it asks for, not what the
// drives give: sampled ten times too slowly, it runs away.
TEST_F(CommandLine, ARunThatDivergesSaysWhenAndWhat) {
  const ProgramResult result = wall(
      {"--case", "drac-2N", "--set", "control.period_s=0.02", "--duration", "30", "--out", "run"});
  EXPECT_EQ(result.status, 3);
  const auto manifest = json("run/manifest.json");
  EXPECT_EQ(manifest["status"], "failed");
  EXPECT_EQ(manifest["reason"], "command of actuator 1 is not finite");
  const double time_s = manifest["time_s"];
  std::ostringstream time_text;
  time_text << time_s;
  EXPECT_NE(result.err.find("failed at t = " + time_text.str() + " s: "), std::string::npos)
      << result.err;
  EXPECT_FALSE(fs::exists(folder_ / "run/metrics.json"));
  const auto torque =
      read_hdf5_signal((folder_ / "run/log.h5").string(), "control/torque_command_Nm");
  EXPECT_EQ(torque.rows, static_cast<std::size_t>(std::lround(time_s / 0.02)));
  EXPECT_GT(*std::max_element(torque.values.begin(), torque.values.end()), 1e3);
}

TEST_F(CommandLine, ADroppedSampleIsCounted) {
  EXPECT_EQ(wall({"--duration", "1", "--set", "fault.sensor=q2", "fault.at_s=0.5",
                  "sensor.nan_policy=drop", "--out", "run"})
                .status,
            0);
  EXPECT_EQ(json("run/manifest.json")["dropped_samples"], 1);
  EXPECT_EQ(wall({"--duration", "1", "--set", "fault.sensor=q2", "fault.at_s=0.5",
                  "fault.samples=3", "sensor.nan_policy=drop", "--out", "run"})
                .status,
            3);
}

TEST_F(CommandLine, AKilledRunLeavesNoFolderAndTheNextOneClearsUp) {
  const auto killed = run_program({"arm_wall_contact", "--out", "run"}, folder_, 0.5, SIGKILL);
  EXPECT_EQ(killed.status, 128 + SIGKILL);
  EXPECT_FALSE(fs::exists(folder_ / "run"));
  EXPECT_EQ(wall({"--duration", "0.1", "--out", "run"}).status, 0);
  for (const std::string& name : entries()) {
    EXPECT_EQ(name.find("partial"), std::string::npos) << name;
  }
}

TEST_F(CommandLine, AnInterruptedRunLeavesNothing) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto result = run_program({"arm_wall_contact", "--case", "all"}, folder_, 0.5, signal);
    EXPECT_EQ(result.status, 130);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(entries().empty());
  }
}

TEST_F(CommandLine, ANewProjectSaysWhatToPasteInTheTree) {
  const ProgramResult result = run({"breakwater", "new", "controller", "mine"});
  ASSERT_EQ(result.status, 0) << result.err;
  std::istringstream lines(result.out);
  std::vector<std::string> said;
  for (std::string line; std::getline(lines, line);) said.push_back(line);
  ASSERT_EQ(said.size(), 6U) << result.out;
  const std::string prefix = said[2].substr(said[2].find(" --prefix ") + 10);
  const std::string build = prefix.substr(0, prefix.rfind("/installed"));
  EXPECT_TRUE(fs::exists(build + "/CMakeCache.txt")) << build;
  EXPECT_EQ(said[2], "cmake --install " + build + " --prefix " + prefix);
  EXPECT_EQ(said[3], "cd mine && CMAKE_PREFIX_PATH=" + prefix +
                         " cmake --preset release && cmake --build --preset release && ctest "
                         "--preset release");
}

// A motor's model with more in its world, and maybe a higher bound on its elements.
class LargeModels : public CommandLine {
 protected:
  ProgramResult motor_with(const std::string& part, std::vector<std::string> sets = {},
                           double kill_after_s = 0.0) {
    copy_with("models/motor.xml", "motor.xml", "<worldbody>", part + "<worldbody>");
    std::vector<std::string> words = {
        "breakwater", "run", "motor_estimation", "--duration", "0.01",
        "--out",      "run", "--quiet",          "--set",      "model.mjcf=motor.xml"};
    words.insert(words.end(), sets.begin(), sets.end());
    return run_program(words, folder_, kill_after_s, SIGTERM);
  }
};

TEST_F(LargeModels, FilesThatNeverEndAreRefusedInOneLine) {
  ASSERT_EQ(mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  const std::string pipe = (folder_ / "fifo").string();
  for (const std::string& file : {std::string("/dev/zero"), pipe}) {
    for (const std::string& part :
         {"<include file='" + file + "'/>", "<asset><mesh name='m' file='" + file + "'/></asset>",
          "<asset><hfield name='h' file='" + file + "' size='1 1 1 1'/></asset>"}) {
      const ProgramResult result = motor_with(part);
      EXPECT_EQ(result.status, 2) << part;
      EXPECT_EQ(result.err, file + ": is no regular file: it may never end\n") << part;
      EXPECT_FALSE(fs::exists(folder_ / "run"));
    }
  }
  const ProgramResult result =
      run({"breakwater", "run", "motor_estimation", "--config", pipe, "--out", "run"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err, pipe + ": cannot be read\n");
}

TEST_F(LargeModels, MoreElementsThanTheKeyAllowsAreRefused) {
  const auto refusal = [&](const std::string& part, const std::vector<std::string>& sets = {}) {
    const ProgramResult result = motor_with(part, sets);
    EXPECT_EQ(result.status, 2);
    EXPECT_LT(result.seconds, 5.0 * testing::kSlowness);
    return result.err.substr(result.err.find(": ") + 2);
  };
  const std::string many =
      "<worldbody><body><composite type='particle' count='3000 3000 1' spacing='1'>"
      "<geom size='.1'/></composite></body></worldbody>";
  EXPECT_TRUE(refusal(many).starts_with("<composite>: here the model has 90000"));
  EXPECT_NE(refusal(many).find(" elements: model.most_elements allows 20000\n"), std::string::npos);
  std::string sites = "<worldbody>";
  for (int k = 0; k < 30000; ++k) sites += "<site/>";
  sites += "</worldbody>";
  EXPECT_EQ(refusal(sites),
            "<site>: here the model has 20001 elements: model.most_elements allows 20000\n");
  EXPECT_NE(refusal("", {"model.most_elements=9"}).find("has 10 elements"), std::string::npos);
  EXPECT_EQ(motor_with("", {"model.most_elements=100"}).status, 0);
}

TEST_F(LargeModels, ASignalEndsACompilationSoon) {
  std::string geoms = "<worldbody>";
  for (int k = 0; k < 60000; ++k) geoms += "<geom size='1'/>";
  const ProgramResult result =
      motor_with(geoms + "</worldbody>", {"model.most_elements=1000000"}, 1.0);
  EXPECT_EQ(result.status, 130);
  EXPECT_LT(result.seconds, 6.0 * testing::kSlowness) << "without the signal it is minutes";
  EXPECT_EQ(result.err, "interrupted while a model was compiled\n");
  EXPECT_EQ(entries(), std::vector<std::string>{"motor.xml"});
}

}  // namespace
}  // namespace breakwater
