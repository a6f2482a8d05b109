// A view of one run's plant at successive times.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <breakwater/render/canvas.h>
#include <breakwater/render/scene_description.h>
#include <breakwater/sim/model.h>

namespace breakwater {

/// Filters for textures drawn smaller than they are. Magnified textures are bilinear.
enum class Minification {
  no_mipmaps,      ///< bilinear; patterns finer than a pixel alias
  nearest_mipmap,  ///< bilinear in the nearest mipmap
  trilinear        ///< between two mipmaps
};

/// The features and the quality of a picture.
struct Look {
  bool shadows = true;
  bool sky = true;  ///< the model's own skybox, if it has one
  bool reflections = false;
  Minification minification = Minification::nearest_mipmap;
  int shadow_map = 1024;  ///< side of the shadow map, in texels
  int samples = 1;        ///< per pixel and direction: 4 draws 16 times as many pixels
};

/// For quick videos.
inline constexpr Look kFastLook{
    .shadows = false, .sky = false, .minification = Minification::no_mipmaps};
/// For videos.
inline constexpr Look kFullLook{};
/// For print, however long it takes.
inline constexpr Look kPrintLook{
    .reflections = true, .minification = Minification::trilinear, .shadow_map = 4096, .samples = 4};

class Offscreen;

/// An arrow in the scene, such as a force.
struct SceneArrow {
  int site = 0;  ///< its start
  Eigen::Vector3d offset_m =
      Eigen::Vector3d::Zero();  ///< offset of the start from the site, in the world
  Eigen::Vector3d vector_m = Eigen::Vector3d::Zero();  ///< direction and length
  bool in_site_frame = false;   ///< frame of vector_m: the site's, or the world's if false
  double contact_mark_m = 0.0;  ///< radius of a ball at the site; 0: none
  Colour colour;
  double number = 0.0;  ///< beside it
};

/// The index of the model's camera with this name; −1, a view of the whole model, for an empty
/// name. Throws std::invalid_argument with a list of the cameras if there is no such camera.
int camera_id(const Model& model, const std::string& name);

/// Draws a model.
class SceneView {
 public:
  /// Draws into `offscreen`, whose context is current. The model must outlive it. `camera` is from
  /// camera_id(). Throws RenderError.
  SceneView(const Offscreen& offscreen, Model& model, int camera, const Look& look);
  ~SceneView();
  SceneView(const SceneView&) = delete;
  SceneView& operator=(const SceneView&) = delete;

  /// Poses the plant, with changed height fields. Throws RenderError, as draw(), if the engine
  /// fails.
  void pose(std::span<const double> qpos);
  /// Draws it into a part of the picture, in pixels from the left and the bottom.
  void draw(const mjrRect& viewport, const std::vector<SceneArrow>& arrows);
  /// The ends of an arrow in the last drawn part, in pixels from its left and top; nothing if it is
  /// behind the camera. Valid after draw().
  struct Ends {
    Point from;
    Point to;
  };
  std::optional<Ends> ends_of(const SceneArrow& arrow) const;

 private:
  struct Segment {
    Eigen::Vector3d from;
    Eigen::Vector3d to;
  };
  Segment place(const SceneArrow& arrow) const;
  std::optional<Point> project(const Eigen::Vector3d& point) const;
  void fit_frame(double aspect);
  void add(const SceneArrow& arrow);

  Model& model_;
  ScenePoser poser_;
  mjvScene scene_;
  mjrContext context_;
  mjvCamera camera_;
  mjvOption options_;
  mjrRect viewport_{};
  std::vector<float> uploaded_heights_;
};

}  // namespace breakwater
