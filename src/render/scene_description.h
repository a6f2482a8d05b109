// The look of a model as data, for another program that draws it, such as a page in a browser.
// ScenePoser gives the poses.
#pragma once

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include <breakwater/sim/model.h>
#include <breakwater/sim/surface_waves.h>

namespace breakwater {

/// Geoms of groups below this are drawn: bodies and decoration. The others are for the physics.
inline constexpr int kDrawnGroups = 3;

/// The pose of a body, camera or light in the world: position [m] and unit quaternion (w, x, y, z).
using Pose = std::array<double, 7>;
Pose pose_of(const mjtNum* position_m, const mjtNum* quaternion);

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

/// Meshes, height fields and textures. Runs that share one have it only once.
class SceneAssets {
 public:
  /// The index of an asset, which `pack` makes once for a model. The model must outlive this.
  template <typename Pack>
  int of(const mjModel& model, const std::string& kind, int id, const Pack& pack) {
    const auto [place, is_new] = numbers_.try_emplace({&model, kind, id});
    if (is_new) {
      const nlohmann::ordered_json asset = pack();
      const auto equal = std::find(all_.begin(), all_.end(), asset);
      place->second = static_cast<int>(equal - all_.begin());
      if (equal == all_.end()) all_.push_back(asset);
    }
    return place->second;
  }
  const nlohmann::ordered_json& all() const { return all_; }

 private:
  std::map<std::tuple<const mjModel*, std::string, int>, int> numbers_;
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
