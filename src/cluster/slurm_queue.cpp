#include <breakwater/cluster/slurm_queue.h>

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>

#include <breakwater/cluster/slurm_answers.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/signals/environment.h>
#include <breakwater/study/sweep.h>

namespace breakwater {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostLogsShown = 5;

// Variables that describe the current job: sbatch inside a job would pass them on to the tasks of
// the new job, such as SLURM_CPUS_PER_TASK. Variables about the cluster and the user may stay.
bool is_of_a_job(std::string_view variable) {
  return (variable.starts_with("SLURM_") || variable.starts_with("SLURMD_")) &&
         variable != "SLURM_CONF" && variable != "SLURM_CLUSTERS" && variable != "SLURM_JWT";
}

std::vector<std::string> lines_of_file(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string text_of(const std::string& job, const std::vector<QueuedTask>& tasks) {
  std::map<std::string, int> states;
  for (const QueuedTask& task : tasks) {
    if (task.job != job) continue;
    ++states[task.reason.empty() ? task.state : task.state + " (" + task.reason + ")"];
  }
  std::vector<std::string> parts;
  for (const auto& [state, count] : states) parts.push_back(fmt::format("{} {}", count, state));
  return parts.empty() ? "" : fmt::format("job {}: {}", job, fmt::join(parts, ", "));
}

// The last line of a task's log.
std::string last_words(const fs::path& log) {
  std::string last;
  for (const std::string& line : lines_of_file(log)) {
    if (!line.empty()) last = line;
  }
  if (!last.empty()) return one_line(last);
  return "no log: the task was cancelled before it began, or its node cannot see the folder";
}

// One array job: DIR/slurm/N with job.sh, tasks (the points of each task, one line each), job (its
// number) and TASK.log. A tuning also has candidates (the keys of its runs).
struct Submission {
  fs::path folder;
  std::string job;
  std::vector<std::string> tasks;
};

// All accepted submissions, the last one first.
std::vector<Submission> submissions(const StudyFolder& folder) {
  std::map<long, Submission, std::greater<>> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder.path() / "slurm", error), end; !error && entry != end;
       entry.increment(error)) {
    const std::vector<std::string> job = lines_of_file(entry->path() / "job");
    if (job.empty()) continue;
    found[std::strtol(entry->path().filename().c_str(), nullptr, 10)] = {
        entry->path(), job.front(), lines_of_file(entry->path() / "tasks")};
  }
  // A task with an unreadable state may still be in the queue. Do not submit it again.
  if (error && error != std::errc::no_such_file_or_directory) {
    throw std::invalid_argument(fmt::format("{}: cannot be read ({})",
                                            (folder.path() / "slurm").string(), error.message()));
  }
  std::vector<Submission> all;
  for (auto& [number, submission] : found) all.push_back(std::move(submission));
  return all;
}

}  // namespace

std::vector<std::string> ask_slurm(const std::vector<std::string>& words) {
  const bool is_in_a_job = environment("SLURM_JOB_ID").has_value();
  ReadProgram program(words, true, is_in_a_job ? is_of_a_job : nullptr);
  std::vector<std::string> lines;
  while (const auto line = program.next()) {
    if (!line->empty()) lines.push_back(*line);
  }
  const int status = program.wait();
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return lines;
  const std::string said = lines.empty() ? "has failed" : fmt::format("{}", fmt::join(lines, "; "));
  throw std::invalid_argument(said.starts_with(words.front() + ": ") ? said
                                                                     : words.front() + ": " + said);
}

Queued queued(const StudyFolder& folder, std::size_t points) {
  Queued result;
  result.points.resize(points);
  const std::vector<Submission> all = submissions(folder);
  if (all.empty()) return result;
  result.is_asked = true;
  // All tasks of this user.
  const std::vector<QueuedTask> tasks = queued_tasks(
      ask_slurm({"squeue", "--noheader", "--array", fmt::format("--user={}", geteuid()),
                 fmt::format("--format={}", kQueueFormat)}));
  std::vector<std::string> texts;
  for (const Submission& submission : all) {
    for (const QueuedTask& task : tasks) {
      if (task.job != submission.job || task.index > submission.tasks.size()) continue;
      for (const std::size_t point : parse_points(submission.tasks[task.index - 1], points)) {
        result.points[point] = true;
      }
    }
    const std::string text = text_of(submission.job, tasks);
    if (!text.empty()) texts.push_back(text);
  }
  result.text = fmt::format("{}", fmt::join(texts, "; "));
  return result;
}

std::optional<Queued> queued_if_known(const StudyFolder& folder, std::size_t points) {
  try {
    return queued(folder, points);
  } catch (const std::invalid_argument& error) {
    fmt::print(stderr, "{}: cannot find out whether its tasks are in a queue ({})\n",
               folder.kind().command, one_line(error.what()));
    return std::nullopt;
  }
}

void check_not_queued(const Queued& queue, const StudyFolder& folder, const std::string& what) {
  if (queue.text.empty()) return;
  throw std::invalid_argument(
      fmt::format("{}: {} is still in the queue ({}): end it first with scancel", what,
                  folder.path().string(), queue.text));
}

void print_slurm_status(const StudyFolder& folder, const ShardIndex& index) {
  const std::vector<Submission> all = submissions(folder);
  if (all.empty()) return;
  std::vector<bool> is_explained;
  try {
    const Queued queue = queued(folder, index.points());
    if (!queue.text.empty()) fmt::print("in the queue: {}\n", queue.text);
    is_explained = queue.points;
  } catch (const std::invalid_argument& error) {
    fmt::print("cannot find out what is in the queue: {}\n", error.what());
    return;
  }
  std::vector<fs::path> logs;
  for (const Submission& submission : all) {
    for (std::size_t task = 0; task < submission.tasks.size(); ++task) {
      bool is_unfinished = false;
      for (const std::size_t point : parse_points(submission.tasks[task], index.points())) {
        if (!index.has(point) && !is_explained[point]) is_unfinished = true;
        is_explained[point] = true;
      }
      if (is_unfinished) logs.push_back(submission.folder / fmt::format("{}.log", task + 1));
    }
  }
  if (logs.empty()) return;
  fmt::print("{} task{} ended before {} points were done:\n", logs.size(),
             logs.size() == 1 ? " has" : "s have", logs.size() == 1 ? "its" : "their");
  for (std::size_t i = 0; i < std::min(logs.size(), kMostLogsShown); ++i) {
    fmt::print("  {}: {}\n", logs[i].lexically_relative(folder.path()).string(),
               last_words(logs[i]));
  }
  if (logs.size() > kMostLogsShown) fmt::print("  … and {} more\n", logs.size() - kMostLogsShown);
}

}  // namespace breakwater
