#include <breakwater/observers/sized_filters.h>

#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/stf.h>

namespace breakwater {
namespace {

// All instantiations are here: each inclusion of the filters' headers compiles them again.
template <template <int, int, int> class Filter, typename... Adaptation>
std::unique_ptr<DisturbanceEstimator> of_size(const KalmanDesign& design,
                                              const Adaptation&... adaptation) {
  constexpr int kAny = Eigen::Dynamic;
  const bool is_single = design.plant.inputs() == 1 && design.plant.outputs() == 1;
  switch (is_single ? design.plant.states() : 0) {
    case 2:
      return std::make_unique<Filter<2, 1, 1>>(design, adaptation...);
    case 3:
      return std::make_unique<Filter<3, 1, 1>>(design, adaptation...);
    case 4:
      return std::make_unique<Filter<4, 1, 1>>(design, adaptation...);
    case 5:
      return std::make_unique<Filter<5, 1, 1>>(design, adaptation...);
    case 6:
      return std::make_unique<Filter<6, 1, 1>>(design, adaptation...);
    default:
      return std::make_unique<Filter<kAny, kAny, kAny>>(design, adaptation...);
  }
}

}  // namespace

std::unique_ptr<DisturbanceEstimator> sized_kfd(const KalmanDesign& design) {
  return of_size<Kfd>(design);
}

std::unique_ptr<DisturbanceEstimator> sized_fakfd(const KalmanDesign& design,
                                                  const Eigen::VectorXd& gamma) {
  return of_size<Fakfd>(design, gamma);
}

std::unique_ptr<DisturbanceEstimator> sized_vfakfd(const KalmanDesign& design,
                                                   const VfakfdDesign& adaptation) {
  return of_size<Vfakfd>(design, adaptation);
}

std::unique_ptr<DisturbanceEstimator> sized_stf(const KalmanDesign& design,
                                                const SensorError& error) {
  return of_size<Stf>(design, error);
}

}  // namespace breakwater
