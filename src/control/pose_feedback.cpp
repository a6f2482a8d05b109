#include <breakwater/control/pose_feedback.h>

#include <stdexcept>
#include <utility>

namespace breakwater {

PoseFeedback::PoseFeedback(std::shared_ptr<DisturbanceEstimator> estimator,
                           PoseFeedbackDesign design)
    : estimator_(std::move(estimator)),
      design_(std::move(design)),
      y_(Eigen::VectorXd::Zero(design_.plant.outputs())),
      error_(Eigen::VectorXd::Zero(design_.plant.states())),
      held_input_(Eigen::VectorXd::Zero(design_.plant.inputs())) {
  if (estimator_->state().size() != design_.plant.states() ||
      estimator_->disturbance().size() != design_.plant.inputs()) {
    throw std::invalid_argument("state feedback: estimator and gain must be for the same plant");
  }
  signals_ = {{"x_hat",
               "1",
               "estimated state: deviations from the pose, then velocities [SI]",
               {estimator_->state().data(), static_cast<std::size_t>(error_.size())}},
              {"d_hat",
               "1",
               "estimated disturbances of the inputs [SI]",
               {estimator_->disturbance().data(), static_cast<std::size_t>(held_input_.size())}}};
  for (const Signal& signal : signals_of(*estimator_, "1")) signals_.push_back(signal);
}

void PoseFeedback::reset(const Sample& first) {
  y_ = first.y.head(y_.size()) - design_.pose;
  error_.setZero();
  error_.noalias() = design_.plant.C.transpose() * y_;
  estimator_->reset(error_);
  held_input_.setZero();
}

void PoseFeedback::update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
  y_ = y.y.head(y_.size()) - design_.pose;
  estimator_->update(held_input_, y_);
  for (Eigen::Index i = 0; i < y_.size(); ++i) {
    y_(i) = design_.references[static_cast<std::size_t>(i)].at(y.time_s) - design_.pose(i);
  }
  error_ = estimator_->state();
  error_.noalias() -= design_.plant.C.transpose() * y_;
  u = design_.held_input + estimator_->disturbance();
  u.noalias() -= design_.K * error_;
  held_input_ = u.cwiseMin(design_.limit).cwiseMax(-design_.limit) - design_.held_input;
}

}  // namespace breakwater
