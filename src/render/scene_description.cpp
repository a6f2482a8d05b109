#include <breakwater/render/scene_description.h>

#include <zlib.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
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
  const double unit = std::pow(10.0, 7.0 - std::floor(std::log10(std::abs(value))));
  const double near = std::round(value * unit) / unit;
  return std::isfinite(near) ? near : value;
}

nlohmann::ordered_json pose_json(const Pose& pose) {
  nlohmann::ordered_json all = rounded_list(pose.position_m);
  for (const double value : pose.rotation) all.push_back(rounded(value));
  return all;
}

int SceneAssets::of(const nlohmann::ordered_json& asset) {
  const auto [place, is_new] = numbers_.emplace(asset.dump(), static_cast<int>(all_.size()));
  if (is_new) all_.push_back(asset);
  return place->second;
}

namespace {

using Json = nlohmann::ordered_json;

std::ptrdiff_t row_at(int width, int i) {
  return static_cast<std::ptrdiff_t>(width) * i;
}

template <std::size_t N, typename Number>
std::array<double, N> numbers(const Number* from) {
  std::array<double, N> all{};
  std::copy_n(from, N, all.begin());
  return all;
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

Pose pose_of(const mjtNum* position, const mjtNum* matrix) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const Eigen::Quaterniond q{Eigen::Matrix3d(Eigen::Map<const RowMajor>(matrix))};
  return {numbers<3>(position), {q.w(), q.x(), q.y(), q.z()}};
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

Json light_json(bool is_directional, bool casts_shadow, const float* ambient, const float* diffuse,
                const float* specular, double cutoff_deg, double exponent) {
  return {{"directional", is_directional}, {"shadow", casts_shadow},
          {"ambient", row(ambient, 0)},    {"diffuse", row(diffuse, 0)},
          {"specular", row(specular, 0)},  {"cutoff", rounded(cutoff_deg)},
          {"exponent", rounded(exponent)}};
}

// The light at the camera.
Json headlight_json(const mjModel& m) {
  const auto& light = m.vis.headlight;
  const bool is_on = light.active != 0;
  return light_json(false, true, is_on ? light.ambient : kUnlit, is_on ? light.diffuse : kUnlit,
                    is_on ? light.specular : kUnlit, 45.0, 10.0);
}

Json light_json(const mjModel& m, int id) {
  const auto colour = [&](const float* of_all) {
    return m.light_active[id] != 0 ? of_all + row_at(3, id) : kUnlit;
  };
  return light_json(m.light_directional[id] != 0, m.light_castshadow[id] != 0,
                    colour(m.light_ambient), colour(m.light_diffuse), colour(m.light_specular),
                    m.light_cutoff[id], m.light_exponent[id]);
}

// Shows the whole model.
Json free_camera_json(const Model& model) {
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
  return {{"pose", pose_json(pose_of(position.data(), axes.data()))},
          {"fovy", rounded(model->vis.global.fovy)}};
}

// The assets of one model, which are packed once.
class ModelAssets {
 public:
  explicit ModelAssets(SceneAssets& assets) : assets_(assets) {}
  template <typename Make>
  int of(const char* kind, int id, Make make) {
    const auto [place, is_new] = numbers_.try_emplace({kind, id}, 0);
    if (is_new) place->second = assets_.of(make());
    return place->second;
  }

 private:
  SceneAssets& assets_;
  std::map<std::pair<std::string, int>, int> numbers_;
};

// A visible shape, rigid on a body, with its assets. The shininess is OpenGL's exponent divided by
// 128. Repeats of a uniform texture are per metre, not per geom.
Json geom_json(const Model& model, int id, const std::vector<WavingSurface>& surfaces,
               ModelAssets& assets) {
  const mjModel& m = *model.get();
  const int material = m.geom_matid[id];
  std::array<double, 4> rgba = numbers<4>(m.geom_rgba + row_at(4, id));
  // As the engine does it: the compiler's grey means that the geom has no colour.
  if (material >= 0 && rgba == std::array<double, 4>{0.5, 0.5, 0.5, 1.0}) {
    rgba = numbers<4>(m.mat_rgba + row_at(4, material));
  }
  const std::string name = model.name(mjOBJ_GEOM, id);
  const Pose pose = {numbers<3>(m.geom_pos + row_at(3, id)),
                     numbers<4>(m.geom_quat + row_at(4, id))};
  Json geom = {{"id", id},
               {"name", name},
               {"body", m.geom_bodyid[id]},
               {"shape", kShapes[static_cast<std::size_t>(m.geom_type[id])]},
               {"size", row(m.geom_size, id)},
               {"pose", pose_json(pose)},
               {"rgba", rounded_list(rgba)},
               {"emission", rounded(material < 0 ? 0.0 : m.mat_emission[material])},
               {"specular", rounded(material < 0 ? 0.5 : m.mat_specular[material])},
               {"shininess", rounded(material < 0 ? 0.5 : m.mat_shininess[material])}};
  if (material >= 0 && m.mat_texid[material] >= 0) {
    const int texture = m.mat_texid[material];
    geom["texture"] = assets.of("texture", texture, [&] { return texture_json(m, texture); });
    geom["repeat"] = row(m.mat_texrepeat, material, 2);
    geom["uniform"] = m.mat_texuniform[material] != 0;
  }
  const int data = m.geom_dataid[id];
  if (m.geom_type[id] == mjGEOM_HFIELD) {
    const bool is_waving =
        std::any_of(surfaces.begin(), surfaces.end(),
                    [&](const WavingSurface& surface) { return surface.geom == name; });
    geom["asset"] = assets.of("field", data, [&] { return field_json(m, data, is_waving); });
  } else if (m.geom_type[id] == mjGEOM_MESH && data >= 0) {
    geom["asset"] = assets.of("mesh", data, [&] { return mesh_json(m, data); });
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
                                      SceneAssets& all_assets) {
  const mjModel& m = *model.get();
  ModelAssets assets(all_assets);
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
  scene["sky"] =
      sky_id < m.ntex ? assets.of("texture", sky_id, [&] { return texture_json(m, sky_id); }) : -1;
  scene["cameras"] = each(m.ncam, [&](int i) {
    return Json{{"name", model.name(mjOBJ_CAMERA, i)}, {"fovy", rounded(m.cam_fovy[i])}};
  });
  scene["lights"] = each(m.nlight, [&](int i) { return light_json(m, i); });
  scene["headlight"] = headlight_json(m);
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
  return {numbers<3>(data_->xpos + row_at(3, id)), numbers<4>(data_->xquat + row_at(4, id))};
}

Pose ScenePoser::camera(int id) const {
  return pose_of(data_->cam_xpos + row_at(3, id), data_->cam_xmat + row_at(9, id));
}

Pose ScenePoser::light(int id) const {
  const Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(
      -Eigen::Vector3d::UnitZ(), Eigen::Vector3d(vector3(data_->light_xdir + row_at(3, id))));
  return {numbers<3>(data_->light_xpos + row_at(3, id)), {q.w(), q.x(), q.y(), q.z()}};
}

}  // namespace breakwater
