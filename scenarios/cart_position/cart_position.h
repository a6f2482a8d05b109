// Scenario cart_position: position control of a cart with real friction, drive and encoder (thesis
// 2.3.4 and 4.2.5).
#pragma once

#include <breakwater/rigs/cart_mpc.h>
#include <breakwater/scenario/scenario.h>

namespace breakwater {

enum class CartPositionController { pd, mpc };

/// A cart with Coulomb and viscous friction, a drive of finite pulse-width resolution and an
/// encoder goes to a position under PD control with disturbance cancellation (Eq. 4.10), or under
/// predictive control. What the estimator must find is the friction, as the nominal model does not
/// know it.
class CartPosition final : public Scenario {
 public:
  std::string name() const override { return "cart_position"; }
  std::string summary() const override {
    return "position control of a cart with friction, quantised drive and encoder";
  }
  Fields fields() override;
  void check(const Config& config) override;
  const RunSettings& run_settings() const override { return axis_.run; }
  Recording run(const RunControl& control) const override;

 private:
  std::unique_ptr<Controller> make_controller(
      std::unique_ptr<DisturbanceEstimator> estimator) const;

  AxisSettings axis_{cart_axis()};
  EstimatorSettings estimator_;
  CartMpcSettings mpc_;
  CartPositionController controller_ = CartPositionController::pd;
  double k_p_ = 0.0;
  double k_d_ = 0.0;
  StepReference reference_;
  double from_s_ = 0.0;
  double to_s_ = 0.0;
  double settled_within_ = 0.0;
  double high_pass_Hz_ = 0.0;
};

}  // namespace breakwater
