// The thesis' numbers, and properties of any correct simulation.
#include <breakwater/thesis/printed_results.h>
#include "regression/run_case.h"

namespace breakwater::arm_wall_contact_test {
namespace {

using testing::completed_run;
using testing::run_case;

constexpr const char* kWallContact = "arm_wall_contact";

// Long enough for the impact, but not for the steady state.
const std::vector<std::string> kImpactOnly = testing::switched_at_10_s(13);

std::vector<std::string> impact_with(std::vector<std::string> sets) {
  sets.insert(sets.end(), kImpactOnly.begin(), kImpactOnly.end());
  return sets;
}

class EachWallContact : public ::testing::TestWithParam<const char*> {};

TEST_P(EachWallContact, IsWithinTheClassesOfItsPrintedNumbers) {
  const Recording run = completed_run(kWallContact, GetParam());
  const auto values = printed_values(kWallContact, GetParam());
  ASSERT_GE(values.size(), 2U);
  for (const PrintedValue& value : values) {
    const auto measured = run.metric(value.metric);
    ASSERT_TRUE(measured) << value.metric;
    // The thesis explains 0.08 and 0.18 N by a lasting saturation, which does not occur here.
    const bool is_missing = value.metric == "mean_force_error_N" && value.number() > 0.01;
    EXPECT_EQ(value.verdict(*measured) == Verdict::not_reproduced, is_missing)
        << value.metric << ": " << *measured << ", printed " << value.result.text();
  }
  for (const char* metric :
       {"free_motion_time_s", "peak_force_raw_N", "peak_force_filtered_N", "mean_force_error_N",
        "std_force_error_N", "impact_velocity_m_s", "contact_impulse_Ns", "bounce_count",
        "saturated_time_s", "max_posture_error_rad", "max_y_error_m", "late_bounce_count",
        "force_decay_ratio", "force_frequency_Hz", "impact_mass_kg"}) {
    ASSERT_TRUE(run.metric(metric)) << metric;
  }
  // An impulse of 200 ms cannot exceed the raw peak times its length.
  EXPECT_LT(*run.metric("contact_impulse_Ns"), 0.2 * *run.metric("peak_force_raw_N"));
  EXPECT_GE(*run.metric("peak_force_raw_N"), *run.metric("peak_force_filtered_N"));
}

INSTANTIATE_TEST_SUITE_P(Regression, EachWallContact,
                         ::testing::Values("proposed-2N", "hpfc-2N", "drac-2N", "proposed-5N",
                                           "hpfc-5N", "drac-5N", "tuned-2N", "tuned-5N"),
                         [](const auto& param) {
                           std::string name = param.param;
                           name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                           return name;
                         });

TEST(WallContact, SteadyForceIsTheReferenceAndTheDepthIsForceOverStiffness) {
  const Recording run = run_case(kWallContact, "proposed-5N", {"run.duration_s=60"});
  const Track& log = run.track("control");
  const double x = log.values("x_true_m").back();
  const double force = log.values("force_true_N").back();
  EXPECT_NEAR(force, 5.0, 0.02);
  EXPECT_NEAR(x - (0.45 + 0.089), force / 1000.0, 1e-5);
}

// The arm with its force sensor as a second body on a slide, and a stiff wall. The slide has a
// spring of 1 kN/m and a damper of 10 N s/m, so the compliance is not in the contact.
TEST(WallContact, AnElasticLoadCellGivesTheSamePeaks) {
  using testing::replaced;
  std::string mjcf = replaced(
      testing::text_of(testing::source_file("models/arm.xml")),
      "<body name=\"tip\" pos=\"0.19 0 0\">",
      "<body name=\"tip\" pos=\"0.19 0 0\"><joint name=\"load_cell\" type=\"slide\" "
      "axis=\"1 0 0\" armature=\"0\" frictionloss=\"0\" stiffness=\"1000\" damping=\"10\"/>");
  mjcf = replaced(mjcf, "mass=\"0.02\" diaginertia", "mass=\"0.05\" diaginertia");
  mjcf = replaced(mjcf, "qpos=\"0 0 0\"", "qpos=\"0 0 0 0\"");
  const testing::TemporaryPath file{"load_cell.xml", mjcf};

  for (const char* name : {"proposed-2N", "proposed-5N"}) {
    const Recording chain = run_case(kWallContact, name, kImpactOnly);
    const Recording cell =
        completed_run(kWallContact, name,
                      impact_with({"model.mjcf=" + file.string(), "contact.stiffness_N_m=1e6",
                                   "contact.damping_Ns_m=200"}));
    const auto peak = [](const Recording& run, const char* signal) {
      const auto values = run.track("physics").values(signal);
      return *std::max_element(values.begin(), values.end());
    };
    for (const char* signal : {"force_sensor_N", "force_filtered_N"}) {
      EXPECT_NEAR(peak(cell, signal), peak(chain, signal), 0.01 * peak(chain, signal))
          << name << " " << signal;
    }
  }
}

// The quadrotor under waves: equal runs, older files, and readings. Its bounds are in cases.txt.

// A run of an earlier version: C_m alone, and the state hash that it had.
TEST(QuadrotorWaves, OldFilesKeepAVehicleWithoutAddedMass) {
  const ScenarioFile shipped = testing::scenario_file("quadrotor_waves");
  const testing::TemporaryPath path("older.toml");
  const std::string key = "added_mass_coefficient = 0.5 ";
  std::ofstream(path) << testing::replaced(shipped.text(), key, "#");
  const auto older = [&](const std::string& file) {
    return prepare_run(testing::catalogue(), "quadrotor_waves",
                       ScenarioFile(file, "quadrotor_waves"), "resonator",
                       {"run.duration_s=5", "metrics.window_s=2", "wave.inertia_coefficient=1.5"});
  };
  const PreparedRun run = older(path.string());
  EXPECT_EQ(run.scenario->run({}).state_hash, 0x80480e5c71fc68f2U);
  EXPECT_TRUE(lacks(run.config_text, "added_mass_coefficient ="));
  const testing::TemporaryPath again("again.toml");
  std::ofstream(again) << run.config_text;
  EXPECT_EQ(older(again.string()).config_text, run.config_text);
}

TEST(QuadrotorWaves, SetsHavePriorityOverTheReading) {
  const PreparedRun run = testing::prepare("quadrotor_waves", "ukf-zero",
                                           {"controller.gains=printed", "reading=literal"});
  EXPECT_TRUE(has(run.config_text, "gains = \"printed\"", "interpretation = \"variance\"",
                  "disturbance = \"zero\""));
}

TEST(QuadrotorWaves, WarnsOfUnstableGains) {
  const auto warnings = [&](const char* gains) {
    return testing::prepare("quadrotor_waves", "resonator", {gains}).scenario->warnings().size();
  };
  EXPECT_EQ(warnings("controller.gains=printed"), 1U);
  EXPECT_EQ(warnings("controller.gains=retuned"), 0U);
}

}  // namespace
}  // namespace breakwater::arm_wall_contact_test
