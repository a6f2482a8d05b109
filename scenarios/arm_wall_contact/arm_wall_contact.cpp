// Scenario arm_wall_contact: position/force control against a wall (thesis 2.4.3.2, 2.4.3.4).
#include <algorithm>
#include <cmath>

#include <breakwater/experiment/run_loop.h>
#include <breakwater/math/float_environment.h>
#include <breakwater/record/held_reference.h>
#include <breakwater/rigs/arm_scenario.h>
#include <breakwater/sim/contact.h>
#include <breakwater/sim/linear_model.h>
#include <breakwater/sim/model.h>

namespace breakwater {
namespace {

constexpr const char* kWall = "wall";

// The arm moves to its start pose. At `force.from_s` it begins to approach the wall, and then
// presses on it with `force.reference_N`. The main metrics are impact force and free-motion time.
class ArmWallContact final : public ArmScenario {
 public:
  explicit ArmWallContact(const Catalogue& catalogue)
      : ArmScenario(catalogue, MetricRows(catalogue, "arm_wall_contact"), false) {
    plant_.contacts.emplace_back(catalogue, "tip", kWall);
    plant_.tip->contact = contact().name;
    plant_.prepare = [this](Model& model) { place_wall(model, kWall, wall_x_m()); };
  }

  std::string name() const override { return "arm_wall_contact"; }
  std::string summary() const override {
    return "hybrid position/force control against a wall: impact force, free-motion time";
  }
  Fields fields() override {
    Fields fields;
    bind(fields);
    plant_.tip->chain.bind(fields);
    fields.number("wall.distance_m", wall_distance_m_, positive(),
                  "distance from the tip at the start pose to the wall's face [m]");
    fields.number("wall.solid_from_s", wall_solid_from_s_, not_negative(),
                  "time at which the wall becomes solid: the stretched arm starts inside it [s]");
    contact().bind(fields);
    fields.number("force.reference_N", force().value, positive(),
                  "F_x^ref: reference of the contact force [N]");
    fields.number("force.from_s", force_from_s_, not_negative(),
                  "time of the switch from position control to force control [s]");
    fields.number("force.convert_gain_per_m", convert_gain_per_m_, positive(),
                  "factor of the force gain: K_f is this value times F_x^ref [1/m]");
    plant_.tip->chain.bind_filter(fields);
    fields.number("metrics.from_s", metrics_from_s_, not_negative(),
                  "start of the window of the force error [s]");
    fields.number("metrics.to_s", metrics_to_s_, positive(),
                  "end of the window of the force error [s]");
    fields.number("record.fine_from_s", fine_from_s_, not_negative(),
                  "time from which forces are logged at the physics rate [s]");
    fields.number("record.fine_to_s", fine_to_s_, not_negative(),
                  "time until which forces are logged at the physics rate [s]");
    rows_.bind(fields);
    return fields;
  }

  void check(const Config& config) override {
    check_arm(config);
    if (wall_solid_from_s_ > force_from_s_) {
      config.fail("wall.solid_from_s", "must not be after force.from_s");
    }
    if (metrics_to_s_ <= metrics_from_s_) {
      config.fail("metrics.to_s", "must be after metrics.from_s");
    }
    if (fine_to_s_ < fine_from_s_) {
      config.fail("record.fine_to_s", "must not be before record.fine_from_s");
    }
    if (metrics_from_s_ < force_from_s_) {
      config.fail("metrics.from_s", "must not be before force.from_s");
    }
    force().from_s = plant_.physics.sample_time_s(force_from_s_);
    rows_.check(config, [this] { return fields(); }, plant_.physics,
                {.known = {{"force_control", force().from_s}}, .events = {"first_contact"}});
  }

