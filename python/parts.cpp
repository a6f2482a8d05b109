#include "parts.h"

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <breakwater/config/config.h>
#include <breakwater/program/program.h>
#include <breakwater/record/output_error.h>
#include <breakwater/rigs/arm_parts.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/rigs/plant_parts.h>
#include <breakwater/rigs/quadrotor_parts.h>
#include "interpreter.h"

namespace breakwater::python {

const PythonParts* parts_of_program = nullptr;

namespace {

std::string class_name(const py::handle& object) {
  return py::type::of(object).attr("__name__").cast<std::string>();
}

// Calls a function of breakwater/parts.py.
template <typename... Arguments>
py::object helper(const char* name, Arguments&&... arguments) {
  return py::module_::import("breakwater.parts").attr(name)(std::forward<Arguments>(arguments)...);
}

// Calls `body`, which calls Python.
template <typename Body>
auto of_python(const std::string& name, const Body& body) {
  if (parts_of_program == nullptr) return body();
  try {
    return body();
  } catch (const py::error_already_set& error) {
    const py::object line = helper("line_of", error.value(), error.trace());
    throw OutputError(name + ": " + line.cast<std::string>());
  }
}

// A pointer that may be released with or without the interpreter's lock.
template <typename T>
std::shared_ptr<T> share(T object) {
  return {new T(std::move(object)), [](T* held) {
            const Locked lock;
            delete held;
          }};
}
using SharedObject = std::shared_ptr<py::object>;

using Values = Eigen::Ref<const Eigen::VectorXd>;

py::array_t<double> array_of(const Values& values) {
  return py::array_t<double>(values.size(), values.data());
}

// A Python object that a run calls at every sample, with the lock held, through a Link of
// breakwater/parts.py. It gets new arrays, which it may keep.
class Part {
 public:
  // `sample_class` is the class of y in breakwater.samples, if it has no force beside. `what` are
  // the numbers that update() returns.
  Part(const py::object& part, const char* sample_class, const std::string& what,
       const py::dict& setup)
      : name_(class_name(part)) {
    const py::object link = helper("Link", part, sample_class, what, setup);
    objects_ = share(Objects{link.attr("reset"), link.attr("update"), link.attr("sample_class")});
    using Entry = std::tuple<std::string, std::string, std::string, py::array_t<double>>;
    for (const auto& [name, unit, text, values] : link.attr("signals").cast<std::vector<Entry>>()) {
      signals_.push_back(
          {name, unit, text, {values.data(), static_cast<std::size_t>(values.size())}});
    }
  }

  const std::vector<Signal>& signals() const { return signals_; }

  template <typename... Arguments>
  void reset(const Arguments&... arguments) {
    of_python(name_, [&] { return call_python(objects_->reset, arguments...); });
  }

  // Copies the numbers that update() returns. Throws std::invalid_argument.
  template <typename First>
  void update(const First& first, const Values& y, Eigen::Ref<Eigen::VectorXd> values) {
    const py::object returned = of_python(
        name_, [&] { return call_python(objects_->update, first, sample(y), values.size()); });
    if (PyFloat_Check(returned.ptr())) {
      values(0) = PyFloat_AS_DOUBLE(returned.ptr());
    } else {
      std::copy_n(returned.cast<py::array_t<double>>().data(), values.size(), values.data());
    }
  }

  // A new array of the class of y. pybind11 and a view would take several times as long.
  py::object sample(const Values& values) const {
    const py::dtype dtype = py::dtype::of<double>();
    const Py_intptr_t shape[] = {values.size()};
    PyObject* array = py::detail::npy_api::get().PyArray_NewFromDescr_(
        reinterpret_cast<PyTypeObject*>(objects_->sample_class.ptr()), dtype.inc_ref().ptr(), 1,
        shape, nullptr, nullptr, 0, nullptr);
    if (array == nullptr) throw py::error_already_set();
    std::copy_n(values.data(), values.size(),
                reinterpret_cast<double*>(py::detail::array_proxy(array)->data));
    return py::reinterpret_steal<py::object>(array);
  }

 private:
  struct Objects {
    py::object reset;
    py::object update;
    py::object sample_class;
  };

  std::string name_;
  std::shared_ptr<Objects> objects_;
  std::vector<Signal> signals_;
};

class PythonController final : public Controller {
 public:
  explicit PythonController(Part part) : part_(std::move(part)) {}

