#include "module.h"

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <breakwater/config/toml_text.h>
#include <breakwater/control/quadrotor_estimator.h>
#include <breakwater/linear/eigenvalues.h>
#include <breakwater/observers/record_intervals.h>
#include <breakwater/rigs/axis_parts.h>
#include "interpreter.h"
#include "parts.h"

namespace breakwater::python {
namespace {

using Estimator = std::unique_ptr<DisturbanceEstimator>;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The estimators of an axis: name, one line of help, and the keys. A key has its meaning, what it
// takes, and its default value in TOML, which may be missing.
auto table_of_observers() {
  PartChoice<AxisEstimatorKind> choice(shipped_parts(), "observer.name");
  Fields fields;
  choice.bind(fields);
  fields.read_incomplete(Config("Observer", {}));  // the default values
  using Key = std::tuple<std::string, std::string, std::string, std::string>;
  std::vector<std::tuple<std::string, std::string, std::vector<Key>>> table;
  for (const AxisEstimatorKind& kind : shipped_parts().all<AxisEstimatorKind>()) {
    std::vector<Key> keys;
    for (const KeyHelp& key : fields.help()) {
      if (std::ranges::find(key.parts, kind.name) == key.parts.end()) continue;
      keys.emplace_back(key.key.substr(std::string("observer.").size()), key.text, key.takes,
                        key.value);
    }
    table.emplace_back(kind.name, kind.help, std::move(keys));
  }
  return table;
}

// Makes an estimator of the catalogue, with its own keys, as often as it is called.
std::function<Estimator()> maker(const std::string& name, const NominalAxis& axis,
                                 const std::vector<std::string>& sets) {
  auto choice = std::make_shared<PartChoice<AxisEstimatorKind>>(shipped_parts(), "observer.name");
  Fields fields;
  choice->bind(fields);
  Config config("Observer", {});
  config.set("observer.name=" + toml_string(name));
  for (const std::string& assignment : sets) config.set(assignment);
  fields.read(config);
  for (const UnusedKey& unused : fields.unused()) config.fail(unused.key, unused.reason);
  return [choice, config, axis] { return choice->check(config, axis); };
}

// A filter of the underwater quadrotor with the thesis' parameters: x is the pose and its rate, d
// the force. It starts at rest at a pose.
class PoseFilter final : public DisturbanceEstimator {
 public:
  explicit PoseFilter(std::unique_ptr<QuadrotorEstimator> filter) : filter_(std::move(filter)) {}

  void reset(const Vector& pose) override {
    filter_->reset(pose);
    copy();
  }
  void update(const Vector& held_thrusts, const Vector& pose) override {
    filter_->update(held_thrusts, pose);
    copy();
  }
  View state() const override { return {estimate_.data(), 12}; }
  View disturbance() const override { return {estimate_.data() + 12, 3}; }
  std::span<const Signal> signals() const override { return {}; }

 private:
  void copy() { estimate_ << filter_->motion(), filter_->force(); }

  std::unique_ptr<QuadrotorEstimator> filter_;
  Eigen::Matrix<double, 15, 1> estimate_ = Eigen::Matrix<double, 15, 1>::Zero();
};

std::function<Estimator()> maker_of_quadrotors(const std::string& filter,
                                               const std::string& disturbance,
                                               const std::map<std::string, double>& given) {
  static const std::map<std::string, DisturbanceOrder> orders = {
      {"none", DisturbanceOrder::none},
      {"zero", DisturbanceOrder::zero},
      {"second", DisturbanceOrder::second},
      {"resonator", DisturbanceOrder::resonator}};
  QuadrotorEstimatorDesign design;
  design.filter = filter == "ukf" ? QuadrotorFilter::ukf : QuadrotorFilter::ekf;
  design.order = orders.at(disturbance);
  design.noise = ProcessNoiseSource::tuned;
  design.velocity_std_m_s = given.at("velocity_std_m_s");
  design.rate_std_rad_s = given.at("rate_std_rad_s");
  design.disturbance_std = given.at("disturbance_std");
  design.wave_frequency_rad_s = given.at("wave_frequency_rad_s");
  design.estimates_wave_frequency = given.at("estimates_wave_frequency") != 0.0;
  design.position_std_m = given.at("position_std_m");
  design.angle_std_rad = given.at("angle_std_rad");
  design.period_s = given.at("period_s");
  QuadrotorParameters vehicle;
  vehicle.added_mass_coefficient = given.at("added_mass_coefficient");
  return [design, vehicle] {
    return std::make_unique<PoseFilter>(
        make_quadrotor_estimator(design, QuadrotorModel(vehicle, QuadrotorPhysics::physical)));
  };
}

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
  static constexpr std::chrono::milliseconds kLook{50};
  static constexpr int kSamples = 64;  // between two looks at the clock, which takes as long as one

  unsigned samples_ = 0;
  Clock::time_point next_ = Clock::now() + kLook;
};

Vector values_of(std::span<const double> values) {
  return Eigen::Map<const Vector>(values.data(), static_cast<Eigen::Index>(values.size()));
}

// An estimator that the interpreter's lock guards.
class ArrayEstimator {
 public:
  ArrayEstimator(std::function<Estimator()> make, Matrix C, double period_s, double output_std)
      : make_(std::move(make)),
        estimator_(make_()),
        C_(std::move(C)),
        period_s_(period_s),
        output_std_(output_std) {
    estimator_->reset(Vector::Zero(C_.cols()));
  }

  void reset(const Vector& start) { estimator_->reset(start); }

