// A program with one scenario, the Ishigami function, whose runs take almost no time:
//     y = sin x₁ + 7 sin² x₂ + 0.1 x₃⁴ sin x₁
// T. Ishigami, T. Homma, Proc. ISUMA '90 (1990) 398–403.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <string_view>

#include <breakwater/program/program.h>
#include <breakwater/record/recording.h>
#include <breakwater/signals/thread_time.h>

namespace breakwater {
namespace {

class Ishigami : public Scenario {
 public:
  std::string name() const override { return "ishigami"; }
  std::string summary() const override { return "a function with known sensitivity indices"; }

  Fields fields() override {
    Fields fields;
    run_.bind(fields);
    fields.number("x.first", x1_, any(), "x_1");
    fields.number("x.second", x2_, any(), "x_2");
    fields.number("x.third", x3_, any(), "x_3");
    fields.number("y.noise", noise_, not_negative(), "how far y is shifted at most");
    fields.number("trouble.fails_above", fails_above_, any(), "of x.first");
    fields.number("trouble.crashes_above", crashes_above_, any(), "of x.first");
    fields.number("trouble.killed_above", killed_above_, any(), "of x.first");
    fields.number("trouble.takes_s", takes_s_, not_negative(), "of processor time [s]");
    return fields;
  }
  void check(const Config&, const Fields&) override {}
  const RunSettings& run_settings() const override { return run_; }
  std::vector<MetricDefinition> metric_definitions() const override {
    return {{"y_1", "1", "the function"}, {"positive_x_second_1", "1", "x_2, if it is positive"}};
  }

  Recording run(const RunControl& control) const override {
    const double begin_s = thread_time_s();
    while (thread_time_s() - begin_s < takes_s_) {
      if (control.stop != nullptr && *control.stop) throw Interrupted();
    }
    // Another machine, in a test: it does not crash there, and has another hash.
    const bool is_another = std::getenv("ISHIGAMI_IS_ANOTHER") != nullptr;
    if (x1_ > crashes_above_ && !is_another) std::abort();
    if (x1_ > killed_above_) std::raise(SIGKILL);
    Recording recording;
    const double y = std::sin(x1_) + 7.0 * std::pow(std::sin(x2_), 2) +
                     0.1 * std::pow(x3_, 4) * std::sin(x1_) +
                     noise_ * std::sin(static_cast<double>(run_.seed));
    recording.state_hash = static_cast<std::uint64_t>(1e6 * (y + (is_another ? 101.0 : 100.0)));
    recording.simulated_s = run_.duration_s;
    if (x1_ > fails_above_) {
      recording.failure = Failure{0.5, "x_1 is too large"};
    } else {
      add(recording.metrics, "y_1", "1", y);
      // A metric that not all runs have.
      if (x2_ > 0.0) add(recording.metrics, "positive_x_second_1", "1", x2_);
    }
    recording.tracks.emplace_back("control", std::vector<Signal>{{"y", "1", "y", view(y)}}, 1);
    if (control.logs) recording.tracks.back().append(0.0);
    return recording;
  }

 private:
  RunSettings run_;
  double x1_ = 0.0, x2_ = 0.0, x3_ = 0.0, noise_ = 0.0;
  double fails_above_ = 0.0, crashes_above_ = 0.0, killed_above_ = 0.0, takes_s_ = 0.0;
};

std::unique_ptr<Scenario> make_ishigami(const Catalogue&) {
  return std::make_unique<Ishigami>();
}

}  // namespace
}  // namespace breakwater

int main(int argc, char** argv) {
  // Ends a process of --isolate before it begins a point.
  if (std::getenv("ISHIGAMI_TASKS_CRASH") != nullptr &&
      std::find(argv, argv + argc, std::string_view("--points")) != argv + argc) {
    std::abort();
  }
  breakwater::Catalogue catalogue;
  catalogue.add(breakwater::ScenarioKind{"ishigami", breakwater::make_ishigami, ISHIGAMI_FOLDER});
  return breakwater::program(argc, argv, catalogue);
}
