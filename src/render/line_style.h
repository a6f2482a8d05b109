// Colours and dashes of lines: a signal's role, or a candidate, looks the same on pages, replays,
// stills, strips, videos and figures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <breakwater/render/canvas.h>

namespace breakwater {

/// The colour and dash of a line. Each number below `kStyleColours` has a colour of its own; those
/// above have these colours again with other dashes.
using LineStyle = int;

inline constexpr LineStyle kReferenceStyle = -1;  ///< grey and dashed
inline constexpr int kStyleColours = 7;
inline constexpr int kStyleDashes = 7;

/// "#451de2": on white paper, or on the dark page. Readers with any kind of colour blindness tell
/// all of them apart (tests/render/drawing_test.cpp); scripts/figures.py has the first again.
const char* light_colour(LineStyle style);
const char* dark_colour(LineStyle style);
/// Which of the colours that is; `kStyleColours` of a reference.
int colour_number(LineStyle style);
/// The first as pictures draw it.
Colour on_paper(LineStyle style);

/// Lengths of stroke and gap by turns, in pixels; empty: solid.
const std::vector<double>& dashes(LineStyle style);
/// Which of the patterns that is, from 0.
int dash_number(LineStyle style);

/// The style of a word of a signal's name that says its role: "true", "measured", "hat", "ref",
/// …
std::optional<LineStyle> role_of_word(const std::string& word);
/// The same of a whole name, "force_measured_N", "force.reference_N".
std::optional<LineStyle> role_of_signal(const std::string& name);
/// "force", "true", "N" of "force_true_N".
std::vector<std::string> words_of(const std::string& name);

/// A style for each, all different but for references: the preferred one where it is free, else the
/// first that is.
std::vector<LineStyle> distinct_styles(const std::vector<std::optional<LineStyle>>& preferred);

/// The same of candidates. A case has its place in the list of the scenario's cases.
std::vector<LineStyle> candidate_styles(const std::vector<std::string>& names,
                                        const std::vector<std::string>& cases);

}  // namespace breakwater
