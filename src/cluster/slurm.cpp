#include <breakwater/cluster/slurm.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <ctime>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include <breakwater/record/output_error.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/study/plan.h>

namespace breakwater {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostLogsShown = 5;

// The lines of scripts/slurm.py. Throws std::invalid_argument with its last one if Slurm does not
// answer, and OutputError if the script cannot be run.
std::vector<std::string> ask_slurm(std::vector<std::string> words) {
  constexpr int kNoAnswer = 3;
  EndedProgram ended;
  try {
    ended = run_beside(script_words("slurm.py", std::move(words)));
  } catch (const std::invalid_argument& error) {
    throw OutputError(error.what());
  }
  if (ended.exit_status() == 0) return ended.said;
  const std::string reason = ended.take_reason();
  if (ended.exit_status() == kNoAnswer) throw std::invalid_argument(reason);
  throw OutputError("slurm.py: " + reason);
}

// Distributes `points` over `tasks` shares, one line each.
std::vector<std::string> shares(const std::vector<std::size_t>& points, std::size_t tasks) {
  std::vector<std::string> lines;
  for (std::size_t task = 0; task < tasks; ++task) {
    const auto at = [&](std::size_t n) {
      return points.begin() + static_cast<std::ptrdiff_t>(points.size() * n / tasks);
    };
    lines.push_back(print_points({at(task), at(task + 1)}));
  }
  return lines;
}

// Makes a new folder for each submission.
fs::path new_submission(const StudyFolder& folder) {
  for (int n = 1;; ++n) {
    fs::path submission = folder.path() / "slurm" / std::to_string(n);
    fs::create_directories(submission.parent_path());
    if (fs::create_directory(submission)) return submission;
  }
}

// The command of a task, without its points.
std::vector<std::string> task_command(const StudyFolder& folder, const SlurmRequest& request) {
  std::vector<std::string> words = {own_program(), folder.kind().command, folder.path().string(),
                                    "--quiet"};
  words.insert(words.end(), request.of_task.begin(), request.of_task.end());
  return words;
}

// A task with an unreadable state may still be in the queue: it is not submitted again.
bool has_submissions(const StudyFolder& folder) {
  const fs::path submissions = folder.path() / "slurm";
  std::error_code error;
  const fs::directory_iterator entry(submissions, error);
  if (error && error != std::errc::no_such_file_or_directory) {
    throw OutputError(
        fmt::format("{}: cannot be read ({})", submissions.string(), error.message()));
  }
  return entry != fs::directory_iterator();
}

// The last line of a task's log.
std::string last_words(const fs::path& log) {
  std::ifstream stream(log);
  std::string last;
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty()) last = line;
  }
  if (!last.empty()) return one_line(last);
  return "no log: the task was cancelled before it began, or its node cannot see the folder";
}

// A complaint about options of sbatch that would override those of the job script, such as
// --array; empty if there are none.
std::string overriding(const std::string& options) {
  // As getopt does, sbatch takes the begin of a name too.
  static constexpr std::array kLong = {"--array",  "--chdir",  "--open-mode",
                                       "--output", "--signal", "--wrap"};
  static constexpr std::array kShort = {"-a", "-D", "-o"};
  constexpr std::size_t kShortestBegin = 4;  // "--ar": all options with one letter are ambiguous
  std::istringstream words(options);
  for (std::string word; words >> word;) {
    const std::string name = word.substr(0, word.find('='));
    const bool is_long =
        name.size() >= kShortestBegin && std::any_of(kLong.begin(), kLong.end(), [&](auto option) {
          return std::string_view(option).starts_with(name);
        });
    const bool is_short = std::any_of(kShort.begin(), kShort.end(),
                                      [&](auto option) { return word.starts_with(option); });
    if (is_long || is_short) return word + ": is an option that the job script sets: leave it out";
  }
  return "";
}

[[noreturn]] void fail_for_points(const std::string& text, const std::string& reason) {
  throw std::invalid_argument("--points: " + text + ": " + reason);
}

}  // namespace

void check_for_scripts(const StudyFolder& folder) {
  for (const std::string& path :
       {folder.path().string(), fs::current_path().string(), own_program()}) {
    if (one_line(path) == path) continue;
    throw std::invalid_argument(
        path +
        ": has a newline or another control character, which no script may have: choose "
        "another folder");
  }
}

std::size_t most_tasks() {
  return std::stoul(ask_slurm({"limit"}).front());
}

