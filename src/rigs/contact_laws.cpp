// Breakwater's contact laws: the keys of each, and how it is made of them.
#include <breakwater/rigs/contact_settings.h>

namespace breakwater {
namespace {

using Law = std::unique_ptr<ContactForceLaw>;

void bind_stiffness(Fields& fields, double& stiffness) {
  fields.number("stiffness_N_m", stiffness, positive(),
                "K: stiffness of the contact as a whole, not of its steel; "
                "of hertz in N/m^1.5, of hunt_crossley in N/m^n [N/m]");
}

void bind_dissipation(Fields& fields, double& dissipation) {
  fields.optional_number("dissipation_s_m", dissipation, not_negative(),
                         "alpha: the force is that at rest times 1 + alpha times the speed [s/m]");
}

struct SpringAndDamper {
  double stiffness_N_m = 0.0;
  double damping_Ns_m = 0.0;

  void bind(Fields& fields) {
    bind_stiffness(fields, stiffness_N_m);
    fields.number("damping_Ns_m", damping_Ns_m, not_negative(),
                  "B: damping of the same chain [N s/m]");
  }
  template <KelvinVoigt::By by>
  Law make() const {
    return std::make_unique<KelvinVoigt>(stiffness_N_m, damping_Ns_m, by);
  }
};

struct Hertz {
  double stiffness = 0.0;

  void bind(Fields& fields) { bind_stiffness(fields, stiffness); }
  Law make() const { return std::make_unique<HuntCrossley>(stiffness, 1.5, 0.0); }
};

struct HuntCrossleySettings {
  double stiffness = 0.0;
  double exponent = 1.5;
  double dissipation_s_m = 0.0;
  double restitution = 1.0;
  double restitution_speed_m_s = 0.1;

  void bind(Fields& fields) {
    bind_stiffness(fields, stiffness);
    fields.optional_number("exponent", exponent, between(1.0, 10.0),
                           "n: the force at rest is the stiffness times the penetration to this "
                           "power");
    bind_dissipation(fields, dissipation_s_m);
    fields.optional_number(
        "restitution", restitution, between(0.0, 1.0),
        "measured restitution, from which alpha follows; 1: contact.dissipation_s_m is alpha");
    fields.optional_number("restitution_speed_m_s", restitution_speed_m_s, positive(),
                           "impact speed at which the restitution was measured [m/s]");
    fields.either("restitution", "dissipation_s_m");
    fields.only_where({"restitution_speed_m_s"}, "contact.restitution is below 1",
                      [this] { return restitution < 1.0; });
  }
  Law make() const {
    double dissipation = dissipation_s_m;
    if (restitution == 0.0) {
      throw WrongKey("restitution",
                     "must be above 0: no finite contact.dissipation_s_m has a restitution of 0");
    }
    if (restitution < 1.0) {
      if (dissipation > 0.0) {
        throw WrongKey("restitution", "give this or contact.dissipation_s_m, not both");
      }
      dissipation = dissipation_of_restitution(restitution, restitution_speed_m_s);
    }
    return std::make_unique<HuntCrossley>(stiffness, exponent, dissipation);
  }
};

struct Layers {
  std::vector<std::vector<double>> points;
  double dissipation_s_m = 0.0;

  void bind(Fields& fields) {
    fields.number_groups("layers", points, positive(),
                         "points [depth in m, force in N] of the force at rest, which is linear "
                         "between them");
    bind_dissipation(fields, dissipation_s_m);
  }
  Law make() const {
    return blame("layers", [&] {
      std::vector<LayeredContact::Point> pairs;
      for (const std::vector<double>& point : points) {
        if (point.size() != 2) throw std::invalid_argument("each point must be [depth_m, force_N]");
        pairs.emplace_back(point[0], point[1]);
      }
      return std::make_unique<LayeredContact>(std::move(pairs), dissipation_s_m);
    });
  }
};

struct Solid {
  double stiffness_N_m = 0.0;
  double maxwell_stiffness_N_m = 0.0;
  double relaxation_s = 0.0;

  void bind(Fields& fields) {
    bind_stiffness(fields, stiffness_N_m);
    fields.number("maxwell_stiffness_N_m", maxwell_stiffness_N_m, positive(),
                  "K_1: stiffness of the spring in series with the damper, which is in parallel "
                  "with contact.stiffness_N_m [N/m]");
    fields.number("relaxation_s", relaxation_s, positive(),
                  "tau: relaxation time of that spring and damper [s]");
  }
  Law make() const {
    return std::make_unique<StandardLinearSolid>(stiffness_N_m, maxwell_stiffness_N_m,
                                                 relaxation_s);
  }
};

}  // namespace

std::vector<ContactLawKind> contact_laws() {
  return {{"kelvin_voigt", "spring and damper, as MuJoCo's own contact",
           &SpringAndDamper::make<KelvinVoigt::By::engine>},
          {"kelvin_voigt_clipped", "spring and damper, as a force that never pulls",
           &SpringAndDamper::make<KelvinVoigt::By::force>},
          {"hertz", "elastic sphere: k x^1.5", &Hertz::make},
          {"hunt_crossley", "k x^n (1 + alpha v), alpha given or from a measured restitution",
           &HuntCrossleySettings::make},
          {"layered", "layers such as a soft skin on a stiff core: piecewise linear, from a table",
           &Layers::make},
          {"standard_linear_solid", "spring beside a spring and damper in series: it relaxes",
           &Solid::make}};
}

}  // namespace breakwater