  void reset(const Sample& first) override {
    const Locked lock;
    part_.reset(first.time_s, part_.sample(first.y));
  }
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override {
    const Locked lock;
    part_.update(y.time_s, y.y, u);
  }
  std::span<const Signal> signals() const override { return part_.signals(); }

 private:
  Part part_;
};

// An estimator of an axis or of the quadrotor, whose log does not have its signals.
template <typename Interface>
class PythonEstimator final : public Interface {
 public:
  using View = DisturbanceEstimator::View;

  PythonEstimator(Part part, Eigen::Index states, Eigen::Index disturbances)
      : part_(std::move(part)),
        states_(states),
        estimate_(Eigen::VectorXd::Zero(states + disturbances)) {}

  void reset(const Values& x) override {
    const Locked lock;
    estimate_.setZero();
    estimate_.head(x.size()) = x;
    part_.reset(array_of(x));
  }
  void update(const Values& held_input, const Values& y) override {
    const Locked lock;
    part_.update(array_of(held_input), y, estimate_);
  }
  View state() const override { return {estimate_.data(), states_}; }
  View disturbance() const override {
    return {estimate_.data() + states_, estimate_.size() - states_};
  }
  std::span<const Signal> signals() const override { return part_.signals(); }

 private:
  Part part_;
  Eigen::Index states_;
  Eigen::VectorXd estimate_;
};

py::dict setup_of(const ArmSetup& arm) {
  return py::dict(py::arg("period_s") = arm.period_s,
                  py::arg("chain") = *arm.chain->planar(),  // a plant has another kind
                  py::arg("torque_limit_Nm") = arm.acceleration.torque_limit_Nm,
                  py::arg("nominal_inertia_kgm2") = arm.acceleration.nominal_inertia_kgm2,
                  py::arg("start_angles_rad") = arm.task.start_angles_rad,
                  py::arg("start_pose") = arm.task.start_pose,
                  py::arg("force_control_from_s") = arm.task.force_control_from_s,
                  py::arg("force_reference_N") = arm.task.force_reference_N,
                  py::arg("convert_gain_N_m") = arm.task.convert_gain_N_m);
}

py::dict setup_of(const NominalAxis& axis) {
  return py::dict(py::arg("period_s") = axis.period_s, py::arg("A") = axis.plant.A,
                  py::arg("B") = axis.plant.B, py::arg("C") = axis.plant.C,
                  py::arg("force_limit") = axis.force_limit,
                  py::arg("quantum") = axis.sensor.quantum,
                  py::arg("noise_std") = axis.sensor.noise_std, py::arg("joint") = axis.joint);
}

py::cpp_function function_of_time(const Reference& reference) {
  return [reference](double t) { return reference.at(t); };
}

void add_force(const py::dict& setup, const ForceTask& force) {
  if (force.is_there()) setup["force_reference"] = function_of_time(force.reference);
}

py::dict setup_of(const AxisTask& task) {
  py::dict setup = setup_of(task.axis);
  add_force(setup, task.force);
  setup["start_state"] = task.start_state;
  setup["reference"] = function_of_time(task.modelled_reference());
  return setup;
}

py::dict setup_of(const PlantTask& task) {
  py::dict setup = setup_of(task.whole);
  add_force(setup, task.force);
  setup["names"] = task.names;
  setup["pose"] = task.pose;
  setup["to_states"] = task.to_states;
  setup["held_input"] = task.held_input;
  setup["force_limit"] = task.limit;
  py::list references;
  for (const AxisTask& axis : task.axes) {
    references.append(function_of_time(axis.measured_reference()));
  }
  setup["reference"] = references;
  return setup;
}

py::dict setup_of(const QuadrotorTask& task) {
  const QuadrotorParameters& plant = task.plant.parameters();
  return py::dict(py::arg("period_s") = task.period_s, py::arg("reference_m") = task.reference_m,
                  py::arg("mass_kg") = plant.moving_mass_kg(),
                  py::arg("inertia_kgm2") = plant.inertia_kgm2,
                  py::arg("net_weight_N") = plant.net_weight_N(),
                  py::arg("thrust_limit_N") = plant.thrust_limit_N,
                  py::arg("thruster_matrix") = thruster_matrix(plant.thruster_arm_m),
                  py::arg("position_std_m") = task.position_std_m,
                  py::arg("angle_std_rad") = task.angle_std_rad);
}

// A kind whose parts `make` makes with the lock held.
template <typename Kind, typename Make>
Kind kind_of(const std::string& name, Make make) {
  return {name, "written in Python", typename Kind::Makes([make, name](const auto&... context) {
            const Locked lock;
            return of_python(name, [&] { return make(context...); });
          })};
}

template <typename Kind, typename Task>
Kind controller_kind(const std::string& name, const SharedObject& part, const char* sample_class,
                     const char* command) {
  return kind_of<Kind>(name, [=](const Task& task, const auto&... /*estimator*/) {
    return std::make_unique<PythonController>(Part(*part, sample_class, command, setup_of(task)));
  });
}

AxisControllerKind axis_controller(const std::string& name, const SharedObject& part) {
  return controller_kind<AxisControllerKind, AxisTask>(name, part, "AxisSample", "one force");
}

AxisEstimatorKind axis_estimator(const std::string& name, const SharedObject& part) {
  return kind_of<AxisEstimatorKind>(name, [part](const NominalAxis& axis) {
    // Each joint of an arm has its own.
    const py::object own =
        axis.joint == 0 ? *part : py::module_::import("copy").attr("deepcopy")(*part);
    const Eigen::Index states = axis.plant.states();
    const char* estimate =
        states == 2 ? "[position, velocity, disturbance]" : "[state, disturbances]";
    return std::make_unique<PythonEstimator<DisturbanceEstimator>>(
        Part(own, "AxisSample", estimate, setup_of(axis)), states, axis.plant.inputs());
  });
}

}  // namespace

const Catalogue& shipped_parts() {
  static const Catalogue all = standard_catalogue();
  return all;
}

std::string scenario_of(const std::string& word) {
  return is_scenario_file(word) ? scenario_name_in(shipped_parts(), word) : word;
}

PythonParts::PythonParts(const py::tuple& parts) : catalogue_(shipped_parts()) {
  const py::object controller = parts[0];
  const py::object estimator = parts[1];
  if (!controller.is_none()) {
    controller_ = class_name(controller);
    const SharedObject part = share(controller);
    catalogue_.add(controller_kind<ArmControllerKind, ArmSetup>(controller_, part, "ArmSample",
                                                                "torques [N m]"));
    catalogue_.add(axis_controller(controller_, part));
    catalogue_.add(controller_kind<PlantControllerKind, PlantTask>(controller_, part, "PlantSample",
                                                                   "forces [N m or N]"));
    catalogue_.add(controller_kind<QuadrotorControllerKind, QuadrotorTask>(
        controller_, part, "QuadrotorSample", "thrusts [N]"));
  }
  if (!estimator.is_none()) {
    estimator_ = class_name(estimator);
    const SharedObject part = share(estimator);
    catalogue_.add(axis_estimator(estimator_, part));
    catalogue_.add(kind_of<QuadrotorEstimatorKind>(estimator_, [part](const QuadrotorTask& task) {
      return std::make_unique<PythonEstimator<QuadrotorEstimator>>(
          Part(*part, "QuadrotorSample", "[pose, its rate, force]", setup_of(task)), 12, 3);
    }));
  }
  // Two axes may have objects of one class.
  const auto choose = [this](const py::dict& given, const char* key, auto&& kind) {
    for (const auto& [name, part] : given) {
      const std::string axis = py::cast<std::string>(name);
      const std::string its_name = class_name(part) + "_" + axis;
      catalogue_.add(kind(its_name, share(py::reinterpret_borrow<py::object>(part))));
      sets_of_axes_.push_back("axis." + axis + "." + key + "=\"" + its_name + "\"");
    }
  };
  choose(parts[2], "controller.name", axis_controller);
  choose(parts[3], "observer.name", axis_estimator);
}

std::vector<std::string> PythonParts::choices(const std::string& scenario) const {
  const std::unique_ptr<Scenario> made = make_scenario(catalogue_, scenario);
  const Fields fields = made->fields();
  std::vector<std::string> sets = sets_of_axes_;
  const auto choose = [&](const char* part, const char* key, const std::string& name) {
    if (!fields.has(key)) throw std::invalid_argument(part + (": " + scenario) + " takes none");
    sets.push_back(std::string(key) + "=\"" + name + "\"");
  };
  if (!controller_.empty()) {
    choose("controller", "controller.name", controller_);
    // A controller of all axes in Python takes no estimator of the plant.
    const bool has_all_axes = fields.has_chosen("controller.name", "axes");
    if (has_all_axes && estimator_.empty()) choose("estimator", "observer.name", "none");
  }
  if (!estimator_.empty()) {
    choose("estimator", fields.has("estimator.name") ? "estimator.name" : "observer.name",
           estimator_);
  }
  return sets;
}

}  // namespace breakwater::python
