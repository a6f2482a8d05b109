#include "cart_position/cart_position.h"

#include <breakwater/linear/high_pass.h>

namespace breakwater {

Fields CartPosition::fields() {
  Fields fields;
  plant_.bind(fields);
  parts_.bind(fields);
  fields.number("task.reference_m", plant_.axis().reference.value, any(),
                "y_ref: reference of the position [m]");
  fields.number("task.reference_from_s", plant_.axis().reference.from_s, not_negative(),
                "time of the step to the reference [s]");
  fields.number("metrics.from_s", from_s_, not_negative(),
                "start of the window of the steady state [s]");
  fields.number("metrics.to_s", plant_.judged_to_s, not_negative(),
                "end of the window of the steady state [s]");
  fields.number(
      "metrics.settled_within", settled_within_, positive(),
      "distance from the reference, relative to the step, within which the cart counts as settled");
  fields.number(
      "metrics.high_pass_Hz", high_pass_Hz_, positive(),
      "passband of the high-pass behind which the noise of the estimate is measured [Hz]");
  rows_.bind(fields);
  return fields;
}

void CartPosition::check(const Config& config) {
  check_plant(plant_, config);
  parts_.check(config, task());
  config.blame("metrics.high_pass_Hz",
               [&] { HighPass(high_pass_Hz_, plant_.physics.control_period_s); });
  if (plant_.judged_to_s <= from_s_)
    config.fail("metrics.to_s", "must be later than metrics.from_s");
  check_metrics(config);
}

AxisAdditions CartPosition::additions(const AxisRig& /*rig*/, const AxisLoop& loop) const {
  struct HighPassed {
    HighPass high_pass;
    double value_N = 0.0;
  };
  const auto noise = std::make_shared<HighPassed>(
      HighPassed{HighPass(high_pass_Hz_, plant_.physics.control_period_s)});
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

}  // namespace breakwater
