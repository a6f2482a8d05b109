// impact_test against closed forms, an integration of its own, momentum and energy.
#include <breakwater/rigs/contact_settings.h>
#include <breakwater/sim/contact.h>
#include "regression/run_case.h"

namespace breakwater::impact_scenario_test {
namespace {

using testing::completed_run;
using testing::Sets;
using testing::operator+;

constexpr const char* kScenario = "impact_test";

double metric_of(const Recording& run, const char* metric) {
  const auto found = run.metric(metric);
  if (!found) throw std::runtime_error(std::string(metric) + " is absent");
  return *found;
}

std::string key(const std::string& name, double value) {
  std::ostringstream text;
  text.precision(17);
  text << name << "=" << value;
  return text.str();
}

struct Impact {
  double peak_N = 0.0;
  double contact_time_s = 0.0;
  double restitution = 0.0;
  double penetration_m = 0.0;
};

// A law as the keys have it and as the equations have it: force of x, ẋ and z, with ż.
struct Law {
  std::string name;
  Sets keys;
  std::function<double(double x, double v, double z, double& dz)> force;
  double time_s = 0.0;  // about how long the contact takes
};

// Each law with a stiffness K and an impact of 1 kg with v.
std::vector<Law> laws(double K, double v) {
  const double omega = std::sqrt(K);
  const double B = 0.2 * omega;
  const double depth = v / omega;
  const double hertz_s = 2.9432 * std::pow(1.25 * v * v / K, 0.4) / v;
  const double alpha = 0.4 / v, tau = 0.3 / omega;
  const auto power = [K](double x) { return K * x * std::sqrt(x); };
  const auto kelvin_voigt = [=](double x, double u, double, double&) { return K * x + B * u; };
  const double x1 = 0.5 * depth, f1 = 0.25 * K * depth, x2 = depth, f2 = K * depth;
  std::ostringstream table;
  table.precision(17);
  table << "contact.layers=[[" << x1 << "," << f1 << "],[" << x2 << "," << f2 << "]]";
  return {{"kelvin_voigt", {key("contact.damping_Ns_m", B)}, kelvin_voigt, 3.2 / omega},
          {"kelvin_voigt_clipped", {key("contact.damping_Ns_m", B)}, kelvin_voigt, 3.2 / omega},
          {"hertz", {}, [=](double x, double, double, double&) { return power(x); }, hertz_s},
          {"hunt_crossley",
           {"contact.restitution=1", key("contact.dissipation_s_m", alpha)},
           [=](double x, double u, double, double&) { return power(x) * (1.0 + alpha * u); },
           1.3 * hertz_s},
          {"layered",
           {table.str(), "contact.dissipation_s_m=0"},
           [=](double x, double, double, double&) {
             return x < x1 ? f1 / x1 * x : f1 + (f2 - f1) / (x2 - x1) * (x - x1);
           },
           4.2 / omega},
          {"standard_linear_solid",
           {key("contact.maxwell_stiffness_N_m", K), key("contact.relaxation_s", tau)},
           [=](double x, double, double z, double& dz) {
             dz = (x - z) / tau;
             return K * x + K * (x - z);
           },
           3.2 / omega}};
}

// RK4 of its own, 10 000 steps a contact.
Impact integrated(const Law& law, double speed_m_s) {
  Impact impact;
  const double h = law.time_s / 10000.0;
  double x = 0.0, v = speed_m_s, z = 0.0;
  const auto force = [&](double px, double pv, double pz, double& dz) {
    return std::max(law.force(std::max(px, 0.0), pv, pz, dz), 0.0);
  };
  for (int k = 0;; ++k) {
    double dz[4] = {}, a[4], w[4];
    double px = x, pv = v, pz = z;
    for (int s = 0; s < 4; ++s) {
      w[s] = pv;
      a[s] = -force(px, pv, pz, dz[s]);
      if (s == 0 && k > 0 && a[0] == 0.0) {
        impact.contact_time_s = k * h;
        impact.restitution = -v / speed_m_s;
        return impact;
      }
      if (s == 0) impact.peak_N = std::max(impact.peak_N, -a[0]);
      const double part = h * (s < 2 ? 0.5 : 1.0);
      px = x + part * w[s];
      pv = v + part * a[s];
      pz = z + part * dz[s];
    }
    x += h / 6.0 * (w[0] + 2.0 * w[1] + 2.0 * w[2] + w[3]);
    v += h / 6.0 * (a[0] + 2.0 * a[1] + 2.0 * a[2] + a[3]);
    z += h / 6.0 * (dz[0] + 2.0 * dz[1] + 2.0 * dz[2] + dz[3]);
    impact.penetration_m = std::max(impact.penetration_m, x);
  }
}

Recording impact_run(const Law& law, double K, double v, const Sets& more = {}) {
  Sets sets = {key("contact.stiffness_N_m", K), key("impact.speed_m_s", v), "impact.distance_m=0",
               key("run.duration_s", 1.5 * law.time_s + 1e-3), "record.fine_to_s=0"};
  // A soft wall needs no finer step than one of 10 kN/m.
  if (K < 1e4) sets.emplace_back("physics.timestep_s=1e-4");
  return completed_run(kScenario, law.name, sets + law.keys + more, testing::kWithoutLog);
}

TEST(ImpactScenario, IsWithinOnePercentOverStiffnessAndSpeed) {
  for (const double K : {1e2, 1e4, 1e6}) {
    for (const double v : {0.01, 0.2, 2.0}) {
      for (const Law& law : laws(K, v)) {
        const Impact expected = integrated(law, v);
        const Recording run = impact_run(law, K, v);
        const auto is_near = [&](const char* metric, double value) {
          ASSERT_TRUE(run.metric(metric)) << law.name << " " << metric;
          EXPECT_NEAR(metric_of(run, metric), value, 0.01 * value)
              << law.name << " " << metric << " K = " << K << " v = " << v;
        };
        is_near("peak_force_raw_N", expected.peak_N);
        is_near("contact_time_s", expected.contact_time_s);
        is_near("restitution", expected.restitution);
        is_near("penetration_m", expected.penetration_m);
        // Momentum, by the integrator's own stages.
        const double change_Ns = v * (1.0 + metric_of(run, "restitution"));
        EXPECT_NEAR(metric_of(run, "contact_impulse_Ns"), change_Ns, 1e-6 * change_Ns) << law.name;
        EXPECT_EQ(metric_of(run, "bounce_count"), 0.0);
      }
    }
  }
}

TEST(ImpactScenario, KelvinVoigtIsItsClosedForm) {
  const double K = 1e4, B = 30.0, v = 0.2;
  const Recording run =
      completed_run(kScenario, "kelvin_voigt_clipped",
                    {"impact.distance_m=0", "run.duration_s=0.05", "contact.damping_Ns_m=30"});
  const double sigma = 0.5 * B, omega = std::sqrt(K - sigma * sigma);
  // F = m v e^{−σt} (2σ cos ωt + (ω² − σ²)/ω sin ωt), until it is 0.
  const double end_s =
      (M_PI - std::atan2(2.0 * sigma * omega, omega * omega - sigma * sigma)) / omega;
  const double restitution = -std::exp(-sigma * end_s) *
                             (std::cos(omega * end_s) - sigma / omega * std::sin(omega * end_s));
  EXPECT_NEAR(metric_of(run, "contact_time_s"), end_s, 2e-5);
  EXPECT_NEAR(metric_of(run, "restitution"), restitution, 1e-4 * restitution);
  const double depth_m = v / std::sqrt(K) * std::exp(-sigma / omega * std::atan2(omega, sigma));
  EXPECT_NEAR(metric_of(run, "penetration_m"), depth_m, 1e-4 * depth_m);
}

TEST(ImpactScenario, HertzIsItsClosedForm) {
  for (const double k : {1e4, 1e6}) {
    for (const double v : {0.1, 1.0}) {
      const Law law = laws(k, v)[2];
      const Recording run = impact_run(law, k, v);
      const double depth_m = std::pow(5.0 * v * v / (4.0 * k), 0.4);
      EXPECT_NEAR(metric_of(run, "penetration_m"), depth_m, 1e-6 * depth_m);
      EXPECT_NEAR(metric_of(run, "contact_time_s"), 2.9432 * depth_m / v, 2e-5);
      // Energy.
      EXPECT_NEAR(std::pow(metric_of(run, "restitution"), 2), 1.0, 1e-6);
    }
  }
}

// Laws whose force is continuous keep the energy balance to 1e-6 under rk4.
TEST(ImpactScenario, EnergyIsThatOfTheIntegratedLaw) {
  for (const Law& law : laws(1e4, 0.2)) {
    if (law.name.starts_with("kelvin_voigt")) continue;
    const double expected = integrated(law, 0.2).restitution;
    const double found = *impact_run(law, 1e4, 0.2).metric("restitution");
    EXPECT_NEAR(found * found, expected * expected, 1e-6) << law.name;
  }
}

TEST(ImpactScenario, OtherwiseTheErrorFallsWithTheTimestep) {
  for (const char* integrator : {"euler", "implicit", "rk4"}) {
    for (const Law& law : laws(1e4, 0.2)) {
      const bool is_continuous = !law.name.starts_with("kelvin_voigt");
      // The compiled law has MuJoCo's added mass, which no timestep removes.
      if (law.name == "kelvin_voigt" || (is_continuous && integrator[0] == 'r')) continue;
      const double expected = integrated(law, 0.2).restitution;
      const auto error = [&](double h) {
        // The same part of a step before each contact.
        const Recording run =
            impact_run(law, 1e4, 0.2,
                       {key("physics.timestep_s", h), key("impact.distance_m", 0.3 * 0.2 * h),
                        std::string("physics.integrator=") + integrator});
        return std::abs(metric_of(run, "restitution") - expected);
      };
      const double fine = error(2e-5);
      EXPECT_LT(fine, 0.7 * error(4e-5) + 1e-7) << law.name << " " << integrator;
      EXPECT_LT(fine, 2e-3) << law.name << " " << integrator;
    }
  }
}

// A law from outside, by a function.
struct Cubic final : ContactForceLaw {
  explicit Cubic(double k) : stiffness(k) {}
  double force(double penetration_m, double, ContactState&) const override {
    return stiffness * penetration_m * penetration_m * penetration_m;
  }
  double stiffness;
};

TEST(ContactLawKinds, AUserAddsOneWithAFunction) {
  Catalogue own = standard_catalogue();
  struct Settings {
    double stiffness = 0.0;
  };
  own.add(ContactLawKind(
      "cubic", "k x^3",
      +[](Fields& fields, Settings& settings) {
        fields.number("cubic_N_m3", settings.stiffness, positive(), "k [N/m^3]");
      },
      +[](const Settings& settings) -> std::unique_ptr<ContactForceLaw> {
        return std::make_unique<Cubic>(settings.stiffness);
      }));
  const PreparedRun run = prepare_run(
      own, kScenario, testing::scenario_file(kScenario), "kelvin_voigt",
      {"contact.law=cubic", "contact.cubic_N_m3=1e8", "run.duration_s=0.2", "impact.distance_m=0"});
  const Recording recording = run.scenario->run({});
  // k x⁴/4 = m v²/2
  EXPECT_NEAR(*recording.metric("penetration_m"), std::pow(2.0 * 0.04 / 1e8, 0.25), 1e-7);
  EXPECT_NEAR(*recording.metric("restitution"), 1.0, 1e-6);
}

}  // namespace
}  // namespace breakwater::impact_scenario_test
