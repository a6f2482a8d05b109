// Tables of numbers: exact ones, those of a laboratory (`estimate`, `identify`), functions of time
// (disturbances, references, walls) and the force of `compare --measured`.
#include <algorithm>
#include <cmath>

#include <breakwater/config/column_table.h>
#include <breakwater/pages/impact_pulse.h>
#include <breakwater/recorded/encoder_quantum.h>
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

void read_force(const std::string& text) {
  const Series force = read_measured_force(fuzz::file_with(text));
  const ImpactPulse pulse = first_pulse(force);
  fuzz::require(pulse.begin_s >= force.times_s.front() && pulse.begin_s <= force.times_s.back(),
                "a contact begins in the record");
  fuzz::require(pulse.peak_N > 0.0 && pulse.duration_s.value_or(0.0) >= 0.0,
                "a contact has a peak");
}

constexpr fuzz::Parser kParsers[] = {{'e', "exact", read_exact},
                                     {'r', "record", read_record},
                                     {'f', "function", read_time_function},
                                     {'m', "measured", read_force}};

}  // namespace
}  // namespace breakwater

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return breakwater::fuzz::run_selected(breakwater::kParsers, data, size);
}
