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
    fields.number("record.fine_from_s", fine_from_s_, not_negative(),
                  "time from which on forces are logged at the physics rate [s]");
    fields.number("record.fine_to_s", fine_to_s_, not_negative(),
                  "time until which forces are logged at the physics rate [s]");
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
    if (fine_to_s_ < fine_from_s_) {
      config.fail("record.fine_to_s", "must not be before record.fine_from_s");
    }
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
    const std::span<const double> measured = view(sim.sample().y);
    const std::vector<Signal> fine_signals = {
        {"qpos", "m", "the carriage's position", sim.qpos()},
        {"qvel", "m/s", "the carriage's speed", sim.qvel()},
        {"force_true_N", "N", "normal contact force, true", view(force_N)},
        {"force_sensor_N", "N", "force sensor, before its low-pass", view(rig.sensor_force_N())},
        {"force_filtered_N", "N", "force sensor, behind its low-pass",
         view(rig.filtered_force_N())},
        {"penetration_m", "m", "penetration; negative: the gap", view(contact->penetration_m())},
        {"wall_m", "m", "how far the wall has moved", view(contact->wall_m())}};
    std::vector<Signal> signals = fine_signals;
    signals.push_back(
        {"force_measured_N", "N", "filtered force as sampled", measured.subspan(1, 1)});
    signals.push_back(
        {"force_raw_measured_N", "N", "the same before the low-pass", measured.subspan(2, 1)});

    const PhysicsSettings& physics = plant_.physics;
    const std::int64_t steps = physics.step_at(plant_.run.duration_s);
    const std::int64_t fine_from = physics.step_at(fine_from_s_);
    const std::int64_t fine_to =
        control.logs ? std::min(physics.step_at(fine_to_s_), steps) : fine_from;
    Track fine("physics", fine_signals,
               static_cast<std::size_t>(std::max<std::int64_t>(fine_to - fine_from, 0)),
               control.stream);
    double impulse_Ns = 0.0;
    double first_contact_s = std::numeric_limits<double>::infinity();
    double first_separation_s = first_contact_s;
    std::vector<Signal> of_metrics = signals;
    of_metrics.push_back({"approach_m_s", "m/s", "", view(contact->approach_m_s())});
    of_metrics.push_back({"impulse_Ns", "N s", "", view(impulse_Ns)});
    MetricValues values(
        rows_, of_metrics, plant_.run.duration_s,
        {{"first_contact", &first_contact_s}, {"first_separation", &first_separation_s}});
    const auto step = [&](std::int64_t k) {
      rig.step();
      // The impulse, because the contact may begin at a later stage of a step.
      impulse_Ns = contact->impulse_Ns();
      if (impulse_Ns > 0.0) {
        first_contact_s = std::min(first_contact_s, sim.time_s());
      } else if (first_contact_s <= sim.time_s()) {
        first_separation_s = std::min(first_separation_s, sim.time_s());
      }
      if (k >= fine_from && k < fine_to) fine.append(sim.time_s());
    };
    Recording recording = record_run(
        sim, physics, steps, std::move(signals), control, step, [](double) {}, &values);
    if (fine.rows() > 0) recording.tracks.push_back(std::move(fine));
    return recording;
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
  double fine_from_s_ = 0.0;
  double fine_to_s_ = 0.0;
};

}  // namespace

ScenarioKind impact_test() {
  return scenario_kind<ImpactTest>("impact_test", true);
}

}  // namespace breakwater
