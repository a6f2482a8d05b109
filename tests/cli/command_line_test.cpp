// Binaries that are killed, or that meet a full disk or a huge model. Other commands are in
// commands.txt and refusals.txt.
#include <csignal>

#include "cli/program.h"
#include "shell.h"

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

// A small private file system for this command.
constexpr const char* kFillUp = R"(
mount -t tmpfs -o size=1m none . && cd "$PWD" && echo mounted || exit
run() { "$0" --quiet --duration "$1" --set record.compression=0 --out "$2" 2>&1; echo "status $?"; }
sums() { find run -type f | sort | xargs md5sum | md5sum; }
run 0.2 run
sums
run 20 run
run 20 fresh
for free in 0 4 8 16 32 48; do
  dd if=/dev/zero of=filler bs=1k 2>/dev/null
  truncate -s -${free}k filler
  run 0.2 run
  run 0.2 deep/fresh
done
rm filler
sums
ls -A
)";

TEST_F(CommandLine, AFullDiskLeavesTheEarlierRunAndNothingElse) {
  const fs::path script = folder_ / "fill_up";
  write("fill_up", kFillUp);
  const fs::path mount = folder_ / "mount";
  fs::create_directory(mount);
  std::string output;
  for (const char* unshare : {"unshare -rm", "unshare -m"}) {
    output = testing::output_of(
        "cd " + mount.string() + " && " + unshare + " sh -c '. " + script.string() + "' " +
        (testing::bin_folder() / "cart_position").string() + " 2>/dev/null; true");
    if (output.starts_with("mounted\n")) break;
  }
  if (!output.starts_with("mounted\n")) GTEST_SKIP() << "no file system can be mounted here";

  const std::vector<std::string> lines = testing::lines_of(output);
  ASSERT_EQ(lines.size(), 33U) << output;
  EXPECT_EQ(lines[1], "status 0");
  for (std::size_t i = 3; i < 31; i += 2) {  // one line, and a status
    EXPECT_TRUE(has(lines[i], ": cannot be "));
    EXPECT_EQ(lines[i + 1], "status 2") << output;
  }
  EXPECT_EQ(lines[31], lines[2]) << "the earlier run is not what it was";
  EXPECT_EQ(lines[32], "run");
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
      "HERE/motor.xml:59: <body>: here the model has 10 elements: model.most_elements allows 9");
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
