// The C++ side of the comparison with the Python module. It runs a controller that commands a
// constant, and a loop that filters a record. Prints the processor time of each.
//   python_reference run SCENARIO SECONDS | filter SAMPLES
#include <fmt/core.h>

#include <cstdlib>
#include <random>
#include <string>

#include <breakwater/experiment/runner.h>
#include <breakwater/observers/stf.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/program/program.h>
#include <breakwater/rigs/arm_parts.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/signals/thread_time.h>

namespace breakwater {
namespace {

class Constant final : public Controller {
 public:
  void reset(const Sample&) override {}
  void update(const Sample&, Eigen::Ref<Eigen::VectorXd> u) override { u.setZero(); }
  std::span<const Signal> signals() const override { return {}; }
};

struct Nothing {};
void bind_nothing(Fields&, Nothing&) {}

double run_s(const std::string& scenario, const std::string& duration) {
  Catalogue catalogue = standard_catalogue();
  catalogue.add(ArmControllerKind(
      "constant", "no torque", bind_nothing,
      +[](const Nothing&, const ArmSetup&) -> std::unique_ptr<Controller> {
        return std::make_unique<Constant>();
      }));
  catalogue.add(AxisControllerKind(
      "constant", "no force", bind_nothing,
      +[](const Nothing&, const AxisTask&, std::shared_ptr<DisturbanceEstimator>)
          -> std::unique_ptr<Controller> { return std::make_unique<Constant>(); }));
  double elapsed_s = 0.0;
  for (int turn = 0; turn < 2; ++turn) {  // the first one warms up the caches
    const double begin = thread_time_s();
    const ScenarioFile file(catalogue.get<ScenarioKind>(scenario).file().string(), scenario);
    const PreparedRun run = prepare_run(catalogue, scenario, file, file.default_case(),
                                        {"controller.name=constant", "run.duration_s=" + duration});
    if (run.scenario->run({}).failure) std::exit(1);
    elapsed_s = thread_time_s() - begin;
  }
  return elapsed_s;
}

double filter_s(int samples) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<double> u(samples);
  std::vector<double> y(samples);
  for (int k = 0; k < samples; ++k) {
    u[k] = normal(random);
    y[k] = (k > 0 ? y[k - 1] : 0.0) + 1e-3 * normal(random);
  }
  const SensorError error{Eigen::VectorXd::Constant(1, 1e-3), Eigen::VectorXd::Zero(1)};
  const ExtendedPlant plant =
      extend_by_disturbance_model(zero_order_hold(damped_inertia(1.0, 0.0), 1e-3), 0, 1e-3);
  Stf stf(stf_design(plant, error, 1e-3), error);
  std::vector<double> estimates(5 * static_cast<std::size_t>(samples));
  const double begin = thread_time_s();
  stf.reset(Eigen::Vector2d(y[0], 0.0));
  double* next = estimates.data();
  for (int k = 0; k < samples; ++k) {
    const Eigen::Map<const Eigen::VectorXd> held(&u[k > 0 ? k - 1 : 0], 1);
    stf.update(held, Eigen::Map<const Eigen::VectorXd>(&y[k], 1));
    *next++ = stf.state()(0);
    *next++ = stf.state()(1);
    *next++ = stf.disturbance()(0);
    *next++ = stf.innovation()(0);
    *next++ = stf.lambda();
  }
  return thread_time_s() - begin;
}

}  // namespace
}  // namespace breakwater

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "run" && argc == 4) {
    fmt::print("{}\n", breakwater::run_s(argv[2], argv[3]));
  } else if (what == "filter" && argc == 3) {
    fmt::print("{}\n", breakwater::filter_s(std::atoi(argv[2])));
  } else {
    return 2;
  }
}
