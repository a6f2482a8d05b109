// The common part of `sweep` and `tune`: their options, and a study from its begin to its end.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <breakwater/cluster/slurm.h>
#include <breakwater/config/toml_file.h>
#include <breakwater/experiment/catalogue.h>
#include <breakwater/math/interface.h>
#include <breakwater/program/command_line.h>
#include <breakwater/study/executor.h>
#include <breakwater/study/study_folder.h>

namespace CLI {
class App;
}

namespace breakwater {

/// Options of both commands. If a command lacks an option, it keeps its default value.
struct StudyOptions {
  std::string target;
  std::string out;
  std::size_t jobs = 0;  ///< 0: all cores
  bool isolate = false;
  bool rerun = false;
  bool dry_run = false;
  bool quiet = false;
  bool status = false;
  bool collect = false;
  std::string replay;
  std::string points;  ///< points of a task
  bool slurm = false;
  bool wait = false;
  bool print_tasks = false;
  SlurmRequest request;

  bool is_task() const { return !points.empty(); }
};

/// Help texts that differ between the commands, and the groups of their options.
struct StudyOptionsHelp {
  const char* target;
  const char* out;
  const char* dry_run;
  const char* slurm;
  const char* how = "Options";
  const char* begun = "Options";  ///< for an existing study
};

/// Adds TARGET and the common options.
void add_study_options(CLI::App& app, StudyOptions& options, const StudyOptionsHelp& help);

/// The existing study in the folder TARGET. Its working folder becomes that of this process. Throws
/// std::invalid_argument (`TARGET: …`) if there is no such study.
StudyFolder begun_folder(const std::string& target, const StudyKind& kind);
/// TARGET as a file of a study, also a shipped one, or nothing.
std::optional<std::filesystem::path> file_of_study(const std::string& target);
/// The folder for a new study of this name.
StudyFolder new_folder(const StudyOptions& options, const std::string& name, const StudyKind& kind);

/// A text such as "about 2 min on 2 cores (4 min of processor time)\n".
std::string time_needed(double processor_time_s, std::size_t jobs);

/// One call of a command.
class StudyCommand : public Interface {
 public:
  /// From now on signals stop the command.
  StudyCommand(StudyFolder folder, StudyOptions options);

  /// Executes the options. Returns the exit status.
  int run();

 protected:
  const char* name() const { return folder_.kind().command; }
  ShardIndex index() const {
    return folder_.index(size(), [this](std::size_t point) { return source().asked(point); });
  }
  /// Runs points here or in child processes. Returns the number of undone points.
  std::size_t run_here(const std::vector<std::size_t>& points, ExecutorOptions options) const;

  virtual const PointSource& source() const = 0;
  virtual const ScenarioFile& file() const = 0;
  virtual std::size_t size() const = 0;
  /// The text of the study's file, and of the file in the folder.
  virtual std::string text() const = 0;
  virtual std::string text_there() const = 0;
  /// Throws std::invalid_argument unless the study in the folder, which is another one, may become
  /// this one.
  virtual void check_growth() const { folder_.check_is(text(), text_there()); }

  virtual void print_dry_run() const = 0;
  virtual void print_status(const ShardIndex& index) const = 0;
  /// Only for commands with the options --collect and --replay. Return the exit status.
  virtual int collect(const ShardIndex&) const { throw std::logic_error("there is no --collect"); }
  virtual int replay(const ShardIndex&) { throw std::logic_error("there is no --replay"); }
  /// Called before the first output. Throws std::invalid_argument for a mistake and prints
  /// warnings.
  virtual void check() const = 0;

  virtual std::vector<std::size_t> task_points() { return points_of_task(options_.points, size()); }
  /// Whether a failed run ends the study. Prints a message if so.
  virtual bool has_to_stop() const { return false; }
  /// Runs the points of a task, or all. Returns the same as run_here().
  virtual std::size_t make(const std::vector<std::size_t>& points) = 0;
  /// Throws OutputError.
  [[noreturn]] void fail_for_undone(std::size_t left) const;
  /// Runs the points that are missing. Returns the exit status.
  virtual int go_on(const ShardIndex& before) = 0;

  const StudyFolder folder_;
  StudyOptions options_;

 private:
  void begin(bool is_there) const;
  void grow(const ShardIndex& before) const;
  int run_task(const ShardIndex& before);
};

struct SweepOptions {
  StudyOptions study;
  RunChanges run;
  std::map<std::string, std::vector<std::string>>
      what;  ///< options of the study itself, such as "--vary"
  bool sqlite = false;
  bool all = false;  ///< print every table

  /// Whether an option defines the study.
  bool says_what() const;
};

void add_sweep_options(CLI::App& app, SweepOptions& options);

/// Merges KEY=VALUE into [set] of a study's file. Throws std::invalid_argument (`--set: reason`).
void lay_sets(const std::vector<std::string>& sets, const std::string& file, toml::table& tables);

/// Merges the options into the tables of a study file. Throws std::invalid_argument (`OPTION:
/// reason`).
void lay_on(const SweepOptions& options, toml::table& tables);

}  // namespace breakwater
