// Colours and dashes of lines: a signal's role, or a candidate, looks the same on pages, replays,
// stills, strips, videos and figures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <breakwater/render/canvas.h>

namespace breakwater {

/// The look of a line. Each place below `kIdentityColours` has a colour of its own; those above
/// have these colours again with other dashes.
using Identity = int;

inline constexpr Identity kReferenceIdentity = -1;  ///< grey and dashed
inline constexpr int kIdentityColours = 7;
inline constexpr int kIdentityDashes = 7;

/// "#451de2": on white paper, or on the dark page. Readers with any kind of colour blindness tell
/// all of them apart (tests/render/identity_test.cpp); scripts/figures.py has the first again.
const char* light_colour(Identity identity);
const char* dark_colour(Identity identity);
/// The first as pictures draw it.
Colour on_paper(Identity identity);

/// Lengths of stroke and gap by turns, in pixels; empty: solid.
const std::vector<double>& dashes(Identity identity);
/// Which of the patterns that is, from 0.
int dash_number(Identity identity);

/// The identity of a word of a signal's name that says its role: "true", "measured", "hat", "ref",
/// …
std::optional<Identity> role_of_word(const std::string& word);
/// The same of a whole name, "force_measured_N", "force.reference_N".
std::optional<Identity> role_of_signal(const std::string& name);
/// "force", "true", "N" of "force_true_N".
std::vector<std::string> words_of(const std::string& name);

/// One for each, all different but for references: the preferred one where it is free, else the
/// first that is.
std::vector<Identity> distinct_identities(const std::vector<std::optional<Identity>>& preferred);

/// The same of candidates. A case has its place in the list of the scenario's cases.
std::vector<Identity> candidate_identities(const std::vector<std::string>& names,
                                           const std::vector<std::string>& cases);

}  // namespace breakwater
