// A suggestion for a word that is not known.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// The candidate that `word` most likely was meant to be, as " (did you mean X?)"; else "".
std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates);

/// The same; without one, " (there are A, B)" with all candidates.
std::string did_you_mean_or_list(const std::string& word,
                                 const std::vector<std::string>& candidates);

/// The reason why `word` is refused: `must be one of A, B, is "C" (did you mean A?)`.
std::string must_be_one_of(const std::vector<std::string>& names, const std::string& word);

}  // namespace breakwater
