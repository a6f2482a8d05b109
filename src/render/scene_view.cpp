#include <breakwater/render/scene_view.h>

#include <GL/gl.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <stdexcept>

#include <breakwater/render/offscreen.h>
#include <breakwater/render/render_error.h>
#include <breakwater/sim/engine_guard.h>

namespace breakwater {
namespace {

constexpr int kMaxGeoms = 2000;
// The content at this aspect ratio stays visible in a narrower picture.
constexpr double kFramedAspect = 4.0 / 3.0;
constexpr double kArrowRadius_m = 0.006;
constexpr float kGlow = 0.45F;  // makes arrows visible in shadow

Eigen::Map<const Eigen::Vector3d> vector(const mjtNum* values) {
  return Eigen::Map<const Eigen::Vector3d>(values);
}

Eigen::Vector3d vector(const float* values) {
  return Eigen::Map<const Eigen::Vector3f>(values).cast<double>();
}

// Calls the engine. An error of the engine ends the picture.
template <typename Body>
void draw_by_engine(const std::string& what, Body body) {
  const std::string fatal = call_engine(body);
  if (!fatal.empty()) throw RenderError(what + ": " + fatal);
}

// The engine's textures are trilinear.
void minify(const Offscreen& offscreen, const mjrContext& context, Minification how) {
  if (how == Minification::trilinear) return;
  auto* const bind = offscreen.function<void(GLenum, GLuint)>("glBindTexture");
  auto* const get = offscreen.function<void(GLenum, GLenum, GLint*)>("glGetTexParameteriv");
  auto* const set = offscreen.function<void(GLenum, GLenum, GLint)>("glTexParameteri");
  for (int i = 0; i < context.ntexture; ++i) {
    const GLenum target =
        context.textureType[i] == mjTEXTURE_2D ? GL_TEXTURE_2D : GL_TEXTURE_CUBE_MAP;
    bind(target, context.texture[i]);
    GLint now = 0;
    get(target, GL_TEXTURE_MIN_FILTER, &now);
    if (now == GL_LINEAR_MIPMAP_LINEAR) {
      set(target, GL_TEXTURE_MIN_FILTER,
          how == Minification::no_mipmaps ? GL_LINEAR : GL_LINEAR_MIPMAP_NEAREST);
    }
    bind(target, 0);
  }
}

}  // namespace

int camera_id(const Model& model, const std::string& name) {
  if (name.empty()) return -1;
  const int id = mj_name2id(model.get(), mjOBJ_CAMERA, name.c_str());
  if (id >= 0) return id;
  std::string names;
  for (int i = 0; i < model->ncam; ++i) {
    const std::string other = model.name(mjOBJ_CAMERA, i);
    if (!other.empty()) names += (names.empty() ? "" : ", ") + other;
  }
  throw std::invalid_argument(model.file() + ": has no camera \"" + name + "\", but " +
                              (names.empty() ? "none at all" : names));
}

SceneView::SceneView(const Offscreen& offscreen, Model& model, int camera, const Look& look)
    : model_(model), poser_(model) {
  mjModel& m = *model_.get();
  mjv_defaultCamera(&camera_);
  if (camera >= 0) {
    camera_.type = mjCAMERA_FIXED;
    camera_.fixedcamid = camera;
  } else {
    mjv_defaultFreeCamera(&m, &camera_);
  }
  m.vis.quality.shadowsize = look.shadow_map;
  m.vis.quality.offsamples = 0;  // draw into the window's buffer, which Offscreen reads
  m.vis.global.offwidth = m.vis.global.offheight = 1;
  mjv_defaultOption(&options_);
  for (int i = 0; i < mjNGROUP; ++i) {
    options_.geomgroup[i] = i < kDrawnGroups ? 1 : 0;
    options_.sitegroup[i] = 0;
  }
  mjv_defaultScene(&scene_);
  mjr_defaultContext(&context_);
  draw_by_engine("pictures need OpenGL", [&] {
    mjr_makeContext(&m, &context_, mjFONTSCALE_100);
    mjr_setBuffer(mjFB_WINDOW, &context_);
  });
  minify(offscreen, context_, look.minification);
  draw_by_engine("pictures", [&] { mjv_makeScene(&m, &scene_, kMaxGeoms); });
  scene_.flags[mjRND_SHADOW] = look.shadows ? 1 : 0;
  scene_.flags[mjRND_SKYBOX] = look.sky ? 1 : 0;
  scene_.flags[mjRND_REFLECTION] = look.reflections ? 1 : 0;
  uploaded_heights_.assign(m.hfield_data, m.hfield_data + m.nhfielddata);
}

SceneView::~SceneView() {
  mjv_freeScene(&scene_);
  mjr_freeContext(&context_);
}

void SceneView::pose(std::span<const double> qpos) {
  poser_.pose(qpos);
  const mjModel& m = *model_.get();
  if (std::equal(uploaded_heights_.begin(), uploaded_heights_.end(), m.hfield_data)) return;
  uploaded_heights_.assign(m.hfield_data, m.hfield_data + m.nhfielddata);
  draw_by_engine("pictures", [&] {
    for (int i = 0; i < m.nhfield; ++i) mjr_uploadHField(&m, &context_, i);
  });
}

SceneView::Segment SceneView::place(const SceneArrow& arrow) const {
  const mjData& data = poser_.data();
  const Eigen::Vector3d site = vector(data.site_xpos + static_cast<std::ptrdiff_t>(3) * arrow.site);
  Eigen::Vector3d reach = arrow.vector_m;
  if (arrow.in_site_frame) {
    mju_rotVecMat(reach.data(), arrow.vector_m.data(),
                  data.site_xmat + std::ptrdiff_t{9} * arrow.site);
  }
  const Eigen::Vector3d from = site + arrow.offset_m;
  return {from, from + reach};
}

void SceneView::add(const SceneArrow& arrow) {
  const auto add_geom = [&](auto&& shape) {
    if (scene_.ngeom >= scene_.maxgeom) return;
    mjvGeom& geom = scene_.geoms[scene_.ngeom++];
    const std::array<float, 4> rgba = {
        static_cast<float>(arrow.colour.red), static_cast<float>(arrow.colour.green),
        static_cast<float>(arrow.colour.blue), static_cast<float>(arrow.colour.alpha)};
    mjv_initGeom(&geom, mjGEOM_SPHERE, nullptr, nullptr, nullptr, rgba.data());
    shape(geom);
    geom.category = mjCAT_DECOR;
    geom.emission = kGlow;
  };
  const Segment segment = place(arrow);
  if ((segment.to - segment.from).norm() > 1e-4) {
    add_geom([&](mjvGeom& geom) {
      mjv_makeConnector(&geom, mjGEOM_ARROW, kArrowRadius_m, segment.from.x(), segment.from.y(),
                        segment.from.z(), segment.to.x(), segment.to.y(), segment.to.z());
      geom.size[2] *= 2.0F;  // MuJoCo 2.2 draws half of this length
    });
  }
  if (arrow.contact_mark_m > 0.0) {
    const Eigen::Vector3d at = segment.from - arrow.offset_m;
    add_geom([&](mjvGeom& geom) {
      std::fill_n(geom.size, 3, static_cast<float>(arrow.contact_mark_m));
      for (int i = 0; i < 3; ++i) geom.pos[i] = static_cast<float>(at[i]);
    });
  }
}

void SceneView::draw(const mjrRect& viewport, const std::vector<SceneArrow>& arrows) {
  viewport_ = viewport;
  draw_by_engine("pictures", [&] {
    mjv_updateScene(model_.get(), &poser_.data(), &options_, nullptr, &camera_, mjCAT_ALL, &scene_);
  });
  fit_frame(static_cast<double>(viewport.width) / viewport.height);
  for (const SceneArrow& arrow : arrows) add(arrow);
  draw_by_engine("pictures", [&] { mjr_render(viewport, &scene_, &context_); });
}

// A narrow picture shows the view that a 4:3 picture would show.
void SceneView::fit_frame(double aspect) {
  if (aspect >= kFramedAspect) return;
  for (mjvGLCamera& camera : scene_.camera) {
    const double middle = 0.5 * (camera.frustum_top + camera.frustum_bottom);
    const double half_height =
        0.5 * (camera.frustum_top - camera.frustum_bottom) * kFramedAspect / aspect;
    camera.frustum_bottom = static_cast<float>(middle - half_height);
    camera.frustum_top = static_cast<float>(middle + half_height);
  }
}

std::optional<SceneView::Ends> SceneView::ends_of(const SceneArrow& arrow) const {
  const Segment segment = place(arrow);
  const auto from = project(segment.from);
  const auto to = project(segment.to);
  if (!from || !to) return std::nullopt;
  return Ends{*from, *to};
}

// Projects as OpenGL does, with the camera's frustum.
std::optional<Point> SceneView::project(const Eigen::Vector3d& point) const {
  const mjvGLCamera camera = mjv_averageCamera(&scene_.camera[0], &scene_.camera[1]);
  const Eigen::Vector3d forward = vector(camera.forward), up = vector(camera.up);
  const Eigen::Vector3d ray = point - vector(camera.pos);
  const double depth = ray.dot(forward);
  if (depth <= camera.frustum_near) return std::nullopt;
  const double per_tangent = static_cast<double>(viewport_.height) * camera.frustum_near /
                             (camera.frustum_top - camera.frustum_bottom);
  const double middle = 0.5 * (camera.frustum_top + camera.frustum_bottom);
  const double x = ray.dot(forward.cross(up)) / depth - camera.frustum_center / camera.frustum_near;
  const double y = ray.dot(up) / depth - middle / camera.frustum_near;
  return Point{0.5 * viewport_.width + per_tangent * x, 0.5 * viewport_.height - per_tangent * y};
}

}  // namespace breakwater
