#include <breakwater/cluster/slurm.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include <breakwater/cluster/slurm_answers.h>
#include <breakwater/cluster/slurm_queue.h>
#include <breakwater/config/toml_text.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/all_cores.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/signals/environment.h>
#include <breakwater/study/sweep.h>

namespace breakwater {
namespace {

namespace fs = std::filesystem;

constexpr int kWarning_s = 60;  // this long before a time limit

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

// A line of the script's head. The quotes allow any folder name.
std::string directive(const std::string& name, const std::string& value) {
  std::string quoted;
  for (const char c : value) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return fmt::format("#SBATCH --{}=\"{}\"\n", name, quoted);
}

// sbatch reads % in a file name as the beginning of a field: double it.
std::string without_fields(const std::string& path) {
  std::string text;
  for (const char c : path) text += c == '%' ? std::string("%%") : std::string(1, c);
  return text;
}

// The command of a task, without its points.
std::string task_command(const SlurmStudy& study, const SlurmRequest& request) {
  std::string text =
      fmt::format("{} {} {} --quiet", shell_quoted(own_program()), study.folder.kind().command,
                  shell_quoted(study.folder.path().string()));
  for (const std::string& option : request.of_task) text += " " + option;
  return text + " --points";
}

std::string job_script(const SlurmStudy& study, const fs::path& submission, std::size_t tasks,
                       const SlurmRequest& request) {
  std::string text = "#!/bin/bash\n";
  text += directive("job-name", std::string(study.folder.kind().command) + "-" +
                                    study.folder.path().filename().string());
  text += directive("array", request.parallel > 0 ? fmt::format("1-{}%{}", tasks, request.parallel)
                                                  : fmt::format("1-{}", tasks));
  text += directive("output", without_fields(submission.string()) + "/%a.log");
  text += directive("open-mode", "append");
  text += directive("chdir", fs::current_path().string());
  text += directive("signal", fmt::format("B:USR1@{}", kWarning_s));
  text += "#SBATCH --requeue\n";
  text += "fail() {\n  echo \"$(hostname): $1\" >&2\n  exit 127\n}\n";
  text += fmt::format(
      "[ -x {} ] || fail {}\nexec {} @{}:$SLURM_ARRAY_TASK_ID\n", shell_quoted(own_program()),
      shell_quoted("there is no " + own_program() + ": it must lie where all nodes see it"),
      task_command(study, request), shell_quoted((submission / "tasks").string()));
  return text;
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

struct LineOfFile {
  fs::path file;
  std::size_t line = 0;  // counted from 1
};

LineOfFile line_of_file(const std::string& text) {
  LineOfFile place;
  const std::size_t colon = text.rfind(':');
  const char* const end = text.data() + text.size();
  if (text.starts_with("@") && colon != std::string::npos) {
    const auto read = std::from_chars(text.data() + colon + 1, end, place.line);
    if (read.ec != std::errc() || read.ptr != end) place.line = 0;
  }
  if (place.line == 0) fail_for_points(text, "must be @FILE:LINE");
  place.file = text.substr(1, colon - 1);
  return place;
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
  const std::vector<std::string> config = ask_slurm({"scontrol", "show", "config"});
  return std::min(slurm_limit(config, "MaxArraySize") - 1,  // an index must stay below it
                  slurm_limit(config, "MaxJobCount"));
}

SubmittedJob submit(const SlurmStudy& study, const std::vector<std::size_t>& points,
                    const SlurmRequest& request) {
  const std::size_t tasks = std::min({request.tasks, most_tasks(), points.size()});
  const fs::path submission = new_submission(study.folder);
  replace_file(submission / "tasks", fmt::format("{}\n", fmt::join(shares(points, tasks), "\n")));
  if (!study.candidates.empty()) {
    replace_file(submission / "candidates", study.candidates);
  }
  const std::string script = (submission / "job.sh").string();
  replace_file(script, job_script(study, submission, tasks, request));
  std::vector<std::string> words = {"sbatch", "--parsable"};
  for (const std::string& option : request.options) {
    std::istringstream stream(option);
    for (std::string word; stream >> word;) words.push_back(word);
  }
  words.push_back(script);
  std::string job;
  std::vector<std::string> warnings;
  try {
    job = accepted_job(ask_slurm(words), warnings);
  } catch (const std::invalid_argument&) {
    fs::remove_all(submission);
    throw;
  }
  for (const std::string& warning : warnings) fmt::print(stderr, "{}\n", warning);
  replace_file(submission / "job", job + "\n");
  return {job, tasks};
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

void print_tasks(const SlurmStudy& study, const std::vector<std::size_t>& points,
                 const SlurmRequest& request) {
  if (points.empty()) return;
  for (const std::string& line : shares(points, std::min(request.tasks, points.size()))) {
    fmt::print("{} {}\n", task_command(study, request), line);
  }
}

std::vector<std::size_t> points_of_task(const std::string& text, std::size_t size) {
  if (!text.starts_with("@")) return parse_points(text, size);
  const LineOfFile place = line_of_file(text);
  std::ifstream stream(place.file);
  std::string line;
  for (std::size_t i = 0; i < place.line; ++i) {
    if (!std::getline(stream, line)) fail_for_points(text, "there is no such line");
  }
  return parse_points(line, size);
}

fs::path submission_of_task(const std::string& text) {
  return line_of_file(text).file.parent_path();
}

std::size_t task_threads() {
  const std::string given = environment("SLURM_CPUS_PER_TASK").value_or("");
  std::size_t threads = 0;
  std::from_chars(given.data(), given.data() + given.size(), threads);
  if (threads > 0) return threads;
  return environment("SLURM_JOB_ID") ? 1 : usable_cores();
}

void add_slurm_options(CLI::App& app, SlurmRequest& request) {
  app.add_option("--tasks", request.tasks,
                 fmt::format("split the work into this many tasks (default: {})", request.tasks))
      ->type_name("N")
      ->check(CLI::Range(1, 1000000))
      ->group(kOnCluster);
  app.add_option("--parallel", request.parallel, "run at most this many tasks at a time")
      ->type_name("M")
      ->check(CLI::Range(1, 1000000))
      ->group(kOnCluster);
  app.add_option("--sbatch", request.options, "pass these options to sbatch")
      ->type_name("OPTIONS")
      ->check(overriding)
      ->expected(1)
      ->take_all()
      ->group(kOnCluster);
}

}  // namespace breakwater
