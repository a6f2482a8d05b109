// Figures for papers, drawn by scripts/figures.py.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/render/identity.h>

namespace breakwater {

/// The Python that draws figures: BREAKWATER_PYTHON, or Debian's own, which has Debian's packages.
std::string figure_python();

/// Whether the script can draw; if not, it has said in one line on stderr what to install.
bool can_draw_figures();

/// What a figure shows: one line for each run, one panel for each signal.
struct FigureContent {
  std::vector<std::filesystem::path> runs;
  std::vector<std::string> labels;
  std::vector<Identity> looks;  ///< of the runs
  std::vector<std::string> signals;
  std::optional<double> from_s;
  std::optional<double> to_s;
};

/// Draws it into a file, whose name's end (.svg, .pdf, .png) says of which kind. Returns the status
/// to exit with.
int draw_figure(const FigureContent& content, const std::filesystem::path& file);

}  // namespace breakwater
