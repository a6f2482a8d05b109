// Controllers and estimators written in Python, as parts of a catalogue.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>

namespace breakwater::python {
namespace py = pybind11;

/// The catalogue of the `breakwater` program.
const Catalogue& shipped_parts();

/// The scenario of a word: a name, or a scenario file.
std::string scenario_of(const std::string& word);

/// The shipped catalogue with (controller, estimator, controllers, estimators) of Python, as kinds
/// for every rig. The first two are objects or None, and their names are those of their classes.
/// The others are dicts with an object for each named axis of a plant, with the name CLASS_AXIS.
/// Throws std::invalid_argument if such a kind exists.
///
/// Each object has `update` and `reset`. Before a run is checked or made, the rig sets its
/// attribute `setup` and calls `signals()`. Its exceptions leave the run unchanged, but in a
/// program they become an OutputError of one line. A wrong return value is an
/// std::invalid_argument.
class PythonParts {
 public:
  explicit PythonParts(const py::tuple& parts);

  const Catalogue& catalogue() const { return catalogue_; }

  /// `KEY="NAME"` for each object. Throws std::invalid_argument if the scenario does not take one.
  std::vector<std::string> choices(const std::string& scenario) const;

 private:
  Catalogue catalogue_;
  std::string controller_;  // class names; empty: none
  std::string estimator_;
  std::vector<std::string> sets_of_axes_;
};

/// The parts of a process that is a program.
extern const PythonParts* parts_of_program;

}  // namespace breakwater::python
