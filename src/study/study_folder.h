// A study's folder: which study it is, and what made it.
#pragma once

#include <filesystem>
#include <string>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/study/plan.h>
#include <breakwater/study/shards.h>

namespace breakwater {

/// The command that makes studies of a kind and goes on with them, and the file that says what one
/// is.
struct StudyKind {
  const char* command;
  const char* file;
};
inline constexpr StudyKind kSweep = {"sweep", "study.toml"};
inline constexpr StudyKind kTune = {"tune", "tune.toml"};

/// DIR with study.toml (of a tuning: tune.toml), shards/, runs/ and what is collected from them. It
/// may lie on a file system that many computers share: no file is written by two processes, none is
/// locked.
class StudyFolder {
 public:
  StudyFolder(std::filesystem::path folder, const StudyKind& kind)
      : folder_(std::move(folder)), kind_(kind) {}

  const std::filesystem::path& path() const { return folder_; }
  const StudyKind& kind() const { return kind_; }
  std::filesystem::path study_file() const { return folder_ / kind_.file; }
  std::filesystem::path shards() const { return folder_ / "shards"; }
  std::filesystem::path run(const std::string& key) const { return folder_ / "runs" / key; }

  bool is_there() const;
  /// Makes the folder with its file, which says `text`. Throws std::invalid_argument if DIR holds
  /// something else, or another process has begun another study in it by now; OutputError if it
  /// cannot be written.
  void make(const std::string& text, const ScenarioFile& file) const;
  /// Removes the results, so that the study begins anew; nothing of a user's own. Throws
  /// std::invalid_argument if no study left its study.toml.
  void make_anew(const std::string& text, const ScenarioFile& file) const;
  /// The study that it holds. Throws std::invalid_argument.
  Study study() const;
  /// Where it was begun, from which relative names of files count.
  std::filesystem::path working_folder() const;
  /// Throws std::invalid_argument, one line, unless what it holds is what is to be. Where it runs
  /// changes no result: another account or time limit is the same study.
  void check_is(const std::string& now, const std::string& then) const;
  /// Throws std::invalid_argument, one line, unless it was begun by this program, with the scenario
  /// file that is there now, and its results are of the models that are there now.
  void check_made_by_this(const ScenarioFile& file, const ShardIndex& index) const;

 private:
  // The file, with what makes the results.
  static std::string whole_text(const std::string& text, const ScenarioFile& file);
  void make_folders() const;
  [[noreturn]] void fail_to_go_on(const std::string& what) const;
  void check_is_ours() const;
  void check_made_by_this(const ScenarioFile& file) const;

  std::filesystem::path folder_;
  StudyKind kind_;
};

}  // namespace breakwater
