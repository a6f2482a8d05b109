// The values of a varied key in groups.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace breakwater {

/// A varied key with its value in each sample.
struct StudyKey {
  std::string name;
  bool is_number = true;           ///< else a value is the number of its text in `texts`
  std::vector<std::string> texts;  ///< of values that are no numbers, as the study lists them
  std::vector<double> values;      ///< of each sample, or of whatever has values
};

/// A key's values in groups: each value its own where they are few, else neighbours together, about
/// as many samples in each.
struct KeyGroups {
  std::string name;
  bool is_number = true;
  bool is_binned = false;           ///< a group has several values
  bool is_log = false;              ///< positive numbers that are spread more evenly in log x
  std::vector<double> centre;       ///< x of a group: the median of its samples' values
  std::vector<std::string> labels;  ///< "8", "0.061 to 0.07"
  std::vector<std::uint16_t> of_sample;

  std::size_t size() const { return centre.size(); }
};

/// At most `most` groups of a key, 1 ≤ most ≤ 65536; in the numbers' order, texts in the study's.
KeyGroups group_values(const StudyKey& key, std::size_t most);

}  // namespace breakwater
