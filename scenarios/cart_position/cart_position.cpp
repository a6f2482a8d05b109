// Scenario cart_position: a cart with friction, drive and encoder (thesis 2.3.4, 4.2.5).
#include <breakwater/linear/high_pass.h>
#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {
namespace {

// A cart with Coulomb and viscous friction, a drive of finite pulse-width resolution and an
// encoder goes to a position. Its control is PD with disturbance cancellation (Eq. 4.10) or
// predictive control. The nominal model lacks the friction, so the estimator must find it.
class CartPosition final : public AxisScenario {
 public:
  explicit CartPosition(const Catalogue& catalogue)
      : AxisScenario(
            catalogue,
            {.name = "cart_position",
             .summary = "position control of a cart with friction, quantised drive and encoder",
             .axis = cart_axis(),
             .optimises = true}) {}

 private:
  void bind(Fields& fields) override {
    bind_step(fields);
    fields.number(
        "metrics.high_pass_Hz", high_pass_Hz_, positive(),
        "passband of the high-pass behind which the noise of the estimate is measured [Hz]");
  }

  MetricContext complete(const Config& config) override {
    config.blame("metrics.high_pass_Hz", [this] { high_pass(); });
    return {};
  }

  HighPass high_pass() const { return {high_pass_Hz_, plant_.physics.control_period_s}; }

  AxisAdditions additions(const AxisRig& /*rig*/, const AxisLoop& loop) const override {
    struct HighPassed {
      HighPass high_pass;
      double value_N = 0.0;
    };
    const auto noise = std::make_shared<HighPassed>(HighPassed{high_pass()});
    AxisAdditions own;
    own.logged = {{"d_hat_highpass_N", "N", "the estimated disturbance behind a high-pass",
                   view(noise->value_N)}};
    if (loop.estimates()) {
      own.sample = [noise, &loop](double /*time_s*/) {
        noise->value_N = noise->high_pass.update(loop.estimator->disturbance()(0));
      };
    }
    return own;
  }

  double high_pass_Hz_ = 0.0;
};

}  // namespace

ScenarioKind cart_position() {
  return scenario_kind<CartPosition>("cart_position");
}

}  // namespace breakwater
