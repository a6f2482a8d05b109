// Broken scenario files and models are refused in one line, at once, or are legal for a stated
// reason.
#include <breakwater/experiment/runner.h>
#include <breakwater/shell/all_cores.h>
#include <breakwater/signals/thread_time.h>
#include "catalogue.h"
#include "cli/mutants.h"
#include "cli/program.h"

namespace breakwater::mutated_input_test {
namespace fs = std::filesystem;
using testing::Legal;
using testing::Mutant;

constexpr double kAtOnce_s = 1.5 * testing::kSlowness;

class MutatedInput : public ::testing::Test {
 protected:
  MutatedInput() { fs::create_directories(folder_); }

  std::string write(const Mutant& mutant, std::size_t number = 0) const {
    const fs::path path = folder_ / (std::to_string(number) + mutant.file);
    std::ofstream(path, std::ios::binary) << mutant.text;
    return path.string();
  }

  // Invalid: one line and exit 2, at once, nothing left behind. Legal: prints the configuration.
  void run_program_on(const Mutant& mutant, std::size_t number = 0) const {
    const fs::path folder = folder_ / ("cwd" + std::to_string(number));
    fs::create_directory(folder);
    const std::string path = write(mutant, number);
    std::vector<std::string> arguments = {"breakwater", "run", mutant.scenario};
    if (mutant.option == "--config") {
      arguments.insert(arguments.end(), {"--config", path, "--print-config"});
    } else {
      arguments.insert(arguments.end(), {"--print-config", "--set", mutant.option + "=" + path});
    }
    const testing::ProgramResult result = testing::run_program(arguments, folder);
    const bool is_legal = testing::find_legal(mutant) != nullptr;
    EXPECT_TRUE(result.status == 2 || (is_legal && result.status == 0))
        << mutant.name() << ": " << result.status << ": " << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), result.status == 2 ? 1 : 0)
        << mutant.name() << ": " << result.err;
    EXPECT_EQ(result.out.empty(), result.status == 2) << mutant.name();
    EXPECT_LT(result.seconds, kAtOnce_s) << mutant.name();
    EXPECT_TRUE(fs::is_empty(folder)) << mutant.name() << ": left something behind";
    fs::remove_all(folder);
    fs::remove(path);
  }

  const testing::TemporaryPath folder_{"mutants"};
};

// Reads and checks a run of the mutant like a program before a run. Returns the error message; ""
// without an error.
std::string complaint(const Mutant& mutant, const std::string& path) {
  const bool is_scenario = mutant.option == "--config";
  try {
    const ScenarioKind& kind = testing::catalogue().get<ScenarioKind>(mutant.scenario);
    const ScenarioFile file(is_scenario ? path : kind.file().string(), mutant.scenario);
    std::vector<std::string> sets;
    if (!is_scenario) sets.emplace_back(mutant.option + "=" + path);
    const Config config = file.config(file.default_case(), sets);
    const auto scenario = kind.make(testing::catalogue());
    scenario->learn(config);
    Fields fields = scenario->fields();
    fields.check(file);
    fields.read(config);
    scenario->check(config);
    scenario->warnings();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST_F(MutatedInput, IsRefusedInOneLineOrLegalForAReason) {
  const std::vector<Mutant> mutants = testing::all_mutants();
  std::vector<std::string> complaints(mutants.size());
  std::vector<double> seconds(mutants.size());
  on_all_cores(mutants.size(), [&](std::size_t i) {
    const std::string path = write(mutants[i], i);
    const double start = thread_time_s();
    complaints[i] = complaint(mutants[i], path);
    seconds[i] = thread_time_s() - start;
    fs::remove(path);
  });
  std::size_t refused = 0;
  std::map<const Legal*, std::size_t> legal;
  for (std::size_t i = 0; i < mutants.size(); ++i) {
    const std::string& complaint = complaints[i];
    EXPECT_LT(seconds[i], kAtOnce_s) << mutants[i].name();
    if (complaint.empty()) {
      const Legal* reason = testing::find_legal(mutants[i]);
      EXPECT_NE(reason, nullptr) << mutants[i].name() << ": is accepted without a reason";
      ++legal[reason];
      continue;
    }
    ++refused;
    EXPECT_TRUE(lacks(complaint, "\n"));
    // A joint that is only in the URDF is missing in the MJCF.
    EXPECT_TRUE(complaint.find(mutants[i].file) != std::string::npos ||
                (mutants[i].place == "<joint> name" &&
                 complaint.find("models/arm.xml") != std::string::npos))
        << mutants[i].name() << ": " << complaint << ": does not name the file";
  }
  for (const Legal& reason : testing::legal_reasons()) {
    EXPECT_GT(legal[&reason], 0U) << reason.place << ": nothing needs this reason";
  }
  std::printf("%zu mutants: %zu refused, %zu legal\n", mutants.size(), refused,
              mutants.size() - refused);
  EXPECT_GT(mutants.size(), 846U);
}

// The same with the real program. BREAKWATER_MUTANTS=all tries them all, otherwise a sample.
TEST_F(MutatedInput, ASampleIsHandledByTheProgram) {
  std::vector<Mutant> mutants = testing::all_mutants();
  std::shuffle(mutants.begin(), mutants.end(), std::mt19937(1));
  if (std::getenv("BREAKWATER_MUTANTS") == nullptr) mutants.resize(60);
  on_all_cores(mutants.size(), [&](std::size_t i) { run_program_on(mutants[i], i); });
}

// One of each kind of legal mutant runs, or fails like a run.
TEST_F(MutatedInput, LegalInputRunsOrFailsAsARun) {
  std::map<const Legal*, int> done;
  for (const Mutant& mutant : testing::all_mutants()) {
    const Legal* reason = testing::find_legal(mutant);
    if (reason == nullptr || done[reason] > 0) continue;
    const std::string path = write(mutant);
    if (!complaint(mutant, path).empty())
      continue;  // others of this kind are legal, this one is not
    ++done[reason];
    std::vector<std::string> arguments = {"breakwater", "run", mutant.scenario, "--quiet",
                                          "--out",      "run", "--duration",    "0.2"};
    if (mutant.option == "--config") {
      arguments.insert(arguments.end(), {mutant.option, path});
    } else {
      arguments.insert(arguments.end(), {"--set", mutant.option + "=" + path});
    }
    if (mutant.scenario == "quadrotor_waves") arguments.emplace_back("metrics.window_s=0.1");
    const auto result = testing::run_program(arguments, folder_);
    EXPECT_TRUE(result.status == 0 || result.status == 3)
        << mutant.name() << ": " << result.status << ": " << result.err;
    fs::remove_all(folder_ / "run");
  }
}

}  // namespace breakwater::mutated_input_test
