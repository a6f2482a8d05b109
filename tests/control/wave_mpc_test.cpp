// Forecasts of the wave force and the predictive control that takes them.
#include <breakwater/control/wave_mpc.h>
#include <breakwater/linear/riccati.h>
#include "control/controller_signal.h"
#include "support.h"

namespace breakwater::wave_mpc_test {

const QuadrotorModel kVehicle({}, QuadrotorPhysics::physical);

TEST(AutoregressiveModel, ForecastOfASinusoidIsExact) {
  for (const int spacing : {1, 4}) {
    AutoregressiveModel model({.order = 2, .spacing = spacing, .memory = 600.0, .largest = 10.0});
    const auto wave = [](double k) { return 0.3 * std::sin(0.11 * k + 0.4); };
    const int last = 6000;
    for (int k = 0; k <= last; ++k) model.update(wave(k));
    Eigen::RowVectorXd future(40);
    model.forecast(future);
    for (int i = 0; i < 40; ++i) EXPECT_NEAR(future(i), wave(last + 1 + i), 1e-5) << spacing;
    // y(k) = 2 cos(ω s) y(k − s) − y(k − 2s)
    EXPECT_NEAR(model.coefficients()(1), 2.0 * std::cos(0.11 * spacing), 1e-3);
    EXPECT_NEAR(model.coefficients()(2), -1.0, 1e-3);
  }
}

TEST(AutoregressiveModel, IsFiniteForAnyFiniteInput) {
  const AutoregressiveDesign design{.order = 4, .spacing = 3, .memory = 20.0, .largest = 25.0};
  AutoregressiveModel model(design);
  testing::Random random(3);
  Eigen::RowVectorXd future(50);
  for (int k = 0; k < 20000; ++k) {
    const int kind = k / 2000 % 4;  // rest, huge, noise, constant
    model.update(kind == 0   ? 0.0
                 : kind == 1 ? std::pow(10.0, random.uniform(-300.0, 300.0)) * (k % 2 ? 1 : -1)
                 : kind == 2 ? random.uniform(-1.0, 1.0)
                             : 3.0);
    model.forecast(future);
    ASSERT_TRUE(model.coefficients().allFinite()) << k;
    ASSERT_LE(future.cwiseAbs().maxCoeff(), design.largest) << k;
  }
}

TEST(AutoregressiveModel, AResetForgetsAllSamples) {
  const AutoregressiveDesign design{.order = 3, .spacing = 2, .memory = 20.0, .largest = 25.0};
  AutoregressiveModel used(design), fresh(design);
  for (int k = 0; k < 50; ++k) used.update(std::sin(0.3 * k));
  used.reset();
  for (int k = 0; k < 20; ++k) {
    used.update(std::cos(0.2 * k));
    fresh.update(std::cos(0.2 * k));
    ASSERT_EQ(used.coefficients(), fresh.coefficients()) << k;
  }
}

TEST(AutoregressiveModel, RefusesNonsense) {
  EXPECT_REFUSED(AutoregressiveModel({.order = 0}));
  EXPECT_REFUSED(AutoregressiveModel({.spacing = 0}));
  EXPECT_REFUSED(AutoregressiveModel({.memory = 0.5}));
  EXPECT_REFUSED(AutoregressiveModel({.largest = 0.0}));
}

// A vehicle under a regular vertical force whose frequency the resonator has. Without noise and
// nearly without damping, the forecast is the force's closed form.
TEST(ForceForecast, EstimatorForeseesARegularWave) {
  constexpr double kOmega = 1.0, kPeriod_s = 0.01, kMass_kg = 1.38;
  QuadrotorEstimatorDesign design;
  design.order = DisturbanceOrder::resonator;
  design.resonator.damping = 1e-3;
  design.resonator.bias_std_N = 1e-6;
  design.wave_frequency_rad_s = kOmega;
  design.position_std_m = 1e-3;
  const auto estimator = make_quadrotor_estimator(design, kVehicle);
  const auto force = [&](double t) { return 0.2 * std::cos(kOmega * t); };
  const auto height = [&](double t) {
    return -0.2 / kMass_kg / kOmega / kOmega * std::cos(kOmega * t);
  };
  const auto speed = [&](double t) { return 0.2 / kMass_kg / kOmega * std::sin(kOmega * t); };
  const int last = 8000;
  estimator->reset(Vector6d::Unit(2) * height(0.0));
  for (int k = 0; k <= last; ++k) {
    const double t = kPeriod_s * k;
    Vector6d velocity = Vector6d::Zero();
    velocity(2) = speed(t);
    const double hover =
        kVehicle.parameters().net_weight_N() + kVehicle.parameters().drag(velocity)(2);
    estimator->update(Eigen::Vector4d::Constant(0.25 * hover), Vector6d::Unit(2) * height(t));
  }
  EstimatorForecast forecast(0.1, true);
  ForceTable forces(3, 41);
  forecast.update(0.0, *estimator, forces);
  for (int i = 0; i <= 40; ++i) {
    EXPECT_NEAR(forces(2, i), force(kPeriod_s * last + 0.1 * i), 0.02 * 0.2) << i;
  }
  EstimatorForecast held(0.1, false);
  held.update(0.0, *estimator, forces);
  EXPECT_EQ(forces(2, 40), forces(2, 0));
}

// Without disturbance and active bounds the input is that of the Riccati recursion for [x; u], with
// the horizon's own last weight.
TEST(WaveMpc, WithoutDisturbanceEqualsTheRiccatiRecursion) {
  const WaveMpcDesign design{.period_s = 0.1, .prediction_steps = 25, .q_velocity = 0.4};
  const double r = 0.3;
  for (const StateSpace& axis :
       {horizontal_axis(kVehicle.parameters(), 6.0, 6.0), vertical_axis(kVehicle.parameters())}) {
    const Eigen::Index n = axis.states();
    const StateSpace sampled = zero_order_hold(axis, design.period_s);
    Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n + 1, n + 1);
    A.topLeftCorner(n, n) = sampled.A;
    A.topRightCorner(n, 1) = sampled.B.col(0);
    Eigen::VectorXd B = Eigen::VectorXd::Ones(n + 1);
    B.head(n) = sampled.B.col(0);
    Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(n + 1, n + 1);
    Q(0, 0) = 1.0, Q(1, 1) = design.q_velocity;
    Eigen::MatrixXd P = Eigen::MatrixXd::Zero(n + 1, n + 1);
    P.topLeftCorner(n, n) = dlqr(A, B, Q, Eigen::MatrixXd::Constant(1, 1, r)).P.topLeftCorner(n, n);
    Eigen::RowVectorXd K;
    for (int i = 0; i < design.prediction_steps; ++i) {
      const Eigen::MatrixXd weight = P;
      K = (B.transpose() * weight * A) / (r + B.dot(weight * B));
      P = Q + A.transpose() * weight * (A - B * K);
    }
    AxisMpc mpc(axis, design, r, -1e3, 1e3);
    testing::Random random(4);
    double last = 0.0;
    for (int k = 0; k < 10; ++k) {
      const Eigen::VectorXd x = random.vector(n, 1.0);
      Eigen::VectorXd extended(n + 1);
      extended << x, last;
      const double expected = last - K.dot(extended);
      last = mpc.input(x, Eigen::RowVectorXd::Zero(design.prediction_steps + 1));
      EXPECT_NEAR(last, expected, 1e-8 * (1.0 + std::abs(expected)));
    }
  }
}

