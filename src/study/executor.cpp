#include <breakwater/study/executor.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <map>
#include <mutex>
#include <new>
#include <set>
#include <stdexcept>
#include <utility>

#include <breakwater/math/float_environment.h>
#include <breakwater/shell/all_cores.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/signals/thread_time.h>
#include <breakwater/sim/engine_guard.h>
#include <breakwater/sim/model.h>
#include <breakwater/study/plan.h>

namespace breakwater {
namespace {

// Data that all points of a call share.
struct Common {
  const PointSource& source;
  KnownModels& models;
  Shard* shard = nullptr;
  bool is_task = false;
  std::mutex mutex = {};
  std::set<std::filesystem::path> folders = {};                      // already begun
  std::map<std::filesystem::path, std::set<std::string>> left = {};  // hidden names by folder

  // Points with the same key are the same run, so only one writes its folder.
  bool begin(const std::filesystem::path& folder) {
    const std::lock_guard lock(mutex);
    return folders.insert(folder).second;
  }
  const std::set<std::string>& left_beside(const std::filesystem::path& folder) {
    const std::lock_guard lock(mutex);
    const auto [names, is_new] = left.try_emplace(folder.parent_path());
    if (is_new) names->second = hidden_names_in(names->first);
    return names->second;
  }
};

// A fault of the machine is not a result. This check also detects "Too many open files".
void check_machine(const std::string& key, const std::string& reason) {
  const int descriptor = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    throw OutputError(fmt::format("point {} is left undone: {}; no file can be opened ({})", key,
                                  reason, std::strerror(errno)));
  }
  close(descriptor);
}

// Fills in `result`. Its number is already set.
void fill(PointResult& result, RunControl control, Common& common) {
  const std::size_t number = result.number;
  const PointSource& source = common.source;
  KnownModels& known = common.models;
  const double begin_s = thread_time_s();
  const auto start = std::chrono::steady_clock::now();
  PreparedRun run;
  EndedRun ended;
  Recording& recording = ended.recording;
  result.asked = source.asked(number);
  try {
    if (common.is_task) common.shard->begin(number, "");
    run = source.prepare(number);
    ended.models = known.of(run.model_files);
    result.key = point_key(run.config_text, ended.models);
    if (common.shard != nullptr) common.shard->add(ended.models);
    if (common.is_task) common.shard->begin(number, result.key);
    control.logs = !source.folder(number, result.key, false).empty();
    recording = run.scenario->run(control);
  } catch (const OutOfMemory&) {
    throw;
  } catch (const std::invalid_argument& error) {
    result.status = PointStatus::refused;
    if (result.key.empty()) result.key = result.asked;
    result.reason = error.what();
    check_machine(result.key, result.reason);
    known.check_unchanged();  // somebody may be writing the file
    return;
  }
  known.check_unchanged(run.model_files);
  result.state_hash = fmt::format("{:016x}", recording.state_hash);
  if (recording.failure) {
    result.status = PointStatus::failed;
    result.reason =
        fmt::format("at {:.6g} s: {}", recording.failure->time_s, recording.failure->reason);
  }
  for (const Metric& metric : recording.metrics)
    result.metrics.emplace_back(metric.name, metric.value);
  const std::filesystem::path folder =
      source.folder(number, result.key, recording.failure.has_value());
  if (!folder.empty() && common.begin(folder)) {
    if (!control.logs) {
      control.logs = true;
      recording = run.scenario->run(control);
      known.check_unchanged(run.model_files);
    }
    ended.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    RunFolder target(folder, &common.left_beside(folder));
    write_run(run, ended, target);
  }
  result.cost_s = thread_time_s() - begin_s;
}

PointResult execute(std::size_t number, const RunControl& control, Common& common) {
  const math::FloatEnvironment floats;
  PointResult result;
  result.number = number;
  try {
    fill(result, control, common);
    if (result.status == PointStatus::refused) {
      // A fault of the machine that has passed, such as an unreadable file, is not a result.
      PointResult again;
      again.number = number;
      fill(again, control, common);
      result = std::move(again);
    }
  } catch (const std::bad_alloc&) {
    const std::string& key = result.key.empty() ? result.asked : result.key;
    throw OutOfMemory(fmt::format("point {}: there is no memory for it", key));
  }
  return result;
}

// A large number, so that the start of a process and its look at finished points cost little. A
// copy of this process has a single point: parts in Python begin each run as they were given.
std::size_t most_points_of_a_child() {
  return start_copy == nullptr ? 1000 : 1;
}

// Raises the limit of open files to the system's maximum: each thread and each child process needs
// some.
void allow_many_files() {
  static std::once_flag is_allowed;
  std::call_once(is_allowed, [] {
    rlimit limit = {};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
  });
}

// The state that all threads of run_isolated() share. Each thread has one child at a time.
class Children {
 public:
  Children(const std::vector<std::size_t>& points, const PointSource& source,
           const StudyFolder& folder, Shard& shard, const ExecutorOptions& options)
      : points_(points), source_(source), folder_(folder), shard_(shard), options_(options) {}

  // Runs points[begin] to points[end - 1] with as many children as necessary.
  void run(std::size_t begin, std::size_t end) {
    try {
      while (begin < end && !is_stopped_) begin = run_child(begin, end);
    } catch (...) {
      is_stopped_ = true;  // stops the other children too
      throw;
    }
  }

