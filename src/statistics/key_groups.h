// Groups of the values of a varied key.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace breakwater {

/// A varied key with its values.
struct StudyKey {
  std::string name;
  bool is_number = true;           ///< false: a value is an index into `texts`
  std::vector<std::string> texts;  ///< the values that are not numbers, in the order of the study
  std::vector<double> values;      ///< one per sample, or per item of another kind
};

/// The groups of a key's values. Few values have a group each. Otherwise neighbours form groups
/// with about equally many samples.
struct KeyGroups {
  std::string name;
  bool is_number = true;
  bool is_binned = false;           ///< a group has several values
  bool is_log = false;              ///< positive numbers that are spread more evenly in log x
  std::vector<double> centre;       ///< the median of the values in each group
  std::vector<std::string> labels;  ///< "8", "0.061 to 0.07"
  std::vector<std::uint16_t> of_sample;

  std::size_t size() const { return centre.size(); }
};

/// At most `most` groups of a key, 1 ≤ most ≤ 65536. Numbers are in ascending order, texts in the
/// order of the study.
KeyGroups group_values(const StudyKey& key, std::size_t most);

}  // namespace breakwater
