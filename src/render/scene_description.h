// The look of a model as data, for another program that draws it, such as a page in a browser.
// ScenePoser gives the poses.
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include <breakwater/sim/model.h>
#include <breakwater/sim/surface_waves.h>

namespace breakwater {

/// Geoms of groups below this are drawn: bodies and decoration. The others are for the physics.
inline constexpr int kDrawnGroups = 3;

/// The pose of a body, camera or light in the world: position [m] and unit quaternion (w, x, y, z).
struct Pose {
  std::array<double, 3> position_m{};
  std::array<double, 4> rotation{1.0, 0.0, 0.0, 0.0};
};

/// Base64 by RFC 4648, padded.
std::string base64(const void* bytes, std::size_t size);

/// Bytes as base64 of a zlib stream (RFC 1950), the format "deflate" of browsers.
std::string packed_bytes(std::span<const std::uint8_t> bytes);

/// Numbers for pictures: eight digits are enough, and 0 stands for one that is not finite.
double rounded(double value);
template <typename Numbers>
nlohmann::ordered_json rounded_list(const Numbers& numbers) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const auto value : numbers) all.push_back(rounded(static_cast<double>(value)));
  return all;
}
/// The seven numbers of a pose.
nlohmann::ordered_json pose_json(const Pose& pose);

/// Meshes, height fields and textures. Runs that share one have it only once.
class SceneAssets {
 public:
  /// The index of an asset.
  int of(const nlohmann::ordered_json& asset);
  const nlohmann::ordered_json& all() const { return all_; }

 private:
  std::map<std::string, int> numbers_;
  nlohmann::ordered_json all_ = nlohmann::ordered_json::array();
};

/// Whether SceneView now draws a geom: its group is drawn, and it is not fully transparent.
bool is_drawn(const Model& model, int geom);

/// The look of these geoms of the model, its cameras and lights, for
/// data/report/replay. Lengths are in m, angles in rad or, where OpenGL has them so, degrees. The
/// heights of `surfaces` are left out: waves give them.
nlohmann::ordered_json describe_scene(const Model& model, const std::vector<int>& geoms,
                                      const std::vector<WavingSurface>& surfaces,
                                      SceneAssets& assets);

/// Computes poses of bodies, cameras, lights and tendons for given positions of the joints. Forces
/// are in the log.
class ScenePoser {
 public:
  /// The model must outlive it. Throws RenderError.
  explicit ScenePoser(const Model& model);

  /// Throws RenderError if the engine fails.
  void pose(std::span<const double> qpos);
  Pose body(int id) const;
  Pose camera(int id) const;  ///< looks along −z, y up
  Pose light(int id) const;   ///< shines along −z
  mjData& data() const { return *data_; }

 private:
  const Model& model_;
  DataPointer data_;
};

}  // namespace breakwater
