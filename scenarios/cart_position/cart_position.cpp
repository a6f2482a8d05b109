#include "cart_position/cart_position.h"

#include <cmath>
#include <utility>

#include <breakwater/control/disturbance_cancelling_pd.h>
#include <breakwater/linear/high_pass.h>
#include <breakwater/record/window_metrics.h>
#include <breakwater/scenario/run_loop.h>

namespace breakwater {

Fields CartPosition::fields() {
  Fields fields;
  axis_.bind(fields);
  estimator_.bind(fields);
  estimator_.bind_gamma(fields);
  fields.choice("controller.name", controller_,
                {{"pd", CartPositionController::pd}, {"mpc", CartPositionController::mpc}},
                "pd (Eq. 4.10) or mpc");
  fields.number("controller.kp", k_p_, not_negative(), "K_p [N/m]");
  fields.number("controller.kd", k_d_, not_negative(), "K_d [N s/m]");
  mpc_.bind(fields);
  fields.only_for({"controller.kp", "controller.kd"}, "controller.name", {"pd"});
  fields.only_for(CartMpcSettings::regulator_keys(), "controller.name", {"mpc"});
  fields.only_for(CartMpcSettings::predictive_keys(), "controller.name", {"mpc"});
  fields.number("task.reference_m", reference_.value, any(), "y_ref [m]");
  fields.number("task.reference_from_s", reference_.from_s, not_negative(),
                "when it is stepped to [s]");
  fields.number("metrics.from_s", from_s_, not_negative(), "the steady state begins [s]");
  fields.number("metrics.to_s", to_s_, not_negative(), "the steady state ends [s]");
  fields.number("metrics.settled_within", settled_within_, positive(),
                "settled: the cart stays this close to the reference, over the step");
  fields.number("metrics.high_pass_Hz", high_pass_Hz_, positive(),
                "passband of the high-pass behind which the estimate's noise is taken [Hz]");
  return fields;
}

std::unique_ptr<Controller> CartPosition::make_controller(
    std::unique_ptr<DisturbanceEstimator> estimator) const {
  if (controller_ == CartPositionController::mpc) {
    PredictiveControlDesign design = mpc_.design(axis_);
    design.reference = reference_;
    return std::make_unique<PredictiveControl>(std::move(estimator), design);
  }
  return std::make_unique<DisturbanceCancellingPd>(
      std::move(estimator),
      DisturbanceCancellingPdDesign{.k_p = k_p_,
                                    .k_d = k_d_,
                                    .reference = reference_,
                                    .force_limit = axis_.force_limit(),
                                    .period_s = axis_.physics.control_period_s,
                                    .units = axis_.axis.units});
}

void CartPosition::check(const Config& config) {
  check_axis(axis_, config);
  config.blame("observer.name", [&] { make_estimator(estimator_, axis_); });
  mpc_.check(axis_, config);
  config.blame("metrics.high_pass_Hz",
               [&] { HighPass(high_pass_Hz_, axis_.physics.control_period_s); });
  if (to_s_ <= from_s_) config.fail("metrics.to_s", "must be later than metrics.from_s");
}

Recording CartPosition::run(const RunControl& control) const {
  auto estimator = make_estimator(estimator_, axis_);
  const DisturbanceEstimator& estimates = *estimator;
  const std::unique_ptr<Controller> controller = make_controller(std::move(estimator));
  AxisRig rig(axis_, {}, *controller);
  Simulation& sim = rig.simulation();
  const std::int64_t steps = axis_.physics.step_at(axis_.run.duration_s);

  HighPass high_pass(high_pass_Hz_, axis_.physics.control_period_s);
  double high_passed_N = 0.0;
  std::vector<Signal> signals = rig.signals();
  signals.push_back({"d_hat_highpass_N", "N", "the estimated disturbance behind a high-pass",
                     view(high_passed_N)});
  Track log("control", std::move(signals),
            static_cast<std::size_t>(steps / axis_.physics.steps_per_sample() + 1));

  const double end_s = axis_.run.duration_s;
  const TimeWindow window = TimeWindow{from_s_, to_s_}.within(end_s);
  WindowStatistics error(window), input_step(window), noise(TimeWindow{}), position(TimeWindow{});
  double last_input = 0.0;
  SettlingTime settling(TimeWindow{reference_.from_s, to_s_}.within_and_on(end_s),
                        settled_within_ * std::abs(reference_.value));

  Recording recording;
  // One step more than the duration has, so that the sample at its end is there.
  recording.failure = run_loop(steps + 1, control, [&](std::int64_t) {
    rig.step();
    if (!sim.sampled()) return;
    const double t = sim.time_s();
    high_passed_N = high_pass.update(estimates.disturbance()(0));
    const double missing = reference_.at(t) - sim.qpos()[0];
    const double input = sim.actuation()(0);
    error.add(t, missing);
    noise.add(t, high_passed_N);
    settling.add(t, missing);
    position.add(t, sim.qpos()[0]);
    input_step.add(t, input - last_input);
    last_input = input;
    log.append(t);
  });

  conclude(recording, sim);
  if (!recording.failure) {
    std::vector<Metric>& metrics = recording.metrics;
    add(metrics, "steady_state_error_m", "m", error.mean());
    add(metrics, "settling_time_s", "s", settling.value());
    add(metrics, "rms_highpass_disturbance_N", "N", noise.rms());
    add(metrics, "rms_input_step_N", "N", input_step.rms());
    add(metrics, "max_position_m", "m", position.largest());
    if (const auto* mpc = dynamic_cast<const PredictiveControl*>(controller.get())) {
      add_qp_metrics(mpc->lmpc().statistics(), recording);
    }
  }
  recording.tracks.push_back(std::move(log));
  return recording;
}

}  // namespace breakwater
