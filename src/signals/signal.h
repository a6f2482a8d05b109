// A named quantity that something publishes for the log.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>

namespace breakwater {

/// A view of a quantity that its owner keeps up to date. The owner outlives the view, and neither
/// the address nor the size of `values` changes: a recorder copies from it at every sample.
struct Signal {
  std::string name;  ///< unit included, as it appears in the log: "d_hat_Nm"
  /// "N m", "rad", "1"; where the values have different ones, each one's: "m, m, rad".
  std::string unit;
  std::string description;  ///< one line, with the equation where there is one
  std::span<const double> values;
};

/// What a Signal sees of its owner's quantity.
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

}  // namespace breakwater
