// The varied keys of a study and their effects, as far as it can separate them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <breakwater/statistics/key_groups.h>
#include <breakwater/study/study.h>

namespace breakwater {

/// The varied keys without values.
std::vector<StudyKey> study_keys(const Study& study);

/// A number for a key's value, given as TOML.
double key_number(const StudyKey& key, const std::string& value);

/// An effect that a study can separate from the others: a key and the keys that vary with it.
struct KeyEffect {
  std::size_t key = 0;            ///< in Study::vary
  std::vector<std::size_t> with;  ///< keys whose values this key determines
  std::string name;               ///< "a" or "a (with b, c)"
};

/// The effects of the varied keys. In a list the value of one key may determine that of another.
/// Nobody can then separate the two, so they are one effect. In other methods each key is one.
std::vector<KeyEffect> key_effects(const Study& study);

}  // namespace breakwater
