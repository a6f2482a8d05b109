// What the nonlinear Kalman filters need to know of a process.
#pragma once

#include <Eigen/Core>
#include <concepts>

namespace breakwater {

/// A sampled process x(k+1) = A x(k) + g(x(k), u(k)) + noise, of which g fills rows kFirstRow …
/// kFirstRow + kRows − 1 only and depends on the first kArguments states only. A process without
/// such structure has A = 0, kFirstRow = 0 and kRows = kArguments = kStates.
///
/// linear() stays what it is; only Ukf::change_process() may change it.
///
/// The structure saves work, and changes nothing: what is linear a filter carries over exactly, and
/// a sigma point that differs from the mean in other states alone has the mean's g.
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
