#include <breakwater/program/sweep_command.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <breakwater/cluster/slurm.h>
#include <breakwater/cluster/slurm_options.h>
#include <breakwater/cluster/slurm_queue.h>
#include <breakwater/config/toml_file.h>
#include <breakwater/config/toml_text.h>
#include <breakwater/pages/study_report.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/all_cores.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/paths.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/shell/table.h>
#include <breakwater/study/comparison_table.h>
#include <breakwater/study/isolated.h>
#include <breakwater/study/study_comparison.h>
#include <breakwater/study/study_notes.h>
#include <breakwater/study/study_reader.h>
#include <breakwater/study/sweep.h>

namespace breakwater {
namespace {

namespace fs = std::filesystem;

struct SweepArguments {
  std::string target;
  std::vector<std::string> cases;
  std::string config;
  std::vector<std::string> sets;
  std::string duration;
  std::vector<std::string> vary;
  std::string seeds;
  std::string method;
  std::string samples;
  std::string sampling_seed;
  std::string baseline;
  std::vector<std::string> metrics;
  std::vector<std::string> goals;
  std::string worlds;
  std::string keep;
  std::string on_failure;
  std::string out;
  std::size_t jobs = 0;
  bool isolate = false;
  bool rerun = false;
  bool dry_run = false;
  bool status = false;
  bool collect = false;
  std::string replay;
  bool sqlite = false;
  bool quiet = false;
  bool slurm = false;
  bool wait = false;
  bool print_tasks = false;
  SlurmRequest request;
  std::string points;
};

void describe(CLI::App& app, SweepArguments& arguments) {
  app.add_option("TARGET", arguments.target,
                 "a scenario, a study file, or the folder of a study, to go on with it")
      ->required();
  const std::string what = "What is run (in a study file: the keys of these names)";
  app.add_option("--case", arguments.cases, "the case; several, or all, are compared")
      ->type_name("NAME[,NAME...]")
      ->delimiter(',')
      ->group(what);
  app.add_option("--config", arguments.config, "another scenario file")
      ->type_name("FILE")
      ->group(what);
  app.add_option("--set", arguments.sets, "a key of every run")
      ->type_name("KEY=VALUE")
      ->group(what);
  app.add_option("--duration", arguments.duration, "the same as --set run.duration_s=S")
      ->type_name("S")
      ->group(what);
  app.add_option("--vary", arguments.vary,
                 "a key and what it takes: 1,2,5 or lin(A,B,N), log(A,B,N); of the methods that\n"
                 "draw also uniform(A,B), log_uniform(A,B), normal(MEAN,DEVIATION); may be given\n"
                 "again for another key")
      ->type_name("KEY=VALUES")
      ->expected(1)
      ->take_all()
      ->group(what);
  app.add_option("--seeds", arguments.seeds, "the same for each sample and case: 1..20 or 1,4,7")
      ->type_name("SEEDS")
      ->group(what);
  app.add_option("--method", arguments.method,
                 "how values are put together: grid (the default), list, random, lhs, sobol,\n"
                 "saltelli (for sensitivity indices)")
      ->type_name("NAME")
      ->group(what);
  app.add_option("--samples", arguments.samples, "how many are drawn")->type_name("N")->group(what);
  app.add_option("--sampling-seed", arguments.sampling_seed, "of what is drawn (default: 1)")
      ->type_name("N")
      ->group(what);
  app.add_option("--baseline", arguments.baseline, "the case that others are compared with")
      ->type_name("NAME")
      ->group(what);
  app.add_option("--metrics", arguments.metrics, "what is compared (default: all metrics)")
      ->type_name("NAME[,NAME...]")
      ->delimiter(',')
      ->group(what);
  app.add_option("--goal", arguments.goals,
                 "what is better in a metric: METRIC=min or METRIC=max; may be given again")
      ->type_name("METRIC=GOAL")
      ->expected(1)
      ->take_all()
      ->group(what);
  app.add_option("--worlds", arguments.worlds,
                 "what a comparison counts: samples (the default; seeds repeat them, or are the\n"
                 "worlds where no key is varied), or seeds: each of every sample\n")
      ->type_name("WHAT")
      ->group(what);
  app.add_option("--keep", arguments.keep,
                 "whose folders, with logs: metrics (none, the default), failed, all")
      ->type_name("WHAT")
      ->group(what);
  app.add_option("--on-failure", arguments.on_failure,
                 "a failed run is a result (count, the default), or ends the study (stop)")
      ->type_name("WHAT")
      ->group(what);

  const std::string how = "How";
  app.add_option("--out", arguments.out, "the study's folder (default: studies/NAME)")
      ->type_name("DIR")
      ->group(how);
  app.add_option("--jobs", arguments.jobs, "how many runs at a time (default: all cores)")
      ->type_name("N")
      ->check(CLI::Range(1, 4096))
      ->group(how);
  app.add_flag("--isolate", arguments.isolate,
               "in processes of their own: a run that crashes is one failed run")
      ->group(how);
  app.add_flag("--dry-run", arguments.dry_run,
               "count the runs, say how long they will take, from one of each case, and exit")
      ->group(how);
  app.add_flag("--rerun", arguments.rerun, "remove what is there and begin anew")->group(how);
  app.add_flag("--sqlite", arguments.sqlite, "write results.sqlite as well")->group(how);
  app.add_flag("--quiet", arguments.quiet, "print errors and warnings only")->group(how);

  const std::string with = "With a study that was begun";
  app.add_flag("--status", arguments.status, "say what is done, and exit")->group(with);
  app.add_flag("--collect", arguments.collect, "write results.csv of what is done, and exit")
      ->group(with);
  app.add_option("--replay", arguments.replay,
                 "run this point (its first digits will do) once more, with its log, into\n"
                 "DIR/runs/POINT; exit status 3 if it is not the run that it was")
      ->type_name("POINT")
      ->group(with);
  app.add_option("--points", arguments.points,
                 "run these points alone (0-99,120, or @FILE:LINE), as a task of a scheduler does")
      ->type_name("LIST")
      ->group(with);

  for (const char* option : {"--replay", "--points", "--status", "--collect"}) {
    app.get_option("--rerun")->excludes(app.get_option(option));
  }

  app.add_flag("--slurm", arguments.slurm, "submit what is left to do as one array job")
      ->group(kOnCluster);
  add_slurm_options(app, arguments.request);
  app.add_flag("--wait", arguments.wait, "until all tasks have ended; then collect")
      ->group(kOnCluster);
  app.add_flag("--print-tasks", arguments.print_tasks,
               "print what is left to do as commands, one a line, for any other scheduler")
      ->group(kOnCluster);
  app.footer(
      "It leaves study.toml, results.csv (one row a run), comparison.csv (of several cases) and\n"
      "report.html in the study's folder.\n"
      "The same command goes on where it was, whatever ended it.\n"
      "Exit status: 0 all runs are done, 1 a defect, 2 usage or input, 3 a run failed (with\n"
      "--on-failure stop), 130 interrupted.");
}

// Takes a key out of a table, whether its file writes "a.b" = 1 or a.b = 1.
void take_out(toml::table& table, const std::string& key) {
  table.erase(key);
  const std::size_t dot = key.find('.');
  if (dot == std::string::npos) return;
  const std::string first = key.substr(0, dot);
  toml::node* inner = table.get(first);
  if (inner == nullptr || !inner->is_table()) return;
  take_out(*inner->as_table(), key.substr(dot + 1));
  if (inner->as_table()->empty()) table.erase(first);
}

// The options as the tables of a study file, on top of what `tables` has.
void add_options(const SweepArguments& arguments, toml::table& tables) {
  const auto table = [&](const char* name) -> toml::table& {
    if (!tables.contains(name)) tables.insert(name, toml::table{});
    if (tables.get(name)->is_table()) return *tables.get(name)->as_table();
    throw std::invalid_argument(arguments.target + ": " + name + ": must be a table");
  };
  const auto pair = [](const std::string& option, const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      throw std::invalid_argument(option + ": " + text + ": must be of the form KEY=VALUE");
    }
    return std::pair(text.substr(0, equals), text.substr(equals + 1));
  };
  const auto put = [](toml::table& into, const std::string& key, const toml::node& value) {
    into.insert_or_assign(key, value);
  };
  const auto put_number = [&](const char* key, const char* option, const std::string& text) {
    if (text.empty()) return;
    const auto value = parse_toml_value(text, option);
    if (!value) throw std::invalid_argument(fmt::format("{}: {}: must be a number", option, text));
    put(tables, key, *value->get("value"));
  };
  const auto put_text = [&](toml::table& into, const char* key, const std::string& text) {
    if (!text.empty()) into.insert_or_assign(key, text);
  };

