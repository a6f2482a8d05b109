// Scenario impact_test: a mass on a rail strikes a wall.
#include <algorithm>
#include <cmath>
#include <limits>

#include <breakwater/experiment/run_loop.h>
#include <breakwater/experiment/scenario.h>
#include <breakwater/math/float_environment.h>
#include <breakwater/math/functions.h>
#include <breakwater/rigs/axis_scenario.h>
#include <breakwater/rigs/force_sensor_settings.h>
#include <breakwater/rigs/wall_settings.h>
#include <breakwater/sim/held_force.h>
#include <breakwater/sim/named_elements.h>

namespace breakwater {
namespace {

constexpr const char* kStruckWall = "wall";
constexpr const char* kImpactTip = "tip";
constexpr const char* kCarriage = "carriage";
constexpr const char* kRail = "rail";
constexpr double kModelMass_kg = 1.0;  // as in models/impact.xml

class NoController final : public Controller {
 public:
  void reset(const Sample&) override {}
  void update(const Sample&, Eigen::Ref<Eigen::VectorXd>) override {}
  std::span<const Signal> signals() const override { return {}; }
};

// A free mass strikes the wall at a given speed. There is no controller, so the impact depends on
// the contact law, the wall and the force sensor alone.
class ImpactTest final : public Scenario {
 public:
  explicit ImpactTest(const Catalogue& catalogue)
      : Scenario(MetricRows(catalogue, "impact_test")), wall_(catalogue) {}

  std::string name() const override { return "impact_test"; }
  std::string summary() const override {
    return "a mass on a rail strikes a wall: contact laws, wall motion, force sensor";
  }
  Fields fields() override {
    Fields fields;
    bind_model(fields, mjcf_);
    physics_.bind(fields);
    run_.bind(fields);
    fields.number("impact.mass_kg", mass_kg_, between(1e-6, 1e6),
                  "mass that strikes the wall, the tool before the force sensor included [kg]");
    fields.number("impact.speed_m_s", speed_m_s_, positive(), "speed before the impact [m/s]");
    fields.number("impact.distance_m", distance_m_, not_negative(),
                  "distance from the tip to the wall at the start [m]");
    fields.number("impact.push_N", push_N_, not_negative(), "constant force towards the wall [N]");
    wall_.bind(fields);
    force_sensor_.bind_filter(fields);
    force_sensor_.bind_noise(fields);
    force_sensor_.bind(fields);
    fields.number("record.fine_from_s", fine_from_s_, not_negative(),
                  "time from which on forces are logged at the physics rate [s]");
    fields.number("record.fine_to_s", fine_to_s_, not_negative(),
                  "time until which forces are logged at the physics rate [s]");
    rows_.bind(fields);
    return fields;
  }

  void check(const Config& config) override {
    physics_.check(config, run_);
    wall_.check(config, physics_);
    force_sensor_.check(config, physics_.timestep_s);
    if (force_sensor_.tool_mass_kg >= mass_kg_) {
      config.fail("sensor.force_tool_mass_kg", "must be less than impact.mass_kg");
    }
    if (fine_to_s_ < fine_from_s_) {
      config.fail("record.fine_to_s", "must not be before record.fine_from_s");
    }
    const double along_normal = math::cos(wall_.angle_rad());
    wall_.check_impact(config, physics_, mass_kg_ / (along_normal * along_normal),
                       speed_m_s_ * along_normal);
    wall_.make(plant(), kImpactTip, kStruckWall);
    rows_.check(config, [this] { return fields(); }, physics_,
                {.events = {"first_contact", "first_separation"}});
  }

