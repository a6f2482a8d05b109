#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <breakwater/experiment/run_list.h>
#include <breakwater/program/commands.h>
#include <breakwater/record/run_folder.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/table.h>
#include <breakwater/study/study_summary.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

// The folders to remove and to keep, each with a reason.
struct Removal {
  struct Folder {
    fs::path path;
    std::string why;
  };
  std::vector<Folder> goes;
  std::vector<Folder> stays;
};

void refuse_within_study(const fs::path& below) {
  const fs::path absolute = fs::weakly_canonical(below);
  for (fs::path p = absolute.parent_path(); p != p.parent_path(); p = p.parent_path()) {
    if (!is_study_folder(p)) continue;
    throw std::invalid_argument(below.string() + ": belongs to the study " + p.string() +
                                ", which keeps its runs");
  }
}

bool has_failed(const fs::path& folder) {
  return list_run(folder).status == ListedRun::Status::failed;
}

Removal plan_removal(const fs::path& below) {
  refuse_within_study(below);
  Removal removal;
  const auto sort_in = [&](const fs::path& folder, const std::string& why) {
    const std::string complaint = why_not_removable(folder);
    (complaint.empty() ? removal.goes : removal.stays)
        .push_back({folder, complaint.empty() ? why : complaint});
  };
  const FoundRuns found = find_runs(below, is_study_folder);
  for (const fs::path& folder : found.runs) {
    const ListedRun run = list_run(folder);
    if (run.status == ListedRun::Status::failed) sort_in(folder, "failed " + run.reason);
  }
  for (const fs::path& folder : found.unfinished) sort_in(folder, "was never finished");
  return removal;
}

void print_folders(const std::string& heading, const std::vector<Removal::Folder>& folders) {
  if (folders.empty()) return;
  fmt::print("{}:\n", heading);
  for (const Removal::Folder& folder : folders) {
    fmt::print("  {}\n", one_line(folder.path.string() + ": " + folder.why));
  }
}

int remove_failed(const fs::path& below, bool dry_run) {
  const Removal removal = plan_removal(below);
  print_folders("left alone", removal.stays);
  if (removal.goes.empty()) {
    fmt::print("no failed or unfinished run to remove below {}\n", below.string());
    return kSuccess;
  }
  const std::string runs = number_of(removal.goes.size(), "run");
  print_folders(fmt::format("{} {}", dry_run ? "would remove" : "removes", runs), removal.goes);
  if (dry_run) return kSuccess;
  std::fflush(stdout);
  std::size_t removed = 0;
  for (const Removal::Folder& folder : removal.goes) {
    if (remove_run(folder.path, has_failed)) {
      ++removed;
    } else {
      fmt::print("left alone: {}\n", one_line(folder.path.string() + ": is another run by now"));
    }
  }
  fmt::print("removed {}\n", number_of(removed, "run"));
  return kSuccess;
}

}  // namespace

int remove_runs_main(const Catalogue&, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " " + kRemoveRuns;
  return guarded(program, [&] {
    CLI::App app("Removes failed and unfinished runs below a folder, and says which.", program);
    std::string below = "runs";
    bool failed = false;
    bool dry_run = false;
    app.add_flag("--failed", failed, "which runs: those that failed, and what killed ones left")
        ->required();
    app.add_option("DIR", below, "where to look")->capture_default_str();
    app.add_flag("--dry-run", dry_run, "say what would be removed, and remove nothing");
    app.footer(
        "Keeps folders with other files than those of runs, runs of studies, runs that may still\n"
        "be active, and the targets of symbolic links.\n"
        "Exit status: 0 success, 2 usage, or a folder that cannot be removed.");
    if (const auto status = parse(app, argc, argv)) return *status;
    return remove_failed(below, dry_run);
  });
}

}  // namespace breakwater
