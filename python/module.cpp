// The compiled part of the Python package. write_stub.py lists its contents.
#include <dlfcn.h>
#include <pybind11/pybind11.h>

#include <filesystem>
#include <stdexcept>

#include <breakwater/experiment/scenario.h>
#include <breakwater/experiment/version.h>
#include <breakwater/record/interrupted.h>
#include <breakwater/record/output_error.h>
#include <breakwater/shell/paths.h>
#include "interpreter.h"
#include "module.h"

namespace breakwater::python {
namespace py = pybind11;
namespace {

// The search path of models and scenarios begins at this module.
void set_places() {
  Dl_info own{};
  dladdr(reinterpret_cast<void*>(&set_places), &own);
  DataPlaces places;
  places.program = std::filesystem::canonical(own.dli_fname);
  set_data_places(places);
}

// NOLINTNEXTLINE(performance-unnecessary-value-param): what pybind11 calls
void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const Interrupted&) {
    // A Python handler may have set the exception, such as KeyboardInterrupt.
    if (PyErr_Occurred() == nullptr) PyErr_SetString(PyExc_SystemExit, "Python ends");
  } catch (const OutputError& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  } catch (const std::length_error&) {
    PyErr_SetString(PyExc_MemoryError, "there is not enough memory");
  } catch (const std::invalid_argument& error) {
    const py::object type = py::module_::import("breakwater.errors").attr("InputError");
    PyErr_SetString(type.ptr(), error.what());
  }
}

}  // namespace
}  // namespace breakwater::python

PYBIND11_MODULE(_core, module) {
  using namespace breakwater::python;  // NOLINT: the module's own
  set_places();
  pybind11::register_local_exception_translator(translate);
  module.attr("__version__") = breakwater::kVersion;
  bind_exit();
  bind_comparisons(module);
  bind_linear(module);
  bind_observers(module);
  bind_program(module);
  bind_runs(module);
}
