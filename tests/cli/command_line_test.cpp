// Binaries that are interrupted, or that meet a huge model. Other commands are in commands.txt and
// refusals.txt.
#include <csignal>

#include "cli/program.h"

namespace breakwater::command_line_test {
using testing::ProgramResult;

using CommandLine = testing::ProgramTest;

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

TEST_F(CommandLine, AnInterruptedRunLeavesNothing) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto result = run("arm_wall_contact --case all", has_made_something(), signal);
    EXPECT_EQ(result.status, 130);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(entries().empty());
  }
}

TEST_F(CommandLine, ASignalEndsACompilationSoon) {
  write("motor.xml",
        testing::replaced(testing::text_of(testing::source_file("models/motor.xml")), "<worldbody>",
                          "<worldbody>" + testing::repeated("<geom size='1'/>", 60000) +
                              "</worldbody><worldbody>"));
  const ProgramResult result =
      run("breakwater run motor_estimation --duration 0.01 --out run --quiet --set "
          "model.mjcf=motor.xml model.most_elements=1000000",
          testing::worked_for(1.0), SIGTERM);
  EXPECT_EQ(result.status, 130);
  EXPECT_LT(result.seconds, 6.0 * testing::kSlowness) << "without the signal it is minutes";
  EXPECT_EQ(result.err, "interrupted while a model was compiled\n");
  EXPECT_EQ(entries(), std::vector<std::string>{"motor.xml"});
}

}  // namespace breakwater::command_line_test
