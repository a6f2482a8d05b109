// Rules of the house: its rooms, its binaries, its mathematics, and the code in its pages.
#include <dlfcn.h>

#include <mujoco/mujoco.h>
#include <regex>

#include <breakwater/sim/engine_guard.h>
#include "shell.h"
#include "support.h"

namespace breakwater::rooms_test {

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

// Dynamic-loader entries of the built binaries.

// An empty entry in such a path is the working folder: whoever can write there could run code.
TEST(Binaries, HaveNoRunPath) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(testing::bin_folder())) {
    const std::string section =
        testing::output_of("readelf --dynamic --wide '" + entry.path().string() + "'");
    ASSERT_TRUE(has(section, "(NEEDED)")) << entry.path();
    EXPECT_TRUE(lacks(section, "RUNPATH")) << entry.path();
    EXPECT_TRUE(lacks(section, "RPATH")) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 9);
}

// They would be loaded at every start, before a program prints anything.
TEST(Binaries, LinkNoLibraryThatFewCommandsUse) {
  for (const auto& entry : fs::directory_iterator(testing::bin_folder())) {
    const std::string section =
        testing::output_of("readelf --dynamic --wide '" + entry.path().string() + "'");
    for (const char* library : {"libav", "libcairo", "libhdf5", "libnlopt", "libpagmo", "libtbb"}) {
      EXPECT_TRUE(lacks(section, library)) << entry.path();
    }
  }
}

// The code in the documentation is built code.

// A fenced block behind <!-- FILE --> is an exact part of this file. The file is a test or a
// template, which the install tests build and run.
TEST(Docs, CodeEqualsTheTemplates) {
  int blocks = 0;
  const std::regex pattern("<!-- ((?:templates|tests)/\\S+) -->\n```[a-z]*\n([^`]*)```");
  for (const auto& entry : fs::recursive_directory_iterator(testing::source_file("docs"))) {
    if (entry.path().extension() != ".md") continue;
    const std::string page = testing::text_of(entry.path());
    for (std::sregex_iterator block(page.begin(), page.end(), pattern), end; block != end;
         ++block) {
      ++blocks;
      const std::string code = testing::text_of(testing::source_file((*block)[1]));
      EXPECT_TRUE(has(code, (*block)[2])) << entry.path() << ": not in " << (*block)[1] << ":\n"
                                          << (*block)[2];
    }
    const std::regex mark("<!-- (templates|tests)/");
    EXPECT_EQ(std::distance(std::sregex_iterator(page.begin(), page.end(), mark), {}),
              std::distance(std::sregex_iterator(page.begin(), page.end(), pattern), {}))
        << entry.path() << ": a mark without a block behind it";
  }
  EXPECT_GT(blocks, 15);
}

// Users of the libraries need no files of src/: the included headers are installed.
TEST(Docs, NamedHeadersExist) {
  const std::regex pattern("<breakwater/([a-z_]+/[a-z_]+\\.h)>");
  for (const auto& entry : fs::recursive_directory_iterator(testing::source_file("docs"))) {
    if (entry.path().extension() != ".md") continue;
    const std::string page = testing::text_of(entry.path());
    for (std::sregex_iterator name(page.begin(), page.end(), pattern), end; name != end; ++name) {
      EXPECT_TRUE(fs::exists(testing::source_file("src/" + (*name)[1].str())))
          << entry.path() << " names " << (*name)[0];
    }
  }
}

// Functions of the C library's mathematics that code for the simulation's state may call.

// The last word of each line of nm's output, without the symbol's version.
std::vector<std::string> symbols(const std::string& nm) {
  std::vector<std::string> names;
  std::istringstream lines(testing::output_of(nm));
  for (std::string line; std::getline(lines, line);) {
    const std::string word = line.substr(line.rfind(' ') + 1);
    names.push_back(word.substr(0, word.find('@')));
  }
  return names;
}

// glibc has one implementation of these, or all give the exact result. hypot and cabs are made of
// square roots, products and sums. fegetenv and fesetenv compute nothing.
const std::set<std::string> kSameEverywhere = {
    "ceil",      "copysign",  "fabs",      "floor",   "fma",   "fmax",     "fmin",     "fmod",
    "frexp",     "ldexp",     "llrint",    "llround", "lrint", "lround",   "lroundf",  "modf",
    "nearbyint", "nextafter", "remainder", "rint",    "round", "scalbn",   "sqrt",     "sqrtf",
    "sqrtl",     "trunc",     "hypot",     "cabs",    "cabsl", "fegetenv", "fesetenv", "ilogb",
};

// The functions of libm that depend on the processor.
std::set<std::string> processor_dependent() {
  std::set<std::string> libm;
  for (const std::string& name : symbols("nm -D --defined-only '" BREAKWATER_LIBM "'")) {
    if (!kSameEverywhere.contains(name)) libm.insert(name);
  }
  return libm;
}

// render and pages only draw and write finished runs. record only writes.
TEST(House, StateCodeCallsNoProcessorDependentFunction) {
  const std::set<std::string> libm = processor_dependent();
  ASSERT_TRUE(libm.contains("sin") && libm.contains("pow") && libm.contains("cexp"));
  for (const std::string room :
       {"math", "linear", "plants", "observers", "control", "world", "sim", "record", "experiment",
        "rigs", "published", "quadrotor", "statistics", "study", "axes_scenarios", "scenarios"}) {
    const std::string folder = room.ends_with("scenarios") ? "scenarios" : "src";
    const std::string archive = BREAKWATER_ARCHIVES "/" + folder + "/libbreakwater_" + room + ".a";
    const auto called = symbols("nm --undefined-only '" + archive + "'");
    EXPECT_FALSE(called.empty()) << archive;
    for (const std::string& name : called) {
      EXPECT_FALSE(libm.contains(name)) << room << " calls " << name << ": take math/functions.h's";
    }
  }
}

TEST(House, EachProcessorDependentFunctionOfMujocoIsRedirected) {
  const std::set<std::string> only_draw = {"atan2f", "sincosf", "sinf", "tanf"};
  Dl_info library{};
  ASSERT_NE(dladdr(mj_versionString(), &library), 0);
  std::set<std::string> expected;
  const std::set<std::string> libm = processor_dependent();
  for (const auto& name :
       symbols(std::string("nm -D --undefined-only '") + library.dli_fname + "'")) {
    if (libm.contains(name) && !only_draw.contains(name)) expected.insert(name);
  }
  const auto& redirected = engine_functions();
  EXPECT_EQ(expected, std::set<std::string>(redirected.begin(), redirected.end()));
}

}  // namespace breakwater::rooms_test
