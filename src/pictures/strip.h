// The moments of a shot list, in a row.
#pragma once

#include <string>
#include <vector>

#include <breakwater/pictures/staging.h>
#include <breakwater/render/look.h>

namespace breakwater {

struct StripStyle {
  std::string camera;  ///< in place of the shot list's, unless empty
  int width = 560;     ///< of each picture
  int height = 320;
  Look look = kPrintLook;
};

struct Strip {
  std::string png;
  int pictures = 0;
  std::string renderer;
  std::vector<std::string> notes;
};

/// Pictures in a row, each with a letter, its caption and time below, and one chart for the whole
/// width with the moments marked. Throws std::invalid_argument if none of the moments is in the
/// run's log, or RenderError.
Strip draw_strip(const FinishedRun& run, const ShotList& shots, const StripStyle& style);

}  // namespace breakwater
