#include <breakwater/control/estimating_control.h>

#include <algorithm>
#include <utility>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

EstimatingControl::EstimatingControl(std::shared_ptr<DisturbanceEstimator> estimator,
                                     const AxisLoopDesign& design)
    : estimator_(std::move(estimator)), design_(design) {
  refuse_unless(
      state().size() == design.start_state.size() && estimator_->disturbance().size() == 1,
      "control of an axis: the estimator must be for the same plant");
  refuse_unless(design.force_limit > 0.0, "control of an axis: the force limit must be positive");
  const AxisUnits& units = design.units;
  publish({"reference_" + units.position, units.position, "reference", view(reference_)});
  for (const Signal& signal : estimate_signals(*estimator_, units)) publish(signal);
  for (const Signal& signal : signals_of(*estimator_, units.position)) publish(signal);
  if (design.period_s == 0.0) return;
  poles_.emplace(*estimator_, design.period_s);
  for (const Signal& signal : poles_->signals()) publish(signal);
}

void EstimatingControl::reset(const Sample&) {
  estimator_->reset(design_.start_state);
  held_input_.setZero();
}

void EstimatingControl::update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
  estimator_->update(held_input_, y.y.head<1>());
  if (is_watched_ && poles_) poles_->update();
  reference_ = design_.reference.at(y.time_s);
  u(0) = input(y);
  held_input_(0) = std::clamp(u(0), -design_.force_limit, design_.force_limit);
}

}  // namespace breakwater
