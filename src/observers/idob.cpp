#include <breakwater/observers/idob.h>

#include <breakwater/linear/state_space.h>

namespace breakwater {
namespace {

StateSpace observable(const StateSpace& continuous_plant, double period_s) {
  const StateSpace extended = extend_by_input_disturbance(continuous_plant);
  check_observable("IDOB", zero_order_hold(extended, period_s).A, extended.C);
  return extended;
}

}  // namespace

Idob::Idob(const StateSpace& continuous_plant, const std::vector<PoleGroup>& poles, double period_s)
    : StateObserver(observable(continuous_plant, period_s), poles, period_s),
      states_(continuous_plant.states()) {}

}  // namespace breakwater
