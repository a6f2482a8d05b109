// A named quantity for the log, and the input of a controller at a sampling instant.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>

namespace breakwater {

/// A view of a quantity that its owner updates. The owner must outlive the view. The address and
/// the size of `values` are constant: a recorder copies from them at every sample.
struct Signal {
  std::string name;  ///< with the unit, as in the log: "d_hat_Nm"
  /// "N m", "rad", "1"; for values with different units a list: "m, m, rad".
  std::string unit;
  std::string description;  ///< one line, with the equation number if there is one
  std::span<const double> values;
};

/// The view of a number for a Signal.
inline std::span<const double> view(const double& value) {
  return {&value, 1};
}
template <typename Derived>
std::span<const double> view(const Eigen::PlainObjectBase<Derived>& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}
inline std::span<const double> view(const Eigen::Map<const Eigen::VectorXd>& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

/// The sensors' values at one sampling instant. Each controller says which entries of `y` it
/// expects, and in which units. The rig connects the sensors accordingly.
struct Sample {
  double time_s = 0.0;
  Eigen::VectorXd y;
};

}  // namespace breakwater
