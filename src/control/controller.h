// The interface of all controllers.
#pragma once

#include <Eigen/Core>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <breakwater/math/interface.h>
#include <breakwater/signals/signal.h>

namespace breakwater {

/// A controller throws this if it cannot continue. The run then fails.
class ControlFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A sampled-data control law. It knows nothing of the simulator: at each sampling instant it gets
/// a measurement and writes a command. It owns its observer.
class Controller : public Interface {
 public:
  /// Called once before the first update, with the first sample.
  virtual void reset(const Sample& first) = 0;

  /// One sampling instant: `y` is the measurement, `u` the command until the next one, before the
  /// plant's saturation. Allocates nothing. May throw ControlFailure.
  virtual void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) = 0;

  /// Signals for a log: those of publish(). The views stay valid as long as the controller lives.
  virtual std::span<const Signal> signals() const { return signals_; }

  /// Says whether anyone reads the signals() that the control law does not need; true by default.
  /// If not, the controller may skip their computation.
  virtual void set_watched(bool /*is_watched*/) {}

 protected:
  /// Adds a signal to the log. Its view must stay valid as long as the controller lives.
  void publish(Signal signal) { signals_.push_back(std::move(signal)); }

 private:
  std::vector<Signal> signals_;
};

}  // namespace breakwater