SubmittedJob submit(const StudyFolder& folder, const std::vector<std::size_t>& points,
                    const SlurmRequest& request) {
  const std::size_t tasks = std::min({request.tasks, most_tasks(), points.size()});
  const fs::path submission = new_submission(folder);
  replace_file(submission / "tasks", fmt::format("{}\n", fmt::join(shares(points, tasks), "\n")));
  std::vector<std::string> words = {
      "submit", submission.string(),
      fmt::format("name={}-{}", folder.kind().command, folder.path().filename().string())};
  if (request.parallel > 0) words.push_back(fmt::format("parallel={}", request.parallel));
  for (const std::string& option : request.options) words.push_back("sbatch=" + option);
  for (const std::string& word : task_command(folder, request)) words.push_back("command=" + word);
  std::vector<std::string> said = ask_slurm(std::move(words));
  const std::string job = said.back();
  said.pop_back();
  for (const std::string& warning : said) fmt::print(stderr, "{}\n", warning);
  return {job, tasks};
}

std::vector<bool> Queued::points(std::size_t count) const {
  std::vector<bool> all(count);
  for (const SlurmTask& task : tasks) {
    for (const std::size_t point : task.points) all[point] = all[point] || task.is_queued;
  }
  return all;
}

Queued queued(const StudyFolder& folder, std::size_t points) {
  Queued result;
  if (!has_submissions(folder)) return result;
  for (const std::string& line : ask_slurm({"queue", folder.path().string()})) {
    const std::size_t first = line.find('\t'), second = line.find('\t', first + 1);
    if (second == std::string::npos) {
      result.text = line.substr(first + 1);
    } else {
      result.tasks.push_back({line.starts_with("queued"),
                              line.substr(first + 1, second - first - 1),
                              parse_points(line.substr(second + 1), points)});
    }
  }
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
  if (!has_submissions(folder)) return;
  Queued queue;
  try {
    queue = queued(folder, index.points());
  } catch (const std::invalid_argument& error) {
    fmt::print("cannot find out what is in the queue: {}\n", error.what());
    return;
  }
  if (!queue.text.empty()) fmt::print("in the queue: {}\n", queue.text);
  std::vector<bool> is_explained = queue.points(index.points());
  std::vector<fs::path> logs;
  for (const SlurmTask& task : queue.tasks) {
    bool is_unfinished = false;
    for (const std::size_t point : task.points) {
      if (!index.has(point) && !is_explained[point]) is_unfinished = true;
      is_explained[point] = true;
    }
    if (is_unfinished) logs.push_back(task.log);
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

void wait_for_queue(const StudyFolder& folder, std::size_t points) {
  // Wait for a quarter of the time so far before the next query, to spare the cluster.
  constexpr std::time_t kLongest_s = 15;
  std::string trouble;
  std::time_t waited_s = 0;
  while (!interrupted()) {
    try {
      if (queued(folder, points).text.empty()) return;
      trouble.clear();
    } catch (const std::invalid_argument& error) {
      if (error.what() != trouble && !interrupted()) {
        fmt::print(stderr, "{}\n", one_line(error.what()));
      }
      trouble = error.what();
    }
    const timespec pause = {std::clamp<std::time_t>(waited_s / 4, 1, kLongest_s), 0};
    waited_s += pause.tv_sec;
    nanosleep(&pause, nullptr);
  }
}

void print_tasks(const StudyFolder& folder, const std::vector<std::size_t>& points,
                 const SlurmRequest& request) {
  if (points.empty()) return;
  std::string command;
  for (const std::string& word : task_command(folder, request)) command += shell_word(word) + " ";
  for (const std::string& line : shares(points, std::min(request.tasks, points.size()))) {
    fmt::print("{}--points {}\n", command, line);
  }
}

std::vector<std::size_t> points_of_task(const std::string& text, std::size_t size) {
  if (!text.starts_with("@")) return parse_points(text, size);
  const std::size_t colon = std::min(text.rfind(':'), text.size() - 1);
  const char* const end = text.data() + text.size();
  std::size_t number = 0;  // counted from 1
  const auto read = std::from_chars(text.data() + colon + 1, end, number);
  if (read.ec != std::errc() || read.ptr != end || number == 0) {
    fail_for_points(text, "must be @FILE:LINE");
  }
  std::ifstream stream(text.substr(1, colon - 1));
  std::string line;
  for (std::size_t i = 0; i < number; ++i) {
    if (!std::getline(stream, line)) fail_for_points(text, "there is no such line");
  }
  return parse_points(line, size);
}

void add_slurm_options(CLI::App& app, SlurmRequest& request) {
  const auto count = [&](const char* name, std::size_t& target, const char* letter,
                         const std::string& help) {
    app.add_option(name, target, help)
        ->type_name(letter)
        ->check(CLI::Range(1, 1000000))
        ->group(kOnCluster);
  };
  count("--tasks", request.tasks, "N",
        fmt::format("split the work into this many tasks (default: {})", request.tasks));
  count("--parallel", request.parallel, "M", "run at most this many tasks at a time");
  app.add_option("--sbatch", request.options, "pass these options to sbatch")
      ->type_name("OPTIONS")
      ->check(overriding)
      ->expected(1)
      ->take_all()
      ->group(kOnCluster);
}

}  // namespace breakwater
