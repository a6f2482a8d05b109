// Shards: the results of a study, as each process appended them.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <breakwater/experiment/provenance.h>
#include <breakwater/record/output_error.h>

namespace breakwater {

/// How a point ended. A failed run has a state hash but no metrics. A refused point did not begin.
/// A crashed one leaves only a reason.
enum class PointStatus : std::uint8_t { complete, failed, refused, crashed };
const std::string& name_of(PointStatus status);

/// The result of a point.
struct PointResult {
  std::size_t number = 0;
  std::string key;  ///< point_key(), or PointSource::asked() without a configuration
  PointStatus status = PointStatus::complete;
  std::string state_hash;  ///< 16 hexadecimal digits, or empty
  double cost_s = 0.0;     ///< processor time
  std::string reason;      ///< why it is not complete: "at 3 s: diverged"
  std::vector<std::pair<std::string, double>> metrics;  ///< in the scenario's order
  /// PointSource::asked() of the point that ran, and the shard's origin; empty in shards of before.
  std::string asked = {};
};

/// A hash of a run that a study asks for, and of the study's origin, which may be empty.
std::string asked_of(const std::string& origin, const std::string& asked);

/// A file to which only one process appends whole lines. A line has a checksum, a kind ("point",
/// "model" or "begin") and its data, separated by tabs. A line counts only if its checksum (XXH3 of
/// the rest) is right.
class Shard {
 public:
  /// The file is made in the folder at the first write. `origin` is StudyFolder::origin().
  explicit Shard(std::filesystem::path folder, std::string origin = "")
      : folder_(std::move(folder)), origin_(std::move(origin)) {}
  /// Like finish(), but ignores errors.
  ~Shard();
  Shard(const Shard&) = delete;
  Shard& operator=(const Shard&) = delete;

  /// Thread-safe. Throws OutputError if the line cannot be written. A damaged line does not harm
  /// later ones.
  void add(const PointResult& result);
  /// Writes the hashes of the model files that are not in the shard yet.
  void add(const ModelHashes& models);
  /// Records that a point begins, so that the point of a crash is known. Call it again once the key
  /// is known.
  void begin(std::size_t point, const std::string& key);
  /// Call it after the last result. Throws OutputError if a result may not be on the disk: a
  /// network file system may report this only now.
  void finish();

 private:
  void append(const std::string& text);

  std::filesystem::path folder_;
  std::string origin_;
  std::filesystem::path file_;
  int descriptor_ = -1;
  bool is_torn_ = false;  // the file ends within a line
  ModelHashes models_;
  std::mutex mutex_;
};

/// An index of the results in all shards of a folder. Not thread-safe.
class ShardIndex {
 public:
  /// asked_of() a point; empty: not known yet.
  using Asked = std::function<std::string(std::size_t)>;

  /// `points` is the number of points of the study. A line counts for the point with its number, if
  /// it is of the run that `asked` says. Otherwise it counts for the points that ask for its run,
  /// since a study that has grown has other numbers. Lines of no point are ignored. If
  /// a point has several lines, a run counts before a crash. A missing folder counts as empty.
  /// Throws std::invalid_argument if the folder or a shard cannot be read.
  ShardIndex(const std::filesystem::path& folder, std::size_t points, const Asked& asked = {});

  std::size_t points() const { return places_.size(); }
  bool has(std::size_t point) const { return places_[point].length > 0; }
  /// The status of a finished point.
  PointStatus status(std::size_t point) const { return places_[point].status; }
  std::size_t done() const { return done_; }
  /// The number of points with this status.
  std::size_t count(PointStatus status) const { return counts_[static_cast<std::size_t>(status)]; }
  /// Processor time of all runs [s].
  double cost_s() const { return cost_s_; }
  const ModelHashes& models() const { return models_; }
  /// Throws std::invalid_argument if the points used different versions of a model file.
  void check_models() const;

  /// The result of a finished point. Throws std::invalid_argument if the shard has changed.
  PointResult read(std::size_t point) const;
  /// The number of the first point whose key begins with `key`; points() if there is none. Throws
  /// std::invalid_argument if different keys begin with it.
  std::size_t find(const std::string& key) const;

 private:
  struct Place {
    std::uint64_t offset = 0;
    std::uint32_t length = 0;  // 0: not there
    std::uint32_t file = 0;
    float cost_s = 0.0F;
    PointStatus status = PointStatus::complete;
    // Whether another line may take its place: a run counts before a crash.
    bool is_open() const { return length == 0 || status == PointStatus::crashed; }
  };

  // Lines that no point of their number asks for, by PointResult::asked.
  using Others = std::unordered_map<std::string, Place>;

  void read_file(const std::filesystem::path& file, const Asked& asked, Others& others);
  void take_others(const Asked& asked, Others& others);
  // Gives the point a line, unless it has a better one.
  void put(std::size_t point, const Place& line);

  std::vector<std::string> names_;  // shards
  mutable std::ifstream open_;  // the last shard that was read: there may be too many to keep open
  mutable std::uint32_t open_file_ = 0;
  std::vector<Place> places_;
  std::size_t done_ = 0;
  std::size_t counts_[4] = {};
  double cost_s_ = 0.0;
  std::string folder_;
  ModelHashes models_;
  std::vector<ModelHashes> models_of_files_;
  std::vector<bool> has_others_;  // by file: results that no point of their number asks for
  std::string ambiguous_model_;   // a model file with different hashes
};

/// All results that a process of this computer has written so far.
struct ProcessResults {
  std::vector<PointResult> results;    ///< in their order
  std::optional<std::size_t> begun;    ///< the last point that has begun
  std::string begun_key = {};          ///< empty while the point is being prepared
  std::vector<std::size_t> read = {};  ///< bytes read of each shard
};

/// A process without shards has no results. `known` are the results read before: only what
/// the shards have grown by is read. Throws std::invalid_argument if a shard cannot be read.
ProcessResults results_of_process(const std::filesystem::path& folder, pid_t process,
                                  ProcessResults known = {});

/// Other processes of this computer that have a shard of the folder open, and so work on the same
/// study.
std::vector<int> other_writers(const std::filesystem::path& folder);

/// The results in all shards of a folder by key, or by another member, for points without fixed
/// numbers. If a key has several lines, the last one in the newest shard counts. A missing folder
/// counts as empty. Throws std::invalid_argument if a shard cannot be read.
std::unordered_map<std::string, PointResult> results_by_key(
    const std::filesystem::path& folder, std::string PointResult::*key = &PointResult::key);

}  // namespace breakwater
