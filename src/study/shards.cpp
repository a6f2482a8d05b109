#include <breakwater/study/shards.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include <breakwater/record/file_hash.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/record/process_name.h>
#include <breakwater/shell/process.h>

namespace breakwater {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHashLength = 16;
constexpr std::string_view kSuffix = ".shard";
constexpr std::string_view kPoint = "point";       // a kind of line
constexpr std::string_view kAskedPoint = "asked";  // it begins with PointResult::asked
constexpr std::string_view kModel = "model";
constexpr std::string_view kBegin = "begin";

const std::array<std::string, 4>& statuses() {
  static const std::array<std::string, 4> names = {"complete", "failed", "refused", "crashed"};
  return names;
}

// Splits a line at tabs.
class Parts {
 public:
  explicit Parts(std::string_view line) : rest_(line) {}

  bool at_end() const { return is_done_; }
  std::string_view next() {
    const std::size_t tab = rest_.find('\t');
    const std::string_view part = rest_.substr(0, tab);
    is_done_ = tab == std::string_view::npos;
    rest_ = is_done_ ? std::string_view() : rest_.substr(tab + 1);
    return part;
  }

 private:
  std::string_view rest_;
  bool is_done_ = false;
};

template <typename Number>
bool read_number(std::string_view text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

// Reads the fields before the reason; nothing if the line is of another kind or not valid.
std::optional<PointResult> read_head(Parts& parts) {
  PointResult result;
  const std::string_view kind = parts.next();
  if (kind == kAskedPoint) {
    result.asked = parts.next();
  } else if (kind != kPoint) {
    return std::nullopt;
  }
  if (!read_number(parts.next(), result.number)) return std::nullopt;
  result.key = parts.next();
  const auto* const status = std::find(statuses().begin(), statuses().end(), parts.next());
  if (status == statuses().end()) return std::nullopt;
  result.status = static_cast<PointStatus>(status - statuses().begin());
  result.state_hash = parts.next();
  if (!read_number(parts.next(), result.cost_s)) return std::nullopt;
  return result;
}

// The line without its checksum, if the checksum is right.
std::optional<std::string_view> checked(std::string_view line) {
  if (line.size() <= kHashLength || line[kHashLength] != '\t') return std::nullopt;
  const std::string_view rest = line.substr(kHashLength + 1);
  if (text_hash(rest) != line.substr(0, kHashLength)) return std::nullopt;
  return rest;
}

// Reads the result in a line without its checksum; nothing if it is not valid.
std::optional<PointResult> read_result(std::string_view rest) {
  Parts parts(rest);
  auto result = read_head(parts);
  if (!result) return std::nullopt;
  result->reason = parts.next();
  while (!parts.at_end()) {
    const std::string_view part = parts.next();
    const std::size_t equals = part.rfind('=');
    double value = 0.0;
    if (equals == std::string_view::npos || !read_number(part.substr(equals + 1), value)) {
      return std::nullopt;
    }
    result->metrics.emplace_back(part.substr(0, equals), value);
  }
  return result;
}

[[noreturn]] void fail_to_read(const fs::path& file) {
  throw std::invalid_argument(
      fmt::format("{}: cannot be read ({})", file.string(), std::strerror(errno)));
}

// Calls body(offset, rest) for each line with a right checksum; `rest` is the line without it.
// `begin` is the begin of a line. Returns the begin of the next one.
template <typename Body>
std::size_t each_line(const fs::path& file, Body&& body, std::size_t begin = 0) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail_to_read(file);
  stream.seekg(static_cast<std::streamoff>(begin));
  // The last line is incomplete, unless a newline ends it.
  for (std::string line; std::getline(stream, line) && !stream.eof(); begin += line.size() + 1) {
    if (const auto rest = checked(line)) body(begin, line, *rest);
  }
  if (stream.bad()) fail_to_read(file);
  return begin;
}

// The n-th shard of a process number: an earlier process may have had the same number.
fs::path shard_of(const fs::path& folder, pid_t process, std::size_t n) {
  return folder / fmt::format("{}-{}{}", process_name(process), n, kSuffix);
}

std::vector<fs::path> shards_of(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().extension() == kSuffix) files.push_back(entry->path());
  }
  if (error && error != std::errc::no_such_file_or_directory) {
    throw std::invalid_argument(
        fmt::format("{}: cannot be read ({})", folder.string(), error.message()));
  }
  std::sort(files.begin(), files.end());
  return files;
}

[[noreturn]] void fail_to_write(const fs::path& file) {
  throw OutputError(fmt::format("{}: cannot be written ({})", file.string(), std::strerror(errno)));
}

}  // namespace

