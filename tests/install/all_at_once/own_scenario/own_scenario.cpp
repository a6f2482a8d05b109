// The scenario cart_offset_free under another name.
#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {

ScenarioKind own_scenario() {
  return axis_kind({.name = "own_scenario",
                    .summary = "predictive control of a cart under two disturbances",
                    .axis = cart_axis(),
                    .controller = "mpc",
                    .disturbance = DisturbanceKind::step,
                    .totals = qp_totals});
}

}  // namespace breakwater
