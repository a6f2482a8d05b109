// Several axes, each with a controller of its own.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <breakwater/control/controller.h>

namespace breakwater {

/// The controller of one axis of several.
struct AxisControl {
  std::string name;  ///< its signals are NAME_…
  std::unique_ptr<Controller> controller;
  bool is_driven = true;
};

/// Gives each axis its own part of a sample. A sample has one or three entries for each axis: the
/// measured positions of all axes, then all true positions, then all true velocities. Entries
/// behind them, such as a force, go to each axis. The command has an entry for each driven axis.
class AxesControl final : public Controller {
 public:
  /// `entries` of a sample for each axis: 1 or 3.
  AxesControl(std::vector<AxisControl> axes, Eigen::Index entries);

  void reset(const Sample& first) override;
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override;
  void set_watched(bool is_watched) override;

 private:
  const Sample& part(const Sample& y, Eigen::Index axis);

  std::vector<AxisControl> axes_;
  Eigen::Index entries_;
  Sample own_;
  Eigen::VectorXd ignored_;  // the command of an axis that is not driven
};

}  // namespace breakwater
