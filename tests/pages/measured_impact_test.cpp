// A recorded impact over a simulated one.
#include <breakwater/pages/measured_impact.h>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/program.h"

namespace breakwater {
namespace {

// Half a sine of 10 N and 20 ms that begins at 0.1 s, and a smaller one later.
Series half_sines(double step_s) {
  Series force;
  for (int k = 0; k * step_s < 0.3; ++k) {
    const double t = k * step_s;
    const double first = t > 0.1 && t < 0.12 ? 10.0 * std::sin(M_PI * (t - 0.1) / 0.02) : 0.0;
    const double second = t > 0.2 && t < 0.21 ? 4.0 * std::sin(M_PI * (t - 0.2) / 0.01) : 0.0;
    force.times_s.push_back(t);
    force.values.push_back(first + second);
  }
  return force;
}

TEST(MeasuredImpact, FirstPulseIsThatOfAHalfSine) {
  const ImpactPulse pulse = first_pulse(half_sines(1e-5));
  const double cut_s = 0.02 / M_PI * std::asin(kContactShare);  // below the threshold
  EXPECT_NEAR(pulse.begin_s, 0.1 + cut_s, 1e-6);
  EXPECT_NEAR(*pulse.duration_s, 0.02 - 2.0 * cut_s, 1e-6);
  EXPECT_NEAR(pulse.peak_N, 10.0, 1e-4);
  EXPECT_NEAR(pulse.impulse_Ns, 2.0 / M_PI * 10.0 * 0.02, 1e-4);
}

TEST(MeasuredImpact, InertiaBeforeTheContactIsNotPartOfIt) {
  const Series force = half_sines(1e-5);
  const ImpactPulse pulse = first_pulse(force, 0.15);
  EXPECT_NEAR(pulse.begin_s, 0.2, 1e-3);
  EXPECT_NEAR(pulse.peak_N, 4.0, 1e-4);
  // The sensor reads inertia when the contact begins.
  EXPECT_NEAR(first_pulse(force, 0.105).begin_s, 0.105, 1.1e-5);
}

TEST(MeasuredImpact, AContactThatDoesNotEndHasNoDuration) {
  const ImpactPulse pulse = first_pulse({{0.0, 1.0, 2.0}, {0.0, 1.0, 1.0}});
  EXPECT_FALSE(pulse.duration_s);
  EXPECT_EQ(pulse.impulse_Ns, 1.5);
}

TEST(MeasuredImpact, RefusesAForceWithoutAContact) {
  const std::vector<std::pair<Series, std::string>> rows = {
      {{}, "no samples"},
      {{{0.0, 1.0}, {0.0, -1.0}}, "never positive from 0 to 1 s"},
      {{{0.0, 1.0}, {1.0, 0.0}}, "begins in contact"}};
  for (const auto& [series, words] : rows) {
    EXPECT_TRUE(has(complaint_of([&] { first_pulse(series); }), words));
  }
}

class MeasuredImpacts : public testing::ProgramTest {};

TEST_F(MeasuredImpacts, AreComparedWithARunAlignedAtTheFirstContact) {
  ran("impact_test --case hertz --set run.duration_s=0.06 force.filter_time_constant_s=0 --out "
      "run");
  // The run's own force, 1 s later and 10 % larger, with every fourth sample.
  const SavedRun run(folder_ / "run");
  const Series force = run.signal("physics/force_true_N");
  std::ostringstream table;
  table.precision(17);
  table << "time_s;force_N\n";
  for (std::size_t i = 0; i < force.values.size(); i += 4) {
    table << 1.0 + force.times_s[i] << ";" << 1.1 * force.values[i] << "\n";
  }
  write("lab.csv", table.str());
  const auto json =
      nlohmann::json::parse(ran("breakwater compare run --measured lab.csv --json").out);
  const double peak_N = json["simulated"]["peak_N"];
  EXPECT_NEAR(json["measured"]["peak_N"], 1.1 * peak_N, 1e-5 * peak_N);
  EXPECT_NEAR(json["measured"]["duration_s"], json["simulated"]["duration_s"], 1e-6);
  EXPECT_NEAR(json["measured"]["impulse_Ns"], 1.1 * 0.4, 1e-3);
  // A tenth of the root mean square force.
  double sum = 0.0, count = 0.0;
  for (const double value : force.values) {
    sum += value * value;
    if (value > 0.0) ++count;
  }
  EXPECT_NEAR(json["rmse_N"], 0.1 * std::sqrt(sum / count), 0.003 * peak_N);
  EXPECT_TRUE(has(read("run/measured.html"), "measured", "RMSE", "lab.csv"));
  // The table has as many digits as the user asks for.
  for (const int digits : {3, 9}) {
    const std::string shown =
        ran(fmt::format("breakwater compare run --measured lab.csv --digits {}", digits)).out;
    EXPECT_TRUE(has(shown, fmt::format(" {:.{}g} ", peak_N, digits))) << shown;
  }
}

TEST_F(MeasuredImpacts, AreComparedUpToTheirEndIfTheSimulatedContactDoesNotEnd) {
  ran("impact_test --case standard_linear_solid --set run.duration_s=0.06 impact.push_N=200 "
      "contact.stiffness_N_m=1e3 --out run");
  write("lab.csv", "time_s,force_N\n0,0\n0.001,5\n0.01,5\n0.011,0\n0.02,0\n");
  const auto json =
      nlohmann::json::parse(ran("breakwater compare run --measured lab.csv --json").out);
  EXPECT_TRUE(json["simulated"]["duration_s"].is_null());
  EXPECT_NEAR(json["measured"]["duration_s"], 0.011, 1e-3);
  // The simulated impulse is that of 20 ms.
  const Series force = SavedRun(folder_ / "run").signal("physics/force_sensor_N");
  const double whole_Ns = first_pulse(force).impulse_Ns;
  EXPECT_GT(json["simulated"]["impulse_Ns"], 0.0);
  EXPECT_LT(json["simulated"]["impulse_Ns"], 0.9 * whole_Ns);
}

TEST_F(MeasuredImpacts, OfTheExampleFileIsRead) {
  const Series example = read_measured_force(testing::source_file("data/impacts/rubber-ball.csv"));
  const ImpactPulse pulse = first_pulse(example);
  // Momentum of 0.5 kg at 0.25 m/s, of which some comes back.
  EXPECT_GT(pulse.impulse_Ns, 0.5 * 0.25);
  EXPECT_LT(pulse.impulse_Ns, 2.0 * 0.5 * 0.25);
}

}  // namespace
}  // namespace breakwater
