// Scenario impact_test: a mass on a rail strikes a wall.
#include <breakwater/math/functions.h>
#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {
namespace {

// A free mass strikes the wall at a given speed. There is no controller, so the impact depends on
// the contact law, the wall and the force sensor alone.
class ImpactTest final : public AxisScenario {
 public:
  explicit ImpactTest(const Catalogue& catalogue)
      : AxisScenario(catalogue, {.name = "impact_test",
                                 .summary = "a mass on a rail strikes a wall: contact laws, wall "
                                            "motion, force sensor",
                                 .axis = named_axis("rail", "rail", Axis::kNone, false)}) {
    plant_.axis().has_disturbance_keys = false;
    ContactSettings& contact = plant_.contacts.emplace_back(catalogue, "tip", "wall");
    contact.is_measured = true;
    // The tip touches the wall where the rail's position is 0.
    contact.x_m = [this](const Model& model) {
      const double radius_m = model->geom_size[3 * geom_id(model, "tip")];
      return radius_m * (1.0 / math::cos(plant_.contacts.front().angle_rad()) - 1.0);
    };
    plant_.tip = {.contact = contact.name, .touch = "tip_touch", .sensor = "tip_force"};
  }

  AxisPlant plant() const override {
    AxisPlant plant = plant_;
    plant.inertia_ratio *= mass_kg_ - plant_.tip->tool_mass_kg;  // to the model's 1 kg
    AxisSettings& axis = plant.axis();
    axis.start_position -= distance_m_;
    axis.start_velocity += speed_m_s_;
    axis.force = {.kind = DisturbanceKind::step, .amplitude = -push_N_};
    return plant;
  }

 private:
  void bind(Fields& fields) override {
    fields.number("impact.mass_kg", mass_kg_, between(1e-6, 1e6),
                  "mass that strikes the wall, the tool before the force sensor included");
    fields.number("impact.speed_m_s", speed_m_s_, positive(), "speed before the impact");
    fields.number("impact.distance_m", distance_m_, not_negative(),
                  "distance from the tip to the wall at the start");
    fields.number("impact.push_N", push_N_, not_negative(), "constant force towards the wall");
    plant_.bind_fine(fields);
  }

  MetricContext complete(const Config& config) override {
    if (plant_.tip->tool_mass_kg >= mass_kg_) {
      config.fail("sensor.force_tool_mass_kg", "must be less than impact.mass_kg");
    }
    return {};
  }

  void extend(RigRun& run, AxisRig& rig, const AxisLoop& /*loop*/) const override {
    const WallContact& contact = *rig.wall();
    const std::vector<Signal> tip = rig.tip_signals();
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
  }

  void animate_scene(Model& model, double time_s) const override {
    plant_.contacts.front().animate(model, time_s);
  }

  double mass_kg_ = 0.0;
  double speed_m_s_ = 0.0;
  double distance_m_ = 0.0;
  double push_N_ = 0.0;
};

}  // namespace

ScenarioKind impact_test() {
  return scenario_kind<ImpactTest>("impact_test", true);
}

}  // namespace breakwater
