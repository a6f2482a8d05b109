// Run folders as users meet them: full disks, damaged logs, killed runs.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/program.h"
#include "shell.h"
#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;
using testing::ProgramResult;
using testing::run_program;
using testing::text_of;

class RunFolderCli : public ::testing::Test {
 protected:
  RunFolderCli() { fs::create_directories(folder_); }

  ProgramResult run(const std::string& out) {
    return run_program({"cart_position", "--quiet", "--duration", "0.2", "--out", out}, folder_);
  }
  void expect_refused(const ProgramResult& result, const std::string& line) {
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(result.err, line + "\n");
    EXPECT_EQ(result.out, "");
  }

  fs::path folder_ = testing::temporary_path("run_folder_cli");
  testing::Removed removed_{folder_};
};

// A small file system of its own, which only this command sees.
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

TEST_F(RunFolderCli, AFullDiskLeavesTheEarlierRunAndNothingElse) {
  const fs::path script = folder_ / "fill_up";
  std::ofstream(script) << kFillUp;
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

  std::istringstream stream(output);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 33U) << output;
  EXPECT_EQ(lines[1], "status 0");
  for (std::size_t i = 3; i < 31; i += 2) {  // one line, and a status
    EXPECT_NE(lines[i].find(": cannot be "), std::string::npos) << lines[i];
    EXPECT_EQ(lines[i + 1], "status 2") << output;
  }
  EXPECT_EQ(lines[31], lines[2]) << "the earlier run is not what it was";
  EXPECT_EQ(lines[32], "run");
}

TEST_F(RunFolderCli, TheSameRunGivesTheSameLogFile) {
  ASSERT_EQ(run("a").status, 0);
  ASSERT_EQ(run("b").status, 0);
  EXPECT_EQ(text_of(folder_ / "a/log.h5"), text_of(folder_ / "b/log.h5"));
  const auto manifest = nlohmann::json::parse(text_of(folder_ / "a/manifest.json"));
  EXPECT_EQ(manifest["log_hash"].get<std::string>().size(), 16U);
}

TEST_F(RunFolderCli, ADamagedLogIsRefusedByAllThatOpenIt) {
  ASSERT_EQ(run("run").status, 0);
  ASSERT_EQ(run("whole").status, 0);
  EXPECT_EQ(run_program({"breakwater", "report", "run", "--out", "page"}, folder_).status, 0);
  std::fstream log(folder_ / "run/log.h5", std::ios::in | std::ios::out | std::ios::binary);
  log.seekp(-5, std::ios::end);
  log.put('\x5a');
  log.close();
  const std::string line = "run/log.h5: is damaged: it is not what the run wrote; run it again";
  for (const auto& words :
       std::vector<std::vector<std::string>>{{"report", "run", "--out", "other"},
                                             {"compare", "whole", "run"},
                                             {"still", "run", "--at", "0.1", "--out", "still.png"},
                                             {"video", "run", "--out", "video.mp4"}}) {
    std::vector<std::string> arguments = {"breakwater"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    SCOPED_TRACE(words[0]);
    expect_refused(run_program(arguments, folder_), line);
  }
  EXPECT_FALSE(fs::exists(folder_ / "other"));

  // Without the hash, as before version 0.2: the data are taken as they are.
  auto manifest = nlohmann::ordered_json::parse(text_of(folder_ / "run/manifest.json"));
  manifest.erase("log_hash");
  std::ofstream(folder_ / "run/manifest.json") << manifest;
  EXPECT_EQ(run_program({"breakwater", "compare", "whole", "run"}, folder_).status, 0);
}

TEST_F(RunFolderCli, ARunWithItsPicturesIsReplacedByTheNext) {
  ASSERT_EQ(run("run").status, 0);
  for (const char* command : {"replay", "report"}) {
    ASSERT_EQ(run_program({"breakwater", command, "run", "--quiet"}, folder_).status, 0);
  }
  EXPECT_TRUE(fs::exists(folder_ / "run/replay.html"));
  const ProgramResult again = run("run");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_FALSE(fs::exists(folder_ / "run/replay.html"));
}

TEST_F(RunFolderCli, AReaderFindsTheRunThatAKilledOneWasReplacing) {
  ASSERT_EQ(run("run").status, 0);
  std::array<char, 256> host = {};
  gethostname(host.data(), host.size() - 1);
  const std::string aside = std::string(".run.earlier-") + host.data() + "-2000000000";
  fs::rename(folder_ / "run", folder_ / aside);
  EXPECT_EQ(run_program({"breakwater", "report", "run", "--out", "page"}, folder_).status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "run/manifest.json"));
  EXPECT_FALSE(fs::exists(folder_ / aside));
}

}  // namespace
}  // namespace breakwater
