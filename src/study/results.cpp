#include <breakwater/study/results.h>

#include <fmt/format.h>
#include <sqlite3.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include <breakwater/config/toml_text.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/study/plan.h>

namespace breakwater {
namespace {

// A database during writing.
class Database {
 public:
  explicit Database(const std::filesystem::path& file) : file_(file.string()) {
    if (sqlite3_open(file_.c_str(), &database_) != SQLITE_OK) fail();
  }
  ~Database() { sqlite3_close(database_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void execute(const std::string& statement) {
    if (sqlite3_exec(database_, statement.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
  }
  sqlite3* get() { return database_; }
  [[noreturn]] void fail() const {
    throw OutputError(file_ + ": cannot be written (" + sqlite3_errmsg(database_) + ")");
  }

 private:
  std::string file_;
  sqlite3* database_ = nullptr;
};

std::string quoted_name(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

}  // namespace

ResultsTable::ResultsTable(const Plan& plan, const ShardIndex& index) : plan_(plan), index_(index) {
  for (std::size_t point = 0; point < index.points(); ++point) {
    if (!index.has(point)) continue;
    for (const auto& [name, value] : index.read(point).metrics) {
      if (columns_.emplace(name, metrics_.size()).second) metrics_.push_back(name);
    }
  }
}

std::vector<std::string> ResultsTable::header() const {
  std::vector<std::string> names = {"point", "case", "seed"};
  for (const VariedKey& key : plan_.study().compare) names.push_back(key.key);
  for (const VariedKey& key : plan_.study().vary) names.push_back(key.key);
  names.insert(names.end(), {"status", "state_hash"});
  names.insert(names.end(), metrics_.begin(), metrics_.end());
  return names;
}

std::vector<std::string> ResultsTable::head(const PointResult& result) const {
  const StudyPoint point = plan_.point(result.number);
  const Candidate& candidate = plan_.candidates()[point.candidate];
  std::vector<std::string> cells = {result.key, candidate.case_name,
                                    point.seed ? std::to_string(*point.seed) : ""};
  for (const std::string& value : candidate.values) cells.push_back(plain_text(value));
  for (const std::string& value : point.values) cells.push_back(plain_text(value));
  cells.push_back(name_of(result.status));
  cells.push_back(result.state_hash);
  return cells;
}

void ResultsTable::write_csv(const std::filesystem::path& file) const {
  PartialFile partial(file);
  std::ofstream stream(partial.path(), std::ios::binary);
  stream << csv_line(header());
  for (std::size_t point = 0; stream && point < index_.points(); ++point) {
    if (!index_.has(point)) continue;
    const PointResult result = index_.read(point);
    std::vector<std::string> cells = head(result);
    const std::size_t first = cells.size();
    cells.resize(first + metrics_.size());
    for (const auto& [name, value] : result.metrics) {
      cells[first + columns_.at(name)] = fmt::format("{:.17g}", value);
    }
    stream << csv_line(cells);
  }
  stream.close();
  if (!stream) {
    throw OutputError(
        fmt::format("{}: cannot be written ({})", file.string(), std::strerror(errno)));
  }
  partial.commit();
}

void ResultsTable::write_sqlite(const std::filesystem::path& file) const {
  PartialFile partial(file);
  {
    Database database(partial.path());
    // The file gets its name when it is complete, so it needs no journal.
    database.execute("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; BEGIN");
    const std::vector<std::string> names = header();
    std::vector<std::string> columns, marks;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const bool is_metric = i >= names.size() - metrics_.size();
      columns.push_back(quoted_name(names[i]) + (is_metric ? " REAL" : ""));
      marks.emplace_back("?");
    }
    database.execute(fmt::format("CREATE TABLE results ({})", fmt::join(columns, ", ")));
    sqlite3_stmt* made = nullptr;
    const std::string insert =
        fmt::format("INSERT INTO results VALUES ({})", fmt::join(marks, ", "));
    if (sqlite3_prepare_v2(database.get(), insert.c_str(), -1, &made, nullptr) != SQLITE_OK) {
      database.fail();
    }
    const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement(made, sqlite3_finalize);
    for (std::size_t point = 0; point < index_.points(); ++point) {
      if (!index_.has(point)) continue;
      const PointResult result = index_.read(point);
      const std::vector<std::string> cells = head(result);
      sqlite3_clear_bindings(made);
      int column = 0;
      for (const std::string& cell : cells) {
        ++column;
        if (cell.empty()) continue;
        double number = 0.0;
        const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
        const bool is_number = names[static_cast<std::size_t>(column - 1)] != "point" &&
                               names[static_cast<std::size_t>(column - 1)] != "state_hash" &&
                               error == std::errc() && end == cell.data() + cell.size();
        if (is_number && names[static_cast<std::size_t>(column - 1)] == "seed") {
          sqlite3_bind_int64(made, column, std::stoll(cell));  // a double cannot hold all of them
        } else if (is_number) {
          sqlite3_bind_double(made, column, number);
        } else {
          sqlite3_bind_text(made, column, cell.data(), static_cast<int>(cell.size()),
                            SQLITE_TRANSIENT);
        }
      }
      for (const auto& [name, value] : result.metrics) {
        sqlite3_bind_double(made, static_cast<int>(cells.size() + columns_.at(name)) + 1, value);
      }
      if (sqlite3_step(made) != SQLITE_DONE) database.fail();
      sqlite3_reset(made);
    }
    database.execute("COMMIT");
  }
  partial.commit();
}

namespace {

constexpr std::size_t kMostInALine = 4;  // metrics in a line

// Counts for each metric the complete runs of each candidate that have it.
class MetricCounts {
 public:
  explicit MetricCounts(const Plan& plan) : plan_(plan), complete_(plan.candidates().size()) {}

  void add(const PointResult& run) {
    if (run.status != PointStatus::complete) return;
    const std::size_t candidate = run.number % complete_.size();
    ++complete_[candidate];
    for (const auto& [name, value] : run.metrics) {
      counts_.try_emplace(name, complete_.size()).first->second[candidate]++;
    }
  }

  // Metrics that are missing in the same runs share a line.
  std::vector<std::string> lines() const {
    std::map<std::string, std::vector<std::string>> metrics;
    for (const auto& [name, counts] : counts_) {
      const std::string where = missing(counts);
      if (!where.empty()) metrics[where].push_back(name);
    }
    std::vector<std::string> lines;
    for (auto& [where, names] : metrics) {
      const std::size_t more = names.size() > kMostInALine ? names.size() - kMostInALine : 0;
      names.resize(names.size() - more);
      lines.push_back(fmt::format("{}{} missing: in {}", fmt::join(names, ", "),
                                  more > 0 ? fmt::format(" and {} more are", more)
                                           : std::string(names.size() > 1 ? " are" : " is"),
                                  where));
    }
    return lines;
  }

 private:
  // A text such as "12 of 40 complete runs of hpfc-2N"; empty if the metric is in no run.
  std::string missing(const std::vector<std::size_t>& counts) const {
    std::vector<std::string> parts;
    for (std::size_t c = 0; c < counts.size(); ++c) {
      // A metric that no run of a candidate has does not apply to it.
      if (counts[c] == 0 || counts[c] == complete_[c]) continue;
      parts.push_back(fmt::format("{} of {} complete runs of {}", complete_[c] - counts[c],
                                  complete_[c], plan_.candidates()[c].label));
    }
    if (parts.size() > kMostInALine) {
      const std::size_t more = parts.size() - kMostInALine;
      parts.resize(kMostInALine);
      parts.push_back(fmt::format("of {} more candidates", more));
    }
    return fmt::format("{}", fmt::join(parts, ", "));
  }

  const Plan& plan_;
  std::vector<std::size_t> complete_;
  std::map<std::string, std::vector<std::size_t>> counts_;
};

// Checks whether all seeds of every sample and candidate gave the same run.
class SeedEffect {
 public:
  explicit SeedEffect(const Plan& plan) : plan_(plan), first_(plan.candidates().size()) {}

  // Adds a run, in the order of the points.
  void add(const PointResult& run) {
    const std::size_t world = run.number / first_.size();
    auto& first = first_[run.number % first_.size()];
    const std::size_t sample = world / plan_.seeds();
    if (!first || first->first != sample) {
      first.emplace(sample, run);
      return;
    }
    ++pairs_;
    differs_ = differs_ || !are_same_run(run, first->second);
  }
  bool is_none() const { return pairs_ > 0 && !differs_; }

 private:
  const Plan& plan_;
  // Per candidate: a sample and its first run.
  std::vector<std::optional<std::pair<std::size_t, PointResult>>> first_;
  std::size_t pairs_ = 0;
  bool differs_ = false;
};

}  // namespace

bool are_same_run(const PointResult& one, const PointResult& other) {
  return one.state_hash == other.state_hash && one.metrics == other.metrics;
}

std::vector<std::string> notes(const Plan& plan, const ShardIndex& index) {
  MetricCounts metrics(plan);
  SeedEffect seeds(plan);
  for (std::size_t point = 0; point < index.points(); ++point) {
    if (!index.has(point)) continue;
    const PointResult run = index.read(point);
    metrics.add(run);
    if (run.status == PointStatus::complete) seeds.add(run);
  }
  std::vector<std::string> lines = metrics.lines();
  if (plan.seeds() == 1 && !plan.study().goals.empty()) {
    lines.emplace_back("seeds: one, so any noise is one draw of it (--dry-run looks for noise)");
  }
  if (seeds.is_none()) {
    lines.push_back(
        fmt::format("seeds: the {} of each sample gave the same run: {}", plan.seeds(), kNoNoise));
  }
  return lines;
}

}  // namespace breakwater
