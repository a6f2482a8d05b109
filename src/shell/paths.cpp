#include <breakwater/shell/paths.h>

#include <fmt/format.h>

#include <cstdio>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <breakwater/signals/environment.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr const char* kVariable = "BREAKWATER_PATH";
// This link can be read even if the program's file was replaced.
constexpr const char* kOwnProgram = "/proc/self/exe";

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

bool is_source_tree(const fs::path& folder) {
  return is_folder(folder / "models") && is_folder(folder / "scenarios");
}

struct OwnSearch {
  std::mutex mutex;
  DataPlaces places;
  std::optional<SearchPath> path;  // made on first use
  bool has_warned = false;

  fs::path program() const {
    return places.program.empty() ? fs::read_symlink(kOwnProgram) : places.program;
  }
};

OwnSearch& own_search() {
  static OwnSearch search;
  return search;
}

SearchPath own_path() {
  OwnSearch& own = own_search();
  const std::lock_guard lock(own.mutex);
  if (!own.path) {
    own.path = search_path(environment(kVariable).value_or(""), own.program(), own.places);
    if (!std::exchange(own.has_warned, true)) {
      for (const std::string& warning : own.path->warnings) fmt::print(stderr, "{}\n", warning);
    }
  }
  return *own.path;
}

}  // namespace

void set_data_places(const DataPlaces& places) {
  OwnSearch& own = own_search();
  const std::lock_guard lock(own.mutex);
  own.places = places;
  own.path.reset();
}

fs::path program_file() {
  OwnSearch& own = own_search();
  const std::lock_guard lock(own.mutex);
  return own.places.program.empty() ? kOwnProgram : own.places.program;
}

SearchPath search_path(const std::string& variable, const fs::path& program,
                       const DataPlaces& places) {
  SearchPath path;
  const auto add = [&](const fs::path& folder, bool is_one) {
    path.candidates.push_back(folder);
    if (is_one) path.folders.push_back(folder);
  };
  for (const fs::path& folder : places.scenarios) add(folder, is_folder(folder));
  std::stringstream list(variable);
  for (std::string name; std::getline(list, name, ':');) {
    if (name.empty()) continue;
    const fs::path folder = fs::absolute(name).lexically_normal();
    const bool is_one = is_folder(folder);
    add(folder, is_one);
    if (!is_one) {
      path.warnings.push_back(
          fmt::format("warning: {}: {} is no folder", kVariable, folder.string()));
    }
  }
  for (fs::path folder = program.parent_path();; folder = folder.parent_path()) {
    const fs::path share = folder / "share" / "breakwater";
    add(share, is_folder(share));
    add(folder, is_source_tree(folder));
    if (folder == folder.parent_path()) break;
  }
  const fs::path& installation = places.installation;
  if (!installation.empty()) add(installation, is_folder(installation));
  return path;
}

std::optional<fs::path> look_for(const std::string& name) {
  for (const fs::path& folder : own_path().folders) {
    if (is_there(folder / name)) return folder / name;
  }
  return std::nullopt;
}

fs::path data_file(const std::string& name) {
  if (const auto found = look_for(name)) return *found;
  throw std::invalid_argument(fmt::format(
      "{} is in none of {}: name the folder that holds it in the environment variable {}", name,
      searched_places(), kVariable));
}

fs::path own_library(const std::string& name) {
  OwnSearch& own = own_search();
  const std::lock_guard lock(own.mutex);
  const fs::path file = fs::path("lib") / "breakwater" / name;
  for (fs::path folder = own.program(); folder != folder.parent_path();) {
    folder = folder.parent_path();
    if (is_there(folder / file)) return folder / file;
  }
  const fs::path& installation = own.places.installation;
  const fs::path share = installation.empty() ? own.program() : installation;
  return share.parent_path().parent_path() / file;
}

std::string searched_places() {
  std::string text;
  const SearchPath path = own_path();
  for (const fs::path& folder : path.folders.empty() ? path.candidates : path.folders) {
    text += (text.empty() ? "" : ", ") + folder.string();
  }
  return text;
}

std::optional<fs::path> find_file(const std::string& name, const fs::path& folder) {
  const fs::path path(name);
  if (path.is_absolute()) return path.lexically_normal();
  const fs::path beside = fs::absolute(folder / path).lexically_normal();
  return is_there(beside) ? beside : look_for(name);
}

std::string portable_path(const fs::path& file) {
  for (const fs::path& folder : own_path().folders) {
    const fs::path relative = file.lexically_relative(folder);
    if (relative.empty() || *relative.begin() == "..") continue;
    if (look_for(relative.string()) == folder / relative) return relative.string();
  }
  return file.string();
}

}  // namespace breakwater
