// The look of a model as data, for another program that draws it, such as a page in a browser.
// ScenePoser gives the poses.
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <breakwater/sim/model.h>

namespace breakwater {

/// Geoms of groups below this are drawn: bodies and decoration. The others are for the physics.
inline constexpr int kDrawnGroups = 3;

/// Computes the poses of bodies, cameras, lights and tendons at data.qpos. Forces are in the log.
inline void place_scene(const mjModel& model, mjData& data) {
  mj_kinematics(&model, &data);
  mj_comPos(&model, &data);
  mj_camlight(&model, &data);
  mj_tendon(&model, &data);
}

/// The pose of a body, camera or light in the world: position [m] and unit quaternion (w, x, y, z).
struct Pose {
  std::array<double, 3> position_m{};
  std::array<double, 4> rotation{1.0, 0.0, 0.0, 0.0};
};

struct SceneMesh {
  std::vector<float> vertices;   ///< x, y, z each, in the geom's frame [m]
  std::vector<float> normals;    ///< one for each vertex
  std::vector<float> texcoords;  ///< u, v each; empty if there are none
  std::vector<int> faces;        ///< three vertices each, counter-clockwise from outside
};

struct SceneHeightField {
  int rows = 0;                  ///< along y
  int columns = 0;               ///< along x
  std::array<double, 3> size{};  ///< half lengths along x and y, height of a full value [m]
  std::vector<float> heights;    ///< 0 … 1, rows × columns, with increasing x and y
};

struct SceneTexture {
  int width = 0;
  int height = 0;  ///< a cube's is six times its width: right, left, up, down, front, back
  bool is_cube = false;
  std::vector<std::uint8_t> rgb;
};

/// A visible shape, rigid on a body.
struct SceneGeom {
  enum class Shape { plane, height_field, sphere, capsule, ellipsoid, cylinder, box, mesh };

  int id = 0;  ///< in the model
  std::string name;
  int body = 0;
  Shape shape = Shape::sphere;
  std::array<double, 3> size{};  ///< as in MJCF: half lengths [m]; 0 for an infinite plane
  Pose pose;                     ///< in the body's frame
  std::array<double, 4> rgba{};
  double emission = 0.0;
  double specular = 0.5;
  double shininess = 0.5;  ///< OpenGL's exponent divided by 128
  int texture = -1;        ///< index of SceneDescription::textures; −1: none
  std::array<double, 2> texture_repeat{1.0, 1.0};
  bool texture_is_uniform = false;  ///< repeats are per metre, not per geom
  int mesh = -1;                    ///< index of meshes
  int height_field = -1;            ///< index of height_fields
};

struct SceneCamera {
  std::string name;
  double field_of_view_deg = 45.0;  ///< vertical
};

struct SceneLight {
  bool is_directional = false;  ///< false: a spot
  bool casts_shadow = true;
  std::array<double, 3> ambient{};
  std::array<double, 3> diffuse{};
  std::array<double, 3> specular{};
  double cutoff_deg = 45.0;  ///< for a spot
  double exponent = 10.0;    ///< for a spot: the intensity is proportional to cos^exponent
};

/// A hinge or slide joint, in the frame of the parent of its body, at position 0.
struct SceneJoint {
  std::string name;
  bool is_hinge = false;
  int body = 0;
  int parent = 0;
  std::array<double, 3> anchor_m{};
  std::array<double, 3> axis{};
  bool is_limited = false;
  std::array<double, 2> range{};    ///< [rad or m]
  std::array<double, 3> pointer{};  ///< unit vector perpendicular to the axis, at position 0 …
  std::array<double, 3> body_pointer{};  ///< … and the same, fixed to the body
};

struct SceneDescription {
  std::vector<std::string> bodies;  ///< names; 0 is the world
  std::vector<SceneTexture> textures;
  int sky = -1;  ///< texture of the sky; −1: none
  std::vector<SceneMesh> meshes;
  std::vector<SceneHeightField> height_fields;
  std::vector<SceneGeom> geoms;
  std::vector<SceneCamera> cameras;
  std::vector<SceneLight> lights;
  std::vector<SceneJoint> joints;
  SceneLight headlight;  ///< at the camera
  std::array<double, 3> centre_m{};
  double extent_m = 1.0;
  double near_m = 0.01;
  double far_m = 100.0;
  Pose free_camera;  ///< shows the whole model
  double free_field_of_view_deg = 45.0;
  int skipped = 0;  ///< number of skins and tendons, which it does not describe
};

/// Whether SceneView now draws a geom: its group is drawn, and it is not fully transparent.
bool is_drawn(const Model& model, int geom);

/// The look of these geoms of the model, with their assets.
SceneDescription describe_scene(const Model& model, const std::vector<int>& geoms);

/// A site of the model: its body and its place in the body's frame.
struct SiteOnBody {
  int body = 0;
  Pose pose;
};
SiteOnBody site_on_body(const Model& model, int site);

/// Computes poses for given positions of the joints, by the kinematics of SceneView.
class ScenePoser {
 public:
  /// The model must outlive it. Throws RenderError.
  explicit ScenePoser(const Model& model);

  /// Throws RenderError if the engine fails.
  void pose(std::span<const double> qpos);
  Pose body(int id) const;
  Pose camera(int id) const;  ///< looks along −z, y up
  Pose light(int id) const;   ///< shines along −z

 private:
  const Model& model_;
  DataPointer data_;
};

}  // namespace breakwater
