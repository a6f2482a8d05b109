// A signal of a controller's log.
#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <string>

#include <breakwater/control/controller.h>

namespace breakwater::testing {

/// The values of the signal `name`. Throws std::logic_error if there is none.
inline Eigen::VectorXd signal(const Controller& controller, const std::string& name) {
  for (const Signal& s : controller.signals()) {
    if (s.name == name) {
      return Eigen::Map<const Eigen::VectorXd>(s.values.data(),
                                               static_cast<Eigen::Index>(s.values.size()));
    }
  }
  throw std::logic_error("no signal " + name);
}

}  // namespace breakwater::testing
