// Scenario impact_test: a mass on a rail strikes a wall.
#include <breakwater/experiment/run_loop.h>
#include <breakwater/math/float_environment.h>
#include <breakwater/math/functions.h>
#include <breakwater/rigs/axis_rig.h>
#include <breakwater/rigs/plant_parts.h>

namespace breakwater {
namespace {

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
      : Scenario(MetricRows(catalogue, "impact_test")), plant_(rail(), catalogue) {
    plant_.axis().nominal_from = NominalFrom::model;
    plant_.faults.fault.channel = Axis::kNone;
    ContactSettings& contact = plant_.contacts.emplace_back(catalogue, "tip", "wall");
    contact.is_measured = true;
    // The tip touches the wall where the rail's position is 0.
    contact.x_m = [this](const Model& model) {
      const double radius_m = model->geom_size[3 * geom_id(model, "tip")];
      return radius_m * (1.0 / math::cos(plant_.contacts.front().angle_rad()) - 1.0);
    };
    plant_.tip = {.contact = contact.name, .touch = "tip_touch", .sensor = "tip_force"};
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
                  "mass that strikes the wall, the tool before the force sensor included");
    fields.number("impact.speed_m_s", plant_.axis().start_velocity, positive(),
                  "speed before the impact");
    fields.number("impact.distance_m", distance_m_, not_negative(),
                  "distance from the tip to the wall at the start");
    fields.number("impact.push_N", push_N_, not_negative(), "constant force towards the wall");
    plant_.contacts.front().bind(fields);
    plant_.tip->chain.bind_filter(fields);
    plant_.tip->chain.bind_noise(fields);
    plant_.tip->chain.bind(fields);
    plant_.bind_fine(fields);
    rows_.bind(fields);
    return fields;
  }

  void check(const Config& config) override {
    plant_.inertia_ratio = mass_kg_ - plant_.tip->chain.tool_mass_kg;  // to the model's 1 kg
    if (plant_.inertia_ratio <= 0.0) {
      config.fail("sensor.force_tool_mass_kg", "must be less than impact.mass_kg");
    }
    plant_.check(config);
    AxisSettings& axis = plant_.axis();
    axis.start_position = -distance_m_;
    axis.force = {.kind = DisturbanceKind::step, .amplitude = -push_N_};
    const ContactSettings& contact = plant_.contacts.front();
    const double along_normal = math::cos(contact.angle_rad());
    contact.check_impact(config, plant_.physics, mass_kg_ / (along_normal * along_normal),
                         axis.start_velocity * along_normal);
    rows_.check(config, [this] { return fields(); }, plant_.physics,
                {.events = {"first_contact", "first_separation"}});
  }

  const RunSettings& run_settings() const override { return plant_.run; }
  Recording run(const RunControl& control) const override {
    const math::FloatEnvironment floats;
    NoControl controller;
    AxisRig rig(plant_, controller);
    const WallContact& contact = *rig.wall();
    const std::vector<Signal> tip = rig.tip_signals();
    RigRun run;
    run.samples_end = false;
    run.judged.emplace();
    run.fine = {
        {"qpos", "m", "the carriage's position", rig.simulation().qpos()},
        {"qvel", "m/s", "the carriage's speed", rig.simulation().qvel()},
        tip[0],
        tip[1],
        tip[2],
        {"penetration_m", "m", "penetration; negative: the gap", view(contact.penetration_m())},
        {"wall_m", "m", "how far the wall has moved", view(contact.wall_m())}};
    run.signals = run.fine;
    run.signals.insert(run.signals.end(), {tip[3], tip[4]});
    run.for_metrics = {{"approach_m_s", "m/s", "", view(contact.approach_m_s())},
                       {"impulse_Ns", "N s", "", view(contact.impulse_Ns())}};
    return rig.run(control, rows_, std::move(run));
  }

  void prepare_model(Model& model) const override { plant_.contacts.front().prepare(model); }
  void animate_scene(Model& model, double time_s) const override {
    plant_.contacts.front().animate(model, time_s);
  }

 private:
  AxisPlant plant_;
  double mass_kg_ = 0.0;
  double distance_m_ = 0.0;
  double push_N_ = 0.0;
};

}  // namespace

ScenarioKind impact_test() {
  return scenario_kind<ImpactTest>("impact_test", true);
}

}  // namespace breakwater
