#include <breakwater/study/results.h>

#include <fmt/format.h>
#include <sqlite3.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <memory>

#include <breakwater/config/toml_text.h>
#include <breakwater/record/csv.h>
#include <breakwater/record/partial_file.h>

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

}  // namespace breakwater
