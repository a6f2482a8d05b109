#include "module.h"

#include <pybind11/complex.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

#include <breakwater/config/toml_text.h>
#include <breakwater/control/quadrotor_estimator.h>
#include <breakwater/linear/eigenvalues.h>
#include <breakwater/observers/record_intervals.h>
#include <breakwater/rigs/axis_parts.h>
#include "arrays.h"
#include "interpreter.h"
#include "parts.h"

namespace breakwater::python {
namespace {

using Estimator = std::unique_ptr<DisturbanceEstimator>;

// The plant, the sensor and the drive of an estimator. Without a period the plant is a sampled one,
// and the unit of time is a sample.
NominalAxis axis_of(const py::dict& given) {
  const auto not_negative = [&](const char* name) {
    const double value = number(given[name], name);
    if (value >= 0.0) return value;
    throw std::invalid_argument(std::string(name) + ": must be 0 or more");
  };
  NominalAxis axis{
      .plant = {matrix(given["A"], "A"), matrix(given["B"], "B"), matrix(given["C"], "C")},
      .period_s = 1.0,
      .is_sampled = given["period_s"].is_none(),
      .pulses_per_revolution = not_negative("pulses_per_revolution")};
  check(axis.plant);
  if (!axis.is_sampled) axis.period_s = number(given["period_s"], "period_s");
  if (const double largest = not_negative("largest_input"); largest > 0.0) {
    axis.force_limit = largest;
  }
  const Eigen::Index outputs = axis.plant.outputs();
  axis.sensor = {vector_of(given["delta"], outputs, "delta"),
                 vector_of(given["sigma"], outputs, "sigma")};
  axis.sensor.rounding = one_of<EncoderRounding>(
      given["rounding"], "rounding",
      {{"nearest", EncoderRounding::nearest}, {"truncate", EncoderRounding::truncate}});
  return axis;
}

// Values of keys that a scenario's file must give: "NAME.KEY" of one estimator, or "KEY" of all.
std::optional<std::string> default_of(const std::string& name, const std::string& key) {
  static const std::map<std::string, std::string> values = {{"disturbance_order", "0"},
                                                            {"process_noise_on", "\"input\""},
                                                            {"observation_noise", "1.0"},
                                                            {"initial_covariance", "[1.0]"},
                                                            {"lambda_min", "0.8"},
                                                            {"lambda_max", "1.0"},
                                                            {"derivative_cutoff_rad_s", "0.0"},
                                                            {"vfakfd.process_noise", "0.0"}};
  for (const std::string& known : {name + "." + key, key}) {
    if (const auto found = values.find(known); found != values.end()) return found->second;
  }
  return std::nullopt;
}

// The keys of an estimator among those of all, without "observer.", with their default values.
std::vector<KeyHelp> keys_of(const std::string& name, const std::vector<KeyHelp>& all) {
  std::vector<KeyHelp> keys;
  for (KeyHelp key : all) {
    if (std::ranges::find(key.parts, name) == key.parts.end()) continue;
    key.key.erase(0, std::string("observer.").size());
    if (key.value.empty()) key.value = default_of(name, key.key).value_or("");
    keys.push_back(std::move(key));
  }
  return keys;
}

// An estimator of the catalogue, with its own keys.
Estimator make(const std::string& name, const NominalAxis& axis,
               const std::vector<std::string>& sets) {
  PartChoice<AxisEstimatorKind> choice(shipped_parts(), "observer.name");
  Fields fields;
  choice.bind(fields);
  Config config("Observer", {});
  config.set("observer.name=" + toml_string(name));
  for (const KeyHelp& key : keys_of(name, fields.help())) {
    const auto value = default_of(name, key.key);
    if (value) config.set("observer." + key.key + "=" + *value);
  }
  try {
    for (const std::string& assignment : sets) config.set(assignment);
    fields.read(config);
    for (const UnusedKey& unused : fields.unused()) config.fail(unused.key, unused.reason);
    return choice.check(config, axis);
  } catch (const std::invalid_argument& error) {
    // Python has the keys as arguments, without the place of a file or of --set.
    std::string text = error.what();
    for (const char* const begin : {"--set: ", "Observer: ", "observer."}) {
      if (text.starts_with(begin)) text.erase(0, std::strlen(begin));
    }
    throw std::invalid_argument(text);
  }
}

// The estimators of an axis: name, one line of help, and the keys. A key has its meaning, what it
// takes, and its default value in TOML, which may be missing.
py::list table_of_observers() {
  PartChoice<AxisEstimatorKind> choice(shipped_parts(), "observer.name");
  Fields fields;
  choice.bind(fields);
  fields.read_incomplete(Config("Observer", {}));  // the default values
  const std::vector<KeyHelp> all = fields.help();
  py::list table;
  for (const AxisEstimatorKind& kind : shipped_parts().all<AxisEstimatorKind>()) {
    py::list keys;
    for (const KeyHelp& key : keys_of(kind.name, all)) {
      keys.append(py::make_tuple(key.key, key.text, key.takes, key.value));
    }
    table.append(py::make_tuple(kind.name, kind.help, keys));
  }
  return table;
}

// A finite record, rows × width. A copy: another thread may change the array during the work.
class Record {
 public:
  Record(const py::object& object, Eigen::Index width, const char* name)
      : values_(py::array_t<double>(numbers(object, name).attr("copy")())) {
    const bool is_column = width == 1 && values_.ndim() == 1;
    if (!is_column && !(values_.ndim() == 2 && values_.shape(1) == width)) {
      throw std::invalid_argument(std::string(name) + ": must be of shape (samples" +
                                  (width == 1 ? ",)" : ", " + std::to_string(width) + ")") +
                                  ", is " + description(object));
    }
    rows_ = values_.shape(0);
    width_ = width;
    const double* const data = values_.data();
    const auto* const wrong =
        std::find_if(data, data + values_.size(), [](double v) { return !std::isfinite(v); });
    if (wrong != data + values_.size()) {
      throw std::invalid_argument(std::string(name) + ": must be finite; sample " +
                                  std::to_string((wrong - data) / width) + " is not");
    }
  }

