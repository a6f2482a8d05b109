// The nonlinear Kalman filters of the quadrotor. They are compiled once, since each takes many
// seconds to compile.
#pragma once

#include <breakwater/control/quadrotor_process.h>
#include <breakwater/observers/ekf.h>
#include <breakwater/observers/ukf.h>

namespace breakwater {

extern template class GaussianEstimate<ThrusterDisturbance<-1>::kStates, 6>;
extern template class GaussianEstimate<ThrusterDisturbance<0>::kStates, 6>;
extern template class GaussianEstimate<ThrusterDisturbance<2>::kStates, 6>;
extern template class GaussianEstimate<WaveForces<2, 2>::kStates, 6>;
extern template class Ukf<ThrusterDisturbance<-1>, 6>;
extern template class Ukf<ThrusterDisturbance<0>, 6>;
extern template class Ukf<ThrusterDisturbance<2>, 6>;
extern template class Ukf<WaveForces<1, 1>, 6>;
extern template class Ukf<WaveForces<2, 2>, 6>;
extern template class Ekf<ThrusterDisturbance<-1>, 6>;
extern template class Ekf<ThrusterDisturbance<0>, 6>;
extern template class Ekf<ThrusterDisturbance<2>, 6>;

}  // namespace breakwater
