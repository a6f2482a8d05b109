// Breakwater's controllers of a plant: their keys, and the functions that make them.
#include <algorithm>
#include <stdexcept>
#include <utility>

#include <breakwater/control/pose_feedback.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/rigs/plant_parts.h>

namespace breakwater {
namespace {

using SharedEstimator = std::shared_ptr<DisturbanceEstimator>;

struct PlantLqr {
  std::vector<double> q_position;
  std::vector<double> q_velocity;
  std::vector<double> r;

  void bind(Fields& fields) {
    fields.numbers("controller.q_position", q_position, not_negative(),
                   "Q: weights on the positions, one for each joint of the model and then for each "
                   "motor that it lacks, or one for all");
    fields.numbers("controller.q_velocity", q_velocity, not_negative(),
                   "Q: weights on the velocities, in the same order, or one for all");
    fields.numbers("controller.r", r, positive(),
                   "R: weights on the forces, one for each driven axis, or one for all");
  }
  std::unique_ptr<Controller> make(const PlantTask& task, SharedEstimator estimator) const {
    if (!task.why_not_linear.empty()) throw std::invalid_argument(task.why_not_linear);
    if (task.driven.empty()) {
      throw std::invalid_argument("lqr needs an axis with a <motor> in the model");
    }
    if (!estimator) {
      throw WrongKey("observer.name",
                     "none needs an axis for each joint of the model, because lqr feeds all "
                     "positions back: add axes, or choose an estimator");
    }
    const StateSpace& plant = task.whole.plant;
    const Eigen::Index n = plant.states() / 2;
    Eigen::VectorXd q(2 * n);
    q << spread("controller.q_position", q_position, n, "joint"),
        spread("controller.q_velocity", q_velocity, n, "joint");
    const Eigen::VectorXd R = spread("controller.r", r, plant.inputs(), "driven axis");
    const StateSpace sampled = zero_order_hold(plant, task.whole.period_s);
    PoseFeedbackDesign design{plant,           task.to_states, {}, task.pose,
                              task.held_input, task.limit,     {}};
    design.K = blame("controller.q_position",
                     [&] { return dlqr(sampled.A, sampled.B, q.asDiagonal(), R.asDiagonal()).K; });
    for (std::size_t i = 0; i < task.axes.size(); ++i) {
      const bool is_driven = std::ranges::find(task.driven, i) != task.driven.end();
      design.axes.push_back(
          {task.names[i], task.axes[i].axis.units, task.axes[i].measured_reference(), is_driven});
    }
    return std::make_unique<PoseFeedback>(std::move(estimator), std::move(design));
  }
};

}  // namespace

std::vector<PlantControllerKind> plant_controllers() {
  return {{"axes", "each axis has its own controller: axis.NAME.controller.name",
           [](const PlantTask& task, const SharedEstimator&) { return task.own_controllers(); }},
          {"lqr",
           "linear quadratic regulator of the plant linearised about the pose of start.keyframe, "
           "with cancellation of the estimated disturbance",
           &PlantLqr::make}};
}

}  // namespace breakwater
