// The answer of a ranking: a sentence, a table, and both as JSON.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include <breakwater/statistics/ranking.h>

namespace breakwater {

/// "tlsc-2N has the lowest peak_force_N: 5.4 N, 3 N below the next (hpfc-2N), 95 % 2.1 to 3.8 N, in
/// 8 of 8 conditions." or "No difference in peak_force_N is shown between …: about 14 conditions
/// would show 0.5 N.", and what the bounds leave out. A condition is a block.
std::string ranking_sentence(const Ranking& ranking);

/// A header, then a row for each candidate. `behind` is how much worse it is than the first.
std::vector<std::vector<std::string>> ranking_table(const Ranking& ranking);

/// The question, the sentence, the table, its numbers, and the comparison of each pair.
nlohmann::ordered_json ranking_json(const Ranking& ranking);

/// The sentence and the table for a terminal. The table has at most 20 lines. Long names are cut in
/// the middle.
std::string ranking_text(const Ranking& ranking, std::size_t width);

}  // namespace breakwater
