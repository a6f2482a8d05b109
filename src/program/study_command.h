// A study from its beginning to its end: what `sweep` and `tune` do alike.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/cluster/slurm.h>
#include <breakwater/experiment/catalogue.h>
#include <breakwater/study/executor.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// Options of both commands, besides what is run. An option that a command does not have stays as
/// it is here.
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
  std::string points;  ///< of a task
  bool slurm = false;
  bool wait = false;
  bool print_tasks = false;
  SlurmRequest request;

  bool is_task() const { return !points.empty(); }
};

/// The help of what each command says in its own words, and the groups that its options stand in.
struct StudyOptionsHelp {
  const char* target;
  const char* out;
  const char* dry_run;
  const char* slurm;
  const char* how = "Options";
  const char* begun = "Options";  ///< with a study that was begun
};

/// TARGET and the options that both have.
void add_study_options(CLI::App& app, StudyOptions& options, const StudyOptionsHelp& help);

/// TARGET as the folder of a study of this kind, whose working folder becomes this process' own.
/// Throws std::invalid_argument, `TARGET: …`, if it is none.
StudyFolder begun_folder(const std::string& target, const StudyKind& kind,
                         const std::string& what_it_is);
/// TARGET as a file that tells of a study; shipped ones are found from everywhere.
std::optional<std::filesystem::path> file_of_study(const std::string& target);
/// Where a study of that name is made.
StudyFolder new_folder(const StudyOptions& options, const std::string& name, const StudyKind& kind);

/// "about 2 min on 2 cores (4 min of processor time)\n".
std::string time_needed(double processor_time_s, std::size_t jobs);

/// One call of a command.
class StudyCommand {
 public:
  /// From now on signals stop it.
  StudyCommand(StudyFolder folder, StudyOptions options);
  virtual ~StudyCommand() = default;
  StudyCommand(const StudyCommand&) = delete;
  StudyCommand& operator=(const StudyCommand&) = delete;

  /// Does what the options say. Returns the exit status.
  int run();

 protected:
  const char* name() const { return folder_.kind().command; }
  ShardIndex index() const { return {folder_.shards(), size()}; }
  /// Runs points here, or in processes of their own. Returns how many of them no process has done.
  std::size_t run_here(const std::vector<std::size_t>& points, ExecutorOptions options) const;

  virtual const PointSource& source() const = 0;
  virtual const ScenarioFile& file() const = 0;
  virtual std::size_t size() const = 0;
  /// The text of the study's file, and of the one in the folder.
  virtual std::string text() const = 0;
  virtual std::string text_there() const = 0;

  virtual void print_dry_run() const = 0;
  virtual void print_status(const ShardIndex& index) const = 0;
  /// A command without the option has no use for it, and for replay(): std::logic_error.
  virtual void collect(const ShardIndex& index) const;
  virtual int replay(const ShardIndex& index);
  /// Before anything is made: throws std::invalid_argument for what is wrong, warns of the rest.
  virtual void check() const = 0;

  virtual std::vector<std::size_t> task_points() { return points_of_task(options_.points, size()); }
  /// Whether a result ends the study, which is then said.
  virtual bool has_to_stop() const { return false; }
  /// Makes points of a task, or all; as run_here().
  virtual std::size_t make(const std::vector<std::size_t>& points) = 0;
  /// Throws OutputError.
  [[noreturn]] void fail_for_undone(std::size_t left) const;
  /// Makes what is not there. Returns the exit status.
  virtual int go_on(const ShardIndex& before) = 0;

  const StudyFolder folder_;
  StudyOptions options_;

 private:
  void begin(bool is_there) const;
  int run_task(const ShardIndex& before);
};

}  // namespace breakwater
