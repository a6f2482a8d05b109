// Figures for papers, drawn by scripts/figures.py.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/render/identity.h>

namespace breakwater {

/// The Python that draws figures: BREAKWATER_PYTHON, or Debian's own Python, which finds Debian's
/// packages.
std::string figure_python();

/// Whether the script can draw. If not, it prints on stderr what to install.
bool can_draw_figures();

/// Content of a figure: one line for each run, one panel for each signal.
struct FigureContent {
  std::vector<std::filesystem::path> runs;
  std::vector<std::string> labels;
  std::vector<Identity> looks;  ///< one for each run
  std::vector<std::string> signals;
  std::optional<double> from_s;
  std::optional<double> to_s;
};

/// Draws the content into a file of the type of its suffix (.svg, .pdf, .png). Returns the exit
/// status.
int draw_figure(const FigureContent& content, const std::filesystem::path& file);

}  // namespace breakwater
