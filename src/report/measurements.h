// What was measured, kept line by line, so that it survives a kill at any moment.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace breakwater {

/// A run's numbers.
struct Measurement {
  bool failed = false;
  std::string failure;                   ///< "at t = 3 s: diverged"
  std::map<std::string, double> values;  ///< NaN: the run has it, but it is no finite number
  /// What other runs of its scenario have and this one has not. Not kept in the file.
  std::set<std::string> absent;
};

/// A file of one JSON object a line: each run's key and its numbers; of two lines of one key, the
/// later. A line is whole or not there: one that was cut off, or is no measurement, is ignored. The
/// key says which configuration and version it was, so that what belongs to another is not found.
class Measurements {
 public:
  /// Reads what is there. Throws OutputError if it cannot be opened for writing.
  explicit Measurements(const std::filesystem::path& file);
  ~Measurements();
  Measurements(const Measurements&) = delete;
  Measurements& operator=(const Measurements&) = delete;

  std::optional<Measurement> find(const std::string& key) const;
  /// Appends a line at once. Thread-safe. Throws OutputError if it cannot; what it wrote of the
  /// line then harms none that is added later.
  void add(const std::string& key, const std::string& name, const Measurement& measurement);

 private:
  void read();
  bool append(const std::string& text);

  std::filesystem::path file_;
  int descriptor_ = -1;
  bool is_torn_ = false;  // the file ends within a line
  std::map<std::string, Measurement> known_;
  mutable std::mutex mutex_;
};

/// 16 hexadecimal digits that differ when any of `parts` does.
std::string fingerprint(const std::vector<std::string>& parts);

}  // namespace breakwater
