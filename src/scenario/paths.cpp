#include "scenario/paths.h"

#include <stdexcept>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

bool holds_the_data(const fs::path& folder) {
  return fs::is_directory(folder / "models") && fs::is_directory(folder / "scenarios");
}

fs::path find_data_root() {
  const fs::path binary = fs::read_symlink("/proc/self/exe");
  for (fs::path folder = binary.parent_path();; folder = folder.parent_path()) {
    for (const fs::path& candidate : {folder / "share" / "breakwater", folder}) {
      if (holds_the_data(candidate)) return candidate;
    }
    if (folder == folder.root_path()) break;
  }
  throw std::runtime_error("models/ and scenarios/ are not found above " + binary.string());
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
