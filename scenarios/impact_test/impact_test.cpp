// Scenario impact_test: a mass on a rail strikes a wall.
#include <algorithm>
#include <cmath>
#include <limits>

#include <breakwater/experiment/run_loop.h>
#include <breakwater/math/float_environment.h>
#include <breakwater/math/functions.h>
#include <breakwater/rigs/axis_rig.h>
#include <breakwater/rigs/plant_parts.h>
#include <breakwater/sim/contact.h>
#include <breakwater/sim/model.h>

namespace breakwater {
namespace {

constexpr const char* kStruckWall = "wall";
constexpr const char* kImpactTip = "tip";
constexpr double kModelMass_kg = 1.0;  // as in models/impact.xml

// The axis of models/impact.xml, without a drive.
Axis rail() {
  Axis axis = cart_axis();
  axis.actuator = Axis::kNone;
  return axis;
}

// A free mass strikes the wall at a given speed. There is no controller, so the impact depends on
// the contact law, the wall and the force sensor alone.
class ImpactTest final : public Scenario {
 public:
  explicit ImpactTest(const Catalogue& catalogue)
      : Scenario(MetricRows(catalogue, "impact_test")),
        plant_(rail(), catalogue),
        wall_(catalogue, kImpactTip, kStruckWall) {
    plant_.axis().nominal_from = NominalFrom::model;
    plant_.tip.emplace().sensor = "tip_force";
    plant_.faults.fault.channel = Axis::kNone;
    plant_.geoms = {kImpactTip, kStruckWall};
    plant_.prepare = [this](Model& model) {
      model.add_mass("carriage", mass_kg_ - kModelMass_kg - plant_.tip->chain.tool_mass_kg);
      prepare_model(model);
    };
  }

  std::string name() const override { return "impact_test"; }
  std::string summary() const override {
    return "a mass on a rail strikes a wall: contact laws, wall motion, force sensor";
  }
  Fields fields() override {
    Fields fields;
    bind_model(fields, plant_.mjcf);
    plant_.physics.bind(fields);
    plant_.run.bind(fields);
    fields.number("impact.mass_kg", mass_kg_, between(1e-6, 1e6),
                  "mass that strikes the wall, the tool before the force sensor included [kg]");
    fields.number("impact.speed_m_s", plant_.axis().start_velocity, positive(),
                  "speed before the impact [m/s]");
    fields.number("impact.distance_m", distance_m_, not_negative(),
                  "distance from the tip to the wall at the start [m]");
    fields.number("impact.push_N", push_N_, not_negative(), "constant force towards the wall [N]");
    wall_.bind(fields);
    plant_.tip->chain.bind_filter(fields);
    plant_.tip->chain.bind_noise(fields);
    plant_.tip->chain.bind(fields);
    plant_.bind_fine(fields);
    rows_.bind(fields);
    return fields;
  }

  void check(const Config& config) override {
    wall_.check(config, plant_.physics);
    if (plant_.tip->chain.tool_mass_kg >= mass_kg_) {
      config.fail("sensor.force_tool_mass_kg", "must be less than impact.mass_kg");
    }
    AxisSettings& axis = plant_.axis();
    check_plant(plant_, config);
    axis.start_position = -distance_m_;
    axis.force = {.kind = DisturbanceKind::step, .amplitude = -push_N_};
    const double along_normal = math::cos(wall_.angle_rad());
    wall_.check_impact(config, plant_.physics, mass_kg_ / (along_normal * along_normal),
                       axis.start_velocity * along_normal);
    wall_.measure(plant_.load_model());
    rows_.check(config, [this] { return fields(); }, plant_.physics,
                {.events = {"first_contact", "first_separation"}});
  }

  const RunSettings& run_settings() const override { return plant_.run; }
  Recording run(const RunControl& control) const override {
    const math::FloatEnvironment floats;
    NoControl controller;
    AxisRig rig(plant_, controller);
    Simulation& sim = rig.simulation();
    const std::unique_ptr<WallContact> contact = wall_.measure(sim.model());
    sim.add(*contact);
    contact->set_solid(true);
    sim.set_collidable(geom_id(sim.model(), kStruckWall), wall_.is_of_engine());

    const double& force_N = wall_.is_of_engine() ? sim.sensor("tip_touch") : contact->force_N();
    const std::vector<Signal> tip = rig.tip_signals();
    RigRun run;
    run.samples_end = false;
    run.judged.emplace();
    run.fine = {
        {"qpos", "m", "the carriage's position", sim.qpos()},
        {"qvel", "m/s", "the carriage's speed", sim.qvel()},
        {"force_true_N", "N", "normal contact force, true", view(force_N)},
        tip[0],
        tip[1],
        {"penetration_m", "m", "penetration; negative: the gap", view(contact->penetration_m())},
        {"wall_m", "m", "how far the wall has moved", view(contact->wall_m())}};
    run.signals = run.fine;
    run.signals.insert(run.signals.end(), {tip[2], tip[3]});
    double first_contact_s = std::numeric_limits<double>::infinity();
    double first_separation_s = first_contact_s;
    run.for_metrics = {{"approach_m_s", "m/s", "", view(contact->approach_m_s())},
                       {"impulse_Ns", "N s", "", view(contact->impulse_Ns())}};
    run.events = {{"first_contact", &first_contact_s}, {"first_separation", &first_separation_s}};
    run.after_step = [&] {
      // The impulse, because the contact may begin at a later stage of a step.
      if (contact->impulse_Ns() > 0.0) {
        first_contact_s = std::min(first_contact_s, sim.time_s());
      } else if (first_contact_s <= sim.time_s()) {
        first_separation_s = std::min(first_separation_s, sim.time_s());
      }
    };
    return rig.run(control, rows_, std::move(run));
  }

  void prepare_model(Model& model) const override {
    place_wall(model, kStruckWall, wall_x_m(model));
    wall_.prepare(model);
  }

  void animate_scene(Model& model, double time_s) const override {
    wall_.animate(model, wall_x_m(model), time_s);
  }

 private:
  // The tip touches the wall where the rail's position is 0.
  double wall_x_m(const Model& model) const {
    const double radius_m = model->geom_size[3 * geom_id(model, kImpactTip)];
    return radius_m * (1.0 / math::cos(wall_.angle_rad()) - 1.0);
  }

  AxisPlant plant_;
  ContactSettings wall_;
  double mass_kg_ = 0.0;
  double distance_m_ = 0.0;
  double push_N_ = 0.0;
};

}  // namespace

ScenarioKind impact_test() {
  return scenario_kind<ImpactTest>("impact_test", true);
}

}  // namespace breakwater
