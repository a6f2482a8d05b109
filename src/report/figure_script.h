// Figures for papers, drawn by scripts/figures.py.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace breakwater {

/// Whether the script can draw; if not, it has said in one line on stderr what to install.
bool can_draw_figures();

/// Draws the signals of all runs into a file, whose name's end (.svg, .pdf, .png) says of which
/// kind. Returns the status to exit with.
int draw_figure(const std::vector<std::filesystem::path>& runs,
                const std::vector<std::string>& signals, const std::filesystem::path& file);

}  // namespace breakwater
