#include <breakwater/rigs/plant_parts.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include <breakwater/control/pose_feedback.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/observers/raw_difference.h>
#include <breakwater/rigs/tip_controllers.h>
#include <breakwater/sim/linear_model.h>

namespace breakwater {
namespace {

using SharedEstimator = std::shared_ptr<DisturbanceEstimator>;

struct NoKeys {};

void bind_nothing(Fields&, NoKeys&) {}

std::unique_ptr<Controller> make_axes(const NoKeys&, const PlantTask& task, SharedEstimator) {
  return task.own_controllers();
}

struct LqrWeights {
  std::vector<double> q_position;
  std::vector<double> q_velocity;
  std::vector<double> r;
};

void bind_lqr(Fields& fields, LqrWeights& weights) {
  const auto numbers = [&](const std::string& key, std::vector<double>& target, const Range& range,
                           const std::string& what) {
    fields.numbers("controller." + key, target, range, what + ", or one for all");
  };
  numbers(
      "q_position", weights.q_position, not_negative(),
      "Q: weights on the positions, one for each joint of the model and then for each motor that "
      "it lacks");
  numbers("q_velocity", weights.q_velocity, not_negative(),
          "Q: weights on the velocities, in the same order");
  numbers("r", weights.r, positive(), "R: weights on the forces, one for each driven axis");
}

Eigen::VectorXd spread(const char* key, const std::vector<double>& weights, Eigen::Index size) {
  return breakwater::spread(
      key, weights, size,
      fmt::format("must have 1 number{}, has {}", size == 1 ? "" : fmt::format(" or {}", size),
                  weights.size()));
}

std::unique_ptr<Controller> make_lqr(const LqrWeights& weights, const PlantTask& task,
                                     SharedEstimator estimator) {
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
  q << spread("controller.q_position", weights.q_position, n),
      spread("controller.q_velocity", weights.q_velocity, n);
  const Eigen::VectorXd r = spread("controller.r", weights.r, plant.inputs());
  const StateSpace sampled = zero_order_hold(plant, task.whole.period_s);
  PoseFeedbackDesign design{plant, task.to_states, {}, task.pose, task.held_input, task.limit, {}};
  design.K = blame("controller.q_position",
                   [&] { return dlqr(sampled.A, sampled.B, q.asDiagonal(), r.asDiagonal()).K; });
  for (std::size_t i = 0; i < task.axes.size(); ++i) {
    const bool is_driven =
        std::find(task.driven.begin(), task.driven.end(), i) != task.driven.end();
    design.axes.push_back(
        {task.names[i], task.axes[i].axis.units, task.axes[i].measured_reference(), is_driven});
  }
  return std::make_unique<PoseFeedback>(std::move(estimator), std::move(design));
}

std::unique_ptr<DisturbanceEstimator> make_raw_difference(const NoKeys&, const NominalAxis& axis) {
  // Without a linear model, or with joints that no axis measures, there is no estimate of the whole
  // plant. The axes' own controllers need none.
  const bool is_whole = axis.E.size() == 0;
  if (axis.plant.states() == 0 || (is_whole && 2 * axis.plant.outputs() < axis.plant.states())) {
    return nullptr;
  }
  return std::make_unique<RawDifference>(axis.plant, axis.period_s);
}

// Commands nothing.
class NoControl final : public Controller {
 public:
  void reset(const Sample&) override {}
  void update(const Sample&, Eigen::Ref<Eigen::VectorXd> u) override { u.setZero(); }
  std::span<const Signal> signals() const override { return {}; }
};

std::unique_ptr<Controller> make_no_control(const NoKeys&, const AxisTask&, SharedEstimator) {
  return std::make_unique<NoControl>();
}

std::unique_ptr<ContactForceLaw> make_no_law(const NoKeys&) {
  return nullptr;
}

}  // namespace

PlantTask plant_task(const AxisPlant& plant) {
  PlantTask task;
  task.senses_true_state = plant.senses_true_state;
  const Eigen::Index entries = plant.senses_true_state ? 3 : 1;
  const auto force_behind = [&](std::size_t axes) {
    if (!plant.tip) return ForceTask();
    return ForceTask{entries * static_cast<Eigen::Index>(axes), plant.tip->reference};
  };
  task.force = force_behind(plant.axes.size());
  const Model model = plant.load_model();
  std::vector<int> joints, actuators;
  std::vector<std::unique_ptr<Transmission>> transmissions;
  std::vector<SpringOnJoint> springs;
  std::vector<double> limits;
  task.pose.resize(static_cast<Eigen::Index>(plant.axes.size()));
  for (std::size_t i = 0; i < plant.axes.size(); ++i) {
    const AxisSettings& one = plant.axes[i];
    task.names.push_back(one.axis.name);
    task.axes.push_back({.axis = plant.nominal(i),
                         .reference = one.reference,
                         .start_state = Eigen::Vector2d(one.reference.before, one.start_velocity) *
                                        one.transmission.measured_ratio(),
                         .senses_true_state = plant.senses_true_state,
                         .force = force_behind(1)});
    task.pose(static_cast<Eigen::Index>(i)) = one.reference.before;
    joints.push_back(model.id(mjOBJ_JOINT, one.measured_joint()));
    if (!one.axis.is_driven()) continue;
    task.driven.push_back(i);
    actuators.push_back(actuator_id(model, one.axis));
    limits.push_back(one.force_limit());
  }
  task.limit =
      Eigen::Map<const Eigen::VectorXd>(limits.data(), static_cast<Eigen::Index>(limits.size()));
  NominalAxis& whole = task.whole;
  whole.period_s = plant.physics.control_period_s;
  const auto count = static_cast<Eigen::Index>(plant.axes.size());
  whole.sensor.quantum.resize(count);
  whole.sensor.noise_std.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const SensorError& sensor = task.axes[static_cast<std::size_t>(i)].axis.sensor;
    whole.sensor.quantum(i) = sensor.quantum(0);
    whole.sensor.noise_std(i) = sensor.noise_std(0);
  }
  try {
    Model nominal = plant.nominal_model();
    for (const AxisSettings& one : plant.axes) {
      if (!one.transmission.is_elastic()) continue;
      // The engine never integrates the nominal spring, so its stability does not matter.
      transmissions.push_back(std::make_unique<Transmission>(
          nominal, one.transmission.motor(one.axis.joint), one.axis.joint,
          one.transmission.linear_design(one.nominal_from)));
      springs.push_back({transmissions.back().get(),
                         nominal.id(mjOBJ_JOINT, one.transmission.motor(one.axis.joint))});
    }
    LinearModel linear =
        linearise(std::move(nominal), plant.pose(model), joints, actuators, springs);
    whole.plant = std::move(linear.plant);
    task.held_input = std::move(linear.held_input);
    task.to_states = whole.plant.C.transpose();
    for (Eigen::Index i = 0; i < count; ++i) {
      const AxisSettings& one = plant.axes[static_cast<std::size_t>(i)];
      task.pose(i) = linear.qpos(model->jnt_qposadr[joints[static_cast<std::size_t>(i)]]);
      if (!one.transmission.is_elastic()) continue;
      // At rest the other side of the spring moves too.
      const bool is_motor = one.transmission.measured == Side::motor;
      const double ratio = one.transmission.design.ratio;
      const std::string other = is_motor ? one.axis.joint : one.transmission.motor(one.axis.joint);
      task.to_states(model->jnt_dofadr[model.id(mjOBJ_JOINT, other)], i) =
          is_motor ? 1.0 / ratio : ratio;
    }
  } catch (const std::invalid_argument& error) {
    task.why_not_linear = error.what();
  }
  return task;
}

std::vector<PlantControllerKind> plant_controllers() {
  return {
      {"axes", "each axis has its own controller: axis.NAME.controller.name", bind_nothing,
       make_axes},
      {"lqr",
       "linear quadratic regulator of the plant linearised about the pose of start.keyframe, with "
       "cancellation of the estimated disturbance",
       bind_lqr, make_lqr}};
}

Catalogue with_none(Catalogue catalogue) {
  catalogue.add(AxisEstimatorKind(
      "none", "no estimator: the measured position, its difference over a sample, no disturbance",
      bind_nothing, make_raw_difference));
  for (PlantControllerKind& kind : tip_controllers(catalogue)) catalogue.add(std::move(kind));
  catalogue.add(AxisControllerKind("none", "no control", bind_nothing, make_no_control));
  catalogue.add(ContactLawKind(WallSettings::kOfModel, "the contact as the model file has it",
                               bind_nothing, make_no_law));
  return catalogue;
}

}  // namespace breakwater
