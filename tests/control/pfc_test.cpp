// Controllers of single axes against their equations.
#include <Eigen/Dense>

#include <breakwater/control/axes_control.h>
#include <breakwater/control/pfc.h>
#include <breakwater/control/reference.h>
#include <breakwater/control/state_feedback.h>
#include <breakwater/linear/eigenvalues.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/plants/damped_inertia.h>
#include "support.h"

namespace breakwater::pfc_test {
namespace {

constexpr double T_s = 1e-3;

TEST(Pfc, GainsFromOneSecondMatchEq286) {
  const Pfc pfc({1.0, T_s, 3, 3});
  EXPECT_EQ(pfc.coincidence_points(), (std::vector<int>{333, 500, 1000}));
  EXPECT_NEAR(pfc.alpha(), std::exp(-0.003), 1e-15);
  EXPECT_NEAR(pfc.k_p(), 27.297, 5e-4);
  EXPECT_NEAR(pfc.k_d(), 12.012, 5e-4);
}

// Eqs. 2.78 and 2.80, with simulated responses. With as many bases as points it meets all of them.
TEST(Pfc, IsTheLeastSquaresFit) {
  const auto play = [](double effect, int l, double q, double dq, int samples) {
    for (int i = 0; i < samples; ++i) {
      q += T_s * dq;
      dq += T_s * effect * std::pow(i * T_s, l);
    }
    return q;
  };
  const double s = 0.4, q = 0.1, dq = -0.3;
  for (const PfcDesign& design : {PfcDesign{0.5, T_s, 3, 3},
                                  {0.7, T_s, 3, 3},
                                  {1.0, T_s, 3, 3},
                                  {1.2, T_s, 3, 3},
                                  {0.8, T_s, 8, 2}}) {
    const Pfc pfc(design);
    const std::vector<int>& h = pfc.coincidence_points();
    Eigen::MatrixXd responses(design.coincidence_points, design.basis_functions);
    Eigen::VectorXd missing(responses.rows());
    for (Eigen::Index j = 0; j < responses.rows(); ++j) {
      missing(j) = s - std::pow(pfc.alpha(), h[j]) * (s - q) - play(0.0, 0, q, dq, h[j]);
      for (int l = 0; l < responses.cols(); ++l) responses(j, l) = play(1.0, l, 0.0, 0.0, h[j]);
    }
    const double first = responses.colPivHouseholderQr().solve(missing)(0);
    EXPECT_NEAR(pfc.acceleration(s, q, dq), first, 1e-10 * std::abs(first))
        << design.target_response_time_s;
  }
}

TEST(Pfc, OnePointAndAStepHasItsClosedForm) {
  // h (h−1)/2 T² u = (1 − α^h)(s − q) − h T q̇
  const Pfc pfc({0.5, T_s, 1, 1});
  const double h = 500;
  EXPECT_NEAR(pfc.k_p(), (1 - std::exp(-3.0)) / (h * (h - 1) / 2 * T_s * T_s), 1e-10);
  EXPECT_NEAR(pfc.k_d(), 2 / ((h - 1) * T_s), 1e-12);
}

// Denominator of Eq. 2.87: (1 + T² k_p + T k_d) z² − (T k_d + 2) z + 1.
Eigen::Vector3d eq287_denominator(const Pfc& pfc) {
  return {1 + T_s * T_s * pfc.k_p() + T_s * pfc.k_d(), -(T_s * pfc.k_d() + 2), 1};
}

TEST(Pfc, Eq287IsTheBackwardDifferenceOfTheContinuousLoop) {
  // s² + k_d s + k_p with s = (1 − z⁻¹)/T, times T² z².
  const Pfc pfc({1.0, T_s, 3, 3});
  const Eigen::Vector3d denominator = eq287_denominator(pfc);
  for (const std::complex<double> z :
       {std::complex<double>(0.3, 0.7), {1.0, 0.0}, {-1.2, 0.1}, {0.997, 0.0}, {2.0, -3.0}}) {
    const std::complex<double> s = (1.0 - 1.0 / z) / T_s;
    const std::complex<double> expected = T_s * T_s * z * z * (s * s + pfc.k_d() * s + pfc.k_p());
    const std::complex<double> printed =
        denominator(0) * z * z + denominator(1) * z + denominator(2);
    EXPECT_LT(std::abs(printed - expected), 1e-12);
  }
}

TEST(Pfc, BothClosedLoopsAreStable) {
  const Pfc pfc({1.0, T_s, 3, 3});
  const Eigen::Vector3d d = eq287_denominator(pfc);
  Eigen::Matrix2d companion;
  companion << -d(1) / d(0), -d(2) / d(0), 1, 0;
  EXPECT_LT(testing::distance(eigenvalues(companion), {0.991111, 0.996966}), 1e-6);

  Eigen::Matrix2d A_q;
  A_q << 1, T_s, 0, 1;
  const Eigen::Vector2d B_q(0, T_s);
  const auto poles = eigenvalues(A_q - B_q * Eigen::RowVector2d(pfc.k_p(), pfc.k_d()));
  EXPECT_LT(testing::distance(poles, {0.991032, 0.996956}), 1e-6);
  for (const auto& pole : poles) EXPECT_LT(std::abs(pole), 1.0);
}

// At this time the reference's error is 5 %. The loop's error is that of its two poles.
TEST(Pfc, ErrorAtTheTargetResponseTimeMatchesThePoles) {
  const Pfc pfc({1.0, T_s, 3, 3});
  double q = 0.0, dq = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const double u = pfc.acceleration(1.0, q, dq);
    q += T_s * dq;
    dq += T_s * u;
  }
  const double fast = std::sqrt(pfc.k_d() * pfc.k_d() / 4.0 - pfc.k_p());
  const double s_1 = -pfc.k_d() / 2.0 + fast;
  const double s_2 = -pfc.k_d() / 2.0 - fast;
  const double error = (s_1 * std::exp(s_2) - s_2 * std::exp(s_1)) / (s_1 - s_2);
  EXPECT_NEAR(error, 0.072, 0.002);
  EXPECT_NEAR(1.0 - q, error, 0.001);
}

TEST(Pfc, RefusesNonsense) {
  EXPECT_REFUSED(Pfc({0.0, T_s, 3, 3}));
  EXPECT_REFUSED(Pfc({1.0, 0.0, 3, 3}));
  EXPECT_REFUSED(Pfc({std::nan(""), T_s, 3, 3}));
  EXPECT_REFUSED(Pfc({1.0, T_s, 2, 3}));
  EXPECT_REFUSED(Pfc({1.0, T_s, 3, 0}));
  EXPECT_REFUSED(Pfc({0.003, T_s, 3, 3}));
  EXPECT_REFUSED(Pfc({1e9, T_s, 3, 3}));
}

TEST(Reference, HasItsShapes) {
  Reference r{.value = 2.0,
              .from_s = 1.0,
              .reversed_from_s = 3.0,
              .before = 0.5,
              .frequency_rad_s = 4.0,
              .table = {.times_s = {0.0, 1.0}, .values = {1.0, 3.0}}};
  const auto expect = [&](ReferenceShape kind, std::initializer_list<double> values) {
    r.kind = kind;
    double time_s = 0.0;
    for (const double value : values) {
      EXPECT_DOUBLE_EQ(r.at(time_s), value) << time_s;
      time_s += 0.5;
    }
  };
  expect(ReferenceShape::hold, {0.5, 0.5, 0.5, 0.5});
  expect(ReferenceShape::step, {0.5, 0.5, 2.0, 2.0, 2.0, 2.0, -2.0});
  expect(ReferenceShape::sine, {0.5, 0.5, 0.5, 0.5 + 2.0 * std::sin(2.0)});
  expect(ReferenceShape::csv, {0.5, 0.5, 1.0, 2.0, 3.0, 3.0});
}

// Commands the sum of its sample.
class Sum final : public Controller {
 public:
  Sum() { publish({"sum", "1", "sum of the sample", view(sum_)}); }
  void reset(const Sample& first) override { sum_ = first.y.sum(); }
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override {
    u(0) = sum_ = y.time_s + y.y.sum();
  }
  void set_watched(bool is_watched) override { sum_ = is_watched ? 1.0 : -1.0; }

