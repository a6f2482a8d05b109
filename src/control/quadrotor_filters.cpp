#include <breakwater/control/quadrotor_filters.h>

namespace breakwater {

template class GaussianEstimate<ThrusterDisturbance<-1>::kStates, 6>;
template class GaussianEstimate<ThrusterDisturbance<0>::kStates, 6>;
template class GaussianEstimate<ThrusterDisturbance<2>::kStates, 6>;
template class GaussianEstimate<WaveForces<2, 2>::kStates, 6>;
template class Ekf<ThrusterDisturbance<-1>, 6>;
template class Ekf<ThrusterDisturbance<0>, 6>;
template class Ekf<ThrusterDisturbance<2>, 6>;

}  // namespace breakwater