  py::ssize_t rows() const { return rows_; }
  std::span<const double> values() const {
    return {values_.data(), static_cast<std::size_t>(values_.size())};
  }
  Eigen::Map<const Eigen::VectorXd> row(py::ssize_t k) const {
    return {values_.data() + k * width_, width_};
  }

 private:
  py::array_t<double> values_;
  py::ssize_t rows_ = 0;
  Eigen::Index width_ = 0;
};

void check_same_length(const Record& record, const Record& y, const std::string& name) {
  if (record.rows() == y.rows()) return;
  throw std::invalid_argument(name + ": must have as many samples as y, " +
                              std::to_string(y.rows()) + ", has " + std::to_string(record.rows()));
}

// The rows of an array that is filled row by row.
class Column {
 public:
  Column(py::ssize_t rows, std::size_t width)
      : values_({rows, static_cast<py::ssize_t>(width)}), next_(values_.mutable_data()) {}
  void append(const double* from, std::size_t width) { next_ = std::copy_n(from, width, next_); }
  const py::array_t<double>& array() const { return values_; }

 private:
  py::array_t<double> values_;
  double* next_;
};

// Restores the interval of a period at the end, also after an exception.
class RegularAfterwards {
 public:
  explicit RegularAfterwards(DisturbanceEstimator& estimator) : estimator_(estimator) {}
  RegularAfterwards(const RegularAfterwards&) = delete;
  RegularAfterwards& operator=(const RegularAfterwards&) = delete;
  ~RegularAfterwards() { estimator_.follow({}); }

