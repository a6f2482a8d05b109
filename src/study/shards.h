// The results of a study's runs, as each process appended them.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <breakwater/experiment/provenance.h>
#include <breakwater/record/output_error.h>

namespace breakwater {

/// How a point ended. A run that failed has a state hash and no metrics; what was refused did not
/// begin; of a crash only the words are left.
enum class PointStatus : std::uint8_t { complete, failed, refused, crashed };
const std::string& name_of(PointStatus status);

/// What is known of a point once it has run.
struct PointResult {
  std::size_t number = 0;
  std::string key;  ///< point_key(); if there is no configuration, of what was asked for
  PointStatus status = PointStatus::complete;
  std::string state_hash;  ///< 16 hexadecimal digits, or empty
  double cost_s = 0.0;     ///< processor time
  std::string reason;      ///< why it is not complete: "at 3 s: diverged"
  std::vector<std::pair<std::string, double>> metrics;  ///< in the scenario's order
};

/// A file of lines to which one process alone appends, whole lines at a time: CHECKSUM, "point",
/// "model" or "begin", and what belongs to it, with tabs between. Whatever its end, a line counts
/// only if its checksum (XXH3 of the rest) is right.
class Shard {
 public:
  /// Makes a file of its own in the folder when there is something to write.
  explicit Shard(std::filesystem::path folder) : folder_(std::move(folder)) {}
  /// As finish(), and keeps what fails to itself.
  ~Shard();
  Shard(const Shard&) = delete;
  Shard& operator=(const Shard&) = delete;

  /// Thread-safe. Throws OutputError if it cannot be written; what it wrote of the line then harms
  /// none that is added later.
  void add(const PointResult& result);
  /// What points are made of besides their keys; each file is written once.
  void add(const ModelHashes& models);
  /// Says which point is run now, so that one that ends the process is known; again once its key
  /// is there.
  void begin(std::size_t point, const std::string& key);
  /// Once all is added. Throws OutputError if what was added may not be on the disk: a file system
  /// over a network may say so only now.
  void finish();

 private:
  void append(const std::string& text);

  std::filesystem::path folder_;
  std::filesystem::path file_;
  int descriptor_ = -1;
  bool is_torn_ = false;  // the file ends within a line
  ModelHashes models_;
  std::mutex mutex_;
};

/// What all shards of a folder hold, found in them when it is asked for. Not thread-safe.
class ShardIndex {
 public:
  /// `points` is how many the study has. A line of a point beyond them does not count; of several
  /// of one point one that ran counts before one that crashed. A folder that is not there is empty.
  /// Throws std::invalid_argument if it cannot be read, or one of its shards.
  ShardIndex(const std::filesystem::path& folder, std::size_t points);
  ~ShardIndex();
  ShardIndex(const ShardIndex&) = delete;
  ShardIndex& operator=(const ShardIndex&) = delete;

  std::size_t points() const { return places_.size(); }
  bool has(std::size_t point) const { return places_[point].length > 0; }
  /// How a point ended, which must be there.
  PointStatus status(std::size_t point) const { return places_[point].status; }
  std::size_t done() const { return done_; }
  /// How many ended so.
  std::size_t count(PointStatus status) const { return counts_[static_cast<std::size_t>(status)]; }
  /// Processor time of all that ran, and of a point, which must be there [s].
  double cost_s() const { return cost_s_; }
  double cost_s(std::size_t point) const { return static_cast<double>(places_[point].cost_s); }
  const ModelHashes& models() const { return models_; }
  /// Throws std::invalid_argument, one line, if points are of different versions of a model.
  void check_models() const;

  /// A point's result, which must be there. Throws std::invalid_argument if the file has changed.
  PointResult read(std::size_t point) const;
  /// The number of the first point whose key begins so; points() if none of those that are there
  /// does. Throws std::invalid_argument if points of different keys do.
  std::size_t find(const std::string& key) const;

 private:
  struct Place {
    std::uint64_t offset = 0;
    std::uint32_t length = 0;  // 0: not there
    std::uint32_t file = 0;
    float cost_s = 0.0F;
    PointStatus status = PointStatus::complete;
  };

  void read_file(const std::filesystem::path& file);
  std::string line(const Place& place) const;

  std::vector<std::string> names_;  // of the files
  mutable int open_ = -1;           // the one that was read last: there may be very many
  mutable std::uint32_t open_file_ = 0;
  std::vector<Place> places_;
  std::size_t done_ = 0;
  std::size_t counts_[4] = {};
  double cost_s_ = 0.0;
  std::string folder_;
  ModelHashes models_;
  std::string ambiguous_model_;  // one of which there are different hashes
};

/// All that one process of this computer has written by now.
struct ProcessResults {
  std::vector<PointResult> results;    ///< in their order
  std::optional<std::size_t> begun;    ///< the point that was begun last
  std::string begun_key = {};          ///< its key; empty as long as it is being prepared
  std::vector<std::size_t> read = {};  ///< up to which byte each of its shards was read
};

/// A process that wrote nothing has no results. `known` is what was read before: only what the
/// shards have grown by since is read. Throws std::invalid_argument if a shard cannot be read.
ProcessResults results_of_process(const std::filesystem::path& folder, pid_t process,
                                  ProcessResults known = {});

/// Other processes of this computer that have a shard of the folder open: they are at the same
/// study.
std::vector<int> other_writers(const std::filesystem::path& folder);

/// The results in all shards of a folder, by their keys: for points without fixed numbers. Of
/// several lines of one key the last counts; that of a shard that was written later is later. A
/// folder that is not there is empty. Throws std::invalid_argument if a shard cannot be read.
std::unordered_map<std::string, PointResult> results_by_key(const std::filesystem::path& folder);

}  // namespace breakwater
