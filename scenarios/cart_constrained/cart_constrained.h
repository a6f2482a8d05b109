// Scenario cart_constrained: constraints under disturbance and mass error (thesis 2.3.7, 3.3.4).
#pragma once

#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {

/// The conditions of the table in 2.3.7.
enum class CartCondition {
  A,  ///< no disturbance
  B,  ///< a force of 1 N, half of the input's limit
  C,  ///< a force of 2 N, the input's limit
  D,  ///< half of the nominal mass
  E   ///< one and a half times the nominal mass
};

/// The cart starts displaced and moving, and must come to rest at 0. The question is whether the
/// controller keeps its limits of input and velocity under a force or a mass error.
class CartConstrained final : public AxisScenario {
 public:
  explicit CartConstrained(const Catalogue& catalogue)
      : AxisScenario(catalogue, "cart_constrained", Optimises::yes),
        plant_(cart_axis(), catalogue),
        parts_(catalogue, "") {}

  std::string name() const override { return "cart_constrained"; }
  std::string summary() const override {
    return "limits of a cart's input and velocity under disturbance and mass error";
  }
  Matrix matrix() const override {
    return {"condition",
            {"A", "B", "C", "D", "E"},
            {"max_input_N", "max_speed_m_s", "final_position_m", "input_violation_time_s",
             "speed_violation_time_s"}};
  }
  Fields fields() override;
  void check(const Config& config) override;
  const RunSettings& run_settings() const override { return plant_.run; }
  AxisPlant plant() const override;
  AxisTask task() const override;
  const AxisParts& parts() const override { return parts_; }

 private:
  Disturbance disturbance() const;

  AxisPlant plant_;
  AxisParts parts_;
  CartCondition condition_ = CartCondition::A;
  double start_position_m_ = 0.0;
  double start_velocity_m_s_ = 0.0;
  double estimated_start_position_m_ = 0.0;
  double estimated_start_velocity_m_s_ = 0.0;
  double disturbance_start_s_ = 0.0;
  // The limits for the metrics, for any controller.
  double input_lower_N_ = 0.0;
  double input_upper_N_ = 0.0;
  double velocity_m_s_ = 0.0;
  double violation_slack_ = 0.0;
  double settled_within_m_ = 0.0;
};

}  // namespace breakwater
