#include <breakwater/analysis/swept_sine.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

namespace breakwater {
namespace {

constexpr double kAgree = 1e-3;
constexpr std::size_t kMostWindows = 8;
constexpr double kLeastSamples = 200;  // smallest length of a window

double abs2(const Phasors& a) {
  return std::norm(a.command) + std::norm(a.disturbance) + std::norm(a.velocity);
}

Phasors operator-(const Phasors& a, const Phasors& b) {
  return {a.command - b.command, a.disturbance - b.disturbance, a.velocity - b.velocity};
}

// A loop's controller with a sine as the probe. Computes the outputs' phasors at its frequency.
class Probed final : public Controller {
 public:
  Probed(AxisLoop& loop, Probe probe, double amplitude, double omega_per_sample)
      : loop_(loop),
        amplitude_(probe == Probe::force ? amplitude : 0.0),
        omega_per_sample_(omega_per_sample) {}

  void reset(const Sample& first) override { loop_.controller->reset(first); }
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override {
    loop_.controller->update(y, u);
    const double angle = omega_per_sample_ * static_cast<double>(k_++);
    const std::complex<double> turned = std::polar(1.0, -angle);
    sums_.command += u(0) * turned;
    if (loop_.estimates()) {
      sums_.disturbance += loop_.estimator->disturbance()(0) * turned;
      sums_.velocity += loop_.estimator->state()(1) * turned;
    }
    u(0) += amplitude_ * std::sin(angle);
  }
  std::span<const Signal> signals() const override { return loop_.controller->signals(); }

  std::size_t samples() const { return k_; }
  // The sums since the last call.
  Phasors take() { return std::exchange(sums_, Phasors{}); }

 private:
  AxisLoop& loop_;
  double amplitude_;
  double omega_per_sample_;
  std::size_t k_ = 0;
  Phasors sums_;
};

}  // namespace

SineResponse measure_sine(const AxisOfPlant& axis, const SineTest& test) {
  const AxisTask& task = axis.task;
  const double period_s = task.axis.period_s;
  // A window of whole periods in whole samples.
  const double per_period = 2.0 * std::numbers::pi / (test.omega_rad_s * period_s);
  const double periods = std::max(1.0, std::ceil(kLeastSamples / per_period));
  const double samples = std::round(periods * per_period);
  const auto window = static_cast<std::size_t>(samples);
  const double omega_per_sample = 2.0 * std::numbers::pi * periods / samples;

  AxisLoop loop = axis.parts->make(task);
  auto own = std::make_unique<Probed>(loop, test.probe, test.amplitude, omega_per_sample);
  Probed& probed = *own;
  std::unique_ptr<Controller> controller = std::move(own);
  if (axis.among_others) controller = axis.among_others(std::move(controller));
  SineResponse response;
  response.omega_rad_s = omega_per_sample / period_s;
  AxisPlant plant = axis.plant;
  for (AxisSettings& one : plant.axes) one.force = one.output = {};
  plant.pushes.clear();
  if (test.probe == Probe::noise) {
    plant.axes[axis.index].output = {DisturbanceKind::sine, test.amplitude, response.omega_rad_s,
                                     0.0};
  }
  AxisRig rig(plant, *controller);

  std::size_t saturated = 0, taken = 0;
  const auto run_until = [&](std::size_t samples_in_all) {
    while (probed.samples() < samples_in_all) {
      rig.step();
      if (!rig.simulation().sampled()) continue;
      ++taken;
      if (rig.simulation().saturated()) ++saturated;
      if (test.stop != nullptr && test.stop->load()) throw Interrupted();
    }
  };
  auto end = static_cast<std::size_t>(std::ceil(test.settle_s / period_s / samples)) * window;
  run_until(end);
  probed.take();
  // The phasor of the probe: Σ a sin(ωk) e^{−jωk} = −j a K/2.
  const std::complex<double> probe(0.0, -0.5 * test.amplitude * samples);
  std::vector<Phasors> windows;
  while (windows.size() < kMostWindows) {
    run_until(end += window);
    const Phasors sums = probed.take();
    windows.push_back({sums.command / probe, sums.disturbance / probe, sums.velocity / probe});
    if (windows.size() < 2) continue;
    const Phasors& now = windows.back();
    if (abs2(now - windows[windows.size() - 2]) <= kAgree * kAgree * abs2(now)) {
      windows = {now};
      break;
    }
  }
  const auto count = static_cast<double>(windows.size());
  for (const Phasors& one : windows) {
    response.gain.command += one.command / count;
    response.gain.disturbance += one.disturbance / count;
    response.gain.velocity += one.velocity / count;
  }
  double squares = 0.0;
  for (const Phasors& one : windows) squares += std::norm(one.command - response.gain.command);
  response.spread = std::sqrt(squares / count) /
                    std::max(std::abs(response.gain.command), std::numeric_limits<double>::min());
  response.saturated = static_cast<double>(saturated) / static_cast<double>(taken);
  return response;
}

}  // namespace breakwater
