#include <breakwater/rigs/contact_settings.h>

#include <limits>

#include <breakwater/config/column_table.h>
#include <breakwater/math/functions.h>
#include <breakwater/sim/contact.h>
#include <breakwater/sim/model.h>

namespace breakwater {
namespace {

constexpr const char* kMotion = "wall.motion";
constexpr double kLargestTilt_rad = 1.5;
constexpr double kHeavy_kg = std::numeric_limits<double>::infinity();

}  // namespace

void ContactSettings::bind(Fields& fields) {
  if (!name.empty()) {
    const Fields::Under under(fields, prefix());
    fields.text("geom_1", geom_1, "geom of the model");
    fields.text("geom_2", geom_2, "geom of the model that may touch the first one");
  }
  bind_wall(fields);
  const Fields::Under under(fields, prefix());
  law_.bind(fields);
  fields.optional_number("friction_coefficient", friction_.coefficient, not_negative(),
                         "mu: coefficient of the dry friction across the wall's normal; 0: none");
  fields.optional_number("friction_stick_m_s", friction_.stick_m_s, positive(),
                         "sliding speed below which the friction is a damper: the contact creeps "
                         "where it would stick");
  fields.only_with({"friction_stick_m_s"}, "friction_coefficient");
}

void ContactSettings::bind_wall(Fields& fields) {
  const Fields::Under under(fields, wall());
  fields.optional_number(
      "wall.angle_rad", angle_rad_, between(-kLargestTilt_rad, kLargestTilt_rad),
      "tilt of the wall about its axis nearest to the vertical, or its y axis if it is "
      "horizontal, counter-clockwise seen from above");
  fields.optional_choice(
      kMotion, motion_.kind,
      {{"fixed", WallMotionKind::fixed},
       {"ramp", WallMotionKind::ramp},
       {"sine", WallMotionKind::sine},
       {"csv", WallMotionKind::csv},
       {"free", WallMotionKind::free}},
      "motion along the wall's normal, positive away from the tip; free: a mass on a "
      "spring and a damper");
  const auto of = [&](const char* kind, auto&& bind_keys) {
    const Fields::OfPart part(fields, kMotion, kind);
    bind_keys();
  };
  const auto start = [&](double& start_s) {
    fields.optional_number("wall.motion_from_s", start_s, not_negative(),
                           "time at which the wall begins to move");
  };
  of("ramp", [&] {
    start(motion_.ramp.start_s);
    fields.number("wall.speed_m_s", motion_.ramp.amplitude, any(),
                  "speed of the wall, positive away from the tip");
  });
  of("sine", [&] {
    start(motion_.sine.start_s);
    fields.number("wall.amplitude_m", motion_.sine.amplitude, not_negative(),
                  "amplitude of the wall's motion");
    fields.number("wall.frequency_rad_s", motion_.sine.frequency_rad_s, positive(),
                  "angular frequency of the wall's motion");
  });
  of("csv", [&] {
    fields.file("wall.file", file_,
                "table of the wall's motion, with the columns time_s and position_m");
  });
  of("free", [&] {
    fields.number("wall.mass_kg", motion_.mass_kg, positive(), "mass of the wall");
    fields.number("wall.stiffness_N_m", motion_.stiffness_N_m, not_negative(),
                  "stiffness of the spring that holds the wall");
    fields.number("wall.damping_Ns_m", motion_.damping_Ns_m, not_negative(),
                  "damping of what holds the wall");
  });
}

void ContactSettings::check(const Config& config, const PhysicsSettings& physics) const {
  law_.check(config.under(prefix()));
  const Config own = config.under(wall());
  own.blame("wall.file", [&] { motion(); });
  const bool has_law = make_law() != nullptr;
  if (!has_law && (motion_.kind != WallMotionKind::fixed || angle_rad_ != 0.0)) {
    own.fail(motion_.kind != WallMotionKind::fixed ? kMotion : "wall.angle_rad",
             "needs a law: the contact of the model file knows no such wall");
  }
  if (!has_law && has_friction()) {
    config.under(prefix()).fail("friction_coefficient",
                                "needs a law: the contact of the model file has its own");
  }
  if (motion_.kind != WallMotionKind::free) return;
  // At the beginning of a contact with a body that is much heavier than the wall.
  const ContactSlopes slopes =
      with_wall(slopes_of(*make_law(), ContactState(), 0.0, 0.0, kHeavy_kg), motion_);
  if (is_stable(physics.integrator, physics.timestep_s, slopes)) return;
  config.fail("physics.timestep_s", limit_in_words(physics.integrator, physics.timestep_s, slopes));
}

WallMotion ContactSettings::motion() const {
  WallMotion motion = motion_;
  if (motion.kind != WallMotionKind::csv) return motion;
  motion.csv.table = read_function(file_, "position_m");
  return motion;
}

std::unique_ptr<ContactForceLaw> ContactSettings::make_law() const {
  std::unique_ptr<ContactForceLaw> law = law_.make();
  const KelvinVoigt* engine = law ? law->for_engine() : nullptr;
  const bool is_smooth = !has_friction();
  if (engine == nullptr || (is_smooth && motion_.kind == WallMotionKind::fixed)) return law;
  // MuJoCo's contact knows neither this friction nor the speed of a wall that moves.
  return std::make_unique<KelvinVoigt>(*engine, KelvinVoigt::By::force);
}

bool ContactSettings::is_of_engine() const {
  const std::unique_ptr<ContactForceLaw> law = make_law();
  return !law || law->for_engine() != nullptr;
}

std::pair<std::string, std::string> ContactSettings::geoms(const Model& model) const {
  const bool is_plane_first = model->geom_type[geom_id(model, geom_1)] == mjGEOM_PLANE;
  return is_plane_first ? std::pair(geom_2, geom_1) : std::pair(geom_1, geom_2);
}

void ContactSettings::prepare(Model& model) const {
  const auto [geom, plane] = geoms(model);
  if (x_m) place_wall(model, plane, x_m(model));
  if (angle_rad_ != 0.0) tilt_wall(model, plane, angle_rad_);
  const std::unique_ptr<ContactForceLaw> law = make_law();
  if (const KelvinVoigt* engine = law ? law->for_engine() : nullptr) {
    author_contact(model, geom_id(model, geom), geom_id(model, plane), *engine);
  }
  const std::unique_ptr<WallContact> contact = make(model);
  if (contact && !is_of_engine()) model.separate(geom_id(model, geom), geom_id(model, plane));
}

void ContactSettings::animate(Model& model, double time_s) const {
  if (motion_.kind == WallMotionKind::fixed || motion_.kind == WallMotionKind::free) return;
  // Along x: the plane is the same as if it moved along its normal.
  place_wall(model, geom_2, x_m(model) + motion().at(time_s).position_m / math::cos(angle_rad_));
}

std::unique_ptr<WallContact> ContactSettings::make(const Model& model) const {
  if (is_of_engine() && !is_measured) return nullptr;
  const auto [sphere, plane] = geoms(model);
  auto contact =
      std::make_unique<WallContact>(model, sphere, plane, make_law(), motion(), friction_);
  contact->set_solid(begins_solid());
  return contact;
}

// The contact laws: the keys of each, and how it is made of them.
namespace {

using Law = std::unique_ptr<ContactForceLaw>;

void bind_stiffness(Fields& fields, double& stiffness) {
  fields.number("stiffness_N_m", stiffness, positive(),
                "K: stiffness of the contact as a whole, not of its steel; "
                "of hertz in N/m^1.5, of hunt_crossley in N/m^n");
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
    fields.number("damping_Ns_m", damping_Ns_m, not_negative(), "B: damping of the same chain");
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
                           "impact speed at which the restitution was measured");
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
                  "with contact.stiffness_N_m");
    fields.number("relaxation_s", relaxation_s, positive(),
                  "tau: relaxation time of that spring and damper");
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
