// TLSC must be faster than the thesis' method and softer than HPFC:
// docs/explanation/methods/soft-contact.md. A short protocol: the switch at 10 s with the arm at
// rest; errors from 13 to 18 s.

#include <cmath>

#include "regression/run_case.h"

namespace breakwater::soft_contact_regression {
namespace {

using Sets = std::vector<std::string>;

Sets briefly(Sets sets = {}) {
  const Sets brief = {"run.duration_s=18",  "wall.solid_from_s=9",      "force.from_s=10",
                      "metrics.from_s=13",  "metrics.to_s=18",          "record.fine_from_s=0",
                      "record.fine_to_s=0", "sensor.force_noise_N=0.02"};
  sets.insert(sets.end(), brief.begin(), brief.end());
  return sets;
}

Recording contact(const std::string& case_name, const Sets& sets = {}) {
  Recording run = testing::run_case("arm_wall_contact", case_name, briefly(sets));
  EXPECT_FALSE(run.failure) << case_name;
  return run;
}

double value(const Recording& run, const char* metric) {
  return run.metric(metric).value_or(NAN);
}

struct Promise {
  const char* force;  // "2N"
  double free_s;
  double peak_N;
};

class Tlsc : public ::testing::TestWithParam<Promise> {};

TEST_P(Tlsc, KeepsItsLimitsOverSeeds) {
  const auto [force, free_s, peak_N] = GetParam();
  for (const char* seed : {"11", "12", "13"}) {
    SCOPED_TRACE(seed);
    const Recording run = contact("tlsc-" + std::string(force), {"run.seed=" + std::string(seed)});
    EXPECT_LE(value(run, "free_motion_time_s"), free_s);
    EXPECT_LE(value(run, "peak_force_filtered_N"), peak_N);
    EXPECT_LE(value(run, "max_y_error_m"), 0.002);
    EXPECT_LE(value(run, "max_posture_error_rad"), 0.005);
    EXPECT_LE(std::abs(value(run, "mean_force_error_N")), 0.005);
    EXPECT_EQ(value(run, "bounce_count"), 0.0);
  }
}

TEST_P(Tlsc, IsFasterThanProposedAndSofterThanHpfc) {
  const std::string force = GetParam().force;
  const Recording tlsc = contact("tlsc-" + force);
  const Recording proposed = contact("proposed-" + force), hpfc = contact("hpfc-" + force);
  EXPECT_LT(value(tlsc, "free_motion_time_s"), value(proposed, "free_motion_time_s"));
  EXPECT_LT(value(tlsc, "peak_force_filtered_N"), value(hpfc, "peak_force_filtered_N"));
}

TEST_P(Tlsc, DoesNotBounceOnStifferWalls) {
  for (const char* stiffness : {"3000", "10000"}) {
    const Recording run =
        contact("tlsc-" + std::string(GetParam().force),
                {"contact.stiffness_N_m=" + std::string(stiffness), "contact.damping_Ns_m=10"});
    EXPECT_EQ(value(run, "bounce_count"), 0.0) << stiffness;
    EXPECT_LE(std::abs(value(run, "mean_force_error_N")), 0.005) << stiffness;
  }
}

INSTANTIATE_TEST_SUITE_P(SoftContact, Tlsc,
                         ::testing::Values(Promise{"2N", 0.490, 4.2}, Promise{"5N", 0.395, 7.6}),
                         [](const auto& row) { return "at" + std::string(row.param.force); });

TEST(SoftContact, IsTheSameWithTheFrictionOfTheModel) {
  const Sets brief = {"run.duration_s=11", "wall.solid_from_s=9", "force.from_s=10",
                      "metrics.from_s=10"};
  Sets named = brief;
  named.push_back("plant.friction_Nm=4");
  Sets none = brief;
  none.push_back("plant.friction_Nm=0");
  const auto hash = [](const Sets& sets) {
    return testing::run_case("arm_wall_contact", "proposed-2N", sets).state_hash;
  };
  EXPECT_EQ(hash(named), hash(brief));
  EXPECT_NE(hash(none), hash(brief));
}

TEST(SoftContact, RecoversFromAPushOfEachLinkByItsJoints) {
  for (const char* name : {"tlsc-link1", "tlsc-link2", "tlsc-link3"}) {
    const Recording run = testing::completed_run("arm_push", name);
    EXPECT_LT(value(run, "overshoot_rad"), 0.05) << name;
    EXPECT_LT(value(run, "settling_time_s"), 1.7) << name;
  }
}

}  // namespace
}  // namespace breakwater::soft_contact_regression
