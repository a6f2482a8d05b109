// One run's plant, drawn at one instant after the other.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <breakwater/render/canvas.h>
#include <breakwater/render/look.h>
#include <breakwater/sim/model.h>

namespace breakwater {

class Offscreen;

/// An arrow in the scene: a force, say.
struct SceneArrow {
  int site = 0;                                        ///< where it starts
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();  ///< of its start from the site, world
  Eigen::Vector3d vector_m = Eigen::Vector3d::Zero();  ///< how far it reaches
  bool in_site_frame = false;                          ///< the vector; else it is the world's
  double contact_mark_m = 0.0;  ///< radius of a ball at the site itself; 0: none
  Colour colour;
};

/// The positions between two logged ones, each joint on its shortest way: part 0 is the first.
void interpolate_qpos(const mjModel& model, std::span<const double> first,
                      std::span<const double> second, double part, std::vector<double>& qpos);

/// The number of the model's camera of that name; −1 for none, one that shows all of it, if the
/// name is empty. Throws std::invalid_argument that lists the cameras if there is none of that
/// name.
int camera_id(const Model& model, const std::string& name);

/// Draws a model.
class SceneView {
 public:
  /// Into `offscreen`, whose context is current. The model outlives it; `camera` is a camera_id().
  /// Throws RenderError.
  SceneView(const Offscreen& offscreen, Model& model, int camera, const Look& look);
  ~SceneView();
  SceneView(const SceneView&) = delete;
  SceneView& operator=(const SceneView&) = delete;

  /// What is to be in sight in parts of a picture that are narrower than 4:3, in which the camera's
  /// own frame would leave a band: all bounded geoms at these positions, as far as they are in the
  /// camera's frame of 16:9. May be called for several positions, before draw().
  void include_in_frame(std::span<const double> qpos);

  /// Poses the plant. Height fields that changed since are taken over. Throws RenderError, as
  /// draw() does, if the engine cannot.
  void pose(std::span<const double> qpos);
  /// Draws it into a part of the picture, given in pixels from the left and the bottom.
  void draw(const mjrRect& viewport, const std::vector<SceneArrow>& arrows);
  /// Where an arrow is in the part of the picture last drawn, in pixels from that part's left and
  /// top; nothing if it is behind the camera. Valid after draw().
  struct Ends {
    Point from;
    Point to;
  };
  std::optional<Ends> ends_of(const SceneArrow& arrow) const;
  /// What moves, as circles in the part of the picture last drawn [pixels from its left and top].
  /// Valid after draw().
  struct Circle {
    Point centre;
    double radius;
  };
  std::vector<Circle> moving_parts() const;

 private:
  struct Segment {
    Eigen::Vector3d from;
    Eigen::Vector3d to;
  };
  Segment place(const SceneArrow& arrow) const;
  struct Projected {
    Point point;
    double per_metre;  // pixels, at that depth
  };
  std::optional<Projected> project(const Eigen::Vector3d& point) const;
  void fit_frame(double aspect);
  void add(const SceneArrow& arrow);
  void upload_height_fields();

  Model& model_;
  DataPointer data_;
  mjvScene scene_;
  mjrContext context_;
  mjvCamera camera_;
  mjvOption options_;
  mjrRect viewport_{};
  // What is in the frame, as tangents of the angles from the camera's axis; empty: lower > upper.
  Eigen::AlignedBox2d content_;
  std::vector<float> uploaded_heights_;
};

}  // namespace breakwater
