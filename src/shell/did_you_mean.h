// A suggestion for a word that is not known.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// The candidate that `word` most likely was meant to be, as " (did you mean X?)"; else "".
std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace breakwater
