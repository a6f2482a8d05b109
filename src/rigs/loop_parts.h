// An estimator and a controller that a scenario chooses by name.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/control/controller.h>
#include <breakwater/experiment/parts.h>

namespace breakwater {

/// A number for each of `size`, from these or from the only one. Throws a WrongKey if there are
/// others. `of` says what has them.
inline Eigen::VectorXd spread(const char* key, const std::vector<double>& numbers,
                              Eigen::Index size, const std::string& of) {
  if (numbers.size() == 1) return Eigen::VectorXd::Constant(size, numbers.front());
  if (static_cast<Eigen::Index>(numbers.size()) != size) {
    throw WrongKey(key, "must have one number, or " + std::to_string(size) + ": one for each " +
                            of + "; has " + std::to_string(numbers.size()));
  }
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), size);
}

/// A controller and the estimator that it updates; null if it released the given one.
template <typename Estimator>
struct ControlLoop {
  std::unique_ptr<Controller> controller;
  std::shared_ptr<Estimator> estimator;

  bool estimates() const { return estimator != nullptr; }
};

/// The chosen estimator and controller of a loop. `estimator_for(task, make)` makes the estimator
/// by `make(MODEL)`; the controller gets the task and the estimator.
template <typename Estimator, typename EstimatorKind, typename ControllerKind, typename Task>
class LoopParts {
 public:
  /// The default values of controller.name and of EstimatorKind::kKey. Without one, its key is
  /// required.
  LoopParts(const Catalogue& catalogue, const std::string& standard_controller,
            const std::string& standard_estimator = "")
      : estimator_(catalogue, EstimatorKind::kKey, standard_estimator),
        controller_(catalogue, "controller.name", standard_controller) {}

  void bind(Fields& fields) {
    estimator_.bind(fields);
    controller_.bind(fields);
  }

  /// Throws std::invalid_argument `ORIGIN: KEY: reason` if make() would fail.
  void check(const Config& config, const Task& task) const {
    controller_.check(config, task, estimator_for(task, [&](const auto& known) {
                        return estimator_.check(config, known);
                      }));
  }

  ControlLoop<Estimator> make(const Task& task) const {
    std::shared_ptr<Estimator> given =
        estimator_for(task, [&](const auto& known) { return estimator_.make(known); });
    const std::weak_ptr<Estimator> kept = given;
    std::unique_ptr<Controller> controller = controller_.make(task, std::move(given));
    return {std::move(controller), kept.lock()};
  }

  const std::string& controller_name() const { return controller_.chosen(); }
  const std::string& estimator_name() const { return estimator_.chosen(); }

 private:
  PartChoice<EstimatorKind> estimator_;
  PartChoice<ControllerKind> controller_;
};

}  // namespace breakwater
