#include "parts.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <tuple>

#include <breakwater/program/program.h>
#include <breakwater/record/output_error.h>
#include <breakwater/rigs/arm_parts.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/rigs/plant_parts.h>
#include <breakwater/rigs/quadrotor_parts.h>
#include <breakwater/shell/did_you_mean.h>
#include "arrays.h"
#include "interpreter.h"

namespace breakwater::python {
namespace {

using Input = Eigen::Ref<const Eigen::VectorXd>;

std::string class_name(const py::handle& object) {
  return py::type::of(object).attr("__name__").cast<std::string>();
}

// For all parts of this process: a program has one set of them.
PythonErrors errors_of_parts = PythonErrors::pass;

// "ZeroDivisionError: division by zero (law.py:12)"
std::string one_line(const py::error_already_set& error) {
  const py::list frames = py::module_::import("traceback").attr("extract_tb")(error.trace());
  std::string text = error.type().attr("__name__").cast<std::string>() + ": " +
                     py::str(error.value()).cast<std::string>();
  if (frames.empty()) return text;
  const py::object last = frames[frames.size() - 1];
  const py::object path = py::module_::import("os.path").attr("basename")(last.attr("filename"));
  return text + " (" + py::str(path).cast<std::string>() + ":" +
         py::str(last.attr("lineno")).cast<std::string>() + ")";
}

// Calls `body`, which calls Python.
template <typename Body>
auto of_python(const std::string& name, const Body& body) {
  if (errors_of_parts == PythonErrors::pass) return body();
  try {
    return body();
  } catch (const py::error_already_set& error) {
    throw OutputError(name + ": " + one_line(error));
  }
}

py::object steal_or_throw(PyObject* result) {
  if (result == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(result);
}

// A Python object that a run calls at every sample, with the lock held. It gets new arrays, which
// it may keep.
class Part {
 public:
  // `sample_class` is the class of y in breakwater.samples.
  Part(const py::object& part, const char* sample_class)
      : name_(class_name(part)),
        part_(share(part)),
        reset_(share(part.attr("reset"))),
        update_(share(part.attr("update"))),
        sample_class_(share(py::module_::import("breakwater.samples").attr(sample_class))),
        dtype_(share(py::dtype::of<double>())) {}

  const std::string& name() const { return name_; }

  py::object call_update(const py::object& first, const py::object& second) {
    py::object result = of_python(name_, [&] { return call(update_, first, second); });
    copy_signals();
    return result;
  }
  void call_reset(const py::object& first, const py::object& second) {
    of_python(name_, [&] { return call(reset_, first, second); });
    copy_signals();
  }
  void call_reset(const py::object& state) {
    of_python(name_, [&] { return py::handle(reset_.get())(state); });
    copy_signals();
  }

  // A new array for y.
  py::object sample(const double* values, Eigen::Index size) const {
    Py_INCREF(dtype_.get());  // the array takes this reference
    const Py_intptr_t shape[] = {size};
    py::object array = steal_or_throw(py::detail::npy_api::get().PyArray_NewFromDescr_(
        type_of(sample_class_), dtype_.get(), 1, shape, nullptr, nullptr, 0, nullptr));
    std::memcpy(py::detail::array_proxy(array.ptr())->data, values,
                static_cast<std::size_t>(size) * sizeof(double));
    return array;
  }

  // Copies `size` numbers that a method returned. Throws std::invalid_argument.
  void take(const py::handle& result, double* target, Eigen::Index size, const char* what) const {
    if (size == 1 && PyFloat_Check(result.ptr())) {
      *target = PyFloat_AS_DOUBLE(result.ptr());
      return;
    }
    if (is_plain_array(result) || Py_IS_TYPE(result.ptr(), type_of(sample_class_))) {
      const auto* array = py::detail::array_proxy(result.ptr());
      if (array->descr == dtype_.get() && array->nd == 1 && array->dimensions[0] == size &&
          array->strides[0] == sizeof(double)) {
        std::memcpy(target, array->data, static_cast<std::size_t>(size) * sizeof(double));
        return;
      }
    }
    const std::string returned = name_ + ".update() returned " + what;
    if (result.is_none()) refuse(result, size, what);
    const py::array_t<double> values = numbers(result, returned);
    if (values.size() != size || values.ndim() > 1) refuse(result, size, what);
    std::memcpy(target, values.data(), static_cast<std::size_t>(size) * sizeof(double));
  }

  [[noreturn]] void refuse(const py::handle& result, Eigen::Index size, const char* what) const {
    throw std::invalid_argument(name_ + ".update() returned " + what + ": must be " +
                                std::to_string(size) + (size == 1 ? " number" : " numbers") +
                                ", is " + description(result));
  }

  void set_setup(const py::object& setup) const { py::setattr(part_.get(), "setup", setup); }

  // The result of signals(), a dict NAME: (unit, description, array). Keeps the arrays, and copies
  // them after each call.
  std::vector<Signal> signals() {
    std::vector<Signal> list;
    const py::object published = py::handle(part_.get()).attr("signals")();
    const std::string place = name_ + ".signals()";
    if (!py::isinstance<py::dict>(published)) {
      throw std::invalid_argument(place + ": must return a dict, is " + description(published));
    }
    for (const auto& [key, value] : published.cast<py::dict>()) {
      const std::string name = utf8(py::str(key), place);
      const std::string where = place + ": " + name;
      const bool is_entry = py::isinstance<py::tuple>(value) && py::len(value) == 3;
      if (!is_entry) {
        throw std::invalid_argument(where + ": must be a tuple (unit, description, array), is " +
                                    description(value));
      }
      const auto entry = py::reinterpret_borrow<py::tuple>(value);
      const py::object values = entry[2];
      if (!is_vector(values)) {
        throw std::invalid_argument(
            where + ": must be an array of float64 of one dimension that is written in place, is " +
            description(values));
      }
      const py::ssize_t size = values.cast<py::array>().size();
      published_.push_back(
          {where, share(values), std::vector<double>(static_cast<std::size_t>(size))});
      list.push_back({name, utf8(py::str(entry[0]), where), utf8(py::str(entry[1]), where),
                      published_.back().values});
    }
    copy_signals();
    return list;
  }

 private:
  struct Published {
    std::string where;
    SharedObject array;
    std::vector<double> values;
  };

  static bool is_vector(const py::handle& object) {
    return py::array_t<double, py::array::c_style>::check_(object) && !is_masked(object) &&
           py::reinterpret_borrow<py::array>(object).ndim() == 1;
  }

  // Python may have moved an array, or given it another size or type.
  void copy_signals() {
    for (Published& signal : published_) {
      const py::handle object = signal.array.get();
      const auto* const array = py::detail::array_proxy(object.ptr());
      const std::size_t size = signal.values.size();
      if (!is_vector(object) || array->dimensions[0] != static_cast<Py_intptr_t>(size)) {
        throw std::invalid_argument(signal.where + ": must keep its " + std::to_string(size) +
                                    " numbers of float64, is " + description(object));
      }
      if (size > 0) std::memcpy(signal.values.data(), array->data, size * sizeof(double));
    }
  }

  static PyTypeObject* type_of(const SharedObject& type) {
    return reinterpret_cast<PyTypeObject*>(type.get());
  }

  static py::object call(const SharedObject& method, const py::object& first,
                         const py::object& second) {
    PyObject* arguments[] = {nullptr, first.ptr(), second.ptr()};
    return steal_or_throw(
        call_python(method.get(), arguments + 1, 2 | PY_VECTORCALL_ARGUMENTS_OFFSET));
  }

  std::string name_;
  SharedObject part_;
  SharedObject reset_;
  SharedObject update_;
  SharedObject sample_class_;
  SharedObject dtype_;
  std::vector<Published> published_;
};

py::object namespace_of(const py::dict& entries) {
  return py::module_::import("types").attr("SimpleNamespace")(**entries);
}

class PythonController final : public Controller {
 public:
  PythonController(const py::object& part, const char* sample_class, const py::object& setup,
                   const char* command)
      : part_(part, sample_class), command_(command) {
    part_.set_setup(setup);
    signals_ = part_.signals();
  }

  void reset(const Sample& first) override {
    const Locked lock;
    part_.call_reset(py::float_(first.time_s), part_.sample(first.y.data(), first.y.size()));
  }
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override {
    const Locked lock;
    const py::object result =
        part_.call_update(py::float_(y.time_s), part_.sample(y.y.data(), y.y.size()));
    part_.take(result, u.data(), u.size(), command_);
  }
  std::span<const Signal> signals() const override { return signals_; }

 private:
  Part part_;
  const char* command_;
  std::vector<Signal> signals_;
};

class PythonAxisEstimator final : public DisturbanceEstimator {
 public:
  PythonAxisEstimator(const py::object& part, const NominalAxis& axis, const py::object& setup)
      : part_(part, "AxisSample"),
        states_(axis.plant.states()),
        inputs_(axis.plant.inputs()),
        estimate_(Eigen::VectorXd::Zero(states_ + inputs_)) {
    part_.set_setup(setup);
    signals_ = part_.signals();
  }

  void reset(const Vector& x) override {
    const Locked lock;
    estimate_ << x, Eigen::VectorXd::Zero(inputs_);
    part_.call_reset(array(x));
  }
  void update(const Vector& held_input, const Vector& y) override {
    const Locked lock;
    const py::object result =
        part_.call_update(array(held_input), part_.sample(y.data(), y.size()));
    part_.take(result, estimate_.data(), estimate_.size(),
               states_ == 2 ? "[position, velocity, disturbance]" : "[state, disturbances]");
  }
  View state() const override { return {estimate_.data(), states_}; }
  View disturbance() const override { return {estimate_.data() + states_, inputs_}; }
  std::span<const Signal> signals() const override { return signals_; }

 private:
  Part part_;
  Eigen::Index states_;
  Eigen::Index inputs_;
  Eigen::VectorXd estimate_;
  std::vector<Signal> signals_;
};

class PythonQuadrotorEstimator final : public QuadrotorEstimator {
 public:
  PythonQuadrotorEstimator(const py::object& part, const py::object& setup)
      : part_(part, "QuadrotorSample") {
    part_.set_setup(setup);
  }

  void reset(const Vector6d& pose) override {
    const Locked lock;
    motion_ << pose, Vector6d::Zero();
    force_.setZero();
    part_.call_reset(array(Input(pose)));
  }
  void update(const Eigen::Vector4d& held_thrusts, const Vector6d& pose) override {
    const Locked lock;
    const py::object result =
        part_.call_update(array(Input(held_thrusts)), part_.sample(pose.data(), pose.size()));
    Eigen::Matrix<double, 15, 1> values;
    part_.take(result, values.data(), 15, "[pose, its rate, force]");
    motion_ = values.head<12>();
    force_ = values.tail<3>();
  }
  const Motion& motion() const override { return motion_; }
  // It has no covariance, so the run has no nees_mean.
  MotionCovariance motion_covariance() const override {
    return MotionCovariance::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  Eigen::Vector4d thrust_disturbance() const override { return Eigen::Vector4d::Zero(); }
  Eigen::Vector3d force() const override { return force_; }
  bool models_world_force() const override { return true; }
  bool models_disturbance() const override { return true; }

 private:
  Part part_;
  Motion motion_ = Motion::Zero();
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
};

py::object setup_of(const ArmSetup& arm) {
  return namespace_of(py::dict(
      py::arg("period_s") = arm.period_s,
      py::arg("chain") = *arm.chain.planar(),  // a plant has another kind
      py::arg("torque_limit_Nm") = array(Input(arm.acceleration.torque_limit_Nm)),
      py::arg("nominal_inertia_kgm2") = array(Input(arm.acceleration.nominal_inertia_kgm2)),
      py::arg("start_angles_rad") = array(Input(arm.task.start_angles_rad)),
      py::arg("start_pose") = array(Input(arm.task.start_pose)),
      py::arg("force_control_from_s") = arm.task.force_control_from_s,
      py::arg("force_reference_N") = arm.task.force_reference_N,
      py::arg("convert_gain_N_m") = arm.task.convert_gain_N_m));
}

py::object setup_of(const NominalAxis& axis) {
  return namespace_of(py::dict(
      py::arg("period_s") = axis.period_s, py::arg("A") = matrix_array(axis.plant.A),
      py::arg("B") = matrix_array(axis.plant.B), py::arg("C") = matrix_array(axis.plant.C),
      py::arg("force_limit") = axis.force_limit,
      py::arg("quantum") = array(Input(axis.sensor.quantum)),
      py::arg("noise_std") = array(Input(axis.sensor.noise_std)), py::arg("joint") = axis.joint));
}

template <typename Function>
py::cpp_function function_of_time(const char* name, const Function& function) {
  return [name, function](const py::args& given, const py::kwargs& named) -> py::object {
    if (given.size() != 1 || !named.empty()) throw py::type_error(std::string(name) + "() takes t");
    return function(number(given[0], "t"));
  };
}

void add_force(const py::object& setup, const ForceTask& force) {
  if (!force.is_there()) return;
  setup.attr("force_reference") = function_of_time(
      "force_reference",
      [reference = force.reference](double t) { return py::float_(reference.at(t)); });
}

py::object setup_of(const AxisTask& task) {
  py::object setup = setup_of(task.axis);
  add_force(setup, task.force);
  setup.attr("start_state") = array(Input(task.start_state));
  setup.attr("reference") = function_of_time(
      "reference",
      [reference = task.modelled_reference()](double t) { return py::float_(reference.at(t)); });
  return setup;
}

py::object setup_of(const PlantTask& task) {
  py::object setup = setup_of(task.whole);
  add_force(setup, task.force);
  setup.attr("names") = task.names;
  setup.attr("pose") = array(Input(task.pose));
  setup.attr("to_states") = matrix_array(task.to_states);
  setup.attr("held_input") = array(Input(task.held_input));
  setup.attr("force_limit") = array(Input(task.limit));
  std::vector<Reference> references;
  for (const AxisTask& axis : task.axes) references.push_back(axis.measured_reference());
  setup.attr("reference") = function_of_time("reference", [references](double t) {
    Eigen::VectorXd values(static_cast<Eigen::Index>(references.size()));
    for (std::size_t i = 0; i < references.size(); ++i) {
      values(static_cast<Eigen::Index>(i)) = references[i].at(t);
    }
    return array(Input(values));
  });
  return setup;
}

py::object setup_of(const QuadrotorTask& task) {
  const QuadrotorParameters& plant = task.plant.parameters();
  return namespace_of(py::dict(
      py::arg("period_s") = task.period_s, py::arg("reference_m") = array(Input(task.reference_m)),
      py::arg("mass_kg") = plant.moving_mass_kg(),
      py::arg("inertia_kgm2") = array(Input(plant.inertia_kgm2)),
      py::arg("net_weight_N") = plant.net_weight_N(),
      py::arg("thrust_limit_N") = plant.thrust_limit_N,
      py::arg("thruster_matrix") = matrix_array(thruster_matrix(plant.thruster_arm_m)),
      py::arg("position_std_m") = task.position_std_m,
      py::arg("angle_std_rad") = task.angle_std_rad));
}

// A kind whose parts `make` makes with the lock held.
template <typename Kind, typename Product, typename... Context, typename Make>
Kind kind_of(const PartKind<Product, Context...>*, const std::string& name, Make make) {
  return {name, "written in Python", [make, name](Context... context) -> std::unique_ptr<Product> {
            const Locked lock;
            return of_python(name, [&]() -> std::unique_ptr<Product> { return make(context...); });
          }};
}
template <typename Kind, typename Make>
Kind kind_of(const std::string& name, Make make) {
  return kind_of<Kind>(static_cast<const Kind*>(nullptr), name, make);
}

py::object object_of(const SharedObject& part) {
  return py::reinterpret_borrow<py::object>(part.get());
}

// A controller that gets samples of the class `sample_class`, or `with_force` where there is a tip.
template <typename Kind, typename Task>
Kind controller_kind(const std::string& name, const SharedObject& part, const char* sample_class,
                     const char* command, const char* with_force = nullptr) {
  return kind_of<Kind>(name, [=](const Task& task, const auto&... /*estimator*/) {
    bool has_force = false;
    if constexpr (requires { task.force; }) has_force = task.force.is_there();
    return std::make_unique<PythonController>(
        object_of(part), has_force ? with_force : sample_class, setup_of(task), command);
  });
}

AxisControllerKind axis_controller(const std::string& name, const SharedObject& part) {
  return controller_kind<AxisControllerKind, AxisTask>(name, part, "AxisSample", "one force",
                                                       "AxisForceSample");
}

AxisEstimatorKind axis_estimator(const std::string& name, const SharedObject& part) {
  return kind_of<AxisEstimatorKind>(name, [part](const NominalAxis& axis) {
    // Each joint of an arm has its own.
    const py::object own = axis.joint == 0
                               ? object_of(part)
                               : py::module_::import("copy").attr("deepcopy")(object_of(part));
    return std::make_unique<PythonAxisEstimator>(own, axis, setup_of(axis));
  });
}

}  // namespace

const Catalogue& shipped_parts() {
  static const Catalogue all = standard_catalogue();
  return all;
}

PythonParts::PythonParts(const Catalogue& standard, const py::object& controller,
                         const py::object& estimator, const py::dict& controllers,
                         const py::dict& estimators, PythonErrors errors)
    : catalogue_(standard) {
  errors_of_parts = errors;
  if (!controller.is_none()) {
    controller_ = class_name(controller);
    const SharedObject part = share(controller);
    catalogue_.add(controller_kind<ArmControllerKind, ArmSetup>(controller_, part, "ArmSample",
                                                                "torques [N m]"));
    catalogue_.add(axis_controller(controller_, part));
    catalogue_.add(controller_kind<PlantControllerKind, PlantTask>(
        controller_, part, "PlantSample", "forces [N m or N]", "PlantForceSample"));
    catalogue_.add(controller_kind<QuadrotorControllerKind, QuadrotorTask>(
        controller_, part, "QuadrotorSample", "thrusts [N]"));
  }
  if (!estimator.is_none()) {
    estimator_ = class_name(estimator);
    const SharedObject part = share(estimator);
    catalogue_.add(axis_estimator(estimator_, part));
    catalogue_.add(kind_of<QuadrotorEstimatorKind>(estimator_, [part](const QuadrotorTask& task) {
      return std::make_unique<PythonQuadrotorEstimator>(object_of(part), setup_of(task));
    }));
  }
  // Two axes may have objects of one class.
  const auto choose = [this](const py::dict& parts, const char* key, auto&& kind) {
    for (const auto& [name, part] : parts) {
      const std::string axis = utf8(name, key);
      axes_.push_back(axis);
      const std::string its_name = class_name(part) + "_" + axis;
      catalogue_.add(kind(its_name, share(py::reinterpret_borrow<py::object>(part))));
      sets_of_axes_.push_back("axis." + axis + "." + key + "=\"" + its_name + "\"");
    }
  };
  choose(controllers, "controller.name", axis_controller);
  choose(estimators, "observer.name", axis_estimator);
}

void PythonParts::check_axes(const std::vector<std::string>& names) const {
  for (const std::string& axis : axes_) {
    if (std::find(names.begin(), names.end(), axis) != names.end()) continue;
    throw std::invalid_argument("controllers, estimators: there is no table [axis." + axis + "]" +
                                did_you_mean(axis, names));
  }
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
