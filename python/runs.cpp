#include "module.h"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <breakwater/config/config.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/program/program.h>
#include <breakwater/shell/did_you_mean.h>
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
  std::mutex mutex;
};

// The caller lacks the interpreter's lock. Debian's HDF5 is thread-safe: h5py may use it meanwhile.
void write(const OwnRun& own, RunFolder& folder, LogStream* stream = nullptr) {
  write_run(own.prepared, own.models, own.recording, own.wall_s, folder, false, stream);
}

OwnRun run(const std::string& scenario_or_file, const std::optional<std::string>& case_name,
           const std::optional<std::string>& other_config, std::vector<std::string> sets,
           const py::tuple& of_python, const std::optional<std::string>& out) {
  const PythonParts parts(of_python);
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

// The facts that both kinds of runs have. `run` has metrics, the absent ones and the failure.
py::dict facts(const std::string& scenario, const std::string& case_name,
               const std::string& config_text, const std::string& state_hash,
               const std::vector<Metric>& metrics, const std::vector<AbsentMetric>& absent,
               const std::optional<Failure>& failure) {
  py::dict values;
  for (const Metric& metric : metrics) values[py::str(metric.name)] = metric.value;
  py::dict reasons;
  for (const AbsentMetric& metric : absent) reasons[py::str(metric.name)] = metric.reason;
  py::object end = py::none();
  if (failure) end = py::make_tuple(failure->time_s, failure->reason);
  return py::dict(py::arg("scenario") = scenario, py::arg("case") = case_name,
                  py::arg("config_text") = config_text, py::arg("state_hash") = state_hash,
                  py::arg("metrics") = values, py::arg("absent") = reasons,
                  py::arg("failure") = end, py::arg("is_cut") = failure && failure->is_cut);
}

// (group, name, unit, description, width) of each signal, without time bases.
using SignalFacts = std::tuple<std::string, std::string, std::string, std::string, std::size_t>;

py::dict facts_of_own(const OwnRun& own) {
  const Recording& all = own.recording;
  py::dict known =
      facts(own.prepared.scenario->name(), own.prepared.case_name, own.prepared.config_text,
            fmt::format("{:016x}", all.state_hash), all.metrics, all.absent, all.failure);
  std::vector<SignalFacts> list;
  for (const Track& track : all.tracks) {
    for (const Signal& signal : track.all_signals()) {
      list.emplace_back(track.name(), signal.name, signal.unit, signal.description,
                        signal.values.size());
    }
  }
  known["signals"] = list;
  known["is_streamed"] = all.tracks.front().is_streamed();
  return known;
}

py::dict facts_of_saved(const FolderRun& run) {
  py::dict known = facts(run.scenario(), run.case_name(), run.config_text(), run.state_hash(),
                         run.metrics(), run.absent(), run.failure());
  std::vector<SignalFacts> list;
  for (const LogEntry& entry : run.signals()) {
    list.emplace_back(entry.group, entry.name, entry.unit, entry.description, entry.width);
  }
  known["signals"] = list;
  known["notes"] = run.notes();
  known["warnings"] = run.warnings();
  return known;
}

// A read-only view of rows × width values without a copy. It keeps `owner`, which has them, alive.
py::array view_of(const double* data, std::size_t rows, std::size_t width, std::size_t row_values,
                  const py::object& owner) {
  py::array view(py::dtype::of<double>(), {rows, width},
                 {row_values * sizeof(double), sizeof(double)}, data, owner);
  py::detail::array_proxy(view.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

// The rows of one signal of a track, in place. Python has checked its name.
py::array array_of_own(const py::object& self, const std::string& group, const std::string& name) {
  const Track& track = self.cast<const OwnRun&>().recording.track(group);
  std::size_t column = 0;
  std::size_t width = 1;
  if (name != "time_s") {
    for (const Signal& signal : track.all_signals()) {
      column += width;
      width = signal.values.size();
      if (signal.name == name) break;
    }
  }
  if (track.rows() == 0) return py::array_t<double>(std::vector<std::size_t>{0, width});
  const std::span<const double> first = track.row(0);
  return view_of(&first[column], track.rows(), width, first.size(), self);
}

py::array array_of_saved(const py::object& self, const std::string& group,
                         const std::string& name) {
  const LoggedSignal& signal = [&]() -> const LoggedSignal& {
    auto& run = self.cast<FolderRun&>();
    const Unlocked unlocked;
    const std::lock_guard lock(run.mutex);
    return run.dataset(group + "/" + name);
  }();
  return view_of(signal.values.data(), signal.rows, signal.width, signal.width, self);
}

}  // namespace

void bind_runs(py::module_& module) {
  py::class_<OwnRun>(module, "OwnRun")
      .def_property_readonly("facts", facts_of_own)
      .def("warnings", warnings)
      .def("array", array_of_own, OwnCall())
      .def(
          "save",
          [](const OwnRun& own, const std::string& folder) {
            RunFolder target(folder);
            write(own, target);
          },
          Apart());
  module.def("run", run, OwnCall());

  py::class_<FolderRun>(module, "SavedRun")
      .def(py::init([](const fs::path& folder) {
             const Unlocked unlocked;
             return std::make_unique<FolderRun>(folder);
           }),
           OwnCall())
      .def_property_readonly("facts", facts_of_saved)
      .def("array", array_of_saved, OwnCall());

  module.def(
      "copy_run",
      [](const fs::path& folder, const std::string& copy) {
        RunFolder target(copy);
        std::error_code error;
        fs::copy(folder, target.path(), fs::copy_options::recursive, error);
        if (error) throw OutputError(copy + ": cannot be written (" + error.message() + ")");
        target.commit();
      },
      Apart());

  module.def("did_you_mean", did_you_mean);
  module.def("scenarios", [] {
    py::dict summaries;
    for (const ScenarioKind& kind : shipped_parts().all<ScenarioKind>()) {
      summaries[py::str(kind.name)] = kind.make(shipped_parts())->summary();
    }
    return summaries;
  });
  module.def("cases", [](const std::string& scenario) {
    const Catalogue& all = shipped_parts();
    const bool is_file = is_scenario_file(scenario);
    return all.get<ScenarioKind>(is_file ? scenario_name_in(all, scenario) : scenario)
        .scenario_file(is_file ? scenario : "")
        ->cases();
  });
}

}  // namespace breakwater::python
