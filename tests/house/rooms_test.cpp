// The rooms of src/ depend on each other in one direction and hide their details.

#include <map>
#include <regex>
#include <set>

#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;

const std::string kOwn = "breakwater/";

struct Include {
  std::string room;
  std::string file;
  std::string header;  // ROOM/NAME.h of our own
};

std::vector<Include> all_includes() {
  std::vector<Include> includes;
  const fs::path src = testing::source_file("src");
  const std::regex pattern("^\\s*#\\s*include\\s*[<\"]([^>\"]+)[>\"].*$");
  for (const auto& entry : fs::recursive_directory_iterator(src)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".h" && extension != ".cpp") continue;
    const fs::path relative = entry.path().lexically_relative(src);
    std::ifstream stream(entry.path());
    for (std::string line; std::getline(stream, line);) {
      std::smatch match;
      if (std::regex_match(line, match, pattern)) {
        const bool in_room = relative.has_parent_path();
        std::string header = match[1];
        if (header.starts_with(kOwn)) header.erase(0, kOwn.size());
        includes.push_back({in_room ? relative.begin()->string() : "", relative.string(), header});
      }
    }
  }
  return includes;
}

// In ascending order: a room may only include earlier rooms.
const std::vector<std::string> kRooms = {
    "math",       "linear",   "signals",        "plants",  "observers", "control",    "world",
    "sim",        "record",   "render",         "shell",   "config",    "experiment", "rigs",
    "statistics", "recorded", "study",          "cluster", "search",    "pictures",   "pages",
    "thesis",     "analysis", "identification", "program"};

// Rooms that use only a few of the rooms below them.
const std::map<std::string, std::set<std::string>> kKnowLittle = {
    {"math", {}},
    {"linear", {"math"}},
    {"signals", {}},
    {"plants", {"math", "linear"}},
    {"observers", {"math", "linear", "signals"}},
    {"world", {"math", "linear", "signals"}},
    {"record", {"signals"}},
    {"render", {"linear", "signals", "world", "sim", "record"}},
    {"shell", {"signals", "record"}},
    {"config", {"math", "record", "shell"}},
    {"experiment", {"math", "linear", "signals", "plants", "sim", "record", "shell", "config"}},
    {"statistics", {"math"}}};

TEST(House, RoomsDependOneWay) {
  std::map<std::string, std::set<std::string>> allowed;
  std::set<std::string> below;
  for (const std::string& room : kRooms) {
    const auto little = kKnowLittle.find(room);
    allowed[room] = little == kKnowLittle.end() ? below : little->second;
    below.insert(room);
  }
  const std::vector<Include> includes = all_includes();
  ASSERT_GT(includes.size(), 100U);
  for (const Include& include : includes) {
    ASSERT_TRUE(allowed.contains(include.room)) << include.file << ": a room without a rule";
    const std::string target = include.header.substr(0, include.header.find('/'));
    if (!allowed.contains(target) || target == include.room) continue;
    EXPECT_TRUE(allowed.at(include.room).contains(target))
        << include.file << " includes " << include.header;
  }
}

// A room for a single feature is not a dependency of other rooms.
TEST(House, RoomsLeaveOutWhatTheyDoNotNeed) {
  const std::map<std::string, std::set<std::string>> without = {
      {"rigs", {"render", "shell"}},
      {"recorded", {"render"}},
      {"study", {"rigs", "recorded", "render"}},
      {"search", {"rigs", "recorded", "render"}},
      {"pictures", {"rigs", "recorded", "study", "statistics"}},
      {"pages", {"rigs", "recorded"}},
      {"thesis", {"rigs", "recorded"}}};
  for (const Include& include : all_includes()) {
    const auto found = without.find(include.room);
    const std::string target = include.header.substr(0, include.header.find('/'));
    if (found == without.end()) continue;
    EXPECT_FALSE(found->second.contains(target)) << include.file << " includes " << include.header;
  }
}

// Only rigs and scenarios name the thesis' plants.
TEST(House, NoRoomNamesAScenario) {
  const fs::path src = testing::source_file("src");
  for (const auto& entry : fs::directory_iterator(testing::source_file("scenarios"))) {
    if (!entry.is_directory()) continue;
    const std::string name = entry.path().filename().string();
    // "plant" is also a word of the field, and "two_inertia" a model that identification fits.
    const std::string word = name == "plant"         ? "\"plant\""
                             : name == "two_inertia" ? "scenarios/two_inertia"
                                                     : name;
    for (const auto& file : fs::recursive_directory_iterator(src)) {
      if (!file.is_regular_file()) continue;
      std::ifstream stream(file.path());
      int number = 0;
      for (std::string line; std::getline(stream, line);) {
        ++number;
        EXPECT_TRUE(lacks(line, word)) << file.path() << ":" << number;
      }
    }
  }
}

// Checks which rooms include a matching header.
void expect_only_in(const std::regex& header, const std::set<std::string>& rooms) {
  for (const Include& include : all_includes()) {
    if (!std::regex_search(include.header, header)) continue;
    EXPECT_TRUE(rooms.contains(include.room)) << include.file << " includes " << include.header;
  }
}