// A horizontal axis under a regular wave. The vehicle must turn first, so a known future leaves
// less than a fifth of the error that the present force leaves.
TEST(WaveMpc, AKnownFutureRejectsWhatTheTiltIsTooSlowFor) {
  const WaveMpcDesign design{.period_s = 0.1, .prediction_steps = 40, .q_velocity = 0.1};
  const StateSpace axis = horizontal_axis(kVehicle.parameters(), 6.0, 6.0);
  const StateSpace fine = zero_order_hold(axis, 0.01);
  const auto rmse = [&](bool is_told) {
    AxisMpc mpc(axis, design, 1e-2, -2.0, 2.0);
    const auto wave = [](double t) { return 0.2 * std::sin(1.1 * t); };
    Eigen::VectorXd x = Eigen::VectorXd::Zero(4);
    Eigen::RowVectorXd forecast(design.prediction_steps + 1);
    double sum = 0.0, u = 0.0;
    for (int k = 0; k < 6000; ++k) {
      const double t = 0.01 * k;
      if (k % 10 == 0) {
        for (Eigen::Index i = 0; i < forecast.size(); ++i) {
          forecast(i) = wave(is_told ? t + 0.1 * static_cast<double>(i) : t);
        }
        u = mpc.input(x, forecast);
      }
      x = fine.A * x + fine.B * Eigen::Vector2d(u, wave(t + 0.005));
      if (k >= 3000) sum += x(0) * x(0) / 3000.0;
    }
    return std::sqrt(sum);
  };
  EXPECT_LT(rmse(true), 0.2 * rmse(false));
}

