#include <breakwater/control/quadrotor_filters.h>

namespace breakwater {

template class Ukf<ThrusterDisturbance<-1>, 6>;
template class Ukf<ThrusterDisturbance<0>, 6>;
template class Ukf<ThrusterDisturbance<2>, 6>;
template class Ukf<WaveForces<1, 1>, 6>;
template class Ukf<WaveForces<2, 2>, 6>;

}  // namespace breakwater
