// A suggestion for a word that is not known.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// The candidate that `word` most likely was meant to be, as " (did you mean X?)"; else "".
std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates);

/// The reason why `word` is refused: `must be one of A, B, is "C" (did you mean A?)`.
std::string must_be_one_of(const std::vector<std::string>& names, const std::string& word);

}  // namespace breakwater
