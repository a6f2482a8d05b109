#include <breakwater/control/predictive_control.h>

#include <algorithm>
#include <utility>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

PredictiveControl::PredictiveControl(std::shared_ptr<DisturbanceEstimator> estimator,
                                     const PredictiveControlDesign& design)
    : EstimatingControl(std::move(estimator), design.loop),
      design_(design),
      lmpc_(design.lmpc),
      predicted_state_(Eigen::VectorXd::Zero(lmpc_.states())) {
  const Eigen::Index disturbances = design.disturbance_use == DisturbanceUse::predict ? 1 : 0;
  refuse_unless(lmpc_.inputs() == 1 && lmpc_.states() == state().size() + disturbances &&
                    design.controlled >= 0 && design.controlled < state().size(),
                "predictive control: estimator and model must be for the same plant");
  refuse_unless(design.samples_per_move >= 1,
                "predictive control: needs at least one sample per move");
  const AxisUnits& units = design.loop.units;
  publish({"u_mpc_" + units.force_suffix, units.force, "input of the optimisation (Eq. 2.42)",
           view(lmpc_.u())});
  publish({"qp_iterations", "1", "iterations of the last optimisation", view(lmpc_.iterations())});
  publish({"qp_softened", "1", "number of softened bounds in it: on states, then on du",
           view(lmpc_.softened_bounds())});
  publish({"qp_status", "1", "status of its last solve: 0 solved, 1 iteration cap, 4 inaccurate",
           view(status_)});
  publish(
      {"qp_kkt_residual", "1", "residual of its last solve", view(lmpc_.solution().kkt_residual)});
}

void PredictiveControl::reset(const Sample& first) {
  EstimatingControl::reset(first);
  lmpc_.reset();
  cancelled_ = 0.0;
  sample_ = 0;
}

double PredictiveControl::input(const Sample&) {
  const bool cancels = design_.disturbance_use == DisturbanceUse::cancel ||
                       design_.disturbance_use == DisturbanceUse::cancel_within_bounds;
  const bool decides = sample_++ % design_.samples_per_move == 0;
  if (decides) {
    predicted_state_.head(state().size()) = state();
    if (design_.disturbance_use == DisturbanceUse::predict) {
      predicted_state_.tail<1>()(0) = disturbance();
    }
    if (design_.disturbance_use == DisturbanceUse::cancel_within_bounds) {
      lmpc_.reserved()(0) = disturbance();
    }
    for (int i = 0; i < lmpc_.prediction_steps(); ++i) {
      lmpc_.reference()(i * lmpc_.states() + design_.controlled) = reference();
    }
    lmpc_.optimise(predicted_state_);
    status_ = static_cast<double>(lmpc_.solution().status);
  }
  if (cancels && (decides || design_.cancel_at == CancelAt::sample)) cancelled_ = disturbance();
  double u = cancels ? lmpc_.u()(0) + cancelled_ : lmpc_.u()(0);
  if (design_.disturbance_use == DisturbanceUse::cancel_within_bounds) {
    for (const PredictedBound& bound : design_.lmpc.input_bounds) {
      u = std::clamp(u, bound.lower, bound.upper);
    }
  }
  return u;
}

}  // namespace breakwater
