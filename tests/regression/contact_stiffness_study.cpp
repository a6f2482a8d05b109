// The impact and the onset of bouncing by contact stiffness: a coarse version of
// docs/explanation/studies/contact-stiffness.md.
#include "regression/run_case.h"

namespace breakwater::contact_stiffness_study {

constexpr const char* kScenario = "arm_wall_contact";

// B grows with the root of K: a constant damping ratio, with 10 N s/m at 1000 N/m.
double damping_Ns_m(double stiffness_N_m) {
  return 10.0 * std::sqrt(stiffness_N_m / 1000.0);
}

Recording run_with(const std::string& name, double stiffness_N_m, const std::string& duration_s,
                   std::vector<std::string> sets = {}) {
  sets.push_back("contact.stiffness_N_m=" + std::to_string(stiffness_N_m));
  sets.push_back("contact.damping_Ns_m=" + std::to_string(damping_Ns_m(stiffness_N_m)));
  sets.push_back("run.duration_s=" + duration_s);
  return testing::run_case(kScenario, name, sets);
}

class EachController : public ::testing::TestWithParam<const char*> {};

TEST_P(EachController, ForceGrowsAtMostInProportionToTheStiffness) {
  double stiffness = 200.0;
  Recording softer = run_with(GetParam(), stiffness, "31.5");
  ASSERT_FALSE(softer.failure);
  while (stiffness < 1e5) {
    stiffness *= 5.0;
    Recording stiffer = run_with(GetParam(), stiffness, "31.5");
    ASSERT_FALSE(stiffer.failure);
    const double growth = *stiffer.metric("peak_force_raw_N") / *softer.metric("peak_force_raw_N");
    EXPECT_GT(growth, 1.0) << stiffness;
    EXPECT_LT(growth, 5.0) << stiffness;
    EXPECT_GT(*stiffer.metric("peak_force_filtered_N"), *softer.metric("peak_force_filtered_N"));
    // The wall has no effect before contact.
    EXPECT_NEAR(*stiffer.metric("free_motion_time_s"), *softer.metric("free_motion_time_s"), 1e-9);
    softer = std::move(stiffer);
  }
}

// A short impact ends before the controller reacts. For a small damping ratio
// zeta = B / (2 sqrt(K m)) a mass on a spring has the peak sqrt(K m) v exp(-pi zeta / 2). The peaks
// at two stiffnesses give the mass. The test checks growth by sqrt(10) per decade and a mass
// between 76 and 110 kg. The lower bound is for free joints in the nominal pose minus the damping,
// the upper one for fixed y and phi.
TEST_P(EachController, PeakOfAShortBlowGrowsAsTheRootOfTheStiffness) {
  double previous = 0.0, error = 1.0;
  for (const double stiffness : {1e5, 1e6, 1e7, 1e8}) {
    const Recording run = run_with(GetParam(), stiffness, "31.3", {"physics.timestep_s=2.5e-5"});
    ASSERT_FALSE(run.failure);
    const double peak = *run.metric("peak_force_raw_N");
    if (previous > 0.0) {
      const double from_root = std::abs(peak / previous / std::sqrt(10.0) - 1.0);
      EXPECT_LT(from_root, error) << stiffness;
      error = from_root;
    }
    previous = peak;
    if (stiffness == 1e8) {
      const double root_mass = peak / *run.metric("impact_velocity_m_s") / std::sqrt(stiffness);
      const double mass = root_mass * root_mass;
      EXPECT_GT(mass, 72.0);
      EXPECT_LT(mass, 110.0);
    }
  }
  EXPECT_LT(error, 0.10);
}

TEST_P(EachController, HalfTheTimestepGivesTheSamePeaks) {
  const Recording coarse = run_with(GetParam(), 1e5, "31.5");
  const Recording fine = run_with(GetParam(), 1e5, "31.5", {"physics.timestep_s=5e-5"});
  for (const char* peak : {"peak_force_raw_N", "peak_force_filtered_N"}) {
    EXPECT_NEAR(*fine.metric(peak), *coarse.metric(peak), 0.005 * *coarse.metric(peak)) << peak;
  }
}

INSTANTIATE_TEST_SUITE_P(ContactStiffness, EachController,
                         ::testing::Values("proposed-2N", "hpfc-2N", "drac-2N"),
                         [](const auto& param) {
                           const std::string name = param.param;
                           return name.substr(0, name.find('-'));
                         });

struct Start {
  const char* name;
  double settles_N_m;
  double does_not_N_m;
};

class EachStart : public ::testing::TestWithParam<Start> {};

// From 50 to 100 s. A limit of 5 % of the reference separates decaying and lasting oscillations.
TEST_P(EachStart, SettlesOnlyBelowTheLimit) {
  const Start& start = GetParam();
  const double reference_N = std::string(start.name).ends_with("5N") ? 5.0 : 2.0;
  const Recording settled = run_with(start.name, start.settles_N_m, "100");
  ASSERT_FALSE(settled.failure);
  EXPECT_LT(*settled.metric("std_force_error_N"), 0.05 * reference_N);
  EXPECT_NEAR(*settled.metric("mean_force_error_N"), 0.0, 0.01 * reference_N);
  const Recording run = run_with(start.name, start.does_not_N_m, "100");
  ASSERT_FALSE(run.failure);
  EXPECT_GT(*run.metric("std_force_error_N"), 0.05 * reference_N);
}

// Just below and above the page's onset.
INSTANTIATE_TEST_SUITE_P(
    ContactStiffness, EachStart,
    ::testing::Values(Start{"proposed-2N", 1820.0, 2000.0}, Start{"hpfc-2N", 3160.0, 3970.0},
                      Start{"drac-2N", 1410.0, 1680.0}, Start{"proposed-5N", 3160.0, 3750.0},
                      Start{"hpfc-5N", 5950.0, 7070.0}, Start{"drac-5N", 2000.0, 2290.0}),
    [](const auto& param) {
      std::string name = param.param.name;
      name.erase(name.find('-'), 1);
      return name;
    });

}  // namespace breakwater::contact_stiffness_study
