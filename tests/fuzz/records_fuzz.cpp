// Tables of numbers: exact ones, those of a laboratory (`estimate`, `identify`), functions of time
// (disturbances, references, walls). Files of a run folder of unknown origin: manifest.json,
// metrics.json and log.h5.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include <breakwater/config/column_table.h>
#include <breakwater/experiment/run_manifest.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/record/run_folder.h>
#include <breakwater/recorded/recorded_axis.h>
#include "fuzz/input.h"

namespace breakwater {
namespace {

bool are_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

void read_exact(const std::string& text) {
  const std::string file = fuzz::file_with(text);
  const ColumnTable table = read_columns(file, {{"time_s"}, {"u", "csv.u"}, {"y"}});
  for (const auto& column : table.columns) {
    fuzz::require(column.size() == table.rows() && are_finite(column), "each row has each column");
  }
  check_rising(file, table, table.columns[0], "must rise");
}

void read_record(const std::string& text) {
  const RecordedAxis axis = read_recorded_axis(fuzz::file_with(text), {.time_scale = 1e-3});
  const std::size_t rows = axis.times_s.size();
  fuzz::require(rows >= 2 && axis.inputs.size() == rows && axis.positions.size() == rows,
                "each row has each column");
  fuzz::require(std::adjacent_find(axis.times_s.begin(), axis.times_s.end(),
                                   std::greater_equal<>()) == axis.times_s.end(),
                "times rise");
  fuzz::require(axis.input_times_s.size() == axis.all_inputs.size(), "each input has a time");
  timing_of(axis.times_s, 0.0, 1.5, 0.1);
  fuzz::require(!(encoder_quantum(axis.positions) < 0.0), "a quantum is not negative");
}

void read_time_function(const std::string& text) {
  const math::TableFunction function = read_function(fuzz::file_with(text), "value");
  for (const double time_s : {-1.0, 0.0, 0.5, 1e9}) function.at(time_s);
}

void read_run_manifest(const std::string& text) {
  static const std::string metrics = fuzz::folder().write("metrics.json", "{\"peak_N\": 1.5}");
  fuzz::folder().write("manifest.json", text);
  const bool is_run = is_run_folder(fuzz::folder().path());
  try {
    read_manifest(fuzz::folder().path());
    fuzz::require(is_run, "a run has a manifest");
  } catch (const std::invalid_argument&) {
    // it is damaged
  }
  check_file(fuzz::folder().path(), "log.h5");
}

void read_run_metrics(const std::string& text) {
  static const fuzz::Folder own;
  own.write("metrics.json", text);
  for (const Metric& metric : read_metrics(own.path())) {
    fuzz::require(std::isfinite(metric.value), "a metric is finite");
  }
}

// It is in a run folder, and a child process tries it first.
void read_log(const std::string& bytes) {
  static const fuzz::Folder folder;
  static const std::string files[] = {
      folder.write("config.toml", "scenario = \"s\"\n[case.c]\n"),
      folder.write("metrics.json", "{}"),
      folder.write(
          "manifest.json",
          R"({"scenario": "s", "case": "c", "seed": 1, "state_hash": "0", "status": "complete"})")};
  folder.write("log.h5", bytes);
  const SavedRun run(folder.path());
  for (const LogEntry& entry : run.signals()) {
    const std::string name = entry.group + "/" + entry.name;
    for (std::size_t i = 1; i <= std::min<std::size_t>(entry.width, 3); ++i) {
      const std::string one = entry.width == 1 ? name : name + "[" + std::to_string(i) + "]";
      try {
        run.unit(one);
        const Series series = run.signal(one);
        fuzz::require(series.times_s.size() == series.values.size(), "each value has a time");
      } catch (const std::invalid_argument&) {
        // its group has no times
      }
    }
  }
}

constexpr fuzz::Parser kParsers[] = {{'e', "exact", read_exact},
                                     {'r', "record", read_record},
                                     {'f', "function", read_time_function},
                                     {'a', "manifest", read_run_manifest},
                                     {'n', "metrics", read_run_metrics},
                                     {'l', "log", read_log}};

}  // namespace
}  // namespace breakwater

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return breakwater::fuzz::run_selected(breakwater::kParsers, data, size);
}
