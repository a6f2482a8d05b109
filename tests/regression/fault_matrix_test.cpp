// Every kind of sensor fault in every case. A run is complete, or fails with time and reason within
// one control step of its first value that is not finite. BREAKWATER_FAULTS=DIR runs the whole
// matrix and writes the effects to DIR/SCENARIO.csv.
#include <fmt/format.h>

#include <breakwater/shell/all_cores.h>
#include "regression/run_case.h"
#include "tables.h"

namespace breakwater::fault_matrix_test {

struct Place {
  std::string scenario;
  std::vector<std::string> sensors;
  double period_s;  // T_s
  double at_s;
  std::vector<std::string> sets;
  double size;   // size of a bias, and of the smallest step of a stuck quantiser
  double spike;  // about the range of the motion
};

const std::vector<Place>& places() {
  static const std::vector<Place> all = [] {
    std::vector<Place> read;
    for (const auto& row : testing::rows_of("FaultPlaces")) {
      read.push_back({row.at(0), testing::words_in(row.at(1)), std::stod(row.at(2)),
                      std::stod(row.at(3)), testing::words_in(row.at(4)), std::stod(row.at(5)),
                      std::stod(row.at(6))});
    }
    return read;
  }();
  return all;
}

// The size of a force channel is in newtons.
double scale_of(const std::string& sensor) {
  return sensor.starts_with("force") ? 100.0 : 1.0;
}

struct Fault {
  std::string name;
  std::string kind;
  double lasts_s;      // 0: one sample
  double spike = 0.0;  // in place of the size, in units of Place::spike
  int delay_samples = 1;
  bool drops = false;  // sensor.nan_policy
};

const std::vector<Fault>& faults() {
  static const std::vector<Fault> all = [] {
    std::vector<Fault> read;
    for (const auto& row : testing::rows_of("Faults")) {
      read.push_back({row.at(0), row.at(1), std::stod(row.at(2)), std::stod(row.at(3)),
                      std::stoi(row.at(4)), row.at(5) == "drop"});
    }
    return read;
  }();
  return all;
}

std::vector<std::string> sets_of(const Place& place, const std::string& sensor,
                                 const Fault& fault) {
  std::vector<std::string> sets = place.sets;
  sets.push_back("fault.sensor=" + sensor);
  sets.push_back(fmt::format("fault.at_s={}", place.at_s));
  sets.push_back("fault.kind=" + fault.kind);
  if (fault.kind != "dropped") {
    sets.push_back(
        fmt::format("fault.samples={}", std::max(1L, std::lround(fault.lasts_s / place.period_s))));
  }
  if (fault.kind == "delay") {
    sets.push_back(fmt::format("fault.delay_samples={}", fault.delay_samples));
  }
  if (fault.kind == "spike" || fault.kind == "bias" || fault.kind == "stuck") {
    const double size = fault.spike > 0.0 ? fault.spike * place.spike : place.size;
    sets.push_back(fmt::format("fault.size={}", size * scale_of(sensor)));
  }
  if (fault.drops) sets.emplace_back("sensor.nan_policy=drop");
  return sets;
}

// The time of the first value that is not finite and is finite without the fault.
std::optional<double> first_not_finite(const Recording& run, const Recording& whole) {
  std::optional<double> first;
  for (const Track& track : run.tracks) {
    const Track& other = whole.track(track.name());
    for (std::size_t i = 0; i < track.signals(); ++i) {
      // The residual of a program that the solver reports as not solved may be infinite.
      if (track.signal(i).name == "qp_kkt_residual") continue;
      const std::span<const double> values = track.values(i);
      const std::span<const double> same = other.values(i);
      for (std::size_t k = 0; k < std::min(values.size(), same.size()); ++k) {
        if (std::isfinite(values[k]) || !std::isfinite(same[k])) continue;
        const double time_s = track.times()[k * track.rows() / values.size()];
        if (!first || time_s < *first) first = time_s;
        break;
      }
    }
  }
  return first;
}

// The largest rms difference of a value of these signals in the last fifth of the run. It is
// relative to the value's range without the fault.
double deviation(const Recording& run, const Recording& whole,
                 const std::vector<std::string>& endings) {
  const Track& a = run.track("control");
  const Track& b = whole.track("control");
  const std::size_t rows = std::min(a.rows(), b.rows());
  double largest = 0.0;
  for (std::size_t i = 0; i < a.signals(); ++i) {
    const std::string& name = a.signal(i).name;
    const bool counts = std::any_of(endings.begin(), endings.end(), [&](const auto& ending) {
      return name.find(ending) != std::string::npos;
    });
    if (!counts) continue;
    const std::span<const double> values = a.values(i);
    const std::span<const double> same = b.values(i);
    const std::size_t width = same.size() / b.rows();
    for (std::size_t column = 0; column < width; ++column) {
      double low = std::numeric_limits<double>::infinity();
      double high = -low;
      double squares = 0.0;
      for (std::size_t k = 0; k < rows; ++k) {
        const double value = same[k * width + column];
        low = std::min(low, value);
        high = std::max(high, value);
        if (5 * k < 4 * rows) continue;
        squares += std::pow(values[k * width + column] - value, 2);
      }
      const double rms = std::sqrt(squares / (0.2 * static_cast<double>(rows)));
      if (high - low > 1e-6) largest = std::max(largest, rms / (high - low));
    }
  }
  return largest;
}

// One letter: f failed, m the motion is another, e the estimate of the disturbance is another.
// Anything else that happens is a failure of the test.
char effect(const Place& place, const std::string& case_name, const std::string& sensor,
            const Fault& fault, const Recording& whole, std::string& complaint) {
  constexpr double kSmall = 0.05;
  Recording run;
  try {
    run = testing::run_case(place.scenario, case_name, sets_of(place, sensor, fault));
  } catch (const std::exception& error) {
    complaint = fmt::format("throws: {}", error.what());
    return '!';
  }
  const std::optional<double> bad_s = first_not_finite(run, whole);
  const double sample_s = 1.001 * place.period_s;
  const bool is_refused = fault.kind == "infinity" || (fault.kind == "nan" && !fault.drops);
  if (run.failure) {
    const Failure& failure = *run.failure;
    if (failure.reason.empty()) complaint = "fails without a reason";
    if (failure.time_s < place.at_s - sample_s) complaint = "fails before the fault";
    if (bad_s && failure.time_s > *bad_s + sample_s) {
      complaint = fmt::format("is not finite at {} s, and fails at {} s", *bad_s, failure.time_s);
    }
    if (is_refused && failure.time_s > place.at_s + sample_s) complaint = "fails too late";
    return complaint.empty() ? 'f' : '!';
  }
  if (bad_s) complaint = fmt::format("is complete, and not finite at {} s", *bad_s);
  if (is_refused) complaint = "is complete with a measurement that is not finite";
  if (!complaint.empty()) return '!';
  if (deviation(run, whole, {"position_true", "q_true", "motion_true"}) > kSmall) return 'm';
  return deviation(run, whole, {"d_hat_N", "force_estimate"}) > kSmall ? 'e' : '.';
}

struct Row {
  const Place* place;
  std::string case_name;
  std::string cells;       // cells of a CSV file
  std::string complaints;  // one line each
  int runs = 0;
};

void fill(Row& row, bool all_sensors) {
  const Recording whole = testing::run_case(row.place->scenario, row.case_name, row.place->sets);
  if (whole.failure) {
    row.complaints = "fails without a fault: " + whole.failure->reason + "\n";
    return;
  }
  for (const Fault& fault : faults()) {
    row.cells += ',';
    for (const std::string& sensor : row.place->sensors) {
      if (!all_sensors && sensor != row.place->sensors.back()) continue;
      std::string complaint;
      row.cells += effect(*row.place, row.case_name, sensor, fault, whole, complaint);
      ++row.runs;
      if (complaint.empty()) continue;
      row.complaints += sensor + ", " + fault.name + ": " + complaint + "\n";
    }
  }
}

class SensorFaults : public ::testing::TestWithParam<Place> {};

TEST_P(SensorFaults, EveryRunIsCompleteOrFailsAtOnce) {
  const char* const folder = std::getenv("BREAKWATER_FAULTS");
  ASSERT_TRUE(folder == nullptr || std::filesystem::is_directory(folder)) << folder;
  const Place& place = GetParam();
  std::vector<Row> rows;
  const std::vector<std::string> cases = testing::scenario_file(place.scenario).cases();
  for (const std::string& name : cases) {
    rows.push_back({&place, name, "", ""});
    if (folder == nullptr) break;
  }
  on_all_cores(rows.size(), [&](std::size_t i) { fill(rows[i], folder != nullptr); });

  std::string table = "scenario,case,sensors";
  for (const Fault& fault : faults()) table += "," + fault.name;
  table += "\n";
  int runs = 0;
  for (const Row& row : rows) {
    EXPECT_EQ(row.complaints, "") << row.case_name;
    table += fmt::format("{},{},{}{}\n", place.scenario, row.case_name,
                         fmt::join(place.sensors, " "), row.cells);
    runs += row.runs;
  }
  fmt::print("{} runs with a fault\n", runs);
  if (folder == nullptr) return;
  std::ofstream file(folder + ("/" + place.scenario) + ".csv");
  EXPECT_TRUE(file << table) << "BREAKWATER_FAULTS: " << folder << " cannot be written";
}

INSTANTIATE_TEST_SUITE_P(Faults, SensorFaults, ::testing::ValuesIn(places()),
                         [](const auto& place) { return place.param.scenario; });

}  // namespace breakwater::fault_matrix_test
