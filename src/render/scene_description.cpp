#include <breakwater/render/scene_description.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <stdexcept>

#include <breakwater/render/render_error.h>
#include <breakwater/sim/engine_guard.h>

namespace breakwater {
namespace {

std::ptrdiff_t row_at(int width, int i) {
  return static_cast<std::ptrdiff_t>(width) * i;
}

template <std::size_t N, typename Number>
std::array<double, N> numbers(const Number* from) {
  std::array<double, N> all{};
  std::copy_n(from, N, all.begin());
  return all;
}

std::string name_of(const Model& model, mjtObj kind, int id) {
  const char* name = mj_id2name(model.get(), kind, id);
  return name == nullptr ? "" : name;
}

Pose pose_of(const mjtNum* position, const mjtNum* matrix) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const Eigen::Quaterniond q{Eigen::Matrix3d(Eigen::Map<const RowMajor>(matrix))};
  return {numbers<3>(position), {q.w(), q.x(), q.y(), q.z()}};
}

Eigen::Quaterniond quaternion(const mjtNum* q) {
  return {q[0], q[1], q[2], q[3]};
}

Eigen::Vector3d vector3(const mjtNum* v) {
  return {v[0], v[1], v[2]};
}

std::array<double, 3> triple(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

SceneGeom::Shape shape_of(int type) {
  switch (type) {
    case mjGEOM_PLANE:
      return SceneGeom::Shape::plane;
    case mjGEOM_HFIELD:
      return SceneGeom::Shape::height_field;
    case mjGEOM_SPHERE:
      return SceneGeom::Shape::sphere;
    case mjGEOM_CAPSULE:
      return SceneGeom::Shape::capsule;
    case mjGEOM_ELLIPSOID:
      return SceneGeom::Shape::ellipsoid;
    case mjGEOM_CYLINDER:
      return SceneGeom::Shape::cylinder;
    case mjGEOM_BOX:
      return SceneGeom::Shape::box;
    default:
      return SceneGeom::Shape::mesh;
  }
}

SceneMesh mesh_of(const mjModel& m, int id) {
  SceneMesh mesh;
  const int first = m.mesh_vertadr[id];
  const int vertices = m.mesh_vertnum[id];
  mesh.vertices.assign(m.mesh_vert + row_at(3, first), m.mesh_vert + row_at(3, first + vertices));
  mesh.normals.assign(m.mesh_normal + row_at(3, first),
                      m.mesh_normal + row_at(3, first + vertices));
  if (m.mesh_texcoordadr[id] >= 0) {
    const float* const from = m.mesh_texcoord + row_at(2, m.mesh_texcoordadr[id]);
    mesh.texcoords.assign(from, from + row_at(2, vertices));
  }
  const int face = m.mesh_faceadr[id];
  mesh.faces.assign(m.mesh_face + row_at(3, face),
                    m.mesh_face + row_at(3, face + m.mesh_facenum[id]));
  return mesh;
}

SceneHeightField height_field_of(const mjModel& m, int id) {
  SceneHeightField field;
  field.rows = m.hfield_nrow[id];
  field.columns = m.hfield_ncol[id];
  field.size = numbers<3>(m.hfield_size + row_at(4, id));
  const float* const from = m.hfield_data + m.hfield_adr[id];
  field.heights.assign(from, from + row_at(field.rows, field.columns));
  return field;
}

SceneTexture texture_of(const mjModel& m, int id) {
  SceneTexture texture;
  texture.width = m.tex_width[id];
  texture.height = m.tex_height[id];
  texture.is_cube = m.tex_type[id] != mjTEXTURE_2D;
  const mjtByte* const from = m.tex_rgb + m.tex_adr[id];
  texture.rgb.assign(from, from + row_at(3, texture.width) * texture.height);
  return texture;
}

// The numbers of assets in the description, in the order of first use.
class Numbering {
 public:
  template <typename Asset, typename Make>
  int of(int id, std::vector<Asset>& assets, Make make) {
    if (id < 0) return -1;
    const auto [place, is_new] = numbers_.emplace(id, static_cast<int>(assets.size()));
    if (is_new) assets.push_back(make(id));
    return place->second;
  }

 private:
  std::map<int, int> numbers_;
};

SceneLight headlight_of(const mjModel& m) {
  SceneLight light;
  if (m.vis.headlight.active == 0) return light;
  light.ambient = numbers<3>(m.vis.headlight.ambient);
  light.diffuse = numbers<3>(m.vis.headlight.diffuse);
  light.specular = numbers<3>(m.vis.headlight.specular);
  return light;
}

SceneLight light_of(const mjModel& m, int id) {
  SceneLight light;
  light.is_directional = m.light_directional[id] != 0;
  light.casts_shadow = m.light_castshadow[id] != 0;
  light.cutoff_deg = m.light_cutoff[id];
  light.exponent = m.light_exponent[id];
  if (m.light_active[id] == 0) return light;
  light.ambient = numbers<3>(m.light_ambient + row_at(3, id));
  light.diffuse = numbers<3>(m.light_diffuse + row_at(3, id));
  light.specular = numbers<3>(m.light_specular + row_at(3, id));
  return light;
}

SceneJoint joint_of(const Model& model, int id) {
  const mjModel& m = *model.get();
  SceneJoint joint;
  joint.name = name_of(model, mjOBJ_JOINT, id);
  joint.is_hinge = m.jnt_type[id] == mjJNT_HINGE;
  joint.body = m.jnt_bodyid[id];
  joint.parent = m.body_parentid[joint.body];
  const Eigen::Quaterniond R = quaternion(m.body_quat + row_at(4, joint.body));
  const Eigen::Vector3d axis = vector3(m.jnt_axis + row_at(3, id)).normalized();
  joint.anchor_m =
      triple(vector3(m.body_pos + row_at(3, joint.body)) + R * vector3(m.jnt_pos + row_at(3, id)));
  joint.axis = triple(R * axis);
  joint.is_limited = m.jnt_limited[id] != 0;
  joint.range = numbers<2>(m.jnt_range + row_at(2, id));
  // The axis of the body that is most perpendicular to the joint, so that the pointer lies along
  // the link.
  Eigen::Vector3d pointer = Eigen::Vector3d::UnitX();
  for (const Eigen::Vector3d& other : {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)}) {
    if (std::abs(other.dot(axis)) < std::abs(pointer.dot(axis)) - 1e-9) pointer = other;
  }
  pointer = (pointer - pointer.dot(axis) * axis).normalized();
  joint.body_pointer = triple(pointer);
  // At qpos0 the body is posed as in the file, but the pointer is for position 0.
  const double at_file = m.qpos0[m.jnt_qposadr[id]];
  const Eigen::Quaterniond back(Eigen::AngleAxisd(joint.is_hinge ? -at_file : 0.0, axis));
  joint.pointer = triple(R * (back * pointer));
  if (!joint.is_hinge) {
    joint.anchor_m =
        triple(Eigen::Vector3d(joint.anchor_m[0], joint.anchor_m[1], joint.anchor_m[2]) -
               at_file * (R * axis));
  }
  return joint;
}

void describe_free_camera(const Model& model, SceneDescription& scene) {
  mjvCamera camera;
  mjv_defaultFreeCamera(model.get(), &camera);
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  const double azimuth = camera.azimuth * kDegree;
  const double elevation = camera.elevation * kDegree;
  const Eigen::Vector3d forward(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  const Eigen::Vector3d right(std::sin(azimuth), -std::cos(azimuth), 0.0);
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> axes;
  axes.col(0) = right;
  axes.col(1) = right.cross(forward);
  axes.col(2) = -forward;
  const Eigen::Vector3d position = vector3(camera.lookat) - camera.distance * forward;
  scene.free_camera = pose_of(position.data(), axes.data());
  scene.free_field_of_view_deg = model->vis.global.fovy;
}

}  // namespace

bool is_drawn(const Model& model, int geom) {
  const int group = model->geom_group[geom];
  if (group < 0 || group >= kDrawnGroups) return false;
  const int material = model->geom_matid[geom];
  const float* const rgba = model->geom_rgba + row_at(4, geom);
  return rgba[3] > 0.0F && (material < 0 || model->mat_rgba[4 * material + 3] > 0.0F);
}

SceneDescription describe_scene(const Model& model, const std::vector<int>& geoms) {
  const mjModel& m = *model.get();
  SceneDescription scene;
  for (int i = 0; i < m.nbody; ++i) scene.bodies.push_back(name_of(model, mjOBJ_BODY, i));
  Numbering meshes;
  Numbering fields;
  Numbering textures;
  const auto texture = [&](int id) {
    return textures.of(id, scene.textures, [&](int i) { return texture_of(m, i); });
  };
  for (const int id : geoms) {
    SceneGeom geom;
    geom.id = id;
    geom.name = name_of(model, mjOBJ_GEOM, id);
    geom.body = m.geom_bodyid[id];
    geom.shape = shape_of(m.geom_type[id]);
    geom.size = numbers<3>(m.geom_size + row_at(3, id));
    geom.pose = {numbers<3>(m.geom_pos + row_at(3, id)), numbers<4>(m.geom_quat + row_at(4, id))};
    geom.rgba = numbers<4>(m.geom_rgba + row_at(4, id));
    const int material = m.geom_matid[id];
    if (material >= 0) {
      // As the engine does it: the compiler's grey means that the geom has no colour.
      if (geom.rgba == std::array<double, 4>{0.5, 0.5, 0.5, 1.0}) {
        geom.rgba = numbers<4>(m.mat_rgba + row_at(4, material));
      }
      geom.emission = m.mat_emission[material];
      geom.specular = m.mat_specular[material];
      geom.shininess = m.mat_shininess[material];
      geom.texture = texture(m.mat_texid[material]);
      geom.texture_repeat = numbers<2>(m.mat_texrepeat + row_at(2, material));
      geom.texture_is_uniform = m.mat_texuniform[material] != 0;
    }
    if (geom.shape == SceneGeom::Shape::mesh) {
      geom.mesh = meshes.of(m.geom_dataid[id], scene.meshes, [&](int i) { return mesh_of(m, i); });
    } else if (geom.shape == SceneGeom::Shape::height_field) {
      geom.height_field = fields.of(m.geom_dataid[id], scene.height_fields,
                                    [&](int i) { return height_field_of(m, i); });
    }
    scene.geoms.push_back(geom);
  }
  for (int i = 0; i < m.ntex && scene.sky < 0; ++i) {
    if (m.tex_type[i] == mjTEXTURE_SKYBOX) scene.sky = texture(i);
  }
  for (int i = 0; i < m.ncam; ++i) {
    scene.cameras.push_back({name_of(model, mjOBJ_CAMERA, i), m.cam_fovy[i]});
  }
  scene.headlight = headlight_of(m);
  for (int i = 0; i < m.nlight; ++i) scene.lights.push_back(light_of(m, i));
  for (int i = 0; i < m.njnt; ++i) {
    if (m.jnt_type[i] == mjJNT_HINGE || m.jnt_type[i] == mjJNT_SLIDE) {
      scene.joints.push_back(joint_of(model, i));
    }
  }
  scene.centre_m = numbers<3>(m.stat.center);
  scene.extent_m = m.stat.extent;
  scene.near_m = m.vis.map.znear * m.stat.extent;
  scene.far_m = m.vis.map.zfar * m.stat.extent;
  describe_free_camera(model, scene);
  scene.skipped = m.nskin + m.ntendon;
  return scene;
}

SiteOnBody site_on_body(const Model& model, int site) {
  return {model->site_bodyid[site],
          {numbers<3>(model->site_pos + row_at(3, site)),
           numbers<4>(model->site_quat + row_at(4, site))}};
}

ScenePoser::ScenePoser(const Model& model) : model_(model) {
  try {
    data_ = model.make_data();
  } catch (const std::invalid_argument& error) {
    throw RenderError(std::string("pictures: ") + error.what());
  }
}

void ScenePoser::pose(std::span<const double> qpos) {
  std::copy(qpos.begin(), qpos.end(), data_->qpos);
  const std::string fatal = call_engine([&] { place_scene(*model_.get(), *data_); });
  if (!fatal.empty()) throw RenderError("pictures: " + fatal);
}

Pose ScenePoser::body(int id) const {
  return {numbers<3>(data_->xpos + row_at(3, id)), numbers<4>(data_->xquat + row_at(4, id))};
}

Pose ScenePoser::camera(int id) const {
  return pose_of(data_->cam_xpos + row_at(3, id), data_->cam_xmat + row_at(9, id));
}

Pose ScenePoser::light(int id) const {
  const Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(
      -Eigen::Vector3d::UnitZ(), vector3(data_->light_xdir + row_at(3, id)));
  return {numbers<3>(data_->light_xpos + row_at(3, id)), {q.w(), q.x(), q.y(), q.z()}};
}

}  // namespace breakwater
