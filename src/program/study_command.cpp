#include <breakwater/program/study_command.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <memory>

#include <breakwater/record/partial_file.h>
#include <breakwater/shell/all_cores.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/paths.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace fs = std::filesystem;

void add_study_options(CLI::App& app, StudyOptions& options, const StudyOptionsHelp& help) {
  app.add_option("TARGET", options.target, help.target)->required();
  app.add_option("--out", options.out, help.out)->type_name("DIR")->group(help.how);
  app.add_option("--jobs", options.jobs, "how many runs at a time (default: all cores)")
      ->type_name("N")
      ->check(CLI::Range(1, 4096))
      ->group(help.how);
  app.add_flag("--isolate", options.isolate,
               "in processes of their own: a run that crashes is one failed run")
      ->group(help.how);
  app.add_flag("--dry-run", options.dry_run, help.dry_run)->group(help.how);
  app.add_flag("--rerun", options.rerun, "remove what is there and begin anew")->group(help.how);
  app.add_flag("--status", options.status, "say what is done, and exit")
      ->group(help.begun)
      ->excludes("--rerun");
  app.add_flag("--quiet", options.quiet, "print errors and warnings only")->group(help.how);
  app.add_flag("--slurm", options.slurm, help.slurm)->group(kOnCluster);
  add_slurm_options(app, options.request);
}

StudyFolder begun_folder(const std::string& target, const StudyKind& kind) {
  StudyFolder folder(fs::absolute(target).lexically_normal(), kind);
  if (!folder.is_there()) {
    std::string what = "no study's folder";
    for (const StudyKind& other : {kSweep, kTune}) {
      if (!StudyFolder(target, other).is_there()) continue;
      what = fmt::format("{} {}'s", own_program_name(), other.command);
    }
    throw std::invalid_argument(fmt::format("{}: has no {}: it is {}", target, kind.file, what));
  }
  fs::current_path(folder.working_folder());
  return folder;
}

std::optional<fs::path> file_of_study(const std::string& target) {
  if (fs::exists(target) && !fs::is_directory(target)) return target;
  const auto shipped = target.ends_with(".toml") ? look_for(target) : std::nullopt;
  return shipped && fs::is_regular_file(*shipped) ? shipped : std::nullopt;
}

StudyFolder new_folder(const StudyOptions& options, const std::string& name,
                       const StudyKind& kind) {
  const fs::path out = options.out.empty() ? fs::path("studies") / name : fs::path(options.out);
  return {fs::absolute(out).lexically_normal(), kind};
}

std::string time_needed(double processor_time_s, std::size_t jobs) {
  if (jobs == 0) jobs = usable_cores();
  return fmt::format("about {} on {} ({} of processor time)\n",
                     duration_text(processor_time_s / static_cast<double>(jobs)),
                     number_of(jobs, "core"), duration_text(processor_time_s));
}

StudyCommand::StudyCommand(StudyFolder folder, StudyOptions options)
    : folder_(std::move(folder)), options_(std::move(options)) {
  if (options_.isolate) options_.request.of_task = {"--isolate"};
  if (options_.is_task()) {
    stop_on_signals({SIGUSR1});  // a scheduler's warning before its time limit
  } else {
    stop_on_signals();
  }
}

int StudyCommand::run() {
  if (options_.slurm || options_.print_tasks) check_for_scripts(folder_);
  if (options_.dry_run) {
    print_dry_run();
    return kSuccess;
  }
  const bool is_there = folder_.is_there();
  const bool only_looks = options_.status || options_.collect || !options_.replay.empty();
  if (!is_there && (only_looks || options_.is_task())) {
    throw std::invalid_argument(fmt::format("{}: has no {}: nothing was begun",
                                            folder_.path().string(), folder_.kind().file));
  }
  std::unique_ptr<const ShardIndex> before;  // results before the call
  if (is_there) {
    folder_.check_is_ours();
    const bool is_same = StudyFolder::is_same(text(), text_there());
    if (!is_same) check_growth();
    before.reset(new ShardIndex(index()));
    if (options_.status) {
      print_status(*before);
      print_slurm_status(folder_, *before);
      return kSuccess;
    }
    const bool goes_on = !options_.rerun && (!options_.collect || !is_same);
    if (goes_on) folder_.check_made_by_this(file(), *before);
    if (!options_.replay.empty()) return replay(*before);
    if (goes_on && !is_same) grow(*before);
    if (options_.collect) return collect(*before);
  }
  if (options_.slurm) most_tasks();  // fails without a cluster before anything is made
  if (!is_there || options_.rerun) {
    begin(is_there);
    before.reset(new ShardIndex(index()));
  }
  remove_left(folder_.study_file());
  return options_.is_task() ? run_task(*before) : go_on(*before);
}

void StudyCommand::begin(bool is_there) const {
  if (is_there) check_not_queued(queued(folder_, size()), folder_, "--rerun");
  check();  // before old results are removed
  if (is_there) {
    folder_.make_anew(text(), file());
  } else {
    folder_.make(text(), file());
  }
}

// Tasks and processes at work have the numbers of the smaller study.
void StudyCommand::grow(const ShardIndex& before) const {
  check_not_queued(queued(folder_, size()), folder_, folder_.kind().file);
  const std::vector<int> others = other_writers(folder_.shards());
  if (!others.empty()) {
    throw std::invalid_argument(fmt::format("{}: process {} is at this study: it grows after that",
                                            folder_.path().string(), others.front()));
  }
  if (before.done() < before.points()) check();
  folder_.grow(text(), file());
}

std::size_t StudyCommand::run_here(const std::vector<std::size_t>& points,
                                   ExecutorOptions options) const {
  options.threads = options_.jobs;
  options.is_task = options_.is_task();
  options.stop = &interrupted();
  Shard shard(folder_.shards(), folder_.origin());
  if (options_.isolate) {
    run_isolated(points, source(), folder_, shard, options);
  } else {
    run_points(points, source(), shard, options);
  }
  shard.finish();
  const ShardIndex now = index();  // another process may have done some
  return static_cast<std::size_t>(std::count_if(
      points.begin(), points.end(), [&](std::size_t point) { return !now.has(point); }));
}

void StudyCommand::fail_for_undone(std::size_t left) const {
  throw OutputError(fmt::format("{}: {} left undone: the same command goes on",
                                folder_.path().string(),
                                left == 1 ? "one run was" : fmt::format("{} runs were", left)));
}

// Runs the undone points of --points.
int StudyCommand::run_task(const ShardIndex& before) {
  std::vector<std::size_t> points = task_points();
  std::erase_if(points, [&](std::size_t point) { return before.has(point); });
  if (has_to_stop()) return kRunFailed;
  const std::size_t left = make(points);
  if (has_to_stop()) return kRunFailed;
  if (left == 0) return kSuccess;
  if (!interrupted()) fail_for_undone(left);
  fmt::print(stderr, "{}: interrupted before all points of this task were run\n", name());
  return kInterrupted;
}

}  // namespace breakwater
