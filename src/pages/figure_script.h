// Figures for papers, drawn by scripts/figures.py.
#pragma once

#include <filesystem>
#include <string>

namespace breakwater {

/// The Python that draws figures: BREAKWATER_PYTHON, or Debian's own Python, which finds Debian's
/// packages.
std::string figure_python();

/// Whether the script can draw. If not, it prints on stderr what to install.
bool can_draw_figures();

/// Draws the charts of a page that it does not fold away into a file of the type of its suffix
/// (.svg, .pdf, .png). Returns the exit status.
int draw_figure(const std::filesystem::path& page, const std::filesystem::path& file);

}  // namespace breakwater
