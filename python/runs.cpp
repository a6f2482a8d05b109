#include "module.h"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/config/config.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/program/program.h>
#include <breakwater/shell/did_you_mean.h>
#include "arrays.h"
#include "interpreter.h"
#include "parts.h"

namespace breakwater::python {
namespace {
namespace fs = std::filesystem;

// A run made by this process.
struct OwnRun {
  PreparedRun prepared;
  ModelHashes models;
  Recording recording;
  double wall_s = 0.0;
};

// A run's folder. Its signals are read by one thread at a time.
struct FolderRun : SavedRun {
  using SavedRun::SavedRun;
  Turn turn;
};

// The caller lacks the interpreter's lock. Debian's HDF5 is thread-safe: h5py may use it meanwhile.
void write(const OwnRun& own, RunFolder& folder, LogStream* stream = nullptr) {
  write_run(own.prepared, own.models, own.recording, own.wall_s, folder, false, stream);
}

OwnRun run(const std::string& scenario_or_file, const std::optional<std::string>& case_name,
           const std::optional<std::string>& other_config, std::vector<std::string> sets,
           const py::object& controller, const py::object& estimator, const py::dict& controllers,
           const py::dict& estimators, const std::optional<std::string>& out) {
  const PythonParts parts(shipped_parts(), controller, estimator, controllers, estimators);
  OwnRun own;
  std::optional<RunFolder> folder;
  std::unique_ptr<LogStream> stream;
  std::string scenario = scenario_or_file;
  std::optional<std::string> config = other_config;
  if (is_scenario_file(scenario) && !config) {
    config = scenario;
    scenario = scenario_name_in(parts.catalogue(), *config);
  }
  {
    const Unlocked unlocked;
    const auto start = std::chrono::steady_clock::now();
    for (std::string& choice : parts.choices(scenario)) sets.push_back(std::move(choice));
    const auto read =
        parts.catalogue().get<ScenarioKind>(scenario).scenario_file(config.value_or(""));
    const ScenarioFile& file = *read;
    const std::string chosen = case_name ? *case_name : file.default_case();
    parts.check_axes(file.config(chosen).names_in("axis"));
    own.prepared = prepare_run(parts.catalogue(), scenario, file, chosen, sets);
    if (out) folder.emplace(*out);
    own.models = model_hashes(own.prepared.model_files);
    if (folder) stream = make_log_stream(own.prepared, own.models, *folder);
    own.recording =
        own.prepared.scenario->run({.progress = [](double /*fraction_done*/) { obey_signals(); },
                                    .stop = &is_ending(),
                                    .stream = stream.get()});
    own.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (folder) write(own, *folder, stream.get());
  }
  return own;
}

// Warnings as on the command line. Keys of a replaced part are reported only if they are in `set`,
// not if they are from the case.
std::vector<std::string> warnings(const OwnRun& own, bool has_python_parts) {
  std::vector<std::string> lines;
  for (const IneffectiveKey& ineffective : own.prepared.ineffective) {
    const bool is_set = ineffective.origin == "--set";
    if (has_python_parts && !is_set) continue;
    lines.push_back(fmt::format("{}: {}: {}", is_set ? "set" : ineffective.origin, ineffective.key,
                                ineffective.reason));
  }
  for (const std::string& warning : own.prepared.scenario->warnings()) lines.push_back(warning);
  lines.insert(lines.end(), own.recording.warnings.begin(), own.recording.warnings.end());
  return lines;
}

py::dict dict_of(const std::vector<Metric>& metrics) {
  py::dict values;
  for (const Metric& metric : metrics) values[py::str(metric.name)] = metric.value;
  return values;
}

py::dict reasons_of(const std::vector<AbsentMetric>& absent) {
  py::dict reasons;
  for (const AbsentMetric& metric : absent) reasons[py::str(metric.name)] = metric.reason;
  return reasons;
}

py::object failure_of(const std::optional<Failure>& failure) {
  if (!failure) return py::none();
  return py::make_tuple(failure->time_s, failure->reason);
}

// (group, name, unit, description, width) of each signal, without time bases.
py::list signals_of(const Recording& recording) {
  py::list list;
  for (const Track& track : recording.tracks) {
    for (std::size_t i = 0; i < track.signals(); ++i) {
      const Signal& signal = track.signal(i);
      list.append(py::make_tuple(track.name(), signal.name, signal.unit, signal.description,
                                 signal.values.size()));
    }
  }
  return list;
}

// The rows of one signal of a track, in place.
py::array array_of(const py::object& self, const std::string& group, const std::string& name) {
  constexpr auto kSize = static_cast<py::ssize_t>(sizeof(double));
  const Track& track = self.cast<const OwnRun&>().recording.track(group);
  std::size_t column = 0;
  std::size_t width = 1;
  if (name != "time_s") {
    column = 1;
    std::size_t i = 0;
    while (i < track.signals() && track.signal(i).name != name) {
      column += track.signal(i++).values.size();
    }
    if (i == track.signals()) throw py::key_error(group + "/" + name);
    width = track.signal(i).values.size();
  }
  const auto rows = static_cast<py::ssize_t>(track.rows());
  if (rows == 0) {
    std::vector<py::ssize_t> shape = {0};
    if (width > 1) shape.push_back(static_cast<py::ssize_t>(width));
    return py::array_t<double>(shape);
  }
  const auto stride = static_cast<py::ssize_t>(track.row(0).size()) * kSize;
  const double* const data = track.row(0).data() + column;
  if (width == 1) return view_of(data, {rows}, {stride}, self);
  return view_of(data, {rows, static_cast<py::ssize_t>(width)}, {stride, kSize}, self);
}

void save(const OwnRun& own, const std::string& folder) {
  const Unlocked unlocked;
  RunFolder target(folder);
  write(own, target);
}

py::array array_of_saved(const py::object& self, const std::string& path) {
  constexpr auto kSize = static_cast<py::ssize_t>(sizeof(double));
  const LoggedSignal& signal = [&]() -> const LoggedSignal& {
    auto& run = self.cast<FolderRun&>();
    const std::lock_guard lock(run.turn);
    const Unlocked unlocked;
    return run.dataset(path);
  }();
  const auto rows = static_cast<py::ssize_t>(signal.rows);
  const auto width = static_cast<py::ssize_t>(signal.width);
  if (width == 1) return view_of(signal.values.data(), {rows}, {kSize}, self);
  return view_of(signal.values.data(), {rows, width}, {width * kSize, kSize}, self);
}

py::list signals_of(const SavedRun& run) {
  py::list list;
  for (const LogEntry& entry : run.signals()) {
    list.append(
        py::make_tuple(entry.group, entry.name, entry.unit, entry.description, entry.width));
  }
  return list;
}

}  // namespace

void bind_runs(py::module_& module) {
  bind_class<OwnRun>(module, "OwnRun")
      .def_property_readonly("scenario",
                             [](const OwnRun& own) { return own.prepared.scenario->name(); })
      .def_property_readonly("case", [](const OwnRun& own) { return own.prepared.case_name; })
      .def_property_readonly("config_text",
                             [](const OwnRun& own) { return own.prepared.config_text; })
      .def_property_readonly("metrics",
                             [](const OwnRun& own) { return dict_of(own.recording.metrics); })
      .def_property_readonly("absent",
                             [](const OwnRun& own) { return reasons_of(own.recording.absent); })
      .def_property_readonly("costs",
                             [](const OwnRun& own) { return dict_of(own.recording.costs); })
      .def_property_readonly("failure",
                             [](const OwnRun& own) { return failure_of(own.recording.failure); })
      .def_property_readonly(
          "state_hash",
          [](const OwnRun& own) { return fmt::format("{:016x}", own.recording.state_hash); })
      .def_property_readonly("signals", [](const OwnRun& own) { return signals_of(own.recording); })
      .def_property_readonly("is_cut", [](const OwnRun&) { return false; })
      .def_property_readonly(
          "is_streamed",
          [](const OwnRun& own) { return own.recording.tracks.front().is_streamed(); })
      .def("warnings", warnings)
      .def(
          "array",
          [](const py::object& self, const std::string& group, const std::string& name) {
            return array_of(self, group, name);
          },
          OwnCall())
      .def("save", save, OwnCall());
  module.def("run", run, OwnCall());

  bind_class<FolderRun>(module, "SavedRun")
      .def(py::init([](const fs::path& folder) {
             const Unlocked unlocked;
             return std::make_unique<FolderRun>(folder);
           }),
           OwnCall())
      .def_property_readonly("scenario", &FolderRun::scenario)
      .def_property_readonly("case", &FolderRun::case_name)
      .def_property_readonly("config_text", &FolderRun::config_text)
      .def_property_readonly("metrics", [](const FolderRun& run) { return dict_of(run.metrics()); })
      .def_property_readonly("absent",
                             [](const FolderRun& run) { return reasons_of(run.absent()); })
      .def_property_readonly("failure",
                             [](const FolderRun& run) { return failure_of(run.failure()); })
      .def_property_readonly("state_hash", &FolderRun::state_hash)
      .def_property_readonly("signals", [](const FolderRun& run) { return signals_of(run); })
      .def_property_readonly(
          "is_cut", [](const FolderRun& run) { return run.failure() && run.failure()->is_cut; })
      .def_property_readonly("notes", &FolderRun::notes)
      .def_property_readonly("warnings", &FolderRun::warnings)
      .def(
          "array",
          [](const py::object& self, const std::string& group, const std::string& name) {
            return array_of_saved(self, group + "/" + name);
          },
          OwnCall());

  module.def("did_you_mean", did_you_mean);
  module.def("scenarios", [] {
    py::dict summaries;
    for (const ScenarioKind& kind : shipped_parts().all<ScenarioKind>()) {
      summaries[py::str(kind.name)] = kind.make(shipped_parts())->summary();
    }
    return summaries;
  });
  module.def("cases", [](const std::string& scenario) {
    return shipped_parts().get<ScenarioKind>(scenario).scenario_file()->cases();
  });
}

}  // namespace breakwater::python
