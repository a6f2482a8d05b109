#include <breakwater/program/commands.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <cctype>
#include <map>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <breakwater/config/names.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/record/process_name.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/paths.h>
#include <breakwater/shell/process.h>
#include <breakwater/signals/input_file.h>
#include <breakwater/sim/mjcf_conversion.h>
#include <breakwater/sim/robot_scene.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kLongestShown = 128;  // characters of a wrong name

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

// A template's folder my_part has the placeholders my_part and MyPart.
std::string instantiated(std::string text, const fs::path& folder, const std::string& name) {
  const std::string placeholder = "my_" + folder.filename().string();
  boost::replace_all(text, placeholder, name);
  boost::replace_all(text, camel_case(placeholder), camel_case(name));
  return text;
}

// The texts of the files of templates by their new names, relative to the project's folder.
std::map<fs::path, std::string> files_of(const std::vector<fs::path>& from,
                                         const std::string& name) {
  std::map<fs::path, std::string> files;
  for (const fs::path& folder : from) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (!entry.is_regular_file()) continue;
      const std::string old_name = entry.path().lexically_relative(folder).string();
      const fs::path new_name = instantiated(old_name, folder, name);
      if (!files.emplace(new_name, instantiated(bytes_of(entry.path()), folder, name)).second) {
        throw std::invalid_argument(fmt::format(
            "{}: the project has a {} already: choose another name", name, new_name.string()));
      }
    }
  }
  return files;
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

// Writes the robot's model and its axes into a project of the template robot.
void add_robot(const fs::path& project, const std::string& name, const std::string& mjcf,
               const std::string& tip) {
  RobotScene scene = robot_before_wall(mjcf, tip);
  for (const std::string& line : conversion_warnings(mjcf)) fmt::print("{}\n", line);
  fmt::print("the tip: {}\n", scene.tip);
  bring_assets(scene.root, project);
  write_text_file((project / (name + ".xml")).string(), mjcf_text(scene.root));
  std::string axes;
  for (const std::string& joint : scene.joints) {
    const bool is_word = std::all_of(joint.begin(), joint.end(), [](unsigned char c) {
      return std::isalnum(c) != 0 || c == '_';
    });
    if (!is_word) {
      throw std::invalid_argument(mjcf + ": joint \"" + joint +
                                  "\" moves the tip and needs a name of letters, digits and _");
    }
    axes += fmt::format("[axis.{0}]\njoint = \"{0}\"\n", joint);
  }
  const fs::path settings = project / (name + ".toml");
  write_text_file(settings.string(), boost::replace_all_copy(bytes_of(settings), "AXES\n", axes));
}

// The kinds of projects with the folders of their files: a line of kinds.txt is a kind and its
// folders. A plant and a scenario are the same project.
std::map<std::string, std::vector<fs::path>> kinds_of_projects(const fs::path& templates) {
  std::map<std::string, std::vector<fs::path>> kinds;
  std::istringstream lines(bytes_of(templates / "kinds.txt"));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind, folder;
    words >> kind;
    while (words >> folder) kinds[kind].push_back(templates / folder);
  }
  return kinds;
}

// Refuses a name that a scenario or a part has.
void check_project_name(const Catalogue& catalogue, const std::string& name) {
  static const std::regex kName("[a-z][a-z0-9_]{0,63}");
  if (!std::regex_match(name, kName)) {
    throw std::invalid_argument(fmt::format(
        "new: NAME must be a letter from a to z, then such letters, digits and _, 64 at most, is "
        "\"{}\"",
        name.substr(0, kLongestShown)));
  }
  const auto refuse = [&](const std::string& what) {
    throw std::invalid_argument(
        fmt::format("new: NAME is taken: there is the {} \"{}\"", what, name));
  };
  if (name == "shots") refuse("shot list");
  if (catalogue.has<ScenarioKind>(name)) refuse(ScenarioKind::kWhat);
  for (const ListedPart& part : catalogue.parts()) {
    if (part.name == name) refuse(part.what);
  }
}

// Makes the project folder `out` from the files of the folders `from`, with the robot of `mjcf` if
// it is not empty. On an error no folder is left.
void make_project(const std::vector<fs::path>& from, const std::string& name, const fs::path& out,
                  const std::string& mjcf, const std::string& tip) {
  fs::path folder = fs::absolute(out).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  if (fs::symlink_status(folder).type() != fs::file_type::not_found) {
    throw std::invalid_argument(out.string() + ": is there already");
  }
  const std::map<fs::path, std::string> files = files_of(from, name);
  const fs::path partial =
      folder.parent_path() / (hidden_name(folder, ".partial-") + unique_name());
  std::error_code error;
  if (!fs::create_directories(partial, error)) {
    throw std::invalid_argument(out.string() + ": cannot be made (" + error.message() + ")");
  }
  try {
    for (const auto& [file, text] : files) {
      fs::create_directories((partial / file).parent_path());
      write_text_file((partial / file).string(), text);
    }
    if (!mjcf.empty()) add_robot(partial, name, mjcf, tip);
    fs::rename(partial, folder);
  } catch (const OutputError& failed) {
    fs::remove_all(partial, error);
    throw with_final_name(failed, partial, out);
  } catch (...) {
    fs::remove_all(partial, error);
    throw;
  }
}

int new_project(const Catalogue& catalogue, const std::string& kind, const std::string& name,
                const std::string& folder, const std::string& mjcf, const std::string& tip) {
  const fs::path templates = data_file("templates");
  const auto kinds = kinds_of_projects(templates);
  const auto from = kinds.find(kind);
  if (from == kinds.end()) {
    throw std::invalid_argument("new: KIND " + must_be_one_of(names_of(kinds), kind));
  }
  check_project_name(catalogue, name);
  const bool is_robot = kind == "robot";
  if (is_robot && mjcf.empty()) throw std::invalid_argument("new: robot needs --mjcf FILE");
  if (!is_robot && !(mjcf + tip).empty()) {
    throw std::invalid_argument("new: --mjcf and --tip are for a robot");
  }
  const fs::path out = folder.empty() ? name : folder;
  make_project(from->second, name, out, mjcf, tip);
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

int new_project_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " new";
  return guarded(program, [&] {
    CLI::App app("Makes a project of your own, which builds against an installed Breakwater.",
                 program);
    std::string kind;
    std::string name;
    std::string out;
    app.add_option("KIND", kind,
                   "controller or observer (C++); plant or scenario (an MJCF and a scenario\n"
                   "file, without C++); robot (the same, of a robot's MJCF before a wall)")
        ->required();
    app.add_option("NAME", name, "what it is called: [a-z][a-z0-9_]*")->required();
    app.add_option("--out", out, "the project's folder (default: NAME)")->type_name("DIR");
    std::string mjcf;
    std::string tip;
    app.add_option("--mjcf", mjcf, "a robot's model file")->type_name("FILE");
    app.add_option("--tip", tip, "site or body of the robot that presses on the wall");
    app.footer(
        "The folder has CMakeLists.txt, presets, a scenario file, tests and a README.md, and C++\n"
        "or an MJCF that works. That of a robot has its model, a scenario file and a README.md.\n"
        "--tip may be missing if the model has one site, or one last body. Exit status: 0 success, "
        "1 a defect, 2 usage or input.");
    if (const auto status = parse(app, argc, argv)) return *status;
    return new_project(catalogue, kind, name, out, mjcf, tip);
  });
}

}  // namespace breakwater
