// shots.toml: the content of a scenario's pictures.
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <breakwater/render/picture.h>

namespace breakwater {

/// One picture of a strip: an instant, or the first one from then on with a positive signal.
struct ShotMoment {
  std::string caption;
  double at_s = 0.0;
  std::string first_positive;  ///< a signal; empty: the instant at_s
  double plus_s = 0.0;         ///< delay after this instant
};

/// An arrow at a site of the model. A signal sets its length; a signal of three values is a vector.
struct ShotArrow {
  ArrowTrack track;        ///< without the site, colour and values of a run
  std::string site;        ///< {KEY} in it is replaced by this key of the run's configuration
  std::string site_place;  ///< "FILE:LINE: arrow.site"
};

/// A line of the strip chart: a signal of the log, or a number of the run's configuration.
struct ShotLine {
  std::string label;
  std::string value;
  bool is_dashed = false;
};

/// The first part of a run's page.
struct ShotPage {
  struct KeyChart {
    std::string title;
    std::vector<std::string> signals;  ///< signals of the log; a missing one is left out
  };

  std::string camera;                ///< camera of the replay; empty: that of the shot list
  std::string opens_before;          ///< caption of the moment; empty: at the window's begin
  std::vector<std::string> metrics;  ///< empty: the scenario's first
  std::vector<KeyChart> charts;      ///< empty: the first quantities of the log
};

struct ShotList {
  PictureStyle style;        ///< size, texts and speed of a video
  std::string camera;        ///< empty: the whole model
  std::string camera_place;  ///< "FILE:LINE: camera"
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();  ///< limited by the end of the run
  int fps = 30;
  std::vector<ShotMoment> moments;
  std::vector<ShotArrow> arrows;
  std::vector<ShotLine> lines;
  ShotPage page;
};

/// A scenario's shot list. Without a file, it shows the whole run without arrows and chart. Throws
/// std::invalid_argument `FILE:LINE: KEY: reason`.
ShotList shot_list(const std::filesystem::path& file);

}  // namespace breakwater