const std::string& name_of(PointStatus status) {
  return statuses()[static_cast<std::size_t>(status)];
}

std::string asked_of(const std::string& origin, const std::string& asked) {
  return origin.empty() || asked.empty() ? asked : fingerprint({origin, asked});
}

Shard::~Shard() {
  if (descriptor_ < 0) return;
  fsync(descriptor_);  // the results must survive any end of the study
  close(descriptor_);
}

void Shard::finish() {
  const std::lock_guard lock(mutex_);
  if (descriptor_ < 0) return;
  const bool is_synced = is_on_disk(descriptor_);
  const int error = errno;
  const bool is_closed = close(std::exchange(descriptor_, -1)) == 0;
  if (!is_synced) errno = error;
  if (!is_synced || !is_closed) fail_to_write(file_);
}

void Shard::add(const PointResult& result) {
  const std::string asked = asked_of(origin_, result.asked);
  std::string text =
      asked.empty() ? std::string(kPoint) : fmt::format("{}\t{}", kAskedPoint, asked);
  text +=
      fmt::format("\t{}\t{}\t{}\t{}\t{:.6g}\t{}", result.number, result.key, name_of(result.status),
                  result.state_hash, result.cost_s, one_line(result.reason));
  for (const auto& [name, value] : result.metrics) {
    text += fmt::format("\t{}={:.17g}", one_line(name), value);
  }
  const std::lock_guard lock(mutex_);
  append(text);
}

void Shard::add(const ModelHashes& models) {
  const std::lock_guard lock(mutex_);
  for (const auto& [file, hash] : models) {
    if (models_.contains(file)) continue;
    append(fmt::format("{}\t{}\t{}", kModel, one_line(file), hash));
    models_.emplace(file, hash);
  }
}

void Shard::begin(std::size_t point, const std::string& key) {
  const std::lock_guard lock(mutex_);
  append(fmt::format("{}\t{}\t{}", kBegin, point, key));
}

void Shard::append(const std::string& text) {
  for (std::size_t n = 0; descriptor_ < 0; ++n) {
    file_ = shard_of(folder_, getpid(), n);
    descriptor_ = open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST) fail_to_write(file_);
  }
  // A full disk may have left an incomplete line. The newline ends it.
  const std::string line = (is_torn_ ? "\n" : "") + text_hash(text) + "\t" + text + "\n";
  std::size_t written = 0;
  while (written < line.size()) {
    const ssize_t count = write(descriptor_, line.data() + written, line.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail_to_write(file_);
    written += static_cast<std::size_t>(count);
    is_torn_ = written < line.size();
  }
}

ShardIndex::ShardIndex(const fs::path& folder, std::size_t points, const Asked& asked)
    : places_(points), folder_(folder.string()) {
  Others others;
  for (const fs::path& file : shards_of(folder)) read_file(file, asked, others);
  if (asked && !others.empty()) take_others(asked, others);
  std::vector<bool> is_ours(names_.size());
  for (const Place& place : places_) {
    if (place.length > 0) is_ours[place.file] = true;
  }
  for (std::size_t file = 0; file < names_.size(); ++file) {
    if (has_others_[file] && !is_ours[file]) continue;  // a shard of another study: other models
    for (const auto& [name, hash] : models_of_files_[file]) {
      if (models_.emplace(name, hash).first->second != hash) ambiguous_model_ = name;
    }
  }
}

void ShardIndex::read_file(const fs::path& file, const Asked& asked, Others& others) {
  names_.push_back(file.string());
  const auto nth = static_cast<std::uint32_t>(names_.size() - 1);
  ModelHashes& models = models_of_files_.emplace_back();
  has_others_.push_back(false);
  each_line(file, [&](std::size_t offset, const std::string& text, std::string_view rest) {
    Parts parts(rest);
    const auto head = read_head(parts);
    if (!head) {
      parts = Parts(rest);
      if (parts.next() != kModel) return;
      const std::string name(parts.next());
      models.emplace(name, parts.next());
      return;
    }
    const Place line = {offset, static_cast<std::uint32_t>(text.size()), nth,
                        static_cast<float>(head->cost_s), head->status};
    const std::string wanted = asked && head->number < places_.size() ? asked(head->number) : "";
    const bool is_other = !wanted.empty() && !head->asked.empty() && head->asked != wanted;
    if (head->number < places_.size() && !is_other) {
      cost_s_ += head->cost_s;
      put(head->number, line);
      return;
    }
    has_others_.back() = true;
    if (head->asked.empty()) return;
    Place& other = others[head->asked];
    if (other.is_open()) other = line;
  });
}

