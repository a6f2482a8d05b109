#include <breakwater/observers/idob.h>

#include <stdexcept>
#include <string>

#include <breakwater/linear/state_space.h>

namespace breakwater {
namespace {

StateSpace observable(const StateSpace& continuous_plant, double period_s) {
  StateSpace extended = extend_by_input_disturbance(continuous_plant);
  const Eigen::MatrixXd A = zero_order_hold(extended, period_s).A;
  const Eigen::Index rank = observability_rank(A, extended.C);
  if (rank == extended.states()) return extended;
  throw std::invalid_argument("IDOB: the extended plant is not observable (rank " +
                              std::to_string(rank) + " of " + std::to_string(extended.states()) +
                              ")");
}

}  // namespace

Idob::Idob(const StateSpace& continuous_plant, const std::vector<PoleGroup>& poles, double period_s)
    : StateObserver(observable(continuous_plant, period_s), poles, period_s),
      states_(continuous_plant.states()) {}

}  // namespace breakwater
