#include <breakwater/program/new_project.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <map>
#include <stdexcept>
#include <vector>

#include <breakwater/program/commands.h>
#include <breakwater/record/file_bytes.h>
#include <breakwater/record/process_name.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/paths.h>
#include <breakwater/shell/process.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kLongestName = 64;

// Camel case: "AnOwnName" for "an_own_name".
std::string camel_case(const std::string& name) {
  std::string result;
  bool begins = true;
  for (const char c : name) {
    if (c != '_') {
      result += begins ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    }
    begins = c == '_';
  }
  return result;
}

std::string upper_case(std::string name) {
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

std::string replaced(std::string text, const std::string& word, const std::string& by) {
  for (std::size_t at = text.find(word); at != std::string::npos;
       at = text.find(word, at + by.size())) {
    text.replace(at, word.size(), by);
  }
  return text;
}

std::string instantiated(const std::string& text, const std::string& placeholder,
                         const std::string& name) {
  std::string result = replaced(text, placeholder, name);
  result = replaced(result, camel_case(placeholder), camel_case(name));
  return replaced(result, upper_case(placeholder), upper_case(name));
}

// The files of a template by their new names, relative to the project's folder.
std::map<fs::path, fs::path> files_of(const fs::path& from, const std::string& placeholder,
                                      const std::string& name) {
  std::map<fs::path, fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(from)) {
    if (!entry.is_regular_file()) continue;
    const std::string old_name = entry.path().lexically_relative(from).string();
    const fs::path new_name = instantiated(old_name, placeholder, name);
    if (!files.emplace(new_name, entry.path()).second) {
      throw std::invalid_argument(fmt::format(
          "{}: the project has a {} already: choose another name", name, new_name.string()));
    }
  }
  return files;
}

std::vector<std::string> kinds_of_projects(const fs::path& templates) {
  std::vector<std::string> kinds;
  for (const auto& entry : fs::directory_iterator(templates)) {
    if (entry.is_directory()) kinds.push_back(entry.path().filename().string());
  }
  std::sort(kinds.begin(), kinds.end());
  return kinds;
}

// The first commands for the user. CMake finds packages that are installed in the system.
std::string how_to_build(const fs::path& templates, const fs::path& out) {
  const fs::path share = templates.parent_path();
  const fs::path build = fs::path(own_program()).parent_path().parent_path();
  fs::path prefix;
  std::string text;
  if (share.parent_path().filename() == "share") {
    prefix = share.parent_path().parent_path();
  } else if (fs::exists(build / "CMakeCache.txt")) {
    prefix = build / "installed";
    text = fmt::format("cmake --install {} --prefix {}\n", shell_word(build.string()),
                       shell_word(prefix.string()));
  }
  const bool is_found = prefix.empty() || prefix == "/usr" || prefix == "/usr/local";
  return text +
         fmt::format(
             "cd {} && {}cmake --preset release && cmake --build --preset release && "
             "ctest --preset release\n",
             shell_word(out.string()),
             is_found ? "" : fmt::format("CMAKE_PREFIX_PATH={} ", shell_word(prefix.string())));
}

int new_project(const Catalogue& catalogue, const std::string& kind, const std::string& name,
                const std::string& folder) {
  const fs::path templates = data_file("templates");
  const std::vector<std::string> kinds = kinds_of_projects(templates);
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
    throw std::invalid_argument("new: KIND " + must_be_one_of(kinds, kind));
  }
  check_project_name(catalogue, name);
  const fs::path out = folder.empty() ? name : folder;
  make_project(templates / kind, "my_" + kind, name, out);
  const bool has_code = fs::exists(out / "main.cpp");
  fmt::print(
      "a new {0}: {1}\n\n"
      "{2}\n"
      "{1}/README.md says how to go on.\n",
      kind, out.string(),
      has_code ? how_to_build(templates, out)
               : fmt::format("cd {} && {} run {}.toml\n", shell_word(out.string()),
                             own_program_name(), name));
  return kSuccess;
}

}  // namespace

void check_project_name(const Catalogue& catalogue, const std::string& name) {
  const bool is_one = !name.empty() && name.size() <= kLongestName && name[0] >= 'a' &&
                      name[0] <= 'z' && std::all_of(name.begin(), name.end(), [](char c) {
                        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
                      });
  if (!is_one) {
    throw std::invalid_argument(fmt::format(
        "new: NAME must be a letter from a to z, then such letters, digits and _, {} at most, is "
        "\"{}\"",
        kLongestName, name.substr(0, 2 * kLongestName)));
  }
  const auto refuse = [&](const std::string& what) {
    throw std::invalid_argument(
        fmt::format("new: NAME is taken: there is the {} \"{}\"", what, name));
  };
  if (catalogue.has<ScenarioKind>(name)) refuse(ScenarioKind::kWhat);
  for (const ListedPart& part : catalogue.parts()) {
    if (part.name == name) refuse(part.what);
  }
}

void make_project(const fs::path& from, const std::string& placeholder, const std::string& name,
                  const fs::path& out) {
  fs::path folder = fs::absolute(out).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  if (fs::symlink_status(folder).type() != fs::file_type::not_found) {
    throw std::invalid_argument(out.string() + ": is there already");
  }
  if (!fs::is_directory(folder.parent_path())) {
    throw std::invalid_argument(folder.parent_path().string() + ": is no folder");
  }
  const std::map<fs::path, fs::path> files = files_of(from, placeholder, name);
  const fs::path partial =
      folder.parent_path() / (hidden_name(folder, ".partial-") + unique_name());
  try {
    fs::create_directory(partial);
    for (const auto& [file, original] : files) {
      fs::create_directories((partial / file).parent_path());
      write_text_file((partial / file).string(),
                      instantiated(bytes_of(original), placeholder, name));
    }
    fs::rename(partial, folder);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(partial, ignored);
    throw;
  }
}

int new_project_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " new";
  return guarded(program, [&] {
    CLI::App app("Makes a project of your own, which builds against an installed Breakwater.",
                 program);
    std::string kind;
    std::string name;
    std::string out;
    app.add_option("KIND", kind,
                   "controller, observer, plant (an MJCF and a scenario file, without C++), or\n"
                   "scenario (C++, with a plant of its own)")
        ->required();
    app.add_option("NAME", name, "what it is called: [a-z][a-z0-9_]*")->required();
    app.add_option("--out", out, "the project's folder (default: NAME)")->type_name("DIR");
    app.footer(
        "The folder has CMakeLists.txt, presets, C++ that works, a scenario file, tests and a\n"
        "README.md. A plant has no presets and no C++. Exit status: 0 success, 1 a defect, 2 usage "
        "or input.");
    if (const auto status = parse(app, argc, argv)) return *status;
    return new_project(catalogue, kind, name, out);
  });
}

}  // namespace breakwater
