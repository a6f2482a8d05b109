// Scenario arm_push: forced displacement of a link (thesis 2.4.3.3).
#include <algorithm>
#include <cmath>

#include <breakwater/experiment/run_loop.h>
#include <breakwater/math/float_environment.h>
#include <breakwater/record/held_reference.h>
#include <breakwater/rigs/arm_scenario.h>
#include <breakwater/sim/hand_on_link.h>
#include <breakwater/sim/model.h>
#include <breakwater/world/hand.h>

namespace breakwater {
namespace {

// The farthest of an offset past 0, on the other side of its value at the release.
class Rebound final : public Reduction {
 public:
  explicit Rebound(const ReductionSetup& /*setup*/) {}
  void add(const AddedValues& added) override {
    farthest_ = std::max(farthest_, -std::copysign(1.0, added.all[1]) * added.all[0]);
  }
  std::optional<double> value() const override { return farthest_; }

 private:
  double farthest_ = 0.0;
};

// The same of all joints. An arm that returns in another posture has the farthest joint's offset at
// the end. The values are the joints' offsets, those at the release, and the tip's error.
class PostureOvershoot final : public Reduction {
 public:
  explicit PostureOvershoot(const ReductionSetup& setup) : setup_(setup) {}
  void add(const AddedValues& added) override {
    const std::size_t joints = (added.all.size() - 1) / 2;
    last_offset_rad_ = 0.0;
    for (std::size_t i = 0; i < joints; ++i) {
      const double offset = added.all[i];
      last_offset_rad_ = std::max(last_offset_rad_, std::abs(offset));
      overshoot_rad_ =
          std::max(overshoot_rad_, -std::copysign(1.0, added.all[joints + i]) * offset);
    }
    is_home_ = added.all.back() <= setup_.level.value();
  }
  std::optional<double> value() const override {
    const bool is_otherwise = is_home_ && last_offset_rad_ > kOtherPosture_rad;
    return is_otherwise ? std::max(overshoot_rad_, last_offset_rad_) : overshoot_rad_;
  }

 private:
  static constexpr double kOtherPosture_rad = 0.2;

  ReductionSetup setup_;
  bool is_home_ = false;  // the tip, at the end
  double overshoot_rad_ = 0.0;
  double last_offset_rad_ = 0.0;  // largest of all joints
};

std::vector<MetricKind> kinds_of_a_push() {
  return {{.name = "rebound",
           .meaning = "farthest value past 0, on the other side of the second signal",
           .make = make_reduction<Rebound>,
           .takes_all = true},
          {.name = "posture_overshoot",
           .meaning = "farthest rebound of all joints",
           .make = make_reduction<PostureOvershoot>,
           .has_level = true,
           .takes_all = true}};
}

// The arm holds its start pose. A stiff hand pushes the end of one link, turns it, holds it and
// lets go. The torques saturate; the question is how the arm returns.
class ArmPush final : public ArmScenario {
 public:
  explicit ArmPush(const Catalogue& catalogue)
      : ArmScenario(catalogue, MetricRows(catalogue, "arm_push", kinds_of_a_push()), true) {}

  std::string name() const override { return "arm_push"; }
  std::string summary() const override {
    return "forced displacement of each link: torque saturation, recovery";
  }
  Fields fields() override {
    Fields fields;
    bind(fields);
    // This scenario never controls a force.
    fields.only_for({"controller.ik_weights", "controller.ik_damping", "controller.ik_form"},
                    "controller.positioning", {"workspace"});
    fields.only_where({"controller.k_force", "controller.t_approach_s", "controller.t_contact_s",
                       "controller.design_stiffness_N_m", "controller.peak_margin_N"},
                      "force is controlled (never in this scenario)", [] { return false; });
    fields.count("push.link", link_, between(1, 100),
                 "number of the link whose end the hand pushes");
    fields.number("push.angle_rad", hand_.angle_rad, any(),
                  "angle by which the hand turns the link [rad]");
    fields.optional_number(
        "push.moment_Nm", hand_.given_moment_Nm, any(),
        "moment about the link's joint with which the hand pushes, wherever the link goes; "
        "0: it turns the link by the angle [N m]");
    fields.number("push.start_s", hand_.start_s, not_negative(),
                  "time at which the hand grips [s]");
    fields.number("push.rise_s", hand_.rise_s, positive(),
                  "time that the hand takes to turn the link [s]");
    fields.number("push.hold_s", hand_.hold_s, not_negative(),
                  "time for which the hand then holds the link [s]");
    fields.number("push.stiffness_Nm_rad", hand_.stiffness_Nm_rad, positive(),
                  "stiffness of the hand about the link's joint [N m/rad]");
    fields.number("push.damping_Nms_rad", hand_.damping_Nms_rad, not_negative(),
                  "damping of the hand about the link's joint [N m s/rad]");
    fields.only_where({"push.angle_rad", "push.stiffness_Nm_rad", "push.damping_Nms_rad"},
                      "push.moment_Nm is 0", [this] { return hand_.given_moment_Nm == 0.0; });
    rows_.bind(fields);
    return fields;
  }

