// Scenario two_inertia: vibration control of a motor, a spring and a load.
#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {
namespace {

// A motor turns a load through a spring, with an encoder on the motor. The question is how well a
// controller moves the load, holds it under a torque, and reverses it through a backlash.
class TwoInertiaDrive final : public AxisScenario {
 public:
  explicit TwoInertiaDrive(const Catalogue& catalogue)
      : AxisScenario(catalogue, {.name = "two_inertia",
                                 .summary = "a motor and a load with a spring between them: "
                                            "vibration, load torque, backlash",
                                 .axis = named_axis("", "load", "motor", true),
                                 .controller = "pd",
                                 .totals = qp_totals}) {
    plant_.axis().has_disturbance_keys = false;
  }

  AxisPlant plant() const override {
    AxisPlant plant = plant_;
    AxisSettings& axis = plant.axis();
    if (kind_ == Kind::torque_step) {
      axis.force = {
          .kind = DisturbanceKind::step, .amplitude = torque_Nm_, .start_s = axis.reference.from_s};
      axis.reference.value = 0.0;
    }
    if (kind_ == Kind::reversal) {
      axis.reference.reversed_from_s = reversal_s_;
    } else {
      axis.transmission.design.backlash = 0.0;
    }
    return plant;
  }

 private:
  enum class Kind { position_step, torque_step, reversal };

  void bind(Fields& fields) override {
    fields.choice("task.kind", kind_,
                  {{"position_step", Kind::position_step},
                   {"torque_step", Kind::torque_step},
                   {"reversal", Kind::reversal}},
                  "step of the load's reference, step of the torque on the load, or a step of the "
                  "reference and then its opposite");
    fields.number("task.load_torque_Nm", torque_Nm_, any(), "torque against the load");
    fields.number("task.reversal_s", reversal_s_, not_negative(),
                  "time at which the reference changes its sign");
    fields.only_for({"reference.value_rad"}, "task.kind", {"position_step", "reversal"});
    fields.only_for({"task.load_torque_Nm"}, "task.kind", {"torque_step"});
    fields.only_for({"task.reversal_s", "transmission.backlash_rad"}, "task.kind", {"reversal"});
  }

  MetricContext complete(const Config& config) override {
    const bool reverses = kind_ == Kind::reversal;
    const double from_s = plant_.axis().reference.from_s;
    if (reverses && reversal_s_ <= from_s) {
      config.fail("task.reversal_s", "must be later than reference.from_s");
    }
    return {.known = {{"last_step", reverses ? reversal_s_ : from_s}}};
  }

  void extend(RigRun& run, AxisRig& /*rig*/, const AxisLoop& loop) const override {
    if (!loop.estimates()) return;
    const NominalAxis nominal = task().axis;
    const bool has_spring = nominal.E.size() != 0;
    const Eigen::Index velocity = has_spring ? nominal.controlled + 1 : 1;
    const double per_load = has_spring ? 1.0 : nominal.measured_ratio;
    const double at_load = has_spring ? 1.0 : plant_.axis().transmission.design.ratio;
    run.compute("load_velocity_hat_rad_s", "rad/s", "", [velocity, per_load, &loop](double, auto) {
      return loop.estimator->state()(velocity) / per_load;
    });
    run.compute("load_d_hat_Nm", "N m", "", [at_load, &loop](double, auto) {
      return loop.estimator->disturbance()(0) * at_load;
    });
  }

  Kind kind_ = Kind::position_step;
  double torque_Nm_ = 0.0;
  double reversal_s_ = 0.0;
};

}  // namespace

ScenarioKind two_inertia() {
  return scenario_kind<TwoInertiaDrive>("two_inertia", true);
}

}  // namespace breakwater
