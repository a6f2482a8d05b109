#include <breakwater/sim/contact_stability.h>

#include <gtest/gtest.h>

#include <cmath>

#include <breakwater/linear/eigenvalues.h>
#include "support.h"

namespace breakwater {
namespace {

// The largest growth in a step of m ẍ = −k x − c ẋ.
double growth(Integrator integrator, double h, const ContactSlopes& slopes) {
  const double k = slopes.stiffness_N_m / slopes.mass_kg;
  const double c = slopes.damping_Ns_m / slopes.mass_kg;
  Eigen::Matrix2d step;
  if (integrator == Integrator::rk4) {
    const Eigen::Matrix2d a = h * (Eigen::Matrix2d() << 0.0, 1.0, -k, -c).finished();
    step = Eigen::Matrix2d::Identity() + a + a * a / 2.0 + a * a * a / 6.0 + a * a * a * a / 24.0;
  } else {  // v += h a, x += h v
    step << 1.0 - h * h * k, h - h * h * c, -h * k, 1.0 - h * c;
  }
  return spectral_radius(step);
}

TEST(ContactStability, TheLimitIsWhereTheStepBeginsToGrow) {
  testing::Random random;
  for (const Integrator integrator : {Integrator::euler, Integrator::rk4, Integrator::implicit}) {
    for (int i = 0; i < 200; ++i) {
      const ContactSlopes slopes = {.stiffness_N_m = std::pow(10.0, random.uniform(1.0, 7.0)),
                                    .damping_Ns_m = std::pow(10.0, random.uniform(-1.0, 4.0)),
                                    .mass_kg = std::pow(10.0, random.uniform(-2.0, 2.0))};
      const double h = longest_stable_timestep_s(integrator, slopes);
      EXPECT_LE(growth(integrator, 0.999 * h, slopes), 1.0 + 1e-12);
      EXPECT_GT(growth(integrator, 1.001 * h, slopes), 1.0);
      EXPECT_TRUE(is_stable(integrator, 0.999 * h, slopes));
      EXPECT_FALSE(is_stable(integrator, 1.001 * h, slopes));
    }
  }
}

TEST(ContactStability, ARelaxationHasALimitOfItsOwn) {
  const ContactSlopes slopes = {.stiffness_N_m = 1.0, .relaxation_1_s = 1e3};
  EXPECT_DOUBLE_EQ(longest_stable_timestep_s(Integrator::euler, slopes), 2e-3);
  EXPECT_FALSE(is_stable(Integrator::rk4, 2.1e-3, slopes));
}

TEST(ContactStability, SlopesAreThoseOfTheLaw) {
  const HuntCrossley law(1e5, 1.5, 0.8);
  const ContactSlopes slopes = slopes_of(law, {}, 4e-4, 0.5, 2.0);
  EXPECT_NEAR(slopes.stiffness_N_m, 1e5 * 1.5 * 0.02 * 1.4, 1e-2);
  EXPECT_NEAR(slopes.damping_Ns_m, 1e5 * 8e-6 * 0.8, 1e-6);
  EXPECT_EQ(slopes.mass_kg, 2.0);
  WallMotion wall{.mass_kg = 6.0, .stiffness_N_m = 100.0, .damping_Ns_m = 10.0};
  EXPECT_EQ(with_wall(slopes, wall).mass_kg, 2.0) << "a fixed wall";
  wall.kind = WallMotionKind::free;
  const ContactSlopes both = with_wall(slopes, wall);
  EXPECT_DOUBLE_EQ(both.mass_kg, 1.5);
  EXPECT_NEAR(both.stiffness_N_m, slopes.stiffness_N_m + 25.0, 1e-9);
  EXPECT_NEAR(both.damping_Ns_m, slopes.damping_Ns_m + 2.5, 1e-12);
  const StandardLinearSolid solid(1e3, 2e3, 0.01);
  EXPECT_NEAR(slopes_of(solid, {}, 1e-3, 0.0, 1.0).stiffness_N_m, 3e3, 1e-3);
  EXPECT_NEAR(slopes_of(solid, {}, 1e-3, 0.0, 1.0).relaxation_1_s, 100.0, 1e-3);
}

}  // namespace
}  // namespace breakwater
