#include <breakwater/plants/damped_inertia.h>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

StateSpace damped_inertia(double inertia, double viscous_friction) {
  refuse_unless(inertia > 0.0 && viscous_friction >= 0.0,
                "plant: needs an inertia > 0 and a viscous friction >= 0");
  StateSpace plant{Eigen::Matrix2d::Zero(), Eigen::Vector2d(0.0, 1.0 / inertia),
                   Eigen::RowVector2d(1.0, 0.0)};
  plant.A(0, 1) = 1.0;
  plant.A(1, 1) = -viscous_friction / inertia;
  return plant;
}

}  // namespace breakwater
