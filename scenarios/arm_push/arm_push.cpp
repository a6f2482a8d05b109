// Scenario arm_push: forced displacement of a link (thesis 2.4.3.3).
#include <algorithm>
#include <cmath>
#include <limits>

#include <breakwater/rigs/arm_signals.h>
#include <breakwater/sim/hand_on_link.h>
#include <breakwater/sim/model.h>
#include <breakwater/world/hand.h>

namespace breakwater {
namespace {

// The farthest of all joints' offsets beyond 0, on the other side of the release. An arm that
// returns in another posture has the farthest offset at the end. The last value is the tip's error.
class PostureOvershoot final : public Beyond {
 public:
  using Beyond::Beyond;
  void add(const AddedValues& added) override {
    Beyond::add(added);
    last_offset_rad_ = 0.0;
    for (const double offset : added.all.first(added.all.size() - 1)) {
      last_offset_rad_ = std::max(last_offset_rad_, std::abs(offset));
    }
    is_home_ = added.all.back() <= setup_.level.value();
  }
  std::optional<double> value() const override {
    constexpr double kOtherPosture_rad = 0.2;
    const bool is_otherwise = is_home_ && last_offset_rad_ > kOtherPosture_rad;
    return std::max(*Beyond::value(), is_otherwise ? last_offset_rad_ : 0.0);
  }

 private:
  bool is_home_ = false;          // the tip, at the end
  double last_offset_rad_ = 0.0;  // largest of all joints
};

// The arm holds its start pose. A stiff hand pushes the end of one link, turns it, holds it and
// lets go. The torques saturate; the question is how the arm returns.
class ArmPush final : public AxisScenario {
 public:
  explicit ArmPush(const Catalogue& catalogue)
      : AxisScenario(
            catalogue,
            {.name = "arm_push",
             .summary = "forced displacement of each link: torque saturation, recovery",
             .is_arm = true,
             .reductions = {
                 {.name = "posture_overshoot",
                  .meaning = "farthest joint beyond 0, on the other side of the first values",
                  .make = make_reduction<PostureOvershoot>,
                  .has_level = true,
                  .takes_all = true}}}) {
    plant_.tip->reference.from_s = std::numeric_limits<double>::infinity();  // it never presses
  }

  // The arm starts at its reference.
  AxisPlant plant() const override {
    AxisPlant plant = plant_;
    for (AxisSettings& joint : plant.axes) {
      joint.start_position += joint.reference.at(0.0) - joint.reference.before;
    }
    return plant;
  }

 private:
  void bind(Fields& fields) override {
    fields.only_for({"controller.ik_weights", "controller.ik_damping", "controller.ik_form"},
                    "controller.positioning", {"workspace"});
    fields.only_where(
        {"controller.k_force", "controller.t_approach_s", "controller.t_contact_s",
         "controller.design_stiffness_N_m", "controller.peak_margin_N", "force.convert_gain_per_m"},
        "force is controlled (never in this scenario)", [] { return false; });
    fields.count("push.link", link_, between(1, 100),
                 "number of the link whose end the hand pushes");
    fields.number("push.angle_rad", hand_.angle_rad, any(),
                  "angle by which the hand turns the link");
    fields.optional_number(
        "push.moment_Nm", hand_.given_moment_Nm, any(),
        "moment about the link's joint with which the hand pushes, wherever the link goes; "
        "0: it turns the link by the angle");
    fields.number("push.start_s", hand_.start_s, not_negative(), "time at which the hand grips");
    fields.number("push.rise_s", hand_.rise_s, positive(),
                  "time that the hand takes to turn the link");
    fields.number("push.hold_s", hand_.hold_s, not_negative(),
                  "time for which the hand then holds the link");
    fields.number("push.stiffness_Nm_rad", hand_.stiffness_Nm_rad, positive(),
                  "stiffness of the hand about the link's joint");
    fields.number("push.damping_Nms_rad", hand_.damping_Nms_rad, not_negative(),
                  "damping of the hand about the link's joint");
    fields.only_where({"push.angle_rad", "push.stiffness_Nm_rad", "push.damping_Nms_rad"},
                      "push.moment_Nm is 0", [this] { return hand_.given_moment_Nm == 0.0; });
  }

  MetricContext complete(const Config& config) override {
    const Eigen::Index links = plant_.chain->joints();
    if (link_ > links) {
      config.fail("push.link", "the arm has only " + std::to_string(links) + " links");
    }
    return {.known = {{"release", hand_.release_s()}}};
  }

  void extend(RigRun& run, AxisRig& rig, const AxisLoop& loop) const override {
    log_arm(run, rig, loop, plant_, {hand_.release_s(), plant_.run.duration_s});
    Simulation& sim = rig.simulation();
    const auto hand = std::make_shared<HandOnLink>(hand_, sim.model(), *plant_.chain,
                                                   plant_.reference_at_start(), link_);
    sim.add(*hand);
    for (const int geom : sim.model().geoms_named("wall")) sim.set_collidable(geom, false);
    run.compute("push_turned_rad", "rad", "angle by which the pushed link is turned",
                [hand, &sim](double, auto) { return hand->turned_rad(sim.qpos()); });
    run.compute("push_moment_Nm", "N m", "moment of the hand about the joint",
                [hand, &sim](double time_s, auto) {
                  return hand->moment_Nm(time_s, sim.qpos(), sim.qvel());
                });
  }

  void prepare_model(Model& model) const override { show_geoms(model, "wall_", false); }

  int link_ = 1;
  Hand hand_;
};

}  // namespace

ScenarioKind arm_push() {
  return scenario_kind<ArmPush>("arm_push", true);
}

}  // namespace breakwater
