// The varied keys of a study, and what can be told apart of their effects.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/statistics/key_groups.h>
#include <breakwater/study/study.h>

namespace breakwater {

/// The varied keys, without values.
std::vector<StudyKey> study_keys(const Study& study);

/// The number that stands for a key's value as TOML.
double key_number(const StudyKey& key, const std::string& value);

/// A study can tell this apart from the rest: a key, with those that say nothing beside it.
struct KeyEffect {
  std::size_t key = 0;            ///< in Study::vary
  std::vector<std::size_t> with;  ///< keys whose values this one's fix
  std::string name;               ///< "a", "a (with b, c)"
};

/// The effects of the varied keys. In a list one key's value may fix another's; what the other does
/// alone nobody can tell then, and the two are one effect. Elsewhere each key is one.
std::vector<KeyEffect> key_effects(const Study& study);

/// The number that a key's value, as TOML, is; nothing if it is none.
std::optional<double> number_in(const std::string& value);

}  // namespace breakwater