  Recording run(const RunControl& control) const override {
    const math::FloatEnvironment floats;
    const std::unique_ptr<Controller> controller = make_controller();
    ArmRig rig(plant_, chain(), *controller);
    const Simulation& sim = rig.simulation();
    const PhysicsSettings& physics = plant_.physics;
    const std::int64_t steps = physics.step_at(plant_.run.duration_s);
    const std::int64_t solid_step = physics.step_at(wall_solid_from_s_);
    const std::int64_t fine_from = physics.step_at(fine_from_s_);
    const std::int64_t fine_to =
        control.logs ? std::min(physics.step_at(fine_to_s_), steps) : fine_from;

    Track fine("physics", rig.fine_signals(),
               static_cast<std::size_t>(std::max<std::int64_t>(fine_to - fine_from, 0)),
               control.stream);

    const TipPose pose = start_pose();
    TipPose tip_offset = TipPose::Zero();
    double impact_mass_kg = 0.0;
    std::vector<Signal> of_metrics = rig.fine_signals();
    of_metrics.push_back({"force_reference_N", "N", "", view(force().value)});
    of_metrics.push_back({"tip_speed_x_m_s", "m/s", "", view(sim.sensor("tip_vel"))});
    of_metrics.push_back({"impact_mass_kg", "kg", "", view(impact_mass_kg)});
    of_metrics.push_back({"y_offset_m", "m", "", view(tip_offset[1])});
    of_metrics.push_back({"phi_offset_rad", "rad", "", view(tip_offset[2])});
    for (const Signal& signal : rig.signals()) of_metrics.push_back(signal);
    MetricValues values(rows_, of_metrics, plant_.run.duration_s,
                        {{"first_contact", &rig.first_contact_s()}});

    // The tip first moves to its start pose, and later touches the wall and presses.
    HeldReference held_pose({0.0, force_from_s_}, "the tip", "m");
    HeldReference held_force = rig.held_force({metrics_from_s_, metrics_to_s_});
    ApparentMass mass_along_x(sim.model(), "tip", Eigen::Vector3d::UnitX());

    const auto step = [&](std::int64_t k) {
      if (k == solid_step) rig.set_solid(true);
      rig.step();
      if (rig.first_contact_s() == sim.time_s()) {
        impact_mass_kg = mass_along_x(sim.model(), sim.data());
      }
      if (k >= fine_from && k < fine_to) fine.append(sim.time_s());
    };
    const auto sample = [&](double time_s) {
      rig.observe();
      tip_offset = rig.tip() - pose;
      const double away_m = tip_offset.head<2>().norm();
      if (sim.steps() == 1) held_pose.ask(away_m);
      held_pose.add(time_s, away_m);
      held_force.add(time_s, rig.force_error_N());
    };
    Recording recording =
        record_run(sim, physics, steps, rig.signals(), control, step, sample, &values);
    if (!recording.failure) {
      held_pose.warn(recording.warnings);
      held_force.warn(recording.warnings);
    }
    if (fine.rows() > 0) recording.tracks.push_back(std::move(fine));
    return recording;
  }

  void prepare_model(Model& model) const override {
    plant_.contacts.front().prepare(model);
    plant_.prepare(model);
  }
  void animate_scene(Model& model, double time_s) const override {
    show_geoms(model, "wall_", time_s >= wall_solid_from_s_);
    plant_.contacts.front().animate(model, wall_x_m(), time_s);
  }

 private:
  ArmTask task() const override {
    ArmTask task = ArmScenario::task();
    task.force_control_from_s = force_from_s_;
    task.force_reference_N = force().value;
    task.convert_gain_N_m = convert_gain_per_m_ * task.force_reference_N;
    task.wall_x_m = wall_x_m();
    return task;
  }

  ContactSettings& contact() { return plant_.contacts.front(); }
  Reference& force() { return plant_.tip->reference; }
  const Reference& force() const { return plant_.tip->reference; }
  double wall_x_m() const { return start_pose()[0] + wall_distance_m_; }

  double wall_distance_m_ = 0.0;
  double wall_solid_from_s_ = 0.0;
  double force_from_s_ = 0.0;
  double convert_gain_per_m_ = 0.0;
  double metrics_from_s_ = 0.0;
  double metrics_to_s_ = 0.0;
  double fine_from_s_ = 0.0;
  double fine_to_s_ = 0.0;
};

}  // namespace

ScenarioKind arm_wall_contact() {
  return scenario_kind<ArmWallContact>("arm_wall_contact", true);
}

}  // namespace breakwater
