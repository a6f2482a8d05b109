// The parts that files of studies and of tunings have in common.
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

/// The tables of a study's or a tuning's file. Its `config` is made absolute where it lies beside
/// the file, as the paths of a scenario file are; what made the results of a study whose file this
/// was is left out.
toml::table study_tables(const std::string& file);

/// The root of a study's or a tuning's tables, on which the command line's options may lie.
TomlEntry study_root(const toml::table& tables, const std::string& file);

/// { first = 1, count = 20 }, or an array; of nothing, none.
std::vector<std::uint64_t> read_seeds(const TomlEntry& seeds);
/// key=value of a table of keys.
std::vector<std::string> read_sets(const TomlEntry& table);
/// The keys of [vary], [compare] and the like, in the file's order.
std::vector<VariedKey> read_varied(const TomlEntry& table, const std::set<std::string>& but = {});

}  // namespace breakwater
