// The interface of a process for the nonlinear Kalman filters.
#pragma once

#include <Eigen/Core>
#include <concepts>

namespace breakwater {

/// A sampled process x(k+1) = A x(k) + g(x(k), u(k)) + noise. g fills only the kRows rows from
/// kFirstRow on, and depends only on the first kArguments states. A process without this structure
/// has A = 0, kFirstRow = 0 and kRows = kArguments = kStates.
///
/// linear() is constant. Only Ukf::change_process() may change it.
///
/// The structure only saves work: the linear part is predicted exactly. A sigma point that equals
/// the mean in the first kArguments states shares its g.
template <typename P>
concept Process = requires(const P& process, const typename P::State& x, const typename P::Input& u,
                           typename P::Nonlinear& g) {
  { P::kStates } -> std::convertible_to<int>;
  { P::kInputs } -> std::convertible_to<int>;
  { P::kFirstRow } -> std::convertible_to<int>;
  { P::kRows } -> std::convertible_to<int>;
  { P::kArguments } -> std::convertible_to<int>;
  process.nonlinear(x, u, g);
  { process.linear() } -> std::convertible_to<Eigen::Matrix<double, P::kStates, P::kStates>>;
};

/// The fixed-size types of a process.
template <int N, int M, int Rows>
struct ProcessTypes {
  using State = Eigen::Matrix<double, N, 1>;
  using Input = Eigen::Matrix<double, M, 1>;
  using Nonlinear = Eigen::Matrix<double, Rows, 1>;
};

}  // namespace breakwater