TEST(House, OnlySimAndRenderIncludeTheEngine) {
  expect_only_in(std::regex("mujoco|mjdata|mjmodel"), {"sim", "render"});
}

// Whether a line of code has a name of the engine: mjModel, mju_copy, mjtNum, mjOBJ_GEOM.
bool names_the_engine(const std::string& line) {
  static const std::regex symbol(
      "\\bmj(Model|Data|Option|Contact|VFS|cb|[duvprst]?_|t[A-Z]|[A-Z]{2,}_?)");
  return std::regex_search(line.substr(0, line.find("//")), symbol);
}

// The lines of src/ and scenarios/ that are wrong, except in allowed files.
template <typename IsWrong, typename May>
void expect_no_line(IsWrong&& is_wrong, May&& may) {
  int files = 0;
  for (const std::string folder : {"src", "scenarios"}) {
    const fs::path root = testing::source_file(folder);
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
      const std::string extension = entry.path().extension().string();
      const std::string name = folder + "/" + entry.path().lexically_relative(root).string();
      if ((extension != ".h" && extension != ".cpp") || may(name)) continue;
      ++files;
      std::ifstream stream(entry.path());
      int number = 0;
      for (std::string line; std::getline(stream, line);) {
        ++number;
        EXPECT_FALSE(is_wrong(line)) << name << ":" << number << ": " << line;
      }
    }
  }
  EXPECT_GT(files, 100);
}

TEST(House, TheEnginesNamesAreUsedInSimRenderAndRigsAlone) {
  EXPECT_TRUE(names_the_engine("  sim.model().id(mjOBJ_GEOM, name)"));
  EXPECT_TRUE(names_the_engine("const mjData& data, mjtNum x, mju_copy(x), mj_step(m, d)"));
  EXPECT_FALSE(names_the_engine("bind_model(fields, mjcf_); \"model.mjcf\"  // as mj_loadXML"));
  expect_no_line(names_the_engine, [](const std::string& file) {
    return file.starts_with("src/sim/") || file.starts_with("src/render/") ||
           file.starts_with("src/rigs/");
  });
}

TEST(House, TheEnvironmentIsReadInOnePlace) {
  const auto reads_it = [](const std::string& line) {
    const std::size_t at = line.find("getenv(");
    return at != line.npos && !(at >= 2 && line.compare(at - 2, 2, "fe") == 0);
  };
  EXPECT_TRUE(reads_it("std::getenv(name)"));
  EXPECT_FALSE(reads_it("std::fegetenv(&environment)"));
  expect_no_line(reads_it,
                 [](const std::string& file) { return file == "src/signals/environment.h"; });
}

TEST(House, OnlyRenderUsesOffscreenRendering) {
  expect_only_in(std::regex("EGL/|GL/|libav"), {"render"});
}

TEST(House, FileFormatsStayInTheirRooms) {
  expect_only_in(std::regex("urdf|tinyxml|console_bridge"), {"plants"});
  expect_only_in(std::regex("^hdf5"), {"record"});
  expect_only_in(std::regex("toml\\+\\+"), {"config", "study", "search", "pictures", "thesis"});
  expect_only_in(std::regex("CLI/"), {"shell", "recorded", "study", "cluster", "pictures", "pages",
                                      "thesis", "analysis", "identification", "program"});
  expect_only_in(std::regex("nlohmann"), {"record", "experiment", "study", "search", "pictures",
                                          "pages", "thesis", "identification", "program"});
  expect_only_in(std::regex("^ceres/"), {"identification"});
  expect_only_in(std::regex("mustache"), {"pages"});
  expect_only_in(std::regex("^boost/"), {"study"});
  expect_only_in(std::regex("^sqlite3"), {"study"});
}

TEST(House, TheLowestRoomsIncludeOnlyEigen) {
  for (const Include& include : all_includes()) {
    if (include.room != "math" && include.room != "linear" && include.room != "signals") continue;
    const bool is_standard = include.header.find('/') == std::string::npos &&
                             include.header.find(".h") == std::string::npos;
    EXPECT_TRUE(is_standard || include.header.starts_with("Eigen/") ||
                include.header.starts_with("unsupported/Eigen/") ||
                include.header.starts_with("math/") ||
                include.header.starts_with(include.room + "/"))
        << include.file << " includes " << include.header;
  }
}

TEST(House, EveryScenarioHasItsFolder) {
  for (const auto& entry : fs::directory_iterator(testing::source_file("scenarios"))) {
    if (!entry.is_directory()) continue;
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(fs::exists(entry.path() / (name + ".toml"))) << name;
    EXPECT_TRUE(fs::exists(entry.path() / (name + ".cpp"))) << name;
    // The model and the duration of "plant" are the user's. Without a list, pictures show them
    // whole.
    EXPECT_EQ(fs::exists(entry.path() / "shots.toml"), name != "plant") << name;
  }
}

TEST(House, ScenariosAreBuiltLikeAUsersScenario) {
  const std::string rules = testing::text_of(testing::source_file("scenarios/CMakeLists.txt"));
  EXPECT_TRUE(lacks(rules, "add_executable("));
  EXPECT_TRUE(has(rules, "breakwater_program(${scenario} ONE_SCENARIO"));
}

}  // namespace
}  // namespace breakwater
