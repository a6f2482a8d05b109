// What every controller is.
#pragma once

#include <Eigen/Core>
#include <span>
#include <stdexcept>

#include <breakwater/signals/sample.h>
#include <breakwater/signals/signal.h>

namespace breakwater {

/// Thrown by a controller that cannot go on: it ends the run as failed.
class ControlFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A sampled-data control law. It knows nothing of the simulator: it gets what its sensors gave at
/// its own sampling instant, and writes a command. It owns its observer.
class Controller {
 public:
  Controller() = default;
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;
  virtual ~Controller() = default;

  /// Called once before the first update, with the first sample.
  virtual void reset(const Sample& first) = 0;

  /// One sampling instant: `y` is what was measured, `u` the command until the next one, before
  /// the plant's own saturation. Allocates nothing. May throw ControlFailure.
  virtual void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) = 0;

  /// What it lets others see. The views stay valid as long as the controller lives.
  virtual std::span<const Signal> signals() const = 0;

  /// Tells it whether anyone will read, after the next updates, those of signals() that its law
  /// itself does not need; until it is told, someone does. It may spare itself their computation
  /// where nobody does.
  virtual void set_watched(bool /*is_watched*/) {}
};

}  // namespace breakwater
