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

/// The catalogue with `controller` and `estimator`, each an object or None, as kinds of every rig;
/// they are called as their classes are. Throws std::invalid_argument if a kind of that name is
/// there already.
///
/// Each object has `update` and `reset`; whenever a run is checked or made with it, its attribute
/// `setup` is what the rig tells of the plant, and `signals()` what it publishes. Its exceptions
/// leave the run as they are; what it returns wrongly is an std::invalid_argument.
class PythonParts {
 public:
  PythonParts(const Catalogue& standard, const py::object& controller, const py::object& estimator);

  const Catalogue& catalogue() const { return catalogue_; }

  /// `KEY="CLASS"` for each of the objects. Throws std::invalid_argument if the scenario does not
  /// take one.
  std::vector<std::string> choices(const std::string& scenario) const;

 private:
  // Which kinds a scenario has asked for.
  struct Uses {
    bool controller = false;
    const char* estimator_key = nullptr;
  };

  Catalogue catalogue_;
  std::string controller_;  // class names; empty: none
  std::string estimator_;
  std::shared_ptr<Uses> uses_;
};

}  // namespace breakwater::python
