// An external controller on an installed model.
#include <cmath>
#include <cstdio>

#include <breakwater/control/controller.h>
#include <breakwater/sim/simulation.h>

namespace {

// Holds the motor at 1 rad.
class PdControl final : public breakwater::Controller {
 public:
  void reset(const breakwater::Sample& first) override { last_ = first.y(0); }
  void update(const breakwater::Sample& y, Eigen::Ref<Eigen::VectorXd> u) override {
    const double rate = (y.y(0) - last_) / 1e-3;
    last_ = y.y(0);
    u(0) = 25.0 * (1.0 - y.y(0)) - 10.0 * rate;
  }

 private:
  double last_ = 0.0;
};

}  // namespace

int main(int, char** argv) {
  PdControl control;
  breakwater::SensingSetup sensing;
  sensing.channels.push_back({.name = "q", .sensor = argv[2]});
  breakwater::Simulation sim(breakwater::Model::load(argv[1]), control, sensing, 1);
  while (sim.time_s() < 5.0) sim.step();
  std::printf("%.6f\n", sim.qpos()[0]);
  return std::abs(sim.qpos()[0] - 1.0) < 1e-3 ? 0 : 1;
}
