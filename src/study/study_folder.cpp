#include <breakwater/study/study_folder.h>

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <breakwater/config/toml_file.h>
#include <breakwater/config/toml_text.h>
#include <breakwater/experiment/version.h>
#include <breakwater/record/file_hash.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/paths.h>
#include <breakwater/signals/input_file.h>

namespace breakwater {
namespace {

namespace fs = std::filesystem;

// The lines of a study's text, except for the working folder, which changes no result.
std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    const bool is_text = !line.empty() && !line.starts_with('#');
    if (is_text && !line.starts_with("working_folder = ")) lines.push_back(line);
  }
  return lines;
}

// The first line of `now` that `then` lacks, and that is no table's head.
std::string first_difference(const std::string& now, const std::string& then) {
  const std::vector<std::string> old = lines_of(then);
  for (const std::string& line : lines_of(now)) {
    const bool is_old = std::find(old.begin(), old.end(), line) != old.end();
    if (!is_old && !line.starts_with('[')) return line;
  }
  return "something is left out";
}

// Whether a folder contains only what an interrupted make() leaves.
bool is_begun(const fs::path& folder, const std::string& file) {
  if (!fs::is_directory(folder)) return false;
  return std::all_of(fs::directory_iterator(folder), fs::directory_iterator(),
                     [&](const auto& entry) {
                       const std::string name = entry.path().filename().string();
                       return name.starts_with("." + file + ".") ||
                              (name == "shards" && fs::is_empty(entry.path()));
                     });
}

std::string made_by(const fs::path& file, const char* key) {
  const toml::table table = parse_toml_file(file.string());
  return table["made_by"][key].value_or(std::string());
}

std::string maker() {
  return own_parts.empty() ? program_hash() : fingerprint({program_hash(), own_parts});
}

}  // namespace

std::string StudyFolder::origin() const {
  return fingerprint({made_by(study_file(), "program"), made_by(study_file(), "scenario_file")});
}

ShardIndex StudyFolder::index(std::size_t points, const ShardIndex::Asked& asked) const {
  return {shards(), points,
          [&, origin = origin()](std::size_t point) { return asked_of(origin, asked(point)); }};
}

std::string StudyFolder::whole_text(const std::string& text, const ScenarioFile& file) {
  return text + fmt::format(
                    "\n# What the results are of; it is gone on with nothing else.\n"
                    "[made_by]\nbreakwater = {}\ngit_commit = {}\nprogram = {}\n"
                    "scenario_file = {}\nworking_folder = {}\n",
                    toml_string(kVersion), toml_string(kGitCommit), toml_string(maker()),
                    toml_string(text_hash(file.text())), toml_string(fs::current_path().string()));
}

void StudyFolder::make_folders() const {
  std::error_code error;
  fs::create_directories(shards(), error);
  if (error) {
    throw std::invalid_argument(
        fmt::format("{}: cannot be made ({})", folder_.string(), error.message()));
  }
}

void StudyFolder::make(const std::string& text, const ScenarioFile& file) const {
  // Another process may begin the study at this moment. is_there() comes last because make() writes
  // the file last.
  if (fs::exists(folder_) && !is_begun(folder_, kind_.file) && !is_there()) {
    throw std::invalid_argument(folder_.string() +
                                ": holds something that is not a study; it is left alone");
  }
  make_folders();
  const std::string whole = whole_text(text, file);
  if (create_file(study_file(), whole)) return;
  check_is(whole, bytes_of(study_file()));
}

void StudyFolder::make_anew(const std::string& text, const ScenarioFile& file) const {
  check_is_ours();
  for (const char* name :
       {"shards", "runs", "slurm", "candidates", "front", "tuned", "results.csv", "results.sqlite",
        "comparison.csv", "front.csv", "tuned.csv", "ranking.json", "indices.csv", "report.html"}) {
    fs::remove_all(folder_ / name);
  }
  make_folders();
  replace_file(study_file(), whole_text(text, file));
}

Study StudyFolder::study() const {
  return read_study(parse_toml_file(study_file().string()), study_file().string());
}

fs::path StudyFolder::working_folder() const {
  check_is_ours();
  return made_by(study_file(), "working_folder");
}

void StudyFolder::grow(const std::string& text, const ScenarioFile& file) const {
  replace_file(study_file(), whole_text(text, file));
}

bool StudyFolder::is_same(const std::string& now, const std::string& then) {
  return lines_of(now) == lines_of(then);
}

void StudyFolder::check_is(const std::string& now, const std::string& then) const {
  if (is_same(now, then)) return;
  throw std::invalid_argument(
      fmt::format("{}: holds another study: here it is `{}`; leave it be with another --out",
                  folder_.string(), first_difference(now, then)));
}

void StudyFolder::fail_to_go_on(const std::string& what) const {
  throw std::invalid_argument(
      fmt::format("{}: {}: go on with what it was begun with, or begin anew with --rerun",
                  folder_.string(), what));
}

void StudyFolder::check_made_by_this(const ScenarioFile& file, const ShardIndex& index) const {
  if (made_by(study_file(), "program") != maker()) {
    fail_to_go_on(fmt::format("its results are of another program{} (breakwater {}, {})",
                              own_parts.empty() ? "" : " or another class in Python",
                              made_by(study_file(), "breakwater"),
                              made_by(study_file(), "git_commit")));
  }
  if (made_by(study_file(), "scenario_file") != text_hash(file.text())) {
    fail_to_go_on(file.file() + " has changed since");
  }
  index.check_models();
  for (const auto& [name, hash] : index.models()) {
    const auto found = find_file(name, folder_);
    if (!found || file_hash(*found) != hash) fail_to_go_on(name + " has changed since");
  }
}

void StudyFolder::check_is_ours() const {
  if (!made_by(study_file(), "program").empty()) return;
  throw std::invalid_argument(
      fmt::format("{}: was not left by a study: the study's folder must be another (--out)",
                  study_file().string()));
}

bool is_study_folder(const fs::path& folder) {
  std::error_code ignored;  // a folder that cannot be read is no study
  return fs::is_directory(folder / "shards", ignored) &&
         (fs::exists(folder / kSweep.file, ignored) || fs::exists(folder / kTune.file, ignored));
}

}  // namespace breakwater
