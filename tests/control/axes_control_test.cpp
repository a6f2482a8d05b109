#include <breakwater/control/axes_control.h>

#include <memory>
#include <string>

#include "support.h"

namespace breakwater {
namespace {

// Commands the sum of its sample.
class Sum final : public Controller {
 public:
  Sum() { signals_ = {{"sum", "1", "sum of the sample", view(sum_)}}; }
  void reset(const Sample& first) override { sum_ = first.y.sum(); }
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override {
    u(0) = sum_ = y.time_s + y.y.sum();
  }
  std::span<const Signal> signals() const override { return signals_; }
  void set_watched(bool is_watched) override { sum_ = is_watched ? 1.0 : -1.0; }

 private:
  double sum_ = 0.0;
  std::vector<Signal> signals_;
};

TEST(AxesControl, GivesEachAxisItsPartAndItsCommand) {
  std::vector<AxisControl> axes;
  for (const char* name : {"a", "b", "c"}) {
    axes.push_back({name, std::make_unique<Sum>(), name != std::string("b")});
  }
  AxesControl control(std::move(axes), 3);
  ASSERT_EQ(control.signals().size(), 3u);
  EXPECT_EQ(control.signals()[1].name, "b_sum");
  const auto expect_sums = [&](double a, double b, double c) {
    const double expected[] = {a, b, c};
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(control.signals()[i].values[0], expected[i]);
  };
  Sample sample;
  sample.time_s = 0.5;
  sample.y.resize(9);
  sample.y << 1, 2, 3, 10, 20, 30, 100, 200, 300;
  control.reset(sample);
  expect_sums(111.0, 222.0, 333.0);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(2);
  control.update(sample, u);
  expect_sums(111.5, 222.5, 333.5);
  EXPECT_EQ(u, Eigen::Vector2d(111.5, 333.5));
  control.set_watched(false);
  expect_sums(-1.0, -1.0, -1.0);
}

}  // namespace
}  // namespace breakwater