void ShardIndex::take_others(const Asked& asked, Others& others) {
  for (std::size_t point = 0; point < places_.size(); ++point) {
    const auto found = others.find(asked(point));
    if (found == others.end()) continue;
    if (has(point) && status(point) != PointStatus::crashed) continue;
    put(point, found->second);
    cost_s_ += static_cast<double>(std::exchange(found->second.cost_s, 0.0F));
  }
}

void ShardIndex::put(std::size_t point, const Place& line) {
  Place& place = places_[point];
  if (!place.is_open()) return;
  if (place.length > 0) {
    --counts_[static_cast<std::size_t>(place.status)];
    --done_;
  }
  place = line;
  ++counts_[static_cast<std::size_t>(place.status)];
  ++done_;
}

PointResult ShardIndex::read(std::size_t point) const {
  const Place& place = places_[point];
  const std::string& name = names_[place.file];
  if (!open_.is_open() || open_file_ != place.file) {
    open_ = std::ifstream(name, std::ios::binary);
    if (!open_) fail_to_read(name);
    open_file_ = place.file;
  }
  std::string text(place.length, '\0');
  open_.clear();
  open_.seekg(static_cast<std::streamoff>(place.offset));
  if (!open_.read(text.data(), std::ssize(text)) || !checked(text)) {
    throw std::invalid_argument(name + ": has changed while it was read");
  }
  auto result = read_result(*checked(text));
  if (!result) throw std::invalid_argument(name + ": is damaged");
  result->number = point;
  return *std::move(result);
}

void ShardIndex::check_models() const {
  if (ambiguous_model_.empty()) return;
  throw std::invalid_argument(
      fmt::format("{}: some results are of another version of {} than others: begin anew with "
                  "--rerun",
                  folder_, ambiguous_model_));
}

std::size_t ShardIndex::find(const std::string& key) const {
  std::size_t found = places_.size();
  std::string whole;
  for (std::size_t point = 0; point < places_.size(); ++point) {
    if (!has(point)) continue;
    const std::string other = read(point).key;
    if (other == key) return point;
    if (!other.starts_with(key) || other == whole) continue;
    if (!whole.empty()) {
      throw std::invalid_argument(
          fmt::format("--replay: {}: points {} and {} both begin so", key, whole, other));
    }
    found = point;
    whole = other;
  }
  return found;
}

ProcessResults results_of_process(const fs::path& folder, pid_t process, ProcessResults known) {
  const auto read = [&](std::size_t, const std::string&, std::string_view rest) {
    if (auto result = read_result(rest)) return known.results.push_back(std::move(*result));
    Parts parts(rest);
    std::size_t point = 0;
    if (parts.next() == kBegin && read_number(parts.next(), point)) {
      known.begun = point;
      known.begun_key = parts.next();
    }
  };
  for (std::size_t n = 0; fs::exists(shard_of(folder, process, n)); ++n) {
    const fs::path file = shard_of(folder, process, n);
    if (n == known.read.size()) known.read.push_back(0);
    if (fs::file_size(file) > known.read[n]) known.read[n] = each_line(file, read, known.read[n]);
  }
  return known;
}

std::vector<int> other_writers(const fs::path& folder) {
  std::vector<int> processes;
  for (const fs::path& file : shards_of(folder)) {
    // The name is HOST-PID-N.shard.
    const std::string name = file.filename();
    const std::string host = host_name() + "-";
    int process = 0;
    if (!name.starts_with(host)) continue;
    std::from_chars(name.data() + host.size(), name.data() + name.size(), process);
    if (process <= 0 || process == getpid()) continue;
    // Another process may have this number by now.
    std::error_code error;
    const fs::path open_files = "/proc/" + std::to_string(process) + "/fd";
    for (fs::directory_iterator entry(open_files, error), end; !error && entry != end;
         entry.increment(error)) {
      std::error_code ignored;
      if (!fs::equivalent(entry->path(), file, ignored)) continue;
      processes.push_back(process);
      break;
    }
  }
  return processes;
}

std::unordered_map<std::string, PointResult> results_by_key(const fs::path& folder,
                                                            std::string PointResult::*key) {
  std::vector<std::pair<fs::file_time_type, fs::path>> files;
  for (const fs::path& file : shards_of(folder))
    files.emplace_back(fs::last_write_time(file), file);
  std::sort(files.begin(), files.end());
  std::unordered_map<std::string, PointResult> results;
  for (const auto& [time, file] : files) {
    each_line(file, [&](std::size_t, const std::string&, std::string_view rest) {
      auto result = read_result(rest);
      if (result) results.insert_or_assign((*result).*key, std::move(*result));
    });
  }
  return results;
}

}  // namespace breakwater