  const RunSettings& run_settings() const override { return run_; }
  Recording run(const RunControl& control) const override {
    const math::FloatEnvironment floats;
    NoController controller;
    Simulation sim(plant(), controller, sensing(), physics_.steps_per_sample());
    const std::unique_ptr<WallContact> contact = wall_.make(sim.model(), kImpactTip, kStruckWall);
    JointForce push(sim.model(), kRail);
    push.hold(push_N_);
    if (push_N_ > 0.0) sim.add(push);
    sim.add(*contact);
    contact->set_solid(true);
    sim.set_collidable(geom_id(sim.model(), kStruckWall), wall_.is_of_engine());
    const double start_m = -distance_m_;
    sim.set_position({&start_m, 1});
    sim.set_velocity({&speed_m_s_, 1});

    const double& force_N = wall_.is_of_engine() ? sim.sensor("tip_touch") : contact->force_N();
    const double& sensor_N =
        force_sensor_.has_body() ? sim.sensing().filtered(1) : sim.sensor("tip_force");
    const double& filtered_N = sim.sensing().filtered(0);
    const std::span<const double> measured = view(sim.sample().y);
    const std::vector<Signal> fine_signals = {
        {"qpos", "m", "the carriage's position", sim.qpos()},
        {"qvel", "m/s", "the carriage's speed", sim.qvel()},
        {"force_true_N", "N", "normal contact force, true", view(force_N)},
        {"force_sensor_N", "N", "force sensor, before its low-pass", view(sensor_N)},
        {"force_filtered_N", "N", "force sensor, behind its low-pass", view(filtered_N)},
        {"penetration_m", "m", "penetration; negative: the gap", view(contact->penetration_m())},
        {"wall_m", "m", "how far the wall has moved", view(contact->wall_m())}};
    std::vector<Signal> signals = fine_signals;
    signals.push_back(
        {"force_measured_N", "N", "filtered force as sampled", measured.subspan(0, 1)});
    signals.push_back(
        {"force_raw_measured_N", "N", "the same before the low-pass", measured.subspan(1, 1)});

    const std::int64_t steps = physics_.step_at(run_.duration_s);
    const std::int64_t fine_from = physics_.step_at(fine_from_s_);
    const std::int64_t fine_to =
        control.logs ? std::min(physics_.step_at(fine_to_s_), steps) : fine_from;
    Track fine("physics", fine_signals,
               static_cast<std::size_t>(std::max<std::int64_t>(fine_to - fine_from, 0)),
               control.stream);
    double impulse_Ns = 0.0;
    double first_contact_s = std::numeric_limits<double>::infinity();
    double first_separation_s = first_contact_s;
    std::vector<Signal> of_metrics = fine_signals;
    of_metrics.push_back(
        {"approach_m_s", "m/s", "rate of the penetration", view(contact->approach_m_s())});
    of_metrics.push_back({"impulse_Ns", "N s", "impulse over a step", view(impulse_Ns)});
    of_metrics.insert(of_metrics.end(), signals.begin(), signals.end());
    MetricValues values(
        rows_, of_metrics, run_.duration_s,
        {{"first_contact", &first_contact_s}, {"first_separation", &first_separation_s}});
    const auto step = [&](std::int64_t k) {
      sim.step();
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
        sim, physics_, steps, std::move(signals), control, step, [](double) {}, &values);
    if (fine.rows() > 0) recording.tracks.push_back(std::move(fine));
    return recording;
  }

  void prepare_scene(Model& model) const override {
    wall_.prepare(model, kImpactTip, kStruckWall, wall_x_m(model));
  }

  void animate_scene(Model& model, double time_s) const override {
    wall_.animate(model, kStruckWall, wall_x_m(model), time_s);
  }

 private:
  Model plant() const {
    Model model = Model::load_physics(mjcf_, {kImpactTip, kStruckWall});
    model.set_physics(physics_.timestep_s, physics_.integrator);
    model.add_mass(kCarriage, mass_kg_ - kModelMass_kg - force_sensor_.tool_mass_kg);
    model.add_mass(kImpactTip, force_sensor_.tool_mass_kg);
    wall_.prepare(model, kImpactTip, kStruckWall, wall_x_m(model));
    return model;
  }
  // The tip touches the wall where the rail's position is 0.
  double wall_x_m(const Model& model) const {
    const double radius_m = model->geom_size[3 * geom_id(model, kImpactTip)];
    return radius_m * (1.0 / math::cos(wall_.angle_rad()) - 1.0);
  }

  SensingSetup sensing() const {
    SensingSetup setup;
    force_sensor_.add_channels(setup, {.sensor = "tip_force"});
    setup.seed = run_.seed;
    return setup;
  }

  ModelFile mjcf_;
  PhysicsSettings physics_;
  RunSettings run_;
  WallSettings wall_;
  ForceSensorSettings force_sensor_;
  double mass_kg_ = 0.0;
  double speed_m_s_ = 0.0;
  double distance_m_ = 0.0;
  double push_N_ = 0.0;
  double fine_from_s_ = 0.0;
  double fine_to_s_ = 0.0;
};

}  // namespace

ScenarioKind impact_test() {
  return scenario_kind<ImpactTest>("impact_test");
}

}  // namespace breakwater