 private:
  DisturbanceEstimator& estimator_;
};

// Obeys signals in a long loop. The caller lacks the interpreter's lock.
class Lookout {
 public:
  void sample() {
    if (++samples_ % kSamples != 0 || Clock::now() < next_) return;
    obey_signals();
    next_ = Clock::now() + kLook;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr int kSamples = 64;  // between two looks at the clock, which takes as long as one

  unsigned samples_ = 0;
  Clock::time_point next_ = Clock::now() + kLook;
};

// A filter of the underwater quadrotor with the thesis' parameters: x is the pose and its rate, d
// the force. It starts at rest at a pose.
class PoseFilter final : public DisturbanceEstimator {
 public:
  explicit PoseFilter(const py::dict& arguments) {
    QuadrotorEstimatorDesign design;
    design.filter = one_of<QuadrotorFilter>(
        arguments["kind"], "kind", {{"ukf", QuadrotorFilter::ukf}, {"ekf", QuadrotorFilter::ekf}});
    design.order = one_of<DisturbanceOrder>(arguments["disturbance"], "disturbance",
                                            {{"none", DisturbanceOrder::none},
                                             {"zero", DisturbanceOrder::zero},
                                             {"second", DisturbanceOrder::second},
                                             {"resonator", DisturbanceOrder::resonator}});
    design.noise = ProcessNoiseSource::tuned;
    const auto set = [&](double& target, const char* name) {
      target = number(arguments[name], name);
    };
    set(design.velocity_std_m_s, "velocity_std_m_s");
    set(design.rate_std_rad_s, "rate_std_rad_s");
    set(design.disturbance_std, "disturbance_std");
    set(design.wave_frequency_rad_s, "wave_frequency_rad_s");
    set(design.position_std_m, "position_std_m");
    set(design.angle_std_rad, "angle_std_rad");
    set(design.period_s, "period_s");
    design.estimates_wave_frequency = arguments["estimates_wave_frequency"].cast<bool>();
    QuadrotorParameters vehicle;
    set(vehicle.added_mass_coefficient, "added_mass_coefficient");
    if (!(vehicle.added_mass_coefficient >= 0.0)) {
      throw std::invalid_argument("added_mass_coefficient must be 0 or more");
    }
    filter_ = make_quadrotor_estimator(design, QuadrotorModel(vehicle, QuadrotorPhysics::physical));
  }

  void reset(const Vector& pose) override {
    angles_ = pose.tail<3>();
    filter_->reset(pose);
    copy();
  }
  void update(const Vector& held_thrusts, const Vector& pose) override {
    filter_->update(held_thrusts, unwrapped(pose));
    copy();
  }
  View state() const override { return {estimate_.data(), 12}; }
  View disturbance() const override { return {estimate_.data() + 12, 3}; }
  std::span<const Signal> signals() const override { return {}; }

 private:
  void copy() { estimate_ << filter_->motion(), filter_->force(); }

  // Angles that are logged within ±π jump by whole turns. The filter's own go on.
  Vector6d unwrapped(Vector6d pose) {
    constexpr double kTurn = 2.0 * std::numbers::pi;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double turns = std::round((angles_(i) - pose(3 + i)) / kTurn);
      if (std::isfinite(turns)) pose(3 + i) += kTurn * turns;
      if (std::isfinite(pose(3 + i))) angles_(i) = pose(3 + i);
    }
    return pose;
  }

  std::unique_ptr<QuadrotorEstimator> filter_;
  Eigen::Matrix<double, 15, 1> estimate_ = Eigen::Matrix<double, 15, 1>::Zero();
  Eigen::Vector3d angles_ = Eigen::Vector3d::Zero();  // measured last
};

// One estimator for one thread at a time. No Python code runs while it is in use, except signal
// handlers.
class ArrayEstimator {
 public:
  ArrayEstimator(const std::string& name, const py::dict& arguments,
                 const std::vector<std::string>& sets) {
    const NominalAxis axis = axis_of(arguments);
    estimator_ = make(name, axis, sets);
    set_sizes(axis.plant.inputs(), axis.plant.states());
    C_ = axis.plant.C;
    if (!axis.is_sampled) period_s_ = axis.period_s;
    sensor_std_ = std::sqrt(axis.sensor.variance()(0));
    innovation_ = published(*estimator_, "innovation");
    lambda_ = published(*estimator_, "lambda");
    estimator_->reset(Eigen::VectorXd::Zero(start_));
  }
  explicit ArrayEstimator(const py::dict& of_quadrotor)
      : estimator_(std::make_unique<PoseFilter>(of_quadrotor)),
        C_(Eigen::MatrixXd::Identity(6, 6)) {
    set_sizes(4, 6);
    estimator_->reset(Eigen::VectorXd::Zero(start_));
  }

