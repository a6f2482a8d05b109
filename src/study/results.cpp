#include <breakwater/study/results.h>

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <set>

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

std::vector<std::string> metrics_of(const ShardIndex& index) {
  std::vector<std::string> metrics;
  std::set<std::string> known;
  for (std::size_t point = 0; point < index.points(); ++point) {
    if (!index.has(point)) continue;
    for (const auto& [name, value] : index.read(point).metrics) {
      if (known.insert(name).second) metrics.push_back(name);
    }
  }
  return metrics;
}

ResultsTable::ResultsTable(const Plan& plan, const ShardIndex& index)
    : plan_(plan), index_(index), metrics_(metrics_of(index)) {
  for (std::size_t i = 0; i < metrics_.size(); ++i) columns_.emplace(metrics_[i], i);
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

// "12 of 40 complete runs of hpfc-2N" for each candidate of which only some runs have a metric. One
// that no run of a candidate has does not apply to it.
std::string missing(const Plan& plan, const std::vector<std::size_t>& counts,
                    const std::vector<std::size_t>& complete) {
  std::vector<std::string> parts;
  for (std::size_t c = 0; c < counts.size(); ++c) {
    if (counts[c] == 0 || counts[c] == complete[c]) continue;
    parts.push_back(fmt::format("{} of {} complete runs of {}", complete[c] - counts[c],
                                complete[c], plan.candidates()[c].label));
  }
  const std::size_t more = parts.size() - std::min(parts.size(), kMostInALine);
  parts.resize(parts.size() - more);
  if (more > 0) parts.push_back(fmt::format("of {} more candidates", more));
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

bool are_same_run(const PointResult& one, const PointResult& other) {
  return one.state_hash == other.state_hash && one.metrics == other.metrics;
}

std::vector<std::string> notes(const Plan& plan, const ShardIndex& index) {
  const std::size_t candidates = plan.candidates().size();
  std::vector<std::size_t> complete(candidates);
  std::map<std::string, std::vector<std::size_t>> counts;  // the runs with each metric
  std::vector<std::optional<PointResult>> first(
      candidates);  // in the last sample of each candidate
  const auto sample_of = [&](const PointResult& run) {
    return run.number / candidates / plan.seeds();
  };
  std::size_t pairs = 0, different = 0;
  for (std::size_t point = 0; point < index.points(); ++point) {
    if (!index.has(point) || index.status(point) != PointStatus::complete) continue;
    const PointResult run = index.read(point);
    const std::size_t candidate = point % candidates;
    ++complete[candidate];
    for (const auto& [name, value] : run.metrics) {
      ++counts.try_emplace(name, candidates).first->second[candidate];
    }
    std::optional<PointResult>& other = first[candidate];
    if (!other || sample_of(*other) != sample_of(run)) {
      other = run;
      continue;
    }
    ++pairs;
    different += are_same_run(run, *other) ? 0 : 1;
  }
  // Metrics that are missing in the same runs share a line.
  std::map<std::string, std::vector<std::string>> metrics;
  for (const auto& [name, of_candidates] : counts) {
    const std::string where = missing(plan, of_candidates, complete);
    if (!where.empty()) metrics[where].push_back(name);
  }
  std::vector<std::string> lines;
  for (auto& [where, names] : metrics) {
    const std::size_t more = names.size() - std::min(names.size(), kMostInALine);
    names.resize(names.size() - more);
    lines.push_back(fmt::format("{}{} missing: in {}", fmt::join(names, ", "),
                                more > 0           ? fmt::format(" and {} more are", more)
                                : names.size() > 1 ? " are"
                                                   : " is",
                                where));
  }
  if (plan.seeds() == 1 && !plan.study().goals.empty()) {
    lines.emplace_back("seeds: one, so any noise is one draw of it (--dry-run looks for noise)");
  }
  if (pairs > 0 && different == 0) {
    lines.push_back(
        fmt::format("seeds: the {} of each sample gave the same run: {}", plan.seeds(), kNoNoise));
  }
  return lines;
}

}  // namespace breakwater
