#include "parts.h"

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <breakwater/program/program.h>
#include <breakwater/record/output_error.h>
#include <breakwater/rigs/arm_parts.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/rigs/plant_parts.h>
#include <breakwater/rigs/quadrotor_parts.h>
#include <breakwater/shell/did_you_mean.h>
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

py::object steal_or_throw(PyObject* result) {
  if (result == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(result);
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

// A Python object that a run calls at every sample, with the lock held. It gets new arrays, which
// it may keep. pybind11's own conversions would take several times as long.
class Part {
 public:
  // `sample_class` is the class of y in breakwater.samples.
  Part(const py::object& part, const char* sample_class, const py::dict& setup)
      : name_(class_name(part)),
        objects_(share(Objects{part.attr("reset"),
                               part.attr("update"),
                               py::module_::import("breakwater.samples").attr(sample_class),
                               py::dtype::of<double>(),
                               {}})) {
    using Entry = std::tuple<std::string, std::string, std::string, py::array>;
    for (const auto& [name, unit, text, array] :
         helper("set_up", part, setup).cast<std::vector<Entry>>()) {
      const std::vector<double> values(static_cast<std::size_t>(array.size()));
      objects_->published.push_back({name, array, values});
      signals_.push_back({name, unit, text, objects_->published.back().values});
    }
    copy_signals();
  }

  const std::vector<Signal>& signals() const { return signals_; }

  template <typename... Arguments>
  void reset(const Arguments&... arguments) {
    call(objects_->reset, arguments...);
  }

  // Copies `size` numbers that update() returns. Throws std::invalid_argument.
  void update(const py::object& first, const py::object& y, double* target, Eigen::Index size,
              const char* what) {
    take(call(objects_->update, first, y), target, size, what);
  }

  // A new array for y.
  py::object sample(const double* values, Eigen::Index size) const {
    const py::dtype& dtype = objects_->dtype;
    Py_INCREF(dtype.ptr());  // the array takes this reference
    const Py_intptr_t shape[] = {size};
    py::object array = steal_or_throw(py::detail::npy_api::get().PyArray_NewFromDescr_(
        sample_class(), dtype.ptr(), 1, shape, nullptr, nullptr, 0, nullptr));
    std::memcpy(py::detail::array_proxy(array.ptr())->data, values, bytes(size));
    return array;
  }

 private:
  struct Published {
    std::string name;
    py::array array;
    std::vector<double> values;
  };
  struct Objects {
    py::object reset;
    py::object update;
    py::object sample_class;
    py::dtype dtype;
    std::vector<Published> published;
  };

  static std::size_t bytes(Eigen::Index size) {
    return static_cast<std::size_t>(size) * sizeof(double);
  }
  PyTypeObject* sample_class() const {
    return reinterpret_cast<PyTypeObject*>(objects_->sample_class.ptr());
  }

  template <typename... Arguments>
  py::object call(const py::object& method, const Arguments&... arguments) {
    PyObject* all[] = {nullptr, arguments.ptr()...};
    py::object result = of_python(name_, [&] {
      return steal_or_throw(call_python(method.ptr(), all + 1,
                                        sizeof...(arguments) | PY_VECTORCALL_ARGUMENTS_OFFSET));
    });
    copy_signals();
    return result;
  }

  void take(const py::object& result, double* target, Eigen::Index size, const char* what) const {
    if (size == 1 && PyFloat_Check(result.ptr())) {
      *target = PyFloat_AS_DOUBLE(result.ptr());
      return;
    }
    if (Py_IS_TYPE(result.ptr(), py::detail::npy_api::get().PyArray_Type_) ||
        Py_IS_TYPE(result.ptr(), sample_class())) {
      const auto* array = py::detail::array_proxy(result.ptr());
      if (array->descr == objects_->dtype.ptr() && array->nd == 1 && array->dimensions[0] == size &&
          array->strides[0] == sizeof(double)) {
        std::memcpy(target, array->data, bytes(size));
        return;
      }
    }
    const auto values =
        helper("returned", result, size, name_ + ".update() returned " + what).cast<py::array>();
    std::memcpy(target, values.data(), bytes(size));
  }

  // Python may have moved an array, or given it another size or type.
  void copy_signals() {
    for (Published& signal : objects_->published) {
      const py::array& array = signal.array;
      const auto size = static_cast<Eigen::Index>(signal.values.size());
      if (!py::array_t<double, py::array::c_style>::check_(array) || array.ndim() != 1 ||
          array.size() != size) {
        helper("refuse_change", array, size, name_ + ".signals(): " + signal.name);
      }
      if (size > 0) std::memcpy(signal.values.data(), array.data(), bytes(size));
    }
  }

  std::string name_;
  std::shared_ptr<Objects> objects_;
  std::vector<Signal> signals_;
};

class PythonController final : public Controller {
 public:
  PythonController(const py::object& part, const char* sample_class, const py::dict& setup,
                   const char* command)
      : part_(part, sample_class, setup), command_(command) {}

  void reset(const Sample& first) override {
    const Locked lock;
    part_.reset(py::float_(first.time_s), part_.sample(first.y.data(), first.y.size()));
  }
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override {
    const Locked lock;
    part_.update(py::float_(y.time_s), part_.sample(y.y.data(), y.y.size()), u.data(), u.size(),
                 command_);
  }
  std::span<const Signal> signals() const override { return part_.signals(); }

 private:
  Part part_;
  const char* command_;
};

class PythonAxisEstimator final : public DisturbanceEstimator {
 public:
  PythonAxisEstimator(const py::object& part, const NominalAxis& axis, const py::dict& setup)
      : part_(part, "AxisSample", setup),
        states_(axis.plant.states()),
        inputs_(axis.plant.inputs()),
        estimate_(Eigen::VectorXd::Zero(states_ + inputs_)) {}

  void reset(const Vector& x) override {
    const Locked lock;
    estimate_ << x, Eigen::VectorXd::Zero(inputs_);
    part_.reset(py::cast(Eigen::VectorXd(x)));
  }
  void update(const Vector& held_input, const Vector& y) override {
    const Locked lock;
    part_.update(py::cast(Eigen::VectorXd(held_input)), part_.sample(y.data(), y.size()),
                 estimate_.data(), estimate_.size(),
                 states_ == 2 ? "[position, velocity, disturbance]" : "[state, disturbances]");
  }
  View state() const override { return {estimate_.data(), states_}; }
  View disturbance() const override { return {estimate_.data() + states_, inputs_}; }
  std::span<const Signal> signals() const override { return part_.signals(); }

 private:
  Part part_;
  Eigen::Index states_;
  Eigen::Index inputs_;
  Eigen::VectorXd estimate_;
};

class PythonQuadrotorEstimator final : public QuadrotorEstimator {
 public:
  PythonQuadrotorEstimator(const py::object& part, const py::dict& setup)
      : part_(part, "QuadrotorSample", setup) {}

  void reset(const Vector6d& pose) override {
    const Locked lock;
    motion_ << pose, Vector6d::Zero();
    force_.setZero();
    part_.reset(py::cast(pose));
  }
  void update(const Eigen::Vector4d& held_thrusts, const Vector6d& pose) override {
    const Locked lock;
    Eigen::Matrix<double, 15, 1> values;
    part_.update(py::cast(held_thrusts), part_.sample(pose.data(), pose.size()), values.data(), 15,
                 "[pose, its rate, force]");
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

py::dict setup_of(const ArmSetup& arm) {
  return py::dict(py::arg("period_s") = arm.period_s,
                  py::arg("chain") = *arm.chain.planar(),  // a plant has another kind
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
  std::vector<Reference> references;
  for (const AxisTask& axis : task.axes) references.push_back(axis.measured_reference());
  setup["reference"] = py::cpp_function([references](double t) {
    Eigen::VectorXd values(static_cast<Eigen::Index>(references.size()));
    std::ranges::transform(references, values.data(), [t](const auto& one) { return one.at(t); });
    return values;
  });
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

// A controller that gets samples of the class `sample_class`, or `with_force` where there is a tip.
template <typename Kind, typename Task>
Kind controller_kind(const std::string& name, const SharedObject& part, const char* sample_class,
                     const char* command, const char* with_force = nullptr) {
  return kind_of<Kind>(name, [=](const Task& task, const auto&... /*estimator*/) {
    bool has_force = false;
    if constexpr (requires { task.force; }) has_force = task.force.is_there();
    return std::make_unique<PythonController>(*part, has_force ? with_force : sample_class,
                                              setup_of(task), command);
  });
}

AxisControllerKind axis_controller(const std::string& name, const SharedObject& part) {
  return controller_kind<AxisControllerKind, AxisTask>(name, part, "AxisSample", "one force",
                                                       "AxisForceSample");
}

AxisEstimatorKind axis_estimator(const std::string& name, const SharedObject& part) {
  return kind_of<AxisEstimatorKind>(name, [part](const NominalAxis& axis) {
    // Each joint of an arm has its own.
    const py::object own =
        axis.joint == 0 ? *part : py::module_::import("copy").attr("deepcopy")(*part);
    return std::make_unique<PythonAxisEstimator>(own, axis, setup_of(axis));
  });
}

}  // namespace

const Catalogue& shipped_parts() {
  static const Catalogue all = standard_catalogue();
  return all;
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
      return std::make_unique<PythonQuadrotorEstimator>(*part, setup_of(task));
    }));
  }
  // Two axes may have objects of one class.
  const auto choose = [this](const py::dict& given, const char* key, auto&& kind) {
    for (const auto& [name, part] : given) {
      const std::string axis = py::cast<std::string>(name);
      axes_.push_back(axis);
      const std::string its_name = class_name(part) + "_" + axis;
      catalogue_.add(kind(its_name, share(py::reinterpret_borrow<py::object>(part))));
      sets_of_axes_.push_back("axis." + axis + "." + key + "=\"" + its_name + "\"");
    }
  };
  choose(parts[2], "controller.name", axis_controller);
  choose(parts[3], "observer.name", axis_estimator);
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
