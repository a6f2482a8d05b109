// A complete picture: one run or several side by side, with arrows, captions and charts.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/math/table_function.h>
#include <breakwater/record/hdf5_log.h>
#include <breakwater/render/canvas.h>
#include <breakwater/render/chart.h>
#include <breakwater/render/offscreen.h>
#include <breakwater/render/scene_view.h>
#include <breakwater/sim/model.h>
#include <breakwater/sim/surface_waves.h>

namespace breakwater {

/// Smooths the edges of a picture in place, after Lottes, "FXAA" (NVIDIA, 2009), in its "quality"
/// form. At an abrupt change of luminance it finds both ends of the edge. It blends a pixel with
/// the one across the edge, as far as the straight line between the ends covers it. This takes a
/// few milliseconds. With llvmpipe, 4 samples per pixel would more than double the time.
///
/// `pixels` has 4 bytes per pixel (blue, green, red, any).
void smooth_edges(std::vector<std::uint8_t>& pixels, int width, int height);

/// An arrow over time, from the log.
struct ArrowTrack {
  SceneArrow arrow;                ///< its vector and number are set from the other members
  std::vector<Series> components;  ///< one or three
  /// Direction of a positive value; for a vector: one factor per value.
  Eigen::Vector3d along = Eigen::Vector3d::UnitX();
  double metres_per_unit = 1.0;
  std::string unit;  ///< unit of the number beside it; empty: no number
  std::string signal;
};

SceneArrow arrow_at(const ArrowTrack& track, double time_s);

/// The data for pictures of one run.
struct PictureRun {
  Model model;
  std::function<void(Model&, double time_s)> animate;  ///< may be empty
  std::vector<WavingSurface> surfaces;                 ///< water
  int camera = -1;                                     ///< from camera_id()
  std::vector<double> times_s;
  LoggedSignal qpos;  ///< one row for each time
  std::vector<ArrowTrack> arrows;
  std::vector<ChartLine> lines;
  std::string caption;
};

/// The run's positions at a time, from its log: between two rows each joint is on its shortest way.
/// Before and after the log they are constant.
void interpolate_qpos(const PictureRun& run, double time_s, std::vector<double>& qpos);

struct Corner {
  bool is_right = true;
  bool is_bottom = true;
};

struct PictureStyle {
  int width = 1280;
  int height = 720;
  Look look;
  std::string title;        ///< in the lower corner without the chart
  std::string chart_title;  ///< a chart is drawn if the run has lines
  Corner chart_corner;      ///< a wide picture has it there
  ChartRange chart_range;
  double speed = 1.0;  ///< 0.1: "10 × slower"
  int time_decimals = 3;
  bool captions = true;  ///< case, time and speed
};

/// Draws pictures of up to four runs at any time. Its OpenGL context belongs to its thread.
class Picture {
 public:
  /// The runs must outlive it. It uses their models meanwhile. Throws RenderError.
  Picture(std::vector<PictureRun>& runs, const PictureStyle& style);

  /// The picture at a time: 4 bytes per pixel (blue, green, red, unused), rows from the top. After
  /// its end a run stands still. Valid until the next call.
  const std::uint8_t* draw(double time_s);

  const Offscreen& offscreen() const { return offscreen_; }
  /// The area of a run's chart; width 0: no chart.
  const Rectangle& chart_area(std::size_t run) const { return panels_[run].chart_area; }
  const Chart& chart(std::size_t run) const { return *panels_[run].chart; }

  /// The scale of text and lines in a picture of this size: 1 at 1280x720.
  static double unit_px(double width, double height);

 private:
  struct Panel {
    Rectangle area;  // the scene's area, in whole pixels
    Rectangle chart_area;
    std::unique_ptr<SceneView> view;
    std::unique_ptr<Chart> chart;
    std::vector<SceneArrow> arrows;  // the arrows of the last picture
  };

  void lay_out();
  void draw_scene(PictureRun& run, Panel& panel, double time_s);
  void draw_arrow_numbers(Canvas& canvas, const PictureRun& run, const Panel& panel) const;
  void draw_caption(Canvas& canvas, const PictureRun& run, const Panel& panel, double time_s) const;
  void fill_background();
  void shrink();

  std::vector<PictureRun>& runs_;
  PictureStyle style_;
  Offscreen offscreen_;
  std::vector<std::uint8_t> pixels_;
  std::vector<Panel> panels_;
  std::vector<double> qpos_;
};

}  // namespace breakwater
