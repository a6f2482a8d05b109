#include <nlohmann/json.hpp>

#include "cli/program.h"
#include "shell.h"

namespace breakwater::run_folder_cli_test {
namespace fs = std::filesystem;

const std::string kRun = "cart_position --quiet --duration 0.2 --out ";

class RunFolderCli : public testing::ProgramTest {};

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

TEST_F(RunFolderCli, AFullDiskLeavesTheEarlierRunAndNothingElse) {
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

TEST_F(RunFolderCli, TheSameRunGivesTheSameLogFile) {
  ran(kRun + "a");
  ran(kRun + "b");
  EXPECT_EQ(read("a/log.h5"), read("b/log.h5"));
  EXPECT_EQ(json("a/manifest.json")["log_hash"].get<std::string>().size(), 16U);
}

TEST_F(RunFolderCli, EveryReaderRefusesADamagedLog) {
  ran(kRun + "run");
  ran(kRun + "whole");
  ran("breakwater report run --out page");
  std::fstream log(folder_ / "run/log.h5", std::ios::in | std::ios::out | std::ios::binary);
  log.seekp(-5, std::ios::end);
  log.put('\x5a');
  log.close();
  const std::string line = "run/log.h5: is damaged: it is not what the run wrote; run it again";
  expect_refusals("breakwater ", {{"report run --out other", line},
                                  {"compare whole run", line},
                                  {"still run --at 0.1 --out still.png", line},
                                  {"video run --out video.mp4", line}});

  // Without the hash, as before version 0.2, the data are not checked.
  auto manifest = nlohmann::ordered_json::parse(read("run/manifest.json"));
  manifest.erase("log_hash");
  write("run/manifest.json", manifest.dump());
  ran("breakwater compare whole run");

  for (const std::string file : {"config.toml", "metrics.json"}) {
    write("whole/" + file, " " + read("whole/" + file));
    expect_refused("breakwater compare run whole",
                   "whole/" + file + ": is damaged: it is not what the run wrote; run it again");
    write("whole/" + file, read("whole/" + file).substr(1));
  }
}

TEST_F(RunFolderCli, AReaderFindsTheOldRunAfterAKill) {
  ran(kRun + "run");
  std::array<char, 256> host = {};
  gethostname(host.data(), host.size() - 1);
  const std::string aside = std::string(".run.earlier-") + host.data() + "-2000000000";
  fs::rename(folder_ / "run", folder_ / aside);
  ran("breakwater report run --out page");
  EXPECT_TRUE(fs::exists(folder_ / "run/manifest.json"));
  EXPECT_FALSE(fs::exists(folder_ / aside));
}

}  // namespace breakwater::run_folder_cli_test
