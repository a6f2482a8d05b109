// The nonlinear Kalman filters of the quadrotor, compiled once: each takes many seconds.
#pragma once

#include <breakwater/control/quadrotor_process.h>
#include <breakwater/observers/ekf.h>
#include <breakwater/observers/ukf.h>

namespace breakwater {

extern template class GaussianEstimate<12, 6>;
extern template class GaussianEstimate<16, 6>;
extern template class GaussianEstimate<24, 6>;
extern template class GaussianEstimate<30, 6>;
extern template class Ukf<ThrusterDisturbance<-1>, 6>;
extern template class Ukf<ThrusterDisturbance<0>, 6>;
extern template class Ukf<ThrusterDisturbance<2>, 6>;
extern template class Ukf<WaveResonators, 6>;
extern template class Ukf<WaveForces<2, 2>, 6>;
extern template class Ekf<ThrusterDisturbance<-1>, 6>;
extern template class Ekf<ThrusterDisturbance<0>, 6>;
extern template class Ekf<ThrusterDisturbance<2>, 6>;

}  // namespace breakwater
