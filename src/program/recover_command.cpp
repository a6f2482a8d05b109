#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

#include <breakwater/config/config.h>
#include <breakwater/experiment/run_list.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/program/commands.h>
#include <breakwater/record/cut_run.h>
#include <breakwater/record/log_stream.h>
#include <breakwater/record/run_folder.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

// The folder for the recovered run: the one that the killed run was meant for.
fs::path target_of(const fs::path& partial, const std::string& out) {
  if (out.empty() && !is_unfinished_run(partial)) {
    throw std::invalid_argument(partial.string() +
                                ": has another name than a killed run: give --out");
  }
  fs::path target = out.empty() ? finished_name(partial) : fs::path(out);
  if (fs::exists(fs::symlink_status(target))) {
    throw std::invalid_argument(target.string() +
                                ": is there already: give another folder with --out");
  }
  return target;
}

// The folder without a `.` at its end, which cannot be renamed or removed.
fs::path named(const fs::path& folder) {
  const fs::path last = folder.lexically_normal().filename();
  return last == "." || last == ".." || last.empty() ? fs::weakly_canonical(folder) : folder;
}

// Refuses what would lose something: the folder is removed at the end.
void check_nothing_is_lost(const fs::path& partial, const fs::path& target) {
  const fs::path from = fs::weakly_canonical(partial);
  const fs::path to = fs::weakly_canonical(target);
  if (std::mismatch(from.begin(), from.end(), to.begin(), to.end()).first == from.end()) {
    throw std::invalid_argument(target.string() + ": is inside the folder that is recovered");
  }
  if (const std::string name = other_than_a_runs(partial); !name.empty()) {
    throw std::invalid_argument(partial.string() + ": holds " + name +
                                ", which is not a run's: move it away first");
  }
  // The run would be of no use without its keys.
  const ScenarioFile config((partial / "config.toml").string(),
                            list_streamed_run(partial).scenario);
}

// Killed after the last row, the run may be complete and lack its name alone.
bool is_complete(const fs::path& partial) {
  try {
    return is_recoverable(partial) && !is_being_written(partial) && is_run_folder(partial) &&
           check_log(partial);
  } catch (const std::invalid_argument&) {
    return false;
  }
}

void write_complete_run(const fs::path& partial, RunFolder& folder) {
  for (const auto& entry : fs::directory_iterator(partial)) {
    if (entry.path().filename() == kRunning) continue;
    fs::copy(entry.path(), folder.path() / entry.path().filename());
  }
  forget_stream(folder.path());
  folder.commit();
}

void recover(const fs::path& partial, const std::string& out, bool quiet) {
  std::optional<CutRun> cut;
  if (!is_complete(partial)) cut.emplace(partial);
  const fs::path target = target_of(partial, out);
  check_nothing_is_lost(partial, target);
  RunFolder folder(target);
  if (cut) {
    write_cut_run(*cut, partial, folder);
  } else {
    write_complete_run(partial, folder);
  }
  fs::remove_all(partial);
  if (cut && cut->is_damaged()) {
    warn("recover", {"the rest of the log differs from its journal, as after a power failure: it "
                     "is left out"});
  }
  if (quiet) return;
  if (cut) {
    fmt::print("recovered {:.6g} s of the run, which has no metrics\n", cut->end_s());
  } else {
    fmt::print("the run is complete\n");
  }
  fmt::print("results: {}\n", target.string());
}

}  // namespace

int recover_main(const Catalogue&, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " recover";
  return guarded(program, [&] {
    CLI::App app("Makes a run of the log that a killed run with record.stream=true left.", program);
    std::string partial;
    std::string out;
    bool quiet = false;
    app.add_option("DIR", partial, "the folder that the killed run left; ls shows it")->required();
    app.add_option("--out", out, "the folder of the run (default: the one it was meant for)");
    app.add_flag("--quiet", quiet, "print errors only");
    app.footer(
        "The run has the status \"cut\" and no metrics. Its log ends less than a second before\n"
        "the kill, of simulated time and of the clock. Exit status: 0 success, 2 usage or input.");
    if (const auto status = parse(app, argc, argv)) return *status;
    recover(named(partial), out, quiet);
    return static_cast<int>(kSuccess);
  });
}

}  // namespace breakwater
