// Riccati equations and pole placement for any matrices. A design that is not refused is finite,
// and the closed loop of a regulator is stable.
#include <algorithm>
#include <stdexcept>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/linear/state_space.h>
#include "fuzz/input.h"

namespace breakwater {
namespace {

void regulator(fuzz::Input& input, int n, int m) {
  const Eigen::MatrixXd A = input.matrix(n, n);
  const Eigen::MatrixXd B = input.matrix(n, m);
  const Eigen::MatrixXd Q = input.weight(n);
  const LqrDesign design = dlqr(A, B, Q, input.weight(m));
  fuzz::require(design.K.allFinite() && design.P.allFinite(), "the regulator is finite");
  fuzz::require(is_positive_semidefinite(design.P), "P is positive semidefinite");
  fuzz::require(spectral_radius(A - B * design.K) < 1.0 + 1e-6, "the regulator stabilises");
}

void observer(fuzz::Input& input, int n, int p) {
  const Eigen::MatrixXd A = input.matrix(n, n);
  const Eigen::MatrixXd C = input.matrix(p, n);
  std::vector<PoleGroup> groups(static_cast<std::size_t>(p));
  for (int i = 0; i < n; ++i) {
    const double real = input.number();
    const double imaginary = input.whole(2) == 0 ? input.number() : 0.0;
    PoleGroup& group = groups[static_cast<std::size_t>(i % p)];
    group.emplace_back(real, imaginary);
    if (imaginary != 0.0) group.emplace_back(real, -imaginary);
  }
  if (input.whole(1) == 0) groups = sample_poles(groups, 0.01);
  fuzz::require(place_observer_poles(A, C, groups).allFinite(), "the observer's gain is finite");
}

void hold(fuzz::Input& input, int n, int m) {
  const StateSpace plant{input.matrix(n, n), input.matrix(n, m), input.matrix(1, n)};
  const StateSpace sampled = zero_order_hold(plant, input.number());
  fuzz::require(sampled.A.allFinite() && sampled.B.allFinite(), "the sampled plant is finite");
}

}  // namespace
}  // namespace breakwater

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace breakwater;
  fuzz::count("design");
  fuzz::Input input(data, size);
  const int design = input.whole(2);
  const int n = 1 + input.whole(3);
  const int m = 1 + input.whole(1);
  try {
    if (design == 0) regulator(input, n, m);
    if (design == 1) observer(input, n, std::min(m, n));
    if (design == 2) hold(input, n, m);
  } catch (const std::invalid_argument&) {
    // refused
  }
  return 0;
}
