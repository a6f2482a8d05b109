// Functions of the C library's mathematics that code for the simulation's state may call.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <breakwater/sim/engine_guard.h>
#include "shell.h"

namespace breakwater {
namespace {

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

}  // namespace
}  // namespace breakwater