  void reset(const py::object& x0) {
    const Eigen::VectorXd x = start_of(x0);
    const std::lock_guard lock(turn_);
    estimator_->reset(x);
  }

  py::tuple update(const py::object& u, const py::object& y) {
    const Eigen::VectorXd held = vector_of(u, inputs_, "u");
    const Eigen::VectorXd measured = vector_of(y, C_.rows(), "y");
    py::array_t<double> x(n_);
    py::array_t<double> d(m_);
    {
      const std::lock_guard lock(turn_);
      estimator_->update(held, measured);
      copy(estimator_->state(), x);
      copy(estimator_->disturbance(), d);
    }
    return py::make_tuple(x, d);
  }

  py::tuple filter(const py::object& u_object, const py::object& y_object,
                   const py::object& t_object, const py::object& x0, const py::object& time_std_s) {
    const Record u(u_object, inputs_, "u");
    const Record y(y_object, C_.rows(), "y");
    check_same_length(u, y, "u");
    const std::optional<Record> t =
        t_object.is_none() ? std::nullopt : std::optional<Record>(std::in_place, t_object, 1, "t");
    RecordRows rows{.width = inputs_, .period_s = period_s_, .output_std = sensor_std_};
    rows.instant_std_s = number(time_std_s, "time_std_s");
    if (!(rows.instant_std_s >= 0.0)) {
      throw std::invalid_argument("time_std_s: must be 0 or more");
    }
    if (t) {
      check_same_length(*t, y, "t");
      check_times(*t);
      rows.times_s = t->values();
      rows.inputs = u.values();
    } else if (rows.instant_std_s != 0.0) {
      throw std::invalid_argument("time_std_s: needs t, the times of the samples");
    }
    RecordIntervals intervals(rows);
    const bool is_followed = t && !intervals.is_regular();
    // Without x0: the smallest state that gives y(0).
    const Eigen::VectorXd start = !x0.is_none()  ? start_of(x0)
                                  : y.rows() > 0 ? least_squares(C_, y.row(0))
                                                 : Eigen::VectorXd::Zero(start_);
    Column x(y.rows(), static_cast<std::size_t>(n_));
    Column d(y.rows(), static_cast<std::size_t>(m_));
    Column innovation(y.rows(), innovation_.size());
    Column lambda(y.rows(), lambda_.size());
    {
      const std::lock_guard lock(turn_);
      const Unlocked unlocked;
      Lookout lookout;
      const RegularAfterwards regular(*estimator_);
      estimator_->reset(start);
      const double* const state = estimator_->state().data();
      const double* const disturbance = estimator_->disturbance().data();
      for (py::ssize_t k = 0; k < y.rows(); ++k) {
        lookout.sample();
        if (is_followed && k > 0) {
          intervals.move_to(static_cast<std::size_t>(k));
          estimator_->follow(intervals.interval());
          estimator_->update(intervals.held_input(), y.row(k));
        } else {
          estimator_->update(u.row(std::max<py::ssize_t>(k - 1, 0)), y.row(k));
        }
        x.append(state, static_cast<std::size_t>(n_));
        d.append(disturbance, static_cast<std::size_t>(m_));
        innovation.append(innovation_.data(), innovation_.size());
        lambda.append(lambda_.data(), lambda_.size());
      }
    }
    return py::make_tuple(x.array(), d.array(), innovation.array(), lambda.array());
  }

