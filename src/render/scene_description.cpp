#include <breakwater/render/scene_description.h>

#include <fmt/format.h>
#include <zlib.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>

#include <breakwater/render/render_error.h>
#include <breakwater/sim/engine_guard.h>

namespace breakwater {

std::string base64(const void* bytes, std::size_t size) {
  static constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto* data = static_cast<const unsigned char*>(bytes);
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t left = std::min<std::size_t>(3, size - i);
    unsigned word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8U | (k < left ? data[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= left ? kDigits[word >> (18U - 6U * static_cast<unsigned>(k)) & 63U] : '=';
    }
  }
  return text;
}

std::string packed_bytes(std::span<const std::uint8_t> bytes) {
  uLongf size = compressBound(bytes.size());
  std::vector<std::uint8_t> packed(size);
  if (compress2(packed.data(), &size, bytes.data(), bytes.size(), Z_BEST_COMPRESSION) != Z_OK) {
    throw std::runtime_error("zlib cannot compress the data of a page");
  }
  return base64(packed.data(), size);
}

double rounded(double value) {
  if (!std::isfinite(value) || value == 0.0) return 0.0;
  return std::strtod(fmt::format("{:.8g}", value).c_str(), nullptr);
}

Pose pose_of(const mjtNum* position_m, const mjtNum* quaternion) {
  Pose pose{};
  std::copy_n(quaternion, 4, std::copy_n(position_m, 3, pose.begin()));
  return pose;
}

namespace {

using Json = nlohmann::ordered_json;

std::ptrdiff_t row_at(int width, int i) {
  return static_cast<std::ptrdiff_t>(width) * i;
}

// Row `id` of an array with rows of `width` numbers.
template <typename Number>
Json row(const Number* from, int id, int width = 3) {
  return rounded_list(std::span(from + row_at(width, id), static_cast<std::size_t>(width)));
}

template <typename Number>
std::string packed(const Number* from, std::ptrdiff_t count) {
  return packed_bytes({reinterpret_cast<const std::uint8_t*>(from),
                       static_cast<std::size_t>(count) * sizeof(Number)});
}

Pose pose_with(const mjtNum* position_m, const Eigen::Quaterniond& q) {
  return {position_m[0], position_m[1], position_m[2], q.w(), q.x(), q.y(), q.z()};
}

Eigen::Map<const Eigen::Vector3d> vector3(const mjtNum* v) {
  return Eigen::Map<const Eigen::Vector3d>(v);
}

// In the order of mjtGeom.
constexpr std::array kShapes = {"plane",     "field",    "sphere", "capsule",
                                "ellipsoid", "cylinder", "box",    "mesh"};
static_assert(kShapes.size() == mjGEOM_MESH + 1);

// Faces have three vertices each, counter-clockwise from outside. Their indices have 16 or 32 bits.
Json mesh_json(const mjModel& m, int id) {
  const int first = m.mesh_vertadr[id], vertices = m.mesh_vertnum[id];
  const int texcoords = m.mesh_texcoordadr[id];
  const int* const faces = m.mesh_face + row_at(3, m.mesh_faceadr[id]);
  const std::vector<std::uint16_t> narrow(faces, faces + row_at(3, m.mesh_facenum[id]));
  const bool is_wide = vertices > 65536;
  return {
      {"kind", "mesh"},
      {"vertices", packed(m.mesh_vert + row_at(3, first), row_at(3, vertices))},
      {"normals", packed(m.mesh_normal + row_at(3, first), row_at(3, vertices))},
      {"texcoords",
       texcoords < 0 ? "" : packed(m.mesh_texcoord + row_at(2, texcoords), row_at(2, vertices))},
      {"wide", is_wide},
      {"faces", is_wide ? packed(faces, row_at(3, m.mesh_facenum[id]))
                        : packed(narrow.data(), std::ssize(narrow))}};
}

// Heights from 0 to 1, with increasing x and y.
Json field_json(const mjModel& m, int id, bool is_waving) {
  const int rows = m.hfield_nrow[id], columns = m.hfield_ncol[id];
  return {{"kind", "field"},
          {"rows", rows},
          {"columns", columns},
          {"size", rounded_list(std::span(m.hfield_size + row_at(4, id), 3))},
          {"heights",
           is_waving ? "" : packed(m.hfield_data + m.hfield_adr[id], row_at(rows, columns))}};
}

// The height of a cube is six times its width: right, left, up, down, front, back.
Json texture_json(const mjModel& m, int id) {
  const int width = m.tex_width[id], height = m.tex_height[id];
  return {{"kind", "texture"},
          {"width", width},
          {"height", height},
          {"cube", m.tex_type[id] != mjTEXTURE_2D},
          {"rgb", packed(m.tex_rgb + m.tex_adr[id], row_at(3, width) * height)}};
}

constexpr float kUnlit[3] = {};

// The colours of a light.
Json colours_json(bool is_on, const float* ambient, const float* diffuse, const float* specular) {
  return {{"ambient", row(is_on ? ambient : kUnlit, 0)},
          {"diffuse", row(is_on ? diffuse : kUnlit, 0)},
          {"specular", row(is_on ? specular : kUnlit, 0)}};
}

Json light_json(const mjModel& m, int id) {
  const std::ptrdiff_t at = row_at(3, id);
  Json light = colours_json(m.light_active[id] != 0, m.light_ambient + at, m.light_diffuse + at,
                            m.light_specular + at);
  light.update({{"directional", m.light_directional[id] != 0},
                {"shadow", m.light_castshadow[id] != 0},
                {"cutoff", rounded(m.light_cutoff[id])},
                {"exponent", rounded(m.light_exponent[id])}});
  return light;
}

// Shows the whole model.
Json free_camera_json(const Model& model) {
  mjvCamera camera;
  mjv_defaultFreeCamera(model.get(), &camera);
  constexpr double kDegree = std::numbers::pi / 180.0;
  // A camera looks along −z, with y up.
  const Eigen::Quaterniond q =
      Eigen::AngleAxisd((camera.azimuth - 90.0) * kDegree, Eigen::Vector3d::UnitZ()) *
      Eigen::AngleAxisd((camera.elevation + 90.0) * kDegree, Eigen::Vector3d::UnitX());
  const Eigen::Vector3d position =
      vector3(camera.lookat) + camera.distance * (q * Eigen::Vector3d::UnitZ());
  return {{"pose", rounded_list(pose_with(position.data(), q))},
          {"fovy", rounded(model->vis.global.fovy)}};
}

// A visible shape, rigid on a body, with its assets. The shininess is OpenGL's exponent divided by
// 128. Repeats of a uniform texture are per metre, not per geom.
Json geom_json(const Model& model, int id, const std::vector<WavingSurface>& surfaces,
               SceneAssets& assets) {
  const mjModel& m = *model.get();
  const int material = m.geom_matid[id];
  const float* const own = m.geom_rgba + row_at(4, id);
  // As the engine does it: the compiler's grey means that the geom has no colour.
  const bool is_grey = std::equal(own, own + 4, std::array{0.5F, 0.5F, 0.5F, 1.0F}.begin());
  const std::string name = model.name(mjOBJ_GEOM, id);
  const Pose pose = pose_of(m.geom_pos + row_at(3, id), m.geom_quat + row_at(4, id));
  Json geom = {{"id", id},
               {"name", name},
               {"body", m.geom_bodyid[id]},
               {"shape", kShapes[static_cast<std::size_t>(m.geom_type[id])]},
               {"size", row(m.geom_size, id)},
               {"pose", rounded_list(pose)},
               {"rgba", material >= 0 && is_grey ? row(m.mat_rgba, material, 4) : row(own, 0, 4)},
               {"emission", rounded(material < 0 ? 0.0 : m.mat_emission[material])},
               {"specular", rounded(material < 0 ? 0.5 : m.mat_specular[material])},
               {"shininess", rounded(material < 0 ? 0.5 : m.mat_shininess[material])}};
  if (material >= 0 && m.mat_texid[material] >= 0) {
    const int texture = m.mat_texid[material];
    geom["texture"] = assets.of(m, "texture", texture, [&] { return texture_json(m, texture); });
    geom["repeat"] = row(m.mat_texrepeat, material, 2);
    geom["uniform"] = m.mat_texuniform[material] != 0;
  }
  const int data = m.geom_dataid[id];
  if (m.geom_type[id] == mjGEOM_HFIELD) {
    const bool is_waving =
        std::any_of(surfaces.begin(), surfaces.end(),
                    [&](const WavingSurface& surface) { return surface.geom == name; });
    geom["asset"] = assets.of(m, "field", data, [&] { return field_json(m, data, is_waving); });
  } else if (m.geom_type[id] == mjGEOM_MESH && data >= 0) {
    geom["asset"] = assets.of(m, "mesh", data, [&] { return mesh_json(m, data); });
  }
  return geom;
}

}  // namespace

bool is_drawn(const Model& model, int geom) {
  const int group = model->geom_group[geom];
  if (group < 0 || group >= kDrawnGroups) return false;
  const int material = model->geom_matid[geom];
  const float* const rgba = model->geom_rgba + row_at(4, geom);
  return rgba[3] > 0.0F && (material < 0 || model->mat_rgba[4 * material + 3] > 0.0F);
}

nlohmann::ordered_json describe_scene(const Model& model, const std::vector<int>& geoms,
                                      const std::vector<WavingSurface>& surfaces,
                                      SceneAssets& assets) {
  const mjModel& m = *model.get();
  const auto each = [](int count, auto make) {
    Json all = Json::array();
    for (int i = 0; i < count; ++i) all.push_back(make(i));
    return all;
  };
  Json scene;
  scene["bodies"] = each(m.nbody, [&](int i) { return model.name(mjOBJ_BODY, i); });
  scene["geoms"] = each(static_cast<int>(geoms.size()), [&](int i) {
    return geom_json(model, geoms[static_cast<std::size_t>(i)], surfaces, assets);
  });
  const int* const sky = std::find(m.tex_type, m.tex_type + m.ntex, int{mjTEXTURE_SKYBOX});
  const auto sky_id = static_cast<int>(sky - m.tex_type);
  scene["sky"] = sky_id < m.ntex
                     ? assets.of(m, "texture", sky_id, [&] { return texture_json(m, sky_id); })
                     : -1;
  scene["cameras"] = each(m.ncam, [&](int i) {
    return Json{{"name", model.name(mjOBJ_CAMERA, i)}, {"fovy", rounded(m.cam_fovy[i])}};
  });
  scene["lights"] = each(m.nlight, [&](int i) { return light_json(m, i); });
  const auto& headlight = m.vis.headlight;
  scene["headlight"] =
      colours_json(headlight.active != 0, headlight.ambient, headlight.diffuse, headlight.specular);
  scene["centre"] = row(m.stat.center, 0);
  scene["extent"] = rounded(m.stat.extent);
  scene["near"] = rounded(m.vis.map.znear * m.stat.extent);
  scene["far"] = rounded(m.vis.map.zfar * m.stat.extent);
  scene["free"] = free_camera_json(model);
  return scene;
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
  const std::string fatal = call_engine([&] {
    mj_kinematics(model_.get(), data_.get());
    mj_comPos(model_.get(), data_.get());
    mj_camlight(model_.get(), data_.get());
    mj_tendon(model_.get(), data_.get());
  });
  if (!fatal.empty()) throw RenderError("pictures: " + fatal);
}

Pose ScenePoser::body(int id) const {
  return pose_of(data_->xpos + row_at(3, id), data_->xquat + row_at(4, id));
}

Pose ScenePoser::camera(int id) const {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const Eigen::Matrix3d axes = Eigen::Map<const RowMajor>(data_->cam_xmat + row_at(9, id));
  return pose_with(data_->cam_xpos + row_at(3, id), Eigen::Quaterniond(axes));
}

Pose ScenePoser::light(int id) const {
  return pose_with(data_->light_xpos + row_at(3, id),
                   Eigen::Quaterniond::FromTwoVectors(-Eigen::Vector3d::UnitZ(),
                                                      vector3(data_->light_xdir + row_at(3, id))));
}

}  // namespace breakwater