 private:
  // Returns where the next child continues.
  std::size_t run_child(std::size_t begin, std::size_t end) {
    const std::vector<std::size_t> rest(points_.begin() + static_cast<std::ptrdiff_t>(begin),
                                        points_.begin() + static_cast<std::ptrdiff_t>(end));
    const std::vector<std::string> words = {own_program(),
                                            folder_.kind().command,
                                            folder_.path().string(),
                                            "--points",
                                            print_points(rest),
                                            "--jobs",
                                            "1",
                                            "--quiet"};
    std::size_t next = begin;
    ProcessResults written;
    EndedProgram ended = run_beside(words, [&](pid_t child) {
      const std::size_t before = written.results.size();
      written = results_of_process(folder_.shards(), child, std::move(written));
      for (std::size_t i = before; i < written.results.size(); ++i) {
        // An earlier process may have had the same process number.
        const PointResult& result = written.results[i];
        const std::size_t nth = place_of(result.number, begin, end);
        if (nth == end || result.asked != asked_of(origin_, source_.asked(result.number))) continue;
        next = nth + 1;
        finish(nth, result);
      }
      return has_to_stop();
    });
    // A child that was still loading ends by the signal without a message.
    const bool has_stopped = has_to_stop();
    const std::optional<int> status = ended.exit_status();
    const bool is_over = status && (*status == kInterrupted || *status == kRunFailed);
    if (is_over || status == kUsage) {
      const std::string reason = ended.take_reason();
      ended.repeat_said();
      if (!is_over && !has_stopped) throw std::invalid_argument(reason);
      is_stopped_ = true;
      return end;
    }
    ended.repeat_said();
    if (has_stopped || next == end || status == kSuccess) return end;
    // The child may have left out points that another process did.
    const std::size_t at = written.begun ? place_of(*written.begun, next, end) : end;
    if (status || at == end) {
      throw std::invalid_argument("--isolate: a process of the study ended with " + ended.end());
    }
    PointResult lost;
    lost.number = points_[at];
    lost.key = written.begun_key;
    lost.asked = source_.asked(lost.number);
    if (ended.has_crashed()) {
      if (lost.key.empty()) lost.key = lost.asked;
      lost.status = PointStatus::crashed;
      lost.reason = ended.end();
      shard_.add(lost);
      finish(at, lost);
    } else {
      fmt::print(stderr, "{}: point {} is left undone: its process was ended by {}\n",
                 folder_.kind().command, lost.key.empty() ? std::to_string(lost.number) : lost.key,
                 ended.end());
    }
    return at + 1;
  }

  // The index of a point, searched from points[begin] on; `end` if it is not there.
  std::size_t place_of(std::size_t point, std::size_t begin, std::size_t end) const {
    const auto first = points_.begin();
    const auto last = first + static_cast<std::ptrdiff_t>(end);
    const auto found = std::lower_bound(first + static_cast<std::ptrdiff_t>(begin), last, point);
    return found != last && *found == point ? static_cast<std::size_t>(found - first) : end;
  }

  void finish(std::size_t nth, const PointResult& result) {
    if (options_.progress) options_.progress(nth, 1.0);
    if (options_.on_result) options_.on_result(result);
  }

  bool has_to_stop() {
    if (options_.has_to_stop()) is_stopped_ = true;
    return is_stopped_;
  }

  const std::vector<std::size_t>& points_;
  const PointSource& source_;
  const StudyFolder& folder_;
  const std::string origin_ = folder_.origin();
  Shard& shard_;
  const ExecutorOptions& options_;
  std::atomic<bool> is_stopped_ = false;
};

}  // namespace

PointResult run_point(std::size_t point, const PointSource& source, const RunControl& control) {
  KnownModels known;
  const SharedModels shared([&](const std::string& file) { known.of({file}); });
  Common common{source, known};
  return execute(point, control, common);
}

std::size_t run_points(const std::vector<std::size_t>& points, const PointSource& source,
                       Shard& shard, const ExecutorOptions& options) {
  allow_many_files();
  KnownModels own;
  KnownModels& known = options.models != nullptr ? *options.models : own;
  const SharedModels shared([&](const std::string& file) { known.of({file}); });
  Common common{source, known, &shard, options.is_task};
  std::atomic<std::size_t> finished = 0;
  try {
    on_all_cores(
        points.size(),
        [&](std::size_t i) {
          if (options.has_to_stop()) throw Interrupted();
          RunControl control;
          if (options.progress) {
            control.progress = [&, i](double fraction) { options.progress(i, fraction); };
          }
          if (!options.is_task) control.stop = options.stop;
          const PointResult result = execute(points[i], control, common);
          shard.add(result);
          ++finished;
          if (options.progress) options.progress(i, 1.0);
          if (options.on_result) options.on_result(result);
        },
        options.threads);
  } catch (const Interrupted&) {
  }
  return finished;
}

void run_isolated(const std::vector<std::size_t>& points, const PointSource& source,
                  const StudyFolder& folder, Shard& shard, const ExecutorOptions& options) {
  allow_many_files();
  const std::size_t jobs = options.threads > 0 ? options.threads : usable_cores();
  const std::size_t share =
      std::clamp<std::size_t>(points.size() / (8 * jobs), 1, most_points_of_a_child());
  Children children(points, source, folder, shard, options);
  on_all_cores((points.size() + share - 1) / share,
               [&](std::size_t nth) {
                 children.run(nth * share, std::min((nth + 1) * share, points.size()));
               },
               jobs);
}

}  // namespace breakwater
