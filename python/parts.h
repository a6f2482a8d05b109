// Controllers and estimators written in Python, as parts of a catalogue.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>

namespace breakwater::python {
namespace py = pybind11;

/// The catalogue of the `breakwater` program.
const Catalogue& shipped_parts();

/// An exception in Python passes through, or becomes an OutputError of one line, which ends a
/// program.
enum class PythonErrors { pass, one_line };

/// The catalogue with `controller` and `estimator`, each an object or None, as kinds for every rig.
/// Their names are those of their classes. `controllers` and `estimators` have an object for each
/// named axis of a plant, with the name CLASS_AXIS. Throws std::invalid_argument if such a kind
/// exists.
///
/// Each object has `update` and `reset`. Before a run is checked or made, the rig sets its
/// attribute `setup` and calls `signals()`. Its exceptions leave the run unchanged. A wrong return
/// value is an std::invalid_argument.
class PythonParts {
 public:
  PythonParts(const Catalogue& standard, const py::object& controller, const py::object& estimator,
              const py::dict& controllers, const py::dict& estimators,
              PythonErrors errors = PythonErrors::pass);

  const Catalogue& catalogue() const { return catalogue_; }

  /// Throws std::invalid_argument if an axis with an object is not among `names`.
  void check_axes(const std::vector<std::string>& names) const;

  /// `KEY="NAME"` for each object. Throws std::invalid_argument if the scenario does not take one.
  std::vector<std::string> choices(const std::string& scenario) const;

 private:
  Catalogue catalogue_;
  std::string controller_;  // class names; empty: none
  std::string estimator_;
  std::vector<std::string> axes_;  // the axes with an object of their own
  std::vector<std::string> sets_of_axes_;
};

}  // namespace breakwater::python
