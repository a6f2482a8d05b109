// Breakwater's contact laws: the keys of each, and how it is made of them.
#include <breakwater/rigs/wall_settings.h>

namespace breakwater {
namespace {

using Law = std::unique_ptr<ContactForceLaw>;

void bind_stiffness(Fields& fields, double& stiffness) {
  fields.number("stiffness_N_m", stiffness, positive(),
                "K: stiffness of the contact as a whole, not of its steel; "
                "of hertz in N/m^1.5, of hunt_crossley in N/m^n [N/m]");
}

void bind_dissipation(Fields& fields, double& dissipation) {
  fields.number("dissipation_s_m", dissipation, not_negative(),
                "alpha: the force is that at rest times 1 + alpha times the speed [s/m]");
  fields.standard("dissipation_s_m", {0.0});
}

struct SpringAndDamper {
  double stiffness_N_m = 0.0;
  double damping_Ns_m = 0.0;
};

void bind_spring_and_damper(Fields& fields, SpringAndDamper& settings) {
  bind_stiffness(fields, settings.stiffness_N_m);
  fields.number("damping_Ns_m", settings.damping_Ns_m, not_negative(),
                "B: damping of the same chain [N s/m]");
}

template <KelvinVoigt::By by>
Law make_kelvin_voigt(const SpringAndDamper& settings) {
  return std::make_unique<KelvinVoigt>(settings.stiffness_N_m, settings.damping_Ns_m, by);
}

struct Hertz {
  double stiffness = 0.0;
};

void bind_hertz(Fields& fields, Hertz& settings) {
  bind_stiffness(fields, settings.stiffness);
}

Law make_hertz(const Hertz& settings) {
  return std::make_unique<HuntCrossley>(settings.stiffness, 1.5, 0.0);
}

struct HuntCrossleySettings {
  double stiffness = 0.0;
  double exponent = 1.5;
  double dissipation_s_m = 0.0;
  double restitution = 1.0;
  double restitution_speed_m_s = 0.0;
};

void bind_hunt_crossley(Fields& fields, HuntCrossleySettings& settings) {
  bind_stiffness(fields, settings.stiffness);
  fields.number("exponent", settings.exponent, between(1.0, 10.0),
                "n: the force at rest is the stiffness times the penetration to this power");
  fields.standard("exponent", {1.5});
  bind_dissipation(fields, settings.dissipation_s_m);
  fields.number(
      "restitution", settings.restitution, between(0.0, 1.0),
      "measured restitution, from which alpha follows; 1: contact.dissipation_s_m is alpha");
  fields.standard("restitution", {1.0});
  fields.number("restitution_speed_m_s", settings.restitution_speed_m_s, positive(),
                "impact speed at which the restitution was measured [m/s]");
  fields.standard("restitution_speed_m_s", {0.1});
  fields.only_where({"restitution_speed_m_s"}, "contact.restitution is below 1",
                    [&settings] { return settings.restitution < 1.0; });
}

Law make_hunt_crossley(const HuntCrossleySettings& settings) {
  double dissipation_s_m = settings.dissipation_s_m;
  if (settings.restitution == 0.0) {
    throw WrongKey("restitution",
                   "must be above 0: no finite contact.dissipation_s_m has a restitution of 0");
  }
  if (settings.restitution < 1.0) {
    if (dissipation_s_m > 0.0) {
      throw WrongKey("restitution", "give this or contact.dissipation_s_m, not both");
    }
    dissipation_s_m =
        dissipation_of_restitution(settings.restitution, settings.restitution_speed_m_s);
  }
  return std::make_unique<HuntCrossley>(settings.stiffness, settings.exponent, dissipation_s_m);
}

struct Layers {
  std::vector<std::vector<double>> points;
  double dissipation_s_m = 0.0;
};

void bind_layers(Fields& fields, Layers& settings) {
  fields.number_groups("layers", settings.points, positive(),
                       "points [depth in m, force in N] of the force at rest, which is linear "
                       "between them");
  bind_dissipation(fields, settings.dissipation_s_m);
}

Law make_layers(const Layers& settings) {
  return blame("layers", [&] {
    std::vector<LayeredContact::Point> points;
    for (const std::vector<double>& point : settings.points) {
      if (point.size() != 2) throw std::invalid_argument("each point must be [depth_m, force_N]");
      points.emplace_back(point[0], point[1]);
    }
    return std::make_unique<LayeredContact>(std::move(points), settings.dissipation_s_m);
  });
}

struct Solid {
  double stiffness_N_m = 0.0;
  double maxwell_stiffness_N_m = 0.0;
  double relaxation_s = 0.0;
};

void bind_solid(Fields& fields, Solid& settings) {
  bind_stiffness(fields, settings.stiffness_N_m);
  fields.number("maxwell_stiffness_N_m", settings.maxwell_stiffness_N_m, positive(),
                "K_1: stiffness of the spring in series with the damper, which is in parallel "
                "with contact.stiffness_N_m [N/m]");
  fields.number("relaxation_s", settings.relaxation_s, positive(),
                "tau: relaxation time of that spring and damper [s]");
}

Law make_solid(const Solid& settings) {
  return std::make_unique<StandardLinearSolid>(
      settings.stiffness_N_m, settings.maxwell_stiffness_N_m, settings.relaxation_s);
}

}  // namespace

std::vector<ContactLawKind> contact_laws() {
  return {{"kelvin_voigt", "spring and damper, as MuJoCo's own contact", bind_spring_and_damper,
           make_kelvin_voigt<KelvinVoigt::By::engine>},
          {"kelvin_voigt_clipped", "spring and damper, as a force that never pulls",
           bind_spring_and_damper, make_kelvin_voigt<KelvinVoigt::By::force>},
          {"hertz", "elastic sphere: k x^1.5", bind_hertz, make_hertz},
          {"hunt_crossley", "k x^n (1 + alpha v), alpha given or from a measured restitution",
           bind_hunt_crossley, make_hunt_crossley},
          {"layered", "layers such as a soft skin on a stiff core: piecewise linear, from a table",
           bind_layers, make_layers},
          {"standard_linear_solid", "spring beside a spring and damper in series: it relaxes",
           bind_solid, make_solid}};
}

}  // namespace breakwater
