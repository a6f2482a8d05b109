#include <breakwater/sim/engine_guard.h>

#include <dlfcn.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <cstdio>
#include <stdexcept>

#include <breakwater/math/functions.h>
#include "support.h"

namespace breakwater {
namespace {

// How many of the results have other bits than the functions of math/ and of glibc.
struct Differences {
  int from_math = 0, from_glibc = 0;

  void count(double result, double math, double glibc) {
    from_math += static_cast<int>(result != math);
    from_glibc += static_cast<int>(result != glibc);
  }
};

TEST(EngineFunctions, MujocoCallsThoseOfMath) {
  engine_functions();
  Differences cosine, exponential;
  testing::Random random;
  const double axis[] = {0.0, 0.0, 1.0};
  for (int i = 0; i < 100000; ++i) {
    const double x = random.uniform(0.0, 3.0);
    double quaternion[4];
    mju_axisAngle2Quat(quaternion, axis, 2.0 * x);
    cosine.count(quaternion[0], math::cos(x), std::cos(x));
    // The decay of a critically damped spring from rest at 1: (1 + ωt) e^(−ωt).
    const double decayed = mju_springDamper(1.0, 0.0, 1.0, 2.0, x);
    exponential.count(decayed, (1.0 + x) * math::exp(-x), (1.0 + x) * std::exp(-x));
  }
  EXPECT_EQ(cosine.from_math, 0);
  EXPECT_GT(cosine.from_glibc, 0) << "the test sees no difference";
  EXPECT_EQ(exponential.from_math, 0);
}

TEST(EngineFunctions, ALibraryWithReadOnlyImportsIsRedirectedToo) {
  void* const library = dlopen(READ_ONLY_IMPORTS, RTLD_NOW);
  ASSERT_NE(library, nullptr) << dlerror();
  const auto tangent = reinterpret_cast<double (*)(double)>(dlsym(library, "tangent"));
  EXPECT_EQ(redirect_elementary_functions(reinterpret_cast<const void*>(tangent)),
            std::vector<std::string>{"tan"});
  int differences = 0;
  testing::Random random;
  for (int i = 0; i < 100000; ++i) {
    const double x = random.uniform(-1.5, 1.5);
    EXPECT_EQ(tangent(x), math::tan(x));
    differences += static_cast<int>(tangent(x) != std::tan(x));
  }
  EXPECT_GT(differences, 0) << "the test sees no difference";
  dlclose(library);
}

TEST(EngineFunctions, ALibraryWithoutSuchCallsIsRefused) {
  try {
    redirect_elementary_functions(stdout);
    FAIL() << "libc was redirected";
  } catch (const std::runtime_error& error) {
    EXPECT_TRUE(testing::has(error.what(), "libc.so")) << error.what();
  }
  int local = 0;
  EXPECT_THROW(redirect_elementary_functions(&local), std::runtime_error);
}

}  // namespace
}  // namespace breakwater
