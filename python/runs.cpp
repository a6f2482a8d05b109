#include "module.h"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

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
#include "interpreter.h"
#include "parts.h"

namespace breakwater::python {
namespace {
namespace fs = std::filesystem;

std::string file_of(const std::string& word) {
  return is_scenario_file(word) ? word : "";
}

// A run made by this process, with what its folder would tell.
struct OwnRun : EndedRun {
  PreparedRun prepared;

  std::string scenario() const { return prepared.scenario->name(); }
  const std::string& case_name() const { return prepared.case_name; }
  const std::string& config_text() const { return prepared.config_text; }
  std::string state_hash() const { return fmt::format("{:016x}", recording.state_hash); }
  const std::optional<Failure>& failure() const { return recording.failure; }
  const std::vector<Metric>& metrics() const { return recording.metrics; }
  const std::vector<AbsentMetric>& absent() const { return recording.absent; }
  std::vector<LogEntry> signals() const {
    std::vector<LogEntry> all;
    for (const Track& track : recording.tracks) {
      const auto own = datasets_of(track, track.rows());
      all.insert(all.end(), own.begin() + 1, own.end());  // without the time base
    }
    return all;
  }
};

// A run's folder. Its signals are read by one thread at a time.
struct FolderRun : SavedRun {
  using SavedRun::SavedRun;
  std::mutex mutex;
};

// The caller lacks the interpreter's lock. Debian's HDF5 is thread-safe: h5py may use it meanwhile.
void save(const OwnRun& own, const std::string& target) {
  RunFolder folder(target);
  write_run(own.prepared, own, folder);
}

OwnRun run(const std::string& word, const std::optional<std::string>& case_name,
           const std::optional<std::string>& config, std::vector<std::string> sets,
           const py::tuple& of_python, const std::optional<std::string>& out) {
  const PythonParts parts(of_python);
  std::optional<RunFolder> folder;
  OwnRun own;
  const Unlocked unlocked;
  const std::string scenario = config ? word : scenario_of(word);
  for (std::string& choice : parts.choices(scenario)) sets.push_back(std::move(choice));
  const auto file =
      parts.catalogue().get<ScenarioKind>(scenario).scenario_file(config ? *config : file_of(word));
  const std::string chosen = case_name ? *case_name : file->default_case();
  own.prepared = prepare_run(parts.catalogue(), scenario, *file, chosen, sets);
  if (out) folder.emplace(*out);
  static_cast<EndedRun&>(own) =
      run_to_end(own.prepared, model_hashes(own.prepared.model_files),
                 {.progress = [](double /*fraction_done*/) { obey_signals(); }, .stop = &is_ending},
                 folder ? &*folder : nullptr);
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

// The facts that both kinds of runs have. A signal has (group, name, unit, description, width).
template <typename Run>
py::dict facts(const Run& run) {
  py::dict metrics;
  for (const Metric& metric : run.metrics()) metrics[py::str(metric.name)] = metric.value;
  py::dict absent;
  for (const AbsentMetric& metric : run.absent()) absent[py::str(metric.name)] = metric.reason;
  py::list signals;
  for (const LogEntry& one : run.signals()) {
    signals.append(py::make_tuple(one.group, one.name, one.unit, one.description, one.width));
  }
  py::object end = py::none();
  const std::optional<Failure>& failure = run.failure();
  if (failure) end = py::make_tuple(failure->time_s, failure->reason);
  return py::dict(py::arg("scenario") = run.scenario(), py::arg("case") = run.case_name(),
                  py::arg("config_text") = run.config_text(),
                  py::arg("state_hash") = run.state_hash(), py::arg("metrics") = metrics,
                  py::arg("absent") = absent, py::arg("signals") = signals,
                  py::arg("failure") = end, py::arg("is_cut") = failure && failure->is_cut);
}

// A read-only view of rows × width values without a copy. It keeps `owner`, which has them, alive.
py::array view_of(const double* data, std::size_t rows, std::size_t width,
                  const py::object& owner) {
  py::array view(py::dtype::of<double>(), {rows, width}, data, owner);
  py::detail::array_proxy(view.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

// The rows of one signal of a track, in place. Python has checked its name.
py::array array_of_own(const py::object& self, const std::string& group, const std::string& name) {
  const Track& track = self.cast<const OwnRun&>().recording.track(group);
  for (std::size_t i = 0; i < track.signals(); ++i) {
    if (track.signal(i).name != name) continue;
    return view_of(track.values(i).data(), track.rows(), track.signal(i).values.size(), self);
  }
  return view_of(track.times().data(), track.rows(), 1, self);
}

py::array array_of_saved(const py::object& self, const std::string& group,
                         const std::string& name) {
  const LoggedSignal& signal = [&]() -> const LoggedSignal& {
    auto& run = self.cast<FolderRun&>();
    const Unlocked unlocked;
    const std::lock_guard lock(run.mutex);
    return run.dataset(group + "/" + name);
  }();
  return view_of(signal.values.data(), signal.rows, signal.width, self);
}

}  // namespace

void bind_runs(py::module_& module) {
  py::class_<OwnRun>(module, "OwnRun")
      .def_property_readonly("facts", facts<OwnRun>)
      .def_property_readonly(
          "is_streamed",
          [](const OwnRun& own) { return own.recording.tracks.front().is_streamed(); })
      .def("warnings", warnings)
      .def("array", array_of_own, OwnCall())
      .def("save", save, Apart());
  module.def("run", run, OwnCall());

  py::class_<FolderRun>(module, "SavedRun")
      .def(py::init([](const fs::path& folder) {
             const Unlocked unlocked;
             return std::make_unique<FolderRun>(folder);
           }),
           OwnCall())
      .def_property_readonly("facts", facts<FolderRun>)
      .def_property_readonly("notes", &FolderRun::notes)
      .def_property_readonly("warnings", &FolderRun::warnings)
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
  module.def("cases", [](const std::string& word) {
    const auto& kind = shipped_parts().get<ScenarioKind>(scenario_of(word));
    return kind.scenario_file(file_of(word))->cases();
  });
}

}  // namespace breakwater::python
