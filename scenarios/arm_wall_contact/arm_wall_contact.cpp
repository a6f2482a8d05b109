// Scenario arm_wall_contact: position/force control against a wall (thesis 2.4.3.2, 2.4.3.4).
#include <breakwater/rigs/arm_signals.h>
#include <breakwater/sim/linear_model.h>

namespace breakwater {
namespace {

// The arm moves to its start pose. At `force.from_s` it begins to approach the wall, and then
// presses on it with `force.reference_N`. The main metrics are impact force and free-motion time.
class ArmWallContact final : public AxisScenario {
 public:
  explicit ArmWallContact(const Catalogue& catalogue)
      : AxisScenario(catalogue, {.name = "arm_wall_contact",
                                 .summary = "hybrid position/force control against a wall: impact "
                                            "force, free-motion time",
                                 .is_arm = true}) {
    plant_.contacts.emplace_back(catalogue, "tip", "wall");
    plant_.tip->contact = contact().name;
    contact().x_m = [this](const Model&) { return wall_x_m(); };
  }

 private:
  void bind(Fields& fields) override {
    fields.number("wall.distance_m", wall_distance_m_, positive(),
                  "distance from the tip at the start pose to the wall's face");
    fields.number("wall.solid_from_s", contact().solid_from_s, not_negative(),
                  "time at which the wall becomes solid: the stretched arm starts inside it");
    plant_.bind_fine(fields);
  }

  MetricContext complete(const Config& config) override {
    const double from_s = plant_.tip->reference.from_s;
    if (contact().solid_from_s > from_s) {
      config.fail("wall.solid_from_s", "must not be after force.from_s");
    }
    judged_ = {config.number("metrics.from_s").value_or(from_s),
               config.number("metrics.to_s").value_or(plant_.run.duration_s)};
    if (judged_.from_s < from_s) {
      config.fail("metrics.from_s", "must not be before force.from_s");
    }
    return {.known = {{"force_control", plant_.physics.sample_time_s(from_s)}}};
  }

  void extend(RigRun& run, AxisRig& rig, const AxisLoop& loop) const override {
    // Later the tip touches the wall and presses.
    log_arm(run, rig, loop, plant_, {0.0, plant_.tip->reference.from_s});
    const Simulation& sim = rig.simulation();
    const auto impact_mass_kg = std::make_shared<double>(0.0);
    run.after_step =
        [&rig, &sim, impact_mass_kg,
         mass = std::make_shared<ApparentMass>(sim.model(), "tip", Eigen::Vector3d::UnitX())] {
          if (rig.first_contact_s() == sim.time_s())
            *impact_mass_kg = (*mass)(sim.model(), sim.data());
        };
    run.for_metrics.push_back({"force_reference_N", "N", "", view(plant_.tip->reference.value)});
    run.for_metrics.push_back({"tip_speed_x_m_s", "m/s", "", view(sim.sensor("tip_vel"))});
    run.for_metrics.push_back({"impact_mass_kg", "kg", "", view(*impact_mass_kg)});
    run.judged->push_back(rig.judged_force(judged_));
  }

  void animate_scene(Model& model, double time_s) const override {
    show_geoms(model, "wall_", time_s >= plant_.contacts.front().solid_from_s);
    plant_.contacts.front().animate(model, time_s);
  }

  ArmSetup tip() const override {
    ArmSetup arm = AxisScenario::tip();
    arm.task.wall_x_m = wall_x_m();
    return arm;
  }

  ContactSettings& contact() { return plant_.contacts.front(); }
  double wall_x_m() const {
    return plant_.chain->tip_pose(plant_.reference_at_start())[0] + wall_distance_m_;
  }

  double wall_distance_m_ = 0.0;
  TimeWindow judged_;  // window of the force error
};

}  // namespace

ScenarioKind arm_wall_contact() {
  return scenario_kind<ArmWallContact>("arm_wall_contact", true);
}

}  // namespace breakwater
