// The folder of a study, which records the study and the program that made it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/study/plan.h>
#include <breakwater/study/shards.h>

namespace breakwater {

/// A kind of study: the command that makes and continues it, and the name of its file.
struct StudyKind {
  const char* command;
  const char* file;
};
inline constexpr StudyKind kSweep = {"sweep", "study.toml"};
inline constexpr StudyKind kTune = {"tune", "tune.toml"};

/// A hash of the user's parts in Python, which make the runs with the program; or empty.
inline std::string own_parts;

/// The folder of a study: study.toml (or tune.toml), shards/, runs/ and the collected results. Many
/// computers may share it over a network: no two processes write the same file, and no file is
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

  bool is_there() const { return std::filesystem::exists(study_file()); }
  /// The program and the scenario file that the study was begun with, for the lines of its shards.
  std::string origin() const;
  /// The results of the study's own runs. `asked` is PointSource::asked().
  ShardIndex index(std::size_t points, const ShardIndex::Asked& asked) const;
  /// Makes the folder with `text` in its file. Throws std::invalid_argument if the folder contains
  /// something else or another process has begun a different study in it, OutputError if it cannot
  /// be written.
  void make(const std::string& text, const ScenarioFile& file) const;
  /// Removes the results and begins again. Files of the user stay. Throws std::invalid_argument if
  /// the study.toml is not from a study.
  void make_anew(const std::string& text, const ScenarioFile& file) const;
  /// Gives the study that grows another file. Its results stay. Throws OutputError.
  void grow(const std::string& text, const ScenarioFile& file) const;
  /// Reads the study. Throws std::invalid_argument.
  Study study() const;
  /// Throws std::invalid_argument unless a study wrote the file of the folder.
  void check_is_ours() const;
  /// The folder in which the study was begun. Relative names of files start there. Throws as
  /// check_is_ours().
  std::filesystem::path working_folder() const;
  /// Whether both texts are the same study.
  static bool is_same(const std::string& now, const std::string& then);
  /// Throws std::invalid_argument unless both texts are the same study.
  void check_is(const std::string& now, const std::string& then) const;
  /// Throws std::invalid_argument unless this program began the study with the present scenario
  /// file, and the results are from the present model files.
  void check_made_by_this(const ScenarioFile& file, const ShardIndex& index) const;

 private:
  // The content of the file: the study, and the program and scenario file that make the results.
  static std::string whole_text(const std::string& text, const ScenarioFile& file);
  void make_folders() const;
  [[noreturn]] void fail_to_go_on(const std::string& what) const;

  std::filesystem::path folder_;
  StudyKind kind_;
};

/// Whether the folder is from a sweep or a tuning.
bool is_study_folder(const std::filesystem::path& folder);

}  // namespace breakwater
