// Parts that the files of studies and tunings have in common.
#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include <breakwater/config/toml_entry.h>
#include <breakwater/study/study.h>

namespace breakwater {

const Names<DistributionKind>& distributions();

/// The tables of the file of a study or tuning. A relative `config` becomes absolute, from the
/// folder of the file. The record of a finished study's program is left out.
toml::table study_tables(const std::string& file);

/// The root of the tables. Options of the command line may be merged into them.
TomlEntry study_root(const toml::table& tables, const std::string& file);

/// Reads scenario, config and [set], and prints the first two, and [set].
void read_base(const TomlEntry& root, StudyBase& base);
std::string print_head(const StudyBase& base);
std::string print_seeds(const std::vector<std::uint64_t>& seeds);
std::string print_sets(const StudyBase& base);
/// The lines of a table of keys.
std::string print_keys(const std::vector<VariedKey>& keys);

/// Reads { first = 1, count = 20 }, { first = 1, last = 20 } or an array. An empty entry gives
/// none.
std::vector<std::uint64_t> read_seeds(const TomlEntry& seeds);
/// Refuses seeds beside a set of run.seed.
void check_seeds(const std::vector<std::string>& sets, const std::vector<std::uint64_t>& seeds,
                 const Places& places);
/// Reads the keys of tables such as [vary] and [compare], in the order of the file, except `but`.
std::vector<VariedKey> read_varied(const TomlEntry& table, const std::set<std::string>& but = {});
bool has_key(const std::vector<VariedKey>& keys, const VariedKey& key);
/// Refuses run.seed, keys that are set and `what` ("varied"), and a list of unequal lengths.
void check_keys(const std::vector<VariedKey>& keys, const std::vector<std::string>& sets,
                const std::string& what, bool is_list = false);

/// Whether a text begins with "lin(" or "log(".
bool is_value_list(const std::string& text);

/// n values from a to b, with exact ends:
///     "lin(a,b,n)"    xᵢ = a + (b − a) i/(n − 1)      evenly
///     "log(a,b,n)"    xᵢ = a (b/a)^(i/(n − 1))        evenly in the logarithm; 0 < a
/// The values have the same bits on every processor. A value that differs from a number of at most
/// 12 digits only by rounding becomes this number: lin(0.06,0.12,4) contains 0.08, not
/// 0.07999999999999999.
///
/// Throws std::invalid_argument if the text is not valid, an end is not finite, a ≥ b, or a ≤ 0 for
/// log. Also if b − a or b/a is too large for a double, or n is not an integer of 2 … 10 000 000.
std::vector<double> value_list(const std::string& text);

}  // namespace breakwater
