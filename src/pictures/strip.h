// The moments of a shot list as a row of pictures.
#pragma once

#include <string>
#include <vector>

#include <breakwater/pictures/staging.h>
#include <breakwater/render/look.h>

namespace breakwater {

struct StripStyle {
  std::string camera;  ///< replaces that of the shot list, unless empty
  int width = 560;     ///< width of each picture
  int height = 320;
  Look look = kPrintLook;
};

struct Strip {
  std::string png;
  int pictures = 0;
  std::string renderer;
  std::vector<std::string> notes;
};

/// Draws pictures in a row, each with a letter, its caption and its time below. A chart of the
/// whole width has marks at the moments. Throws std::invalid_argument if none of the moments is in
/// the run's log, or RenderError.
Strip draw_strip(const FinishedRun& run, const ShotList& shots, const StripStyle& style);

}  // namespace breakwater
