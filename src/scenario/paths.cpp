#include <breakwater/scenario/paths.h>

#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

bool holds_the_data(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(folder / "models", error) &&
         fs::is_directory(folder / "scenarios", error);
}

// Where the data may be, in that order.
std::vector<fs::path> candidates() {
  std::vector<fs::path> folders;
  if (const char* variable = std::getenv("BREAKWATER_PATH")) {
    std::stringstream list(variable);
    for (std::string folder; std::getline(list, folder, ':');) {
      if (!folder.empty()) folders.push_back(fs::absolute(folder));
    }
  }
  const fs::path binary = fs::read_symlink("/proc/self/exe");
  for (fs::path folder = binary.parent_path();; folder = folder.parent_path()) {
    folders.push_back(folder / "share" / "breakwater");
    folders.push_back(folder);
    if (folder == folder.root_path()) return folders;
  }
}

fs::path find_data_root() {
  std::string searched;
  for (const fs::path& folder : candidates()) {
    if (holds_the_data(folder)) return folder;
    searched += (searched.empty() ? "" : ", ") + folder.string();
  }
  throw std::invalid_argument(
      "Breakwater's models/ and scenarios/ are in none of " + searched +
      ": name the folder that holds both in the environment variable BREAKWATER_PATH");
}

}  // namespace

fs::path data_root() {
  static const fs::path root = find_data_root();
  return root;
}

fs::path find_file(const std::string& name, const fs::path& folder) {
  const fs::path path(name);
  if (path.is_absolute()) return path.lexically_normal();
  const fs::path beside = fs::absolute(folder / path).lexically_normal();
  return fs::exists(beside) ? beside : data_root() / path;
}

std::string portable_path(const fs::path& file) {
  const fs::path relative = file.lexically_relative(data_root());
  const bool is_inside = !relative.empty() && *relative.begin() != "..";
  return (is_inside ? relative : file).string();
}

}  // namespace breakwater
