#include "module.h"

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <breakwater/config/toml_text.h>
#include <breakwater/linear/eigenvalues.h>
#include <breakwater/observers/record_intervals.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/rigs/quadrotor_parts.h>
#include "interpreter.h"
#include "parts.h"

namespace breakwater::python {
namespace {

using Estimator = std::unique_ptr<DisturbanceEstimator>;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

using Key = std::tuple<std::string, std::string, std::string, std::string>;
using Table = std::vector<std::tuple<std::string, std::string, std::vector<Key>>>;

// "observer." of the keys of an axis.
template <typename Kind>
const std::string kPrefix(Kind::kKey, std::string_view(Kind::kKey).find('.') + 1);

// Adds the estimators of a kind: name, one line of help, and the keys. A key has its meaning, what
// it takes, and its default value in TOML, which may be missing.
template <typename Kind>
void add_observers(Table& table) {
  PartChoice<Kind> choice(shipped_parts(), Kind::kKey);
  Fields fields;
  choice.bind(fields);
  fields.read_incomplete(Config("Observer", {}));  // the default values
  for (const Kind& kind : shipped_parts().all<Kind>()) {
    std::vector<Key> keys;
    for (const KeyHelp& key : fields.help()) {
      if (std::ranges::find(key.parts, kind.name) == key.parts.end()) continue;
      keys.emplace_back(key.key.substr(kPrefix<Kind>.size()), key.text, key.takes, key.value);
    }
    table.emplace_back(kind.name, kind.help, std::move(keys));
  }
}

// Python's values of the keys: those it adds, which may be without effect, and those of its user.
using Assignments = std::vector<std::string>;
using KeyValues = std::pair<Assignments, Assignments>;

// Makes an estimator of the catalogue, with its own keys, as often as it is called.
template <typename Kind, typename Known>
std::function<Estimator()> maker(const std::string& name, const KeyValues& values,
                                 const Known& known) {
  auto choice = std::make_shared<PartChoice<Kind>>(shipped_parts(), Kind::kKey);
  Fields fields;
  choice->bind(fields);
  Config config("Observer", {});
  config.set(Kind::kKey + ("=" + toml_string(name)));
  std::set<std::string> given;
  for (const std::string& line : values.first) config.set(kPrefix<Kind> + line);
  for (const std::string& line : values.second) {
    config.set(kPrefix<Kind> + line);
    given.insert(kPrefix<Kind> + line.substr(0, line.find('=')));
  }
  fields.read(config);
  for (const UnusedKey& unused : fields.unused()) {
    if (given.contains(unused.key)) config.fail(unused.key, unused.reason);
  }
  return [choice, config, known]() -> Estimator { return choice->check(config, known); };
}

// How often a long record looks for signals.
using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kLook(50);
constexpr Eigen::Index kSamples = 64;  // between two looks at the clock, which takes as long as one

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
  std::tuple<Rows, Rows, Rows, Rows> filter(const Rows& u, const Rows& y, const Vector& t,
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
      RecordIntervals intervals({.times_s = view(t),
                                 .inputs = view(u),
                                 .width = u.cols(),
                                 .period_s = period_s_,
                                 .instant_std_s = time_std_s,
                                 .output_std = output_std_});
      // Without x0: the smallest state that gives y(0).
      own.reset(x0 ? *x0 : y.rows() > 0 ? least_squares(C_, y.row(0)) : Vector::Zero(C_.cols()));
      Clock::time_point next = Clock::now() + kLook;
      for (Eigen::Index k = 0; k < y.rows(); ++k) {
        if (k % kSamples == 0 && Clock::now() > next) {
          obey_signals();
          next = Clock::now() + kLook;
        }
        if (k > 0) intervals.move_to(static_cast<std::size_t>(k));
        if (k > 0 && !intervals.is_regular()) own.follow(intervals.interval());
        own.update(intervals.held_input(), y.row(k).transpose());
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
  Vector innovation() const {
    const auto values = published(*estimator_, "innovation");
    return View(values.data(), values.size());
  }
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
  double period_s_;
  double output_std_;  // 0: unknown
};

// Without a period the plant is a sampled one, and the unit of time is a sample.
std::unique_ptr<ArrayEstimator> observer(const std::string& name, const KeyValues& values,
                                         const Matrix& A, const Matrix& B, const Matrix& C,
                                         double period_s, const Vector& delta, const Vector& sigma,
                                         bool truncates, double largest_input,
                                         double pulses_per_revolution) {
  NominalAxis axis{
      .plant = {A, B, C},
      .period_s = period_s == 0.0 ? 1.0 : period_s,
      .is_sampled = period_s == 0.0,
      .sensor = {delta, sigma, truncates ? EncoderRounding::truncate : EncoderRounding::nearest},
      .pulses_per_revolution = pulses_per_revolution};
  check(axis.plant);
  if (largest_input > 0.0) axis.force_limit = largest_input;
  return std::make_unique<ArrayEstimator>(maker<AxisEstimatorKind>(name, values, axis), C,
                                          axis.period_s, std::sqrt(axis.sensor.variance()(0)));
}

std::unique_ptr<ArrayEstimator> quadrotor(const std::string& name, const KeyValues& values,
                                          double period_s, double position_std_m,
                                          double angle_std_rad, double added_mass_coefficient,
                                          double depth_m) {
  QuadrotorParameters vehicle;
  vehicle.added_mass_coefficient = added_mass_coefficient;
  const QuadrotorTask task{.plant = QuadrotorModel(vehicle, QuadrotorPhysics::physical),
                           .period_s = period_s,
                           .reference_m = {0.0, 0.0, -depth_m},
                           .position_std_m = position_std_m,
                           .angle_std_rad = angle_std_rad,
                           .position_noise = position_std_m * position_std_m,
                           .angle_noise = angle_std_rad * angle_std_rad};
  return std::make_unique<ArrayEstimator>(maker<QuadrotorEstimatorKind>(name, values, task),
                                          Matrix::Identity(6, 6), period_s, 0.0);
}

}  // namespace

void bind_observers(py::module_& module) {
  module.def(
      "observers",
      [] {
        Table table;
        add_observers<AxisEstimatorKind>(table);
        add_observers<QuadrotorEstimatorKind>(table);
        return table;
      },
      OwnCall());
  py::class_<ArrayEstimator>(module, "ArrayEstimator")
      .def(py::init(&observer), OwnCall())
      .def(py::init(&quadrotor), OwnCall())
      .def("reset", &ArrayEstimator::reset, OwnCall())
      .def("update", &ArrayEstimator::update, OwnCall())
      .def("filter", &ArrayEstimator::filter, OwnCall())
      .def_property_readonly("x", &ArrayEstimator::state)
      .def_property_readonly("d", &ArrayEstimator::disturbance)
      .def_property_readonly("innovation", &ArrayEstimator::innovation)
      .def_property_readonly("pole_matrix", &ArrayEstimator::pole_matrix, OwnCall());
}

}  // namespace breakwater::python
