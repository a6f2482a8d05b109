#include <breakwater/control/pose_feedback.h>

#include <utility>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

PoseFeedback::PoseFeedback(std::shared_ptr<DisturbanceEstimator> estimator,
                           PoseFeedbackDesign design)
    : estimator_(std::move(estimator)),
      design_(std::move(design)),
      y_(Eigen::VectorXd::Zero(design_.plant.outputs())),
      error_(Eigen::VectorXd::Zero(design_.plant.states())),
      position_hat_(design_.pose),
      held_input_(Eigen::VectorXd::Zero(design_.plant.inputs())) {
  refuse_unless(estimator_->state().size() == design_.plant.states() &&
                    estimator_->disturbance().size() == design_.plant.inputs() &&
                    design_.to_states.rows() == design_.plant.states() &&
                    design_.to_states.cols() == design_.plant.outputs(),
                "state feedback: estimator and gain must be for the same plant");
  Eigen::Index input = 0;
  for (Eigen::Index i = 0; i < y_.size(); ++i) {
    const FeedbackAxis& axis = design_.axes[static_cast<std::size_t>(i)];
    const AxisUnits& units = axis.units;
    Eigen::Index state = 0;
    design_.plant.C.row(i).maxCoeff(&state);
    const auto add = [&](const std::string& name, const std::string& unit, const char* what,
                         const double& value) {
      publish({axis.name + "_" + name, unit, what, view(value)});
    };
    add("position_hat_" + units.position, units.position, "position, estimated", position_hat_(i));
    add("velocity_hat_" + units.velocity_suffix, units.velocity, "velocity, estimated",
        *(estimator_->state().data() + error_.size() / 2 + state));
    if (!axis.is_driven) continue;
    add("d_hat_" + units.force_suffix, units.force, "disturbance at the drive, estimated",
        *(estimator_->disturbance().data() + input++));
  }
  for (const Signal& signal : signals_of(*estimator_, "1")) publish(signal);
}

void PoseFeedback::reset(const Sample& first) {
  y_ = first.y.head(y_.size()) - design_.pose;
  error_.noalias() = design_.to_states * y_;
  estimator_->reset(error_);
  held_input_.setZero();
}

void PoseFeedback::update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
  y_ = y.y.head(y_.size()) - design_.pose;
  estimator_->update(held_input_, y_);
  for (Eigen::Index i = 0; i < y_.size(); ++i) {
    const Reference& reference = design_.axes[static_cast<std::size_t>(i)].reference;
    y_(i) = reference.at(y.time_s) - reference.before;
  }
  error_ = estimator_->state();
  position_hat_ = design_.pose;
  position_hat_.noalias() += design_.plant.C * error_;
  error_.noalias() -= design_.to_states * y_;
  u = design_.held_input + estimator_->disturbance();
  u.noalias() -= design_.K * error_;
  held_input_ = u.cwiseMin(design_.limit).cwiseMax(-design_.limit) - design_.held_input;
}

}  // namespace breakwater
