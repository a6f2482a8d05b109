#include <breakwater/world/contact_law.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

#include <breakwater/world/wall_motion.h>

namespace breakwater {
namespace {

TEST(ContactLaw, ForcesAreThoseOfTheirEquations) {
  ContactState none;
  EXPECT_DOUBLE_EQ(KelvinVoigt(1e3, 20.0, KelvinVoigt::By::force).force(2e-3, 0.1, none), 4.0);
  EXPECT_NEAR(HuntCrossley(1e5, 1.5, 0.8).force(4e-4, 0.5, none), 1e5 * 8e-6 * 1.4, 1e-12);
  const LayeredContact layers({{1e-3, 1.0}, {2e-3, 11.0}}, 2.0);
  EXPECT_NEAR(layers.force(5e-4, 0.0, none), 0.5, 1e-12);
  EXPECT_NEAR(layers.force(1.5e-3, 0.25, none), 6.0 * 1.5, 1e-12);
  EXPECT_NEAR(layers.force(3e-3, 0.0, none), 21.0, 1e-12);
}

TEST(ContactLaw, AStandardLinearSolidRelaxesToItsSpring) {
  const StandardLinearSolid solid(1e3, 2e3, 0.01);
  ContactState state;
  const double depth_m = 1e-3, step_s = 1e-6;
  EXPECT_NEAR(solid.force(depth_m, 0.0, state), 3.0, 1e-12);
  for (int k = 0; k < 20000; ++k) {
    const double force_N = solid.force(depth_m, 0.0, state);
    ASSERT_NEAR(force_N, 1.0 + 2.0 * std::exp(-k * step_s / 0.01), 2e-4);
    state.value[0] += step_s * state.rate[0];
  }
  // The dent of a free surface goes back by K/(K + K1) of that rate.
  solid.force(0.0, 0.0, state);
  EXPECT_NEAR(state.rate[0], -state.value[0] / 3.0 / 0.01, 1e-9);
}

TEST(ContactLaw, DissipationGivesTheRestitution) {
  EXPECT_EQ(dissipation_of_restitution(1.0, 0.3), 0.0);
  for (const double e : {0.05, 0.5, 0.99}) {
    for (const double v : {0.01, 2.0}) {
      const double beta = dissipation_of_restitution(e, v) * v;
      EXPECT_NEAR(beta * (1.0 + e), std::log((1.0 + beta) / (1.0 - e * beta)), 1e-9 * beta);
      EXPECT_GT(beta, 0.0);
    }
  }
}

TEST(ContactLaw, RefusesWhatIsNoLaw) {
  using Make = std::function<void()>;
  const std::vector<Make> wrong = {[] { KelvinVoigt(0.0, 1.0, KelvinVoigt::By::force); },
                                   [] { KelvinVoigt(1.0, -1.0, KelvinVoigt::By::force); },
                                   [] { HuntCrossley(1.0, 0.9, 0.0); },
                                   [] { HuntCrossley(1.0, 1.5, -1.0); },
                                   [] { HuntCrossley(std::nan(""), 1.5, 0.0); },
                                   [] { dissipation_of_restitution(0.0, 1.0); },
                                   [] { dissipation_of_restitution(1.1, 1.0); },
                                   [] { dissipation_of_restitution(0.5, 0.0); },
                                   [] { LayeredContact({}, 0.0); },
                                   [] {
                                     LayeredContact({{1.0, 1.0}, {1.0, 2.0}}, 0.0);
                                   },
                                   [] {
                                     LayeredContact({{1.0, 1.0}, {2.0, 1.0}}, 0.0);
                                   },
                                   [] {
                                     LayeredContact({{1.0, 1.0}}, -1.0);
                                   },
                                   [] { StandardLinearSolid(1.0, 1.0, 0.0); }};
  for (std::size_t i = 0; i < wrong.size(); ++i)
    EXPECT_THROW(wrong[i](), std::invalid_argument) << i;
}

TEST(WallMotion, SpeedIsTheDerivativeOfThePosition) {
  const std::vector<WallMotion> motions = {
      {},
      {.kind = WallMotionKind::ramp, .start_s = 0.1, .speed_m_s = -0.02},
      {.kind = WallMotionKind::sine, .start_s = 0.1, .amplitude_m = 1e-3, .frequency_rad_s = 30.0},
      {.kind = WallMotionKind::csv, .table = {{0.1, 0.3, 0.4}, {0.0, 0.1, 0.05}}}};
  const double d = 1e-7;
  for (const WallMotion& motion : motions) {
    for (const double t : {0.05, 0.15, 0.25, 0.35, 0.5}) {
      const double rate = (motion.at(t + d).position_m - motion.at(t - d).position_m) / (2.0 * d);
      EXPECT_NEAR(motion.at(t).speed_m_s, rate, 1e-6) << t;
    }
  }
  EXPECT_NEAR(motions[3].at(0.35).position_m, 0.075, 1e-12);
  EXPECT_EQ(motions[3].at(0.5).position_m, 0.05);
  EXPECT_NEAR(motions[1].at(0.6).position_m, -0.01, 1e-12);
}

}  // namespace
}  // namespace breakwater
