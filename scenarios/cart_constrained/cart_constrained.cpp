// Scenario cart_constrained: constraints under disturbance and mass error (thesis 2.3.7, 3.3.4).
#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {
namespace {

// A condition of the table in 2.3.7.
struct Condition {
  double force_N = 0.0;  // half of the input's limit or the limit
  double mass_ratio = 1.0;

  bool operator==(const Condition&) const = default;
};

// The cart starts displaced and moving, and must come to rest at 0. The question is whether the
// controller keeps its limits of input and velocity under a force or a mass error.
class CartConstrained final : public AxisScenario {
 public:
  explicit CartConstrained(const Catalogue& catalogue)
      : AxisScenario(catalogue, {.name = "cart_constrained",
                                 .summary = "limits of a cart's input and velocity under "
                                            "disturbance and mass error",
                                 .axis = cart_axis(),
                                 .disturbance = DisturbanceKind::step,
                                 .totals = qp_totals}) {
    plant_.senses_true_state = true;
    plant_.axis().has_disturbance_keys = false;
  }

  Matrix matrix() const override {
    return {"condition",
            {"A", "B", "C", "D", "E"},
            {"max_input_N", "max_speed_m_s", "final_position_m", "input_violation_time_s",
             "speed_violation_time_s"}};
  }

  AxisPlant plant() const override {
    AxisPlant plant = plant_;
    plant.axis().force.amplitude = condition_.force_N;
    plant.inertia_ratio *= condition_.mass_ratio;
    return plant;
  }

 private:
  void bind(Fields& fields) override {
    fields.choice<Condition>(
        "condition", condition_,
        {{"A", {}}, {"B", {1.0}}, {"C", {2.0}}, {"D", {0.0, 0.5}}, {"E", {0.0, 1.5}}},
        "A: nominal. B, C: a force of 1 N or 2 N. D, E: half or one and a half times the "
        "nominal mass");
    fields.number("observer.start_position_m", start_estimate_(0), any(),
                  "position with which the estimator starts");
    fields.number("observer.start_velocity_m_s", start_estimate_(1), any(),
                  "velocity with which the estimator starts");
    fields.number("constraint.velocity_m_s", velocity_m_s_, positive(), "bound on |v|");
    fields.number("constraint.input_lower_N", input_lower_N_, any(), "lower bound on the input");
    fields.number("constraint.input_upper_N", input_upper_N_, any(), "upper bound on the input");
    fields.number("disturbance.start_s", plant_.axis().disturbance.shape.start_s, not_negative(),
                  "in conditions B and C, the time at which the force begins");
    fields.only_for({"disturbance.start_s"}, "condition", {"B", "C"});
  }

  MetricContext complete(const Config& /*config*/) override {
    return {.known = {{"push_s", condition_.force_N > 0.0 ? plant_.axis().force.start_s : 0.0}}};
  }

  Condition condition_;
  // The limits for the metrics, for any controller.
  double input_lower_N_ = 0.0;
  double input_upper_N_ = 0.0;
  double velocity_m_s_ = 0.0;
};

}  // namespace

ScenarioKind cart_constrained() {
  return scenario_kind<CartConstrained>("cart_constrained", true);
}

}  // namespace breakwater