  py::array_t<double> state() { return copy_of(estimator_->state()); }
  py::array_t<double> disturbance() { return copy_of(estimator_->disturbance()); }
  py::array_t<double> innovation() {
    return copy_of({innovation_.data(), static_cast<Eigen::Index>(innovation_.size())});
  }

  py::object pole_matrix() {
    const Eigen::Index poles = estimator_->poles();
    Eigen::MatrixXd F(poles, poles);
    if (poles > 0) {
      const std::lock_guard lock(turn_);
      estimator_->pole_matrix(F);
    }
    return matrix_array(F);
  }

 private:
  using View = Eigen::Map<const Eigen::VectorXd>;

  void set_sizes(Eigen::Index inputs, Eigen::Index start) {
    inputs_ = inputs;
    start_ = start;
    n_ = estimator_->state().size();
    m_ = estimator_->disturbance().size();
  }
  Eigen::VectorXd start_of(const py::object& x0) const {
    const bool is_state = start_ == n_;  // otherwise a pose
    if (is_state && x0.is_none()) return Eigen::VectorXd::Zero(n_);
    return vector_of(x0, start_, is_state ? "x0" : "pose");
  }
  static void copy(const View& from, py::array_t<double>& to) {
    std::copy_n(from.data(), from.size(), to.mutable_data());
  }
  py::array_t<double> copy_of(const View& values) {
    py::array_t<double> all(values.size());
    const std::lock_guard lock(turn_);
    copy(values, all);
    return all;
  }

  void check_times(const Record& t) const {
    if (!(period_s_ > 0.0)) {
      throw std::invalid_argument("t: needs an estimator of a plant in continuous time (period_s)");
    }
    for (py::ssize_t k = 1; k < t.rows(); ++k) {
      if (t.row(k)(0) > t.row(k - 1)(0)) continue;
      throw std::invalid_argument("t: must rise; sample " + std::to_string(k) + " does not");
    }
  }

  Estimator estimator_;
  Eigen::Index inputs_ = 0;
  Eigen::Index start_ = 0;
  Eigen::Index n_ = 0;
  Eigen::Index m_ = 0;
  Eigen::MatrixXd C_;
  double period_s_ = 0.0;    // 0: the plant is sampled already
  double sensor_std_ = 0.0;  // 0: unknown
  std::span<const double> innovation_;
  std::span<const double> lambda_;
  Turn turn_;
};

}  // namespace

void bind_observers(py::module_& module) {
  auto estimator = bind_class<ArrayEstimator>(module, "ArrayEstimator");
  bind_method(estimator, "reset", "x0=None", &ArrayEstimator::reset,
              "Start from the state x0 (n; default: zeros) without a disturbance.",
              py::arg("x0") = py::none());
  bind_method(estimator, "update", "u, y", &ArrayEstimator::update,
              "Take one sample: the input u (m) since the last one, the measurement y (p). Returns "
              "(x, d).\n\n"
              "The first u after a reset is ignored.",
              py::arg("u"), py::arg("y"));
  module.def("observers", &table_of_observers, OwnCall(), "The estimators of an axis.");
  estimator
      .def(py::init<const std::string&, const py::dict&, const std::vector<std::string>&>(),
           OwnCall())
      .def(py::init<const py::dict&>(), OwnCall())
      .def("filter_record", &ArrayEstimator::filter, OwnCall(), "The arrays of filter().")
      .def_property_readonly("x", &ArrayEstimator::state, "A copy of the estimated state (n).")
      .def_property_readonly("d", &ArrayEstimator::disturbance,
                             "A copy of the estimated disturbance (m), which opposes the input.")
      .def_property_readonly("innovation", &ArrayEstimator::innovation,
                             "y - C x(k|k-1) (p), a copy; empty of one that has none.")
      .def_property_readonly("pole_matrix", &ArrayEstimator::pole_matrix, OwnCall(),
                             "The matrix whose eigenvalues are the poles at this sample.");
}

}  // namespace breakwater::python
