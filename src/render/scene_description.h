// What a model looks like, as data: for a program of another kind that draws it, a page in a
// browser say. Poses are apart from it: ScenePoser.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <breakwater/sim/model.h>

namespace breakwater {

/// Where a body, camera or light is, in the world: position [m], and its rotation as a unit
/// quaternion (w, x, y, z).
struct Pose {
  std::array<double, 3> position_m{};
  std::array<double, 4> rotation{1.0, 0.0, 0.0, 0.0};
};

struct SceneMesh {
  std::vector<float> vertices;   ///< x, y, z each, in the geom's frame [m]
  std::vector<float> normals;    ///< as many
  std::vector<float> texcoords;  ///< u, v each; empty: none
  std::vector<int> faces;        ///< three vertices each, counter-clockwise from outside
};

struct SceneHeightField {
  int rows = 0;                  ///< along y
  int columns = 0;               ///< along x
  std::array<double, 3> size{};  ///< half lengths along x and y, height of a full value [m]
  std::vector<float> heights;    ///< 0 … 1, rows × columns, x and y rising
};

struct SceneTexture {
  int width = 0;
  int height = 0;  ///< a cube's is six times its width: right, left, up, down, front, back
  bool is_cube = false;
  std::vector<std::uint8_t> rgb;
};

/// One shape that is drawn, rigid on a body.
struct SceneGeom {
  enum class Shape { plane, height_field, sphere, capsule, ellipsoid, cylinder, box, mesh };

  int id = 0;  ///< the model's
  std::string name;
  int body = 0;
  Shape shape = Shape::sphere;
  std::array<double, 3> size{};  ///< as MJCF has it: half lengths; a plane's 0: without end [m]
  Pose pose;                     ///< in the body's frame
  std::array<double, 4> rgba{};
  double emission = 0.0;
  double specular = 0.5;
  double shininess = 0.5;  ///< 1/128 of OpenGL's exponent
  int texture = -1;        ///< of SceneDescription::textures; −1: none
  std::array<double, 2> texture_repeat{1.0, 1.0};
  bool texture_is_uniform = false;  ///< repeats are per metre, not per geom
  int mesh = -1;                    ///< of meshes
  int height_field = -1;            ///< of height_fields
};

struct SceneCamera {
  std::string name;
  double field_of_view_deg = 45.0;  ///< vertical
};

struct SceneLight {
  bool is_directional = false;  ///< else a spot
  bool casts_shadow = true;
  std::array<double, 3> ambient{};
  std::array<double, 3> diffuse{};
  std::array<double, 3> specular{};
  double cutoff_deg = 45.0;  ///< of a spot
  double exponent = 10.0;    ///< of a spot: intensity goes with cos^exponent
};

/// A hinge or slide, in the frame of its body's parent while its position is 0.
struct SceneJoint {
  std::string name;
  bool is_hinge = false;
  int body = 0;
  int parent = 0;
  std::array<double, 3> anchor_m{};
  std::array<double, 3> axis{};
  bool is_limited = false;
  std::array<double, 2> range{};    ///< [rad or m]
  std::array<double, 3> pointer{};  ///< a unit vector across the axis, when its position is 0 …
  std::array<double, 3> body_pointer{};  ///< … and the same fixed to the body
};

struct SceneDescription {
  std::vector<std::string> bodies;  ///< names; 0 is the world
  std::vector<SceneTexture> textures;
  int sky = -1;  ///< the texture around all; −1: none
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
  Pose free_camera;  ///< one that sees all of it
  double free_field_of_view_deg = 45.0;
  int skipped = 0;  ///< skins and tendons, which it does not hold
};

/// Whether SceneView draws a geom now: by its group, and unless it is wholly transparent.
bool is_drawn(const Model& model, int geom);

/// The look of those geoms of the model, and of what they need.
SceneDescription describe_scene(const Model& model, const std::vector<int>& geoms);

/// A site of the model: its body, and where it is in the body's frame.
struct SiteOnBody {
  int body = 0;
  Pose pose;
};
SiteOnBody site_on_body(const Model& model, int site);

/// Says where things are for given positions of the joints. Kinematics alone, as SceneView's.
class ScenePoser {
 public:
  /// The model outlives it. Throws RenderError.
  explicit ScenePoser(const Model& model);

  /// Throws RenderError if the engine cannot.
  void pose(std::span<const double> qpos);
  Pose body(int id) const;
  Pose camera(int id) const;  ///< looks along −z, y up
  Pose light(int id) const;   ///< shines along −z

 private:
  const Model& model_;
  DataPointer data_;
};

}  // namespace breakwater
