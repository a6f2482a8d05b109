#include <breakwater/sim/surface_waves.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace breakwater {

void set_heights(Model& model, const WavingSurface& surface, double time_s) {
  mjModel& m = *model.get();
  const int id = model.id(mjOBJ_GEOM, surface.geom);
  const mjtNum* position = m.geom_pos + static_cast<std::ptrdiff_t>(3) * id;
  const mjtNum* quaternion = m.geom_quat + static_cast<std::ptrdiff_t>(4) * id;
  const Eigen::Matrix3d R =
      Eigen::Quaterniond(quaternion[0], quaternion[1], quaternion[2], quaternion[3])
          .toRotationMatrix();
  const bool is_level = std::abs(std::abs(R(2, 2)) - 1.0) < 1e-9;
  if (m.geom_type[id] != mjGEOM_HFIELD || m.geom_bodyid[id] != 0 || !is_level) {
    throw std::invalid_argument(model.file() + ": geom \"" + surface.geom +
                                "\" must be a level height field on the world");
  }
  const int field = m.geom_dataid[id];
  const mjtNum* size = m.hfield_size + static_cast<std::ptrdiff_t>(4) * field;
  const int rows = m.hfield_nrow[field];
  const int columns = m.hfield_ncol[field];
  float* data = m.hfield_data + m.hfield_adr[field];
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const Eigen::Vector3d local(size[0] * (2.0 * c / (columns - 1) - 1.0),
                                  size[1] * (2.0 * r / (rows - 1) - 1.0), 0.0);
      const Eigen::Vector3d world = Eigen::Vector3d(position[0], position[1], 0.0) + R * local;
      const double up =
          (surface.sea.elevation(time_s, world.x(), world.y()) - position[2]) * R(2, 2);
      *data++ = static_cast<float>(std::clamp(up / size[2], 0.0, 1.0));
    }
  }
}

}  // namespace breakwater