 private:
  double sum_ = 0.0;
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
  sample.y.resize(10);  // the last one is shared
  sample.y << 1, 2, 3, 10, 20, 30, 100, 200, 300, 4000;
  control.reset(sample);
  expect_sums(4111.0, 4222.0, 4333.0);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(2);
  control.update(sample, u);
  expect_sums(4111.5, 4222.5, 4333.5);
  EXPECT_EQ(u, Eigen::Vector2d(4111.5, 4333.5));
  control.set_watched(false);
  expect_sums(-1.0, -1.0, -1.0);
}

constexpr double kPeriod = 0.01;

std::unique_ptr<DisturbanceEstimator> idob(const StateSpace& plant) {
  return std::make_unique<Idob>(plant, std::vector<PoleGroup>{{-20.0, -25.0, -30.0}}, kPeriod);
}

DisturbanceCancellingPdDesign design() {
  return {.k_p = 10.0,
          .k_d = 5.0,
          .loop = {.reference = {0.5, 1.0}, .period_s = kPeriod, .units = rotation_units()}};
}

// Runs the loop on the exactly sampled plant with a constant disturbance. Returns the last state.
Eigen::Vector2d run_loop(DisturbanceCancellingPd& controller, double disturbance, double limit,
                         int samples) {
  const StateSpace plant = zero_order_hold(damped_inertia(1.0, 0.0), kPeriod);
  Eigen::Vector2d x = Eigen::Vector2d::Zero();
  Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
  Sample sample{0.0, Eigen::VectorXd::Zero(1)};
  controller.reset(sample);
  for (int k = 0; k < samples; ++k) {
    sample.time_s = k * kPeriod;
    sample.y(0) = x(0);
    controller.update(sample, u);
    x = plant.A * x + plant.B * (std::clamp(u(0), -limit, limit) - disturbance);
  }
  return x;
}

TEST(DisturbanceCancellingPd, ReachesItsReferenceUnderAnyDisturbance) {
  for (const double d : {0.0, 7.0, -3.0}) {
    DisturbanceCancellingPd controller(idob(damped_inertia(1.0, 0.0)), design());
    const Eigen::Vector2d x = run_loop(controller, d, INFINITY, 1500);
    EXPECT_NEAR(x(0), 0.5, 1e-9) << d;
    EXPECT_NEAR(controller.estimator().disturbance()(0), d, 1e-9);
  }
}

TEST(DisturbanceCancellingPd, PassesTheDriveLimitsToTheEstimator) {
  // The drive's limit is too small for d = 5. The estimate must stay bounded.
  auto limited = design();
  limited.loop.force_limit = 2.0;
  DisturbanceCancellingPd controller(idob(damped_inertia(1.0, 0.0)), limited);
  run_loop(controller, 5.0, 2.0, 300);
  EXPECT_NEAR(controller.estimator().disturbance()(0), 5.0, 1e-3);
}

TEST(DisturbanceCancellingPd, RefusesNonsense) {
  auto bad = design();
  bad.loop.force_limit = 0.0;
  EXPECT_REFUSED(DisturbanceCancellingPd(idob(damped_inertia(1.0, 0.0)), bad));
  bad = design();
  bad.loop.period_s = -1.0;
  EXPECT_REFUSED(DisturbanceCancellingPd(idob(damped_inertia(1.0, 0.0)), bad));
  const StateSpace two{Eigen::MatrixXd::Zero(3, 3), Eigen::Vector3d(0, 0, 1),
                       Eigen::RowVector3d(1, 0, 0)};
  StateSpace chain = two;
  chain.A(0, 1) = chain.A(1, 2) = 1.0;
  EXPECT_REFUSED(DisturbanceCancellingPd(
      std::make_unique<Idob>(chain, std::vector<PoleGroup>{{-1.0, -2.0, -3.0, -4.0}}, kPeriod),
      design()));
}

}  // namespace
}  // namespace breakwater::pfc_test