  void check(const Config& config) override {
    check_arm(config);
    if (link_ > static_cast<int>(start_angles_rad_.size())) {
      config.fail("push.link",
                  "the arm has only " + std::to_string(start_angles_rad_.size()) + " links");
    }
    [[maybe_unused]] const HandOnLink refuses_a_wrong_link(hand_, plant_.load_model(), chain(),
                                                           start_angles_rad_, link_);
    rows_.check(config, [this] { return fields(); }, plant_.physics,
                {.known = {{"release", hand_.release_s()}}});
  }

  Recording run(const RunControl& control) const override {
    const math::FloatEnvironment floats;
    const std::unique_ptr<Controller> controller = make_controller();
    ArmRig rig(plant_, chain(), *controller);
    Simulation& sim = rig.simulation();
    const HandOnLink hand(hand_, sim.model(), chain(), start_angles_rad_, link_);
    sim.add(hand);
    if (has_geom(sim.model(), "wall")) sim.set_collidable(geom_id(sim.model(), "wall"), false);

    double turned_rad = 0.0;
    double moment_Nm = 0.0;
    std::vector<Signal> signals = rig.signals();
    signals.push_back(
        {"push_turned_rad", "rad", "angle by which the pushed link is turned", view(turned_rad)});
    signals.push_back(
        {"push_moment_Nm", "N m", "moment of the hand about the joint", view(moment_Nm)});

    // The offsets from the start pose, and the last ones before the release.
    const TipPose pose = start_pose();
    const Eigen::Map<const Eigen::VectorXd> start_rad(start_angles_rad_.data(), rig.q().size());
    TipPose tip_offset = TipPose::Zero(), released_tip_offset = tip_offset;
    Eigen::VectorXd offset_rad = Eigen::VectorXd::Zero(start_rad.size());
    Eigen::VectorXd released_rad = offset_rad;
    double tip_error_m = 0.0;
    std::vector<Signal> of_metrics = {
        {"x_offset_m", "m", "", view(tip_offset[0])},
        {"y_offset_m", "m", "", view(tip_offset[1])},
        {"phi_offset_rad", "rad", "", view(tip_offset[2])},
        {"released_x_offset_m", "m", "", view(released_tip_offset[0])},
        {"released_y_offset_m", "m", "", view(released_tip_offset[1])},
        {"released_phi_offset_rad", "rad", "", view(released_tip_offset[2])},
        {"joint_offset_rad", "rad", "", view(offset_rad)},
        {"released_joint_offset_rad", "rad", "", view(released_rad)},
        {"tip_error_m", "m", "distance of the tip from its start", view(tip_error_m)}};
    of_metrics.insert(of_metrics.end(), signals.begin(), signals.end());
    MetricValues values(rows_, of_metrics, plant_.run.duration_s);

    HeldReference held({hand_.release_s(), plant_.run.duration_s}, "the tip", "m");
    const auto sample = [&](double time_s) {
      rig.observe();
      tip_offset = rig.tip() - pose;
      offset_rad = rig.q() - start_rad;
      tip_error_m = tip_offset.head<2>().norm();
      if (hand_.grips(time_s)) {
        released_tip_offset = tip_offset;
        released_rad = offset_rad;
      }
      if (time_s < hand_.release_s()) held.ask(tip_error_m);
      held.add(time_s, tip_error_m);
      turned_rad = hand.turned_rad(sim.qpos());
      moment_Nm = hand.moment_Nm(time_s, sim.qpos(), sim.qvel());
    };
    Recording recording = record_run(
        sim, plant_.physics, plant_.physics.step_at(plant_.run.duration_s), std::move(signals),
        control, [&](std::int64_t) { rig.step(); }, sample, &values);
    if (!recording.failure) held.warn(recording.warnings);
    return recording;
  }

  void prepare_model(Model& model) const override { show_geoms(model, "wall_", false); }

 private:
  int link_ = 1;
  Hand hand_;
};

}  // namespace

ScenarioKind arm_push() {
  return scenario_kind<ArmPush>("arm_push", true);
}

}  // namespace breakwater