  // Without Eigen's conversions, which would take longer than a sample.
  py::tuple update(const py::array_t<double>& u, const py::array_t<double>& y) {
    estimator_->update(View(u.data(), u.size()), View(y.data(), y.size()));
    return py::make_tuple(copy_of(estimator_->state()), copy_of(estimator_->disturbance()));
  }

  // x, d, innovation and lambda of each sample. The record has a new estimator, since others may
  // use this one meanwhile. It takes this one's place at the end.
  std::tuple<Rows, Rows, Rows, Rows> filter(const Rows& u, const Rows& y,
                                            const std::optional<Vector>& t,
                                            const std::optional<Vector>& x0, double time_std_s) {
    Estimator made = make_();
    DisturbanceEstimator& own = *made;
    const auto innovation = published(own, "innovation");
    const auto lambda = published(own, "lambda");
    const auto rows_of = [&](auto width) { return Rows(y.rows(), width); };
    std::tuple all(rows_of(own.state().size()), rows_of(own.disturbance().size()),
                   rows_of(innovation.size()), rows_of(lambda.size()));
    {
      const Unlocked unlocked;
      RecordRows rows{.width = u.cols(), .period_s = period_s_, .output_std = output_std_};
      rows.instant_std_s = time_std_s;
      if (t) {
        rows.times_s = view(*t);
        rows.inputs = view(u);
      }
      RecordIntervals intervals(rows);
      const bool is_followed = t && !intervals.is_regular();
      // Without x0: the smallest state that gives y(0).
      own.reset(x0 ? *x0 : y.rows() > 0 ? least_squares(C_, y.row(0)) : Vector::Zero(C_.cols()));
      Lookout lookout;
      for (Eigen::Index k = 0; k < y.rows(); ++k) {
        lookout.sample();
        if (is_followed && k > 0) {
          intervals.move_to(static_cast<std::size_t>(k));
          own.follow(intervals.interval());
          own.update(intervals.held_input(), y.row(k).transpose());
        } else {
          own.update(u.row(std::max<Eigen::Index>(k - 1, 0)).transpose(), y.row(k).transpose());
        }
        std::get<0>(all).row(k) = own.state();
        std::get<1>(all).row(k) = own.disturbance();
        std::copy(innovation.begin(), innovation.end(), std::get<2>(all).row(k).data());
        std::copy(lambda.begin(), lambda.end(), std::get<3>(all).row(k).data());
      }
      own.follow({});
    }
    estimator_ = std::move(made);
    return all;
  }

  Vector state() const { return estimator_->state(); }
  Vector disturbance() const { return estimator_->disturbance(); }
  Vector innovation() const { return values_of(published(*estimator_, "innovation")); }
  Matrix pole_matrix() const {
    Matrix F(estimator_->poles(), estimator_->poles());
    if (F.size() > 0) estimator_->pole_matrix(F);
    return F;
  }

 private:
  using View = DisturbanceEstimator::View;

  static py::array_t<double> copy_of(const View& values) {
    return py::array_t<double>(values.size(), values.data());
  }

  std::function<Estimator()> make_;
  Estimator estimator_;
  Matrix C_;
  double period_s_;    // 0: the plant is sampled already
  double output_std_;  // 0: unknown
};

// Without a period the plant is a sampled one, and the unit of time is a sample.
std::unique_ptr<ArrayEstimator> make_observer(const std::string& name,
                                              const std::vector<std::string>& sets,
                                              const StateSpace& plant, double period_s,
                                              const SensorError& sensor, double largest_input,
                                              double pulses_per_revolution) {
  NominalAxis axis{.plant = plant,
                   .period_s = period_s == 0.0 ? 1.0 : period_s,
                   .is_sampled = period_s == 0.0,
                   .sensor = sensor,
                   .pulses_per_revolution = pulses_per_revolution};
  if (largest_input > 0.0) axis.force_limit = largest_input;
  return std::make_unique<ArrayEstimator>(maker(name, axis, sets), plant.C, period_s,
                                          std::sqrt(sensor.variance()(0)));
}

}  // namespace

void bind_observers(py::module_& module) {
  module.def("observers", &table_of_observers, OwnCall());
  py::class_<ArrayEstimator>(module, "ArrayEstimator")
      .def(py::init([](const std::string& name, const std::vector<std::string>& sets,
                       const Matrix& A, const Matrix& B, const Matrix& C, double period_s,
                       const Vector& delta, const Vector& sigma, bool truncates,
                       double largest_input, double pulses_per_revolution) {
             const StateSpace plant{A, B, C};
             check(plant);
             return make_observer(
                 name, sets, plant, period_s,
                 {delta, sigma, truncates ? EncoderRounding::truncate : EncoderRounding::nearest},
                 largest_input, pulses_per_revolution);
           }),
           OwnCall())
      .def(py::init([](const std::string& filter, const std::string& disturbance,
                       const std::map<std::string, double>& given) {
             return std::make_unique<ArrayEstimator>(
                 maker_of_quadrotors(filter, disturbance, given), Matrix::Identity(6, 6), 0.0, 0.0);
           }),
           OwnCall())
      .def("reset", &ArrayEstimator::reset, OwnCall())
      .def("update", &ArrayEstimator::update, OwnCall())
      .def("filter", &ArrayEstimator::filter, OwnCall())
      .def_property_readonly("x", &ArrayEstimator::state)
      .def_property_readonly("d", &ArrayEstimator::disturbance)
      .def_property_readonly("innovation", &ArrayEstimator::innovation)
      .def_property_readonly("pole_matrix", &ArrayEstimator::pole_matrix, OwnCall());
}

}  // namespace breakwater::python