  const auto put_names = [&](const char* key, const std::vector<std::string>& names) {
    toml::array array;
    for (const std::string& name : names) {
      for (const std::string& part : option_parts(name)) array.push_back(part);
    }
    table("compare").insert_or_assign(key, std::move(array));
  };

  if (!arguments.cases.empty()) {
    tables.erase("case");
    put_names("case", arguments.cases);
  }
  if (!arguments.config.empty()) {
    tables.insert_or_assign("config", fs::absolute(arguments.config).lexically_normal().string());
  }
  std::vector<std::string> sets = arguments.sets;
  if (!arguments.duration.empty()) sets.push_back("run.duration_s=" + arguments.duration);
  for (const std::string& set : sets) {
    const auto [key, text] = pair("--set", set);
    const auto parsed = parse_toml_value(text, "--set: " + key);
    take_out(table("set"), key);
    if (parsed) {
      put(table("set"), key, *parsed->get("value"));
    } else {
      table("set").insert_or_assign(key, text);  // a bare word
    }
  }
  std::set<std::string> varied;
  for (const std::string& vary : arguments.vary) {
    const auto [key, text] = pair("--vary", vary);
    if (!varied.insert(key).second) {
      throw std::invalid_argument("--vary: " + key + ": is given twice");
    }
    const toml::table value = option_value("--vary: " + key, text);
    take_out(table("vary"), key);
    put(table("vary"), key, *value.get("value"));
  }
  if (!arguments.seeds.empty()) {
    toml::array seeds;
    for (const std::uint64_t seed : parse_seeds(arguments.seeds)) {
      seeds.push_back(static_cast<std::int64_t>(seed));
    }
    tables.insert_or_assign("seeds", std::move(seeds));
  }
  put_text(tables, "method", arguments.method);
  put_number("samples", "--samples", arguments.samples);
  put_number("sampling_seed", "--sampling-seed", arguments.sampling_seed);
  if (!arguments.baseline.empty()) put_text(table("compare"), "baseline", arguments.baseline);
  if (!arguments.metrics.empty()) put_names("metrics", arguments.metrics);
  std::string goals;  // in one table, whose places keep their order
  std::set<std::string> judged;
  for (const std::string& text : arguments.goals) {
    const auto [metric, goal] = pair("--goal", text);
    if (!judged.insert(metric).second) {
      throw std::invalid_argument("--goal: " + metric + ": is given twice");
    }
    goals +=
        fmt::format("{}{} = {}", goals.empty() ? "" : ", ", toml_key(metric), toml_string(goal));
  }
  if (!goals.empty()) {
    const auto parsed = parse_toml_value(fmt::format("{{ {} }}", goals), "--goal").value();
    toml::table& compare = table("compare");
    if (!compare["goal"].is_table()) compare.insert_or_assign("goal", toml::table{});
    for (const auto& [metric, goal] : *parsed["value"].as_table()) {
      compare["goal"].as_table()->insert_or_assign(metric, goal);
    }
  }
  if (!arguments.worlds.empty()) put_text(table("compare"), "worlds", arguments.worlds);
  put_text(tables, "keep", arguments.keep);
  put_text(tables, "on_failure", arguments.on_failure);
}

// Whether any option says what is run.
bool says_what(const SweepArguments& a) {
  return !a.cases.empty() || !a.config.empty() || !a.sets.empty() || !a.duration.empty() ||
         !a.vary.empty() || !a.seeds.empty() || !a.method.empty() || !a.samples.empty() ||
         !a.sampling_seed.empty() || !a.baseline.empty() || !a.metrics.empty() ||
         !a.goals.empty() || !a.worlds.empty() || !a.keep.empty() || !a.on_failure.empty() ||
         !a.out.empty();
}

struct Opened {
  Study study;
  StudyFolder folder;
  bool is_folder = false;  // the target was the study's folder itself
};

Opened open_target(const Catalogue& catalogue, const SweepArguments& arguments) {
  const fs::path target = arguments.target;
  if (fs::is_directory(target) && !catalogue.has<ScenarioKind>(arguments.target)) {
    const StudyFolder folder(fs::absolute(target).lexically_normal());
    if (!folder.is_there()) {
      const bool is_tuning = fs::exists(folder.path() / "tune.toml");
      throw std::invalid_argument(
          arguments.target + ": has no study.toml: it is " +
          (is_tuning ? own_program_name() + " tune's" : std::string("no study's folder")));
    }
    if (says_what(arguments)) {
      throw std::invalid_argument(arguments.target +
                                  ": is a study's folder, and its study.toml says what is run: "
                                  "leave --case, --vary, --out and the like out");
    }
    return {folder.study(), folder, true};
  }
  toml::table tables;
  std::string name = arguments.target;
  std::optional<fs::path> file;
  if (fs::is_regular_file(target)) file = target;
  // Those that Breakwater brings with it are found from everywhere.
  if (!file && target.extension() == ".toml") file = look_for(arguments.target);
  if (file) {
    tables = study_tables(file->string());
    name = file->stem().string();
  } else if (target.extension() == ".toml" || arguments.target.find('/') != std::string::npos) {
    throw std::invalid_argument(arguments.target + ": there is no such file or folder");
  } else {
    tables.insert_or_assign("scenario", catalogue.get<ScenarioKind>(arguments.target).name);
  }
  add_options(arguments, tables);
  const fs::path out = arguments.out.empty() ? fs::path("studies") / name : fs::path(arguments.out);
  return {read_study(tables, file ? file->string() : arguments.target),
          StudyFolder(fs::absolute(out).lexically_normal()), false};
}

std::string counted(const ShardIndex& index) {
  std::string text = fmt::format("{} of {} points are done", index.done(), index.points());
  std::vector<std::string> kinds;
  for (const auto status : {PointStatus::failed, PointStatus::refused, PointStatus::crashed}) {
    if (index.count(status) > 0) {
      kinds.push_back(fmt::format("{} {}", index.count(status), name_of(status)));
    }
  }
  if (!kinds.empty()) text += fmt::format("; of these {}", fmt::join(kinds, ", "));
  return text;
}

std::vector<std::string> metric_names(const PointResult& run) {
  std::vector<std::string> names;
  for (const auto& [name, value] : run.metrics) names.push_back(name);
  return names;
}

// What one run of each candidate tells of the study besides its time.
std::vector<std::string> warnings_of(const Sweep& sweep, const std::vector<PointResult>& runs) {
  const Plan& plan = sweep.plan();
  std::vector<std::string> warnings;
  std::vector<std::string> all;
  for (std::size_t c = 0; c < runs.size(); ++c) {
    if (runs[c].status != PointStatus::complete) {
      warnings.push_back(fmt::format("{}: the first run {}: {}", plan.candidates()[c].label,
                                     name_of(runs[c].status), runs[c].reason));
    }
    for (const std::string& name : metric_names(runs[c])) {
      if (std::find(all.begin(), all.end(), name) == all.end()) all.push_back(name);
    }
  }
  for (std::size_t c = 0; c < runs.size(); ++c) {
    if (runs[c].status != PointStatus::complete) continue;
    std::vector<std::string> lacking = all;
    for (const std::string& name : metric_names(runs[c])) std::erase(lacking, name);
    if (lacking.empty()) continue;
    warnings.push_back(fmt::format("{}: the first run lacks {}", plan.candidates()[c].label,
                                   fmt::join(lacking, ", ")));
  }
  for (const auto& [place, meant] : unknown_metrics(plan.study(), all)) {
    warnings.push_back(fmt::format("{}: none of these runs has it{}", place, meant));
  }
  if (plan.seeds() > 1 && runs.front().status == PointStatus::complete) {
    RunControl control;
    control.stop = &interrupted();
    const PointResult other = run_point(plan.candidates().size(), sweep, control);
    if (other.state_hash == runs.front().state_hash) {
      warnings.push_back(
          fmt::format("seeds: {} and {} give the same run of {}: without noise they change nothing",
                      plan.study().seeds[0], plan.study().seeds[1], plan.candidates()[0].label));
    }
  }
  return warnings;
}

void print_dry_run(const Sweep& sweep, const SweepArguments& arguments) {
  const Plan& plan = sweep.plan();
  fmt::print("{}: {}, {}, {}\n", number_of(plan.size(), "run"), number_of(plan.samples(), "sample"),
             number_of(plan.seeds(), "seed"), number_of(plan.candidates().size(), "candidate"));
  std::fflush(stdout);
  const Estimate time = estimate(sweep, interrupted());
  Table table({"candidate", "one run", "metrics"});
  for (std::size_t c = 0; c < time.runs.size(); ++c) {
    table.add({plan.candidates()[c].label, fmt::format("{:.3g} s", time.runs[c].cost_s),
               std::to_string(time.runs[c].metrics.size())});
  }
  const std::size_t jobs = arguments.jobs > 0 ? arguments.jobs : usable_cores();
  fmt::print("\n{}\nabout {} on {} ({} of processor time)\n", table.print(output_width()),
             duration_text(time.seconds / static_cast<double>(jobs)), number_of(jobs, "core"),
             duration_text(time.seconds));
  std::fflush(stdout);
  warn(kSweep, warnings_of(sweep, time.runs));
}

// A metric that is asked for by a name that is nearly another's is most likely a slip of the pen:
// it is found by a first and a last run of each candidate, before all others are made for it. One
// that those lack and that is like none of theirs may be in others.
void check_asked_metrics(const Sweep& sweep) {
  const Study& study = sweep.plan().study();
  std::vector<std::string> known;
  RunControl control;
  control.stop = &interrupted();
  const std::size_t candidates = sweep.plan().candidates().size();
  for (const std::size_t first : {std::size_t{0}, sweep.plan().size() - candidates}) {
    for (std::size_t c = 0; c < candidates; ++c) {
      if (unknown_metrics(study, known).empty()) return;
      const PointResult run = run_point(first + c, sweep, control);
      if (run.status != PointStatus::complete) return;
      for (const auto& [name, value] : run.metrics) known.push_back(name);
    }
  }
  for (const auto& [place, meant] : unknown_metrics(study, known)) {
    if (meant.empty()) continue;
    throw std::invalid_argument(
        fmt::format("{}: the first and the last run have no such metric{}", place, meant));
  }
}

// Processor time of the points that are not done, each as long as its candidate's others.
double time_to_go_s(const Plan& plan, const ShardIndex& index) {
  const std::size_t candidates = plan.candidates().size();
  std::vector<double> cost_s(candidates);
  std::vector<std::size_t> done(candidates);
  for (std::size_t point = 0; point < index.points(); ++point) {
    if (!index.has(point)) continue;
    cost_s[point % candidates] += index.cost_s(point);
    ++done[point % candidates];
  }
  const double each_s =
      std::accumulate(cost_s.begin(), cost_s.end(), 0.0) / static_cast<double>(index.done());
  double all_s = 0.0;
  for (std::size_t c = 0; c < candidates; ++c) {
    const std::size_t left = plan.size() / candidates - done[c];
    all_s += static_cast<double>(left) *
             (done[c] > 0 ? cost_s[c] / static_cast<double>(done[c]) : each_s);
  }
  return all_s;
}

void print_status(const Plan& plan, const StudyFolder& folder, const ShardIndex& index) {
  fmt::print("{}: {}\n", folder.path().string(), counted(index));
  if (index.done() > 0 && index.done() < index.points()) {
    fmt::print("{} of processor time to go\n", duration_text(time_to_go_s(plan, index)));
  }
  print_slurm_status(folder, index);
}

void collect(const Catalogue& catalogue, const Plan& plan, const ShardIndex& index,
             const StudyFolder& folder, const SweepArguments& arguments) {
  index.check_models();
  const ResultsTable table(plan, index);
  const fs::path csv = folder.path() / "results.csv";
  table.write_csv(csv);
  const fs::path sqlite = folder.path() / "results.sqlite";
  if (arguments.sqlite || fs::exists(sqlite)) table.write_sqlite(sqlite);
  for (const auto& [place, meant] : unknown_metrics(plan.study(), table.metrics())) {
    fmt::print(stderr, "{}: {}: no run has it{}\n", kSweep, place, meant);
  }
  const auto comparison = compare_study(plan, index);
  const fs::path compared = folder.path() / "comparison.csv";
  if (comparison) {
    replace_file(compared, comparison_csv(*comparison));
    const fs::path by_key = folder.path() / "comparison_by_key.csv";
    if (!comparison->interactions.empty()) replace_file(by_key, by_key_csv(*comparison));
  }
  write_study_report(catalogue, plan, index, folder, comparison);
  const std::vector<std::string> to_know = notes(plan, index);
  if (arguments.quiet) {
    warn(kSweep, to_know);
    return;
  }
  if (comparison) {
    fmt::print("{}\n", comparison_text(*comparison, output_width()));
  }
  for (const std::string& note : to_know) fmt::print("{}\n", note);
  fmt::print("{}\nresults: {}\n", counted(index), csv.string());
  if (comparison) fmt::print("comparison: {}\n", compared.string());
  fmt::print("report: {}\n", (folder.path() / "report.html").string());
}

// The first point that did not end well, in the study's order; nothing if all did.
std::optional<PointResult> first_failure(const ShardIndex& index) {
  if (index.count(PointStatus::complete) == index.done()) return std::nullopt;
  std::size_t point = 0;
  while (!index.has(point) || index.status(point) == PointStatus::complete) ++point;
  return index.read(point);
}

// A study that is to stop at the first failure: says so, if there was one.
bool has_to_stop(const Plan& plan, const ShardIndex& index) {
  if (plan.study().on_failure == OnFailure::count) return false;
  const auto failure = first_failure(index);
  if (!failure) return false;
  fmt::print(stderr, "{}: point {} {}: {}\n", kSweep, failure->key, name_of(failure->status),
             failure->reason);
  return true;
}

int run_here(const Sweep& sweep, const StudyFolder& folder, const std::vector<std::size_t>& points,
             const SweepArguments& arguments, bool is_task) {
  Shard shard(folder.shards());
  std::atomic<bool> stop = false;
  ExecutorOptions options;
  options.threads = is_task && arguments.jobs == 0 ? task_threads() : arguments.jobs;
  options.is_task = is_task;
  options.stop = &interrupted();
  const bool stops = sweep.plan().study().on_failure == OnFailure::stop;
  options.on_result = [&](const PointResult& result) {
    if (stops && result.status != PointStatus::complete) stop = true;
  };
  if (stops) options.is_over = [&] { return stop.load(); };
  Progress progress(kSweep, std::vector<double>(points.size(), 1.0), arguments.quiet);
  options.progress = [&](std::size_t i, double done) { progress.update(i, done); };
  const std::size_t ran = arguments.isolate
                              ? run_isolated(points, sweep, {kSweep}, folder, shard, options)
                              : run_points(points, sweep, shard, options);
  shard.finish();
  // Fewer may have been run though nobody stopped it: with --isolate, a point whose process was
  // killed from outside is left undone.
  return ran == points.size() || stop || !interrupted() ? kSuccess : kInterrupted;
}

// What is in the queue is not run twice: leaves it out of `points`, and says so. Returns whether
// there was any.
bool leave_out_queued(std::vector<std::size_t>& points, const Plan& plan, const StudyFolder& folder,
                      const SweepArguments& arguments) {
  if (points.empty()) return false;
  const auto queue =
      arguments.slurm ? queued(folder, plan.size()) : queued_if_known(folder, plan.size(), kSweep);
  if (!queue || !queue->is_asked) return false;
  const std::size_t left =
      std::erase_if(points, [&](std::size_t point) { return queue->points[point]; });
  // A task that has ended since `points` were read is no more in the queue, and its points are
  // done.
  const ShardIndex now(folder.shards(), plan.size());
  std::erase_if(points, [&](std::size_t point) { return now.has(point); });
  if (left == 0) return false;
  const std::string text = fmt::format("{} {} still in the queue ({})", number_of(left, "point"),
                                       left == 1 ? "is" : "are", queue->text);
  if (!arguments.slurm && !arguments.print_tasks) {
    throw std::invalid_argument(
        fmt::format("{}: {}: --status says how far it is; to go on here, end it first with scancel",
                    folder.path().string(), text));
  }
  if (!arguments.quiet) {
    fmt::print(stderr, "{}: {}{}\n", kSweep, text,
               points.empty() ? "; nothing else is left to submit" : "");
  }
  return true;
}

[[noreturn]] void fail_for_undone(const StudyFolder& folder, const ShardIndex& index) {
  throw OutputError(
      fmt::format("{}: {}; the others were left undone, or somebody removed results: the same "
                  "command goes on",
                  folder.path().string(), counted(index)));
}

// How long they take is told by one run of each candidate.
void submit_points(const Sweep& sweep, const StudyFolder& folder,
                   const std::vector<std::size_t>& points, const SweepArguments& arguments) {
  const Plan& plan = sweep.plan();
  const SubmittedJob job =
      submit({kSweep, folder, plan.study().slurm}, points, arguments.request, [&] {
        return estimate(sweep, interrupted()).seconds * static_cast<double>(points.size()) /
               static_cast<double>(plan.size());
      });
  if (arguments.quiet) return;
  fmt::print("{} in {}: job {}\n", number_of(points.size(), "point"), number_of(job.tasks, "task"),
             job.number);
  if (arguments.wait) return;
  fmt::print("--status says how far it is; when it is over, {} {} {} collects the results\n",
             own_program_name(), kSweep, folder.path().string());
}

int go_on(const Catalogue& catalogue, const Sweep& sweep, const StudyFolder& folder,
          const ShardIndex& before, const SweepArguments& arguments) {
  const Plan& plan = sweep.plan();
  if (has_to_stop(plan, before)) return kRunFailed;
  std::vector<std::size_t> points = pending(before);
  if (!arguments.quiet && before.done() > 0 && !points.empty()) {
    fmt::print(stderr, "{}: {}\n", kSweep, counted(before));
  }
  const bool is_queued = leave_out_queued(points, plan, folder, arguments);
  const bool is_done = points.empty() && !is_queued;
  if (arguments.print_tasks) {
    print_tasks({kSweep, folder}, points, arguments.request);
    return kSuccess;
  }
  if (arguments.slurm && !is_done) {
    if (!points.empty()) submit_points(sweep, folder, points, arguments);
    if (!arguments.wait) return kSuccess;
    wait_for_queue(folder, plan.size());
    if (interrupted()) {
      fmt::print(stderr, "{}: interrupted; what is in the queue goes on\n", kSweep);
      return kInterrupted;
    }
  }
  const bool runs_here = !arguments.slurm && !points.empty();
  if (runs_here) {
    const std::vector<int> others = other_writers(folder.shards());
    if (!others.empty()) {
      const bool is_one = others.size() == 1;
      warn(kSweep,
           {fmt::format("process{} {} {} at this study too: points may be run twice",
                        is_one ? "" : "es", fmt::join(others, ", "), is_one ? "is" : "are")});
    }
  }
  const int status =
      runs_here ? run_here(sweep, folder, points, arguments, false) : static_cast<int>(kSuccess);
  const ShardIndex index(folder.shards(), plan.size());
  if (status == kInterrupted) {
    fmt::print(stderr, "{}: interrupted; {}; the same command goes on\n", kSweep, counted(index));
    return kInterrupted;
  }
  const bool is_stopped = plan.study().on_failure == OnFailure::stop && first_failure(index);
  if (arguments.slurm && index.done() < index.points() && !is_stopped) {
    fmt::print(stderr,
               "{}: the tasks have ended; {}; --status says why, the same command goes on\n",
               kSweep, counted(index));
    return kInterrupted;
  }
  collect(catalogue, plan, index, folder, arguments);
  if (has_to_stop(plan, index)) return kRunFailed;
  if (index.done() < index.points()) fail_for_undone(folder, index);
  return kSuccess;
}

// Runs a point once more, and says if it is not the run that it was.
int replay_point(const Sweep& sweep, const StudyFolder& folder, const ShardIndex& index,
                 const SweepArguments& arguments) {
  const std::size_t point = [&] {
    try {
      return index.find(arguments.replay);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(std::string("--replay: ") + error.what());
    }
  }();
  if (point == index.points()) {
    throw std::invalid_argument(
        fmt::format("--replay: no point of {} that ran is {}: the column `point` of results.csv "
                    "names them",
                    folder.path().string(), arguments.replay));
  }
  const PointResult then = index.read(point);
  if (then.status == PointStatus::crashed) {
    fmt::print(stderr, "{}: point {} has crashed: {}; now this process runs it\n", kSweep, then.key,
               then.reason);
  }
  const PointResult now = replay(sweep, folder, point, interrupted());
  if (now.status == PointStatus::refused) {
    fmt::print(stderr, "{}: point {} is refused, and has no folder: {}\n", kSweep, then.key,
               now.reason);
    return kRunFailed;
  }
  if (!arguments.quiet) {
    fmt::print("{}: {}\n", name_of(now.status), folder.run(now.key).string());
  }
  const bool is_same = now.status == then.status && now.state_hash == then.state_hash;
  if (is_same || then.status == PointStatus::crashed) return kSuccess;
  fmt::print(stderr,
             "{}: this is not the run of results.csv: {} with state_hash {}, there {} with {}: was "
             "it made on another machine?\n",
             kSweep, name_of(now.status), now.state_hash, name_of(then.status), then.state_hash);
  return kRunFailed;
}

// The points of --points that are not done.
int run_task(const Sweep& sweep, const StudyFolder& folder, const ShardIndex& before,
             const SweepArguments& arguments) {
  const Plan& plan = sweep.plan();
  std::vector<std::size_t> points = points_of_task(arguments.points, plan.size());
  std::erase_if(points, [&](std::size_t point) { return before.has(point); });
  if (has_to_stop(plan, before)) return kRunFailed;
  const int status = run_here(sweep, folder, points, arguments, true);
  if (status == kInterrupted) {
    fmt::print(stderr, "{}: interrupted before all points of this task were run\n", kSweep);
  }
  const bool may_stop = plan.study().on_failure == OnFailure::stop;
  if (!may_stop && !arguments.isolate) return status;  // in this process, all or interrupted
  const ShardIndex index(folder.shards(), plan.size());
  if (may_stop && has_to_stop(plan, index)) return kRunFailed;
  const bool is_done = std::all_of(points.begin(), points.end(),
                                   [&](std::size_t point) { return index.has(point); });
  if (status == kSuccess && !is_done) fail_for_undone(folder, index);
  return status;
}

int sweep(const Catalogue& catalogue, const SweepArguments& arguments) {
  if (!arguments.points.empty()) {
    stop_on_signals({SIGUSR1});  // a scheduler's warning that time is up
  } else {
    stop_on_signals();
  }
  Opened opened = open_target(catalogue, arguments);
  StudyFolder& folder = opened.folder;
  const bool only_looks = arguments.status || arguments.collect || !arguments.replay.empty() ||
                          !arguments.points.empty();
  if (opened.is_folder) fs::current_path(folder.working_folder());
  if (arguments.slurm || arguments.print_tasks) check_for_scripts(folder);
  Sweep sweep(catalogue, std::move(opened.study));
  const Plan& plan = sweep.plan();

  if (arguments.dry_run) {
    warn(kSweep, sweep.check());
    print_dry_run(sweep, arguments);
    return kSuccess;
  }
  const bool is_there = folder.is_there();
  if (!is_there && only_looks) {
    throw std::invalid_argument(folder.path().string() + ": has no study.toml: nothing was begun");
  }
  std::optional<ShardIndex> before;  // what was there
  if (is_there) {
    folder.check_is(plan.study());
    before.emplace(folder.shards(), plan.size());
    if (arguments.status) {
      print_status(plan, folder, *before);
      return kSuccess;
    }
    if (arguments.collect) {
      collect(catalogue, plan, *before, folder, arguments);
      return kSuccess;
    }
    if (!arguments.rerun) folder.check_made_by_this(sweep.file(), *before);
    if (!arguments.replay.empty()) return replay_point(sweep, folder, *before, arguments);
  }
  if (!is_there || arguments.rerun) {
    if (is_there) check_not_queued(queued(folder, plan.size()), folder, "--rerun");
    warn(kSweep, sweep.check());                         // while what is there is still there
    if (!arguments.isolate) check_asked_metrics(sweep);  // else a run may end this process
    if (is_there) {
      folder.make_anew(plan.study(), sweep.file());
    } else {
      folder.make(plan.study(), sweep.file());
    }
    before.emplace(folder.shards(), plan.size());
  }
  sweep.keep_in(folder);
  if (!arguments.points.empty()) return run_task(sweep, folder, *before, arguments);
  return go_on(catalogue, sweep, folder, *before, arguments);
}

}  // namespace

int sweep_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  return guarded(kSweep, [&] {
    CLI::App app(own_program_name() + " sweep: very many runs, as one table.", kSweep);
    SweepArguments arguments;
    describe(app, arguments);
    if (const auto status = parse(app, argc, argv)) return *status;
    if (arguments.isolate) arguments.request.of_task = {"--isolate"};
    return sweep(catalogue, arguments);
  });
}

}  // namespace breakwater