TEST(WaveMpc, KeepsItsBounds) {
  const WaveMpcDesign design;
  AxisMpc mpc(vertical_axis(kVehicle.parameters()), design, 1e-3, -0.5, 1.5);
  const Eigen::RowVectorXd none = Eigen::RowVectorXd::Zero(design.prediction_steps + 1);
  EXPECT_NEAR(mpc.input(Eigen::Vector2d(10.0, 0.0), none), -0.5, 1e-7);
  EXPECT_NEAR(mpc.input(Eigen::Vector2d(-10.0, 0.0), none), 1.5, 1e-7);
}

// Each column has its number.
class Numbers final : public ForceForecast {
 public:
  void update(double, const QuadrotorEstimator&, ForceTable& forces) override {
    for (Eigen::Index i = 0; i < forces.cols(); ++i) {
      forces.col(i).setConstant(static_cast<double>(i));
    }
  }
};

TEST(WaveMpc, AsksForTheForceUpToTheEndOfItsHorizon) {
  const Backstepping law(kVehicle, {.alpha = retuned_gains({}, 0.01)});
  const WaveMpcDesign design{.prediction_steps = 12};
  QuadrotorEstimatorDesign resonator;
  resonator.order = DisturbanceOrder::resonator;
  WaveMpc mpc(law, make_quadrotor_estimator(resonator, kVehicle), std::make_unique<Numbers>(),
              design, 0.01);
  Sample sample;
  sample.y.setZero(6);
  mpc.reset(sample);
  Eigen::VectorXd u(4);
  mpc.update(sample, u);
  EXPECT_EQ(testing::signal(mpc, "force_forecast_N"),
            Eigen::Vector3d::Constant(design.prediction_steps));
}

TEST(WaveMpc, RefusesNonsense) {
  const Backstepping law(kVehicle, {.alpha = retuned_gains({}, 0.01)});
  const auto make = [&](DisturbanceOrder order, double period_s) {
    QuadrotorEstimatorDesign design;
    design.order = order;
    return WaveMpc(law, make_quadrotor_estimator(design, kVehicle),
                   std::make_unique<EstimatorForecast>(period_s, true), {.period_s = period_s},
                   0.01);
  };
  EXPECT_NO_THROW(make(DisturbanceOrder::resonator, 0.1));
  EXPECT_REFUSED(make(DisturbanceOrder::zero, 0.1));
  EXPECT_REFUSED(make(DisturbanceOrder::resonator, 0.015));
}

}  // namespace breakwater::wave_mpc_test
