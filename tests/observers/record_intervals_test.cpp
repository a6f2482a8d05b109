// Records with irregular samples: the held inputs, and the estimators' treatment of them.
#include <breakwater/linear/eigenvalues.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/record_intervals.h>
#include <breakwater/observers/state_observer.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/plants/motor_and_load.h>
#include "support.h"

namespace breakwater::record_intervals_test {

TEST(StateObserver, HasItsPolesOverEachInterval) {
  const StateSpace axis = extend_by_input_disturbance(damped_inertia(1e-3, 2e-4));
  StateSpace two = axis;  // two axes with one output each
  two.A = Eigen::MatrixXd::Zero(6, 6);
  two.A.topLeftCorner(3, 3) = two.A.bottomRightCorner(3, 3) = axis.A;
  two.B = Eigen::MatrixXd::Zero(6, 2);
  two.B.topLeftCorner(3, 1) = two.B.bottomRightCorner(3, 1) = axis.B;
  two.C = Eigen::MatrixXd::Zero(2, 6);
  two.C.topLeftCorner(1, 3) = two.C.bottomRightCorner(1, 3) = axis.C;
  const PoleGroup real = {-10.0, -20.0, -30.0};
  const PoleGroup complex = {{-15.0, 20.0}, {-15.0, -20.0}, -40.0};
  const auto expect_poles = [](const StateSpace& plant, const std::vector<PoleGroup>& poles) {
    StateObserver observer(plant, poles, 1e-3);
    const auto error_dynamics = [&observer] {
      Eigen::MatrixXd F(observer.poles(), observer.poles());
      observer.pole_matrix(F);
      return F;
    };
    const Eigen::MatrixXd regular = error_dynamics();
    for (const double h : {2e-4, 9e-4, 1.3e-3, 0.02, 0.3}) {
      observer.follow({.length_s = h});
      PoleGroup wanted;
      for (const PoleGroup& group : sample_poles(poles, h)) {
        wanted.insert(wanted.end(), group.begin(), group.end());
      }
      EXPECT_LE(testing::distance(eigenvalues(error_dynamics()), wanted), 1e-6) << h;
    }
    observer.follow({});
    EXPECT_EQ(error_dynamics(), regular) << "to the bit";
  };
  expect_poles(axis, {real});
  expect_poles(axis, {complex});
  expect_poles(two, {real, complex});
}

// Over a long interval the vibration decays, so no gain moves its poles.
TEST(StateObserver, KeepsItsGainOverAnIntervalThatNoneFits) {
  const TwoInertia arm{.motor_inertia = 1e-3,
                       .load_inertia = 1e-3,
                       .stiffness = 1.25,
                       .damping = 1e-2,
                       .load_friction = 1e-3};
  StateObserver observer(motor_and_load(arm, Side::motor), {{-30.0, -40.0, -50.0, -60.0}}, 1e-3);
  Eigen::MatrixXd F(4, 4);
  for (const double interval_s : {1e-9, 0.01, 1.0, 10.0, 100.0}) {
    EXPECT_TRUE(observer.follow({.length_s = interval_s}));
    observer.pole_matrix(F);
    EXPECT_TRUE(F.allFinite()) << interval_s;
  }
}

TEST(RecordIntervals, EqualPeriodsWithRoundedTimesAreOnePeriod) {
  std::vector<double> times;
  for (int k = 0; k < 5000; ++k) times.push_back(1e4 + 1e-3 * k);
  const std::vector<double> inputs(times.size(), 0.0);
  RecordRows rows{.times_s = times, .inputs = inputs, .period_s = 1e-3};
  EXPECT_TRUE(RecordIntervals(rows).is_regular());
  rows.instant_std_s = 1e-6;
  EXPECT_FALSE(RecordIntervals(rows).is_regular());
  rows.instant_std_s = 0.0;
  times[17] += 1e-8;
  EXPECT_FALSE(RecordIntervals(rows).is_regular());
}

TEST(RecordIntervals, InterpolatesTheInputOverAGap) {
  std::vector<double> times;
  std::vector<double> inputs;
  for (int k = 0; k < 100; ++k) {
    if (k >= 50 && k < 54) continue;
    times.push_back(0.1 * k);
    inputs.push_back(3.0 * k);
  }
  RecordRows rows{.times_s = times, .inputs = inputs, .period_s = 0.1};
  RecordIntervals after(rows);
  EXPECT_FALSE(after.is_regular());
  after.move_to(50);  // from k = 49 to k = 54: the inputs 49, …, 53 acted
  EXPECT_NEAR(after.held_input()(0), 3.0 * 51.0, 1e-9);
  EXPECT_NEAR(after.interval().length_s, 0.5, 1e-12);
  after.move_to(51);
  EXPECT_EQ(after.held_input()(0), inputs[50]);
  EXPECT_EQ(after.interval().length_s, 0.0);
  EXPECT_EQ(after.interval().input_std, 0.0);
  rows.inputs_act_before = true;
  RecordIntervals before(rows);
  before.move_to(50);  // the inputs 50, …, 54 acted
  EXPECT_NEAR(before.held_input()(0), 3.0 * 52.0, 1e-9);
}

TEST(RecordIntervals, TakesTheUncertaintyOfAMissingInputFromTheRecord) {
  testing::Random random(4);
  std::vector<double> times;
  std::vector<double> inputs;
  for (int k = 0; k < 20000; ++k) {
    if (k == 700) k += 7;
    times.push_back(1.0 * k);
    inputs.push_back(random.uniform(-1.0, 1.0));
  }
  RecordIntervals intervals({.times_s = times, .inputs = inputs, .period_s = 1.0});
  intervals.move_to(700);
  // The inputs are white with variance 1/3. The first of 8 is known, and 7/16 of the next one is
  // subtracted.
  const double n = 8.0;
  const double share = 7.0 / 16.0;
  const double first = 1.0 / n - 1.0 + share;
  const double variance = (first * first + (n - 1.0) / (n * n) + share * share) / 3.0;
  EXPECT_NEAR(intervals.interval().input_std, std::sqrt(variance), 0.02 * std::sqrt(variance));
}

// With n − 1 missing samples the state and P are those of n predictions.
TEST(KalmanEstimators, PredictOverAGapAsOverSingleSamples) {
  const double T = 1e-2;
  const ExtendedPlant plant = sample_with_disturbance_model(damped_inertia(0.5, 0.1), 1, T);
  const Eigen::Index N = plant.states();
  const KalmanDesign design{plant, uniform_noise(plant, 1e-3), Eigen::MatrixXd::Identity(1, 1),
                            Eigen::MatrixXd::Identity(N, N)};
  Kfd filter(design);
  const Eigen::VectorXd u = Eigen::VectorXd::Constant(1, 0.7);
  Eigen::VectorXd y = Eigen::VectorXd::Constant(1, 0.2);
  filter.reset(Eigen::Vector2d(0.1, 0.3));
  for (int k = 0; k < 5; ++k) filter.update(u, y);
  Eigen::VectorXd x = filter.extended_state();
  Eigen::MatrixXd P = filter.P();
  constexpr int kMissed = 7;
  constexpr double kInputStd = 0.4;
  for (int k = 0; k < kMissed; ++k) {
    x = (plant.sampled.A * x + plant.sampled.B * u).eval();
    P = (plant.sampled.A * P * plant.sampled.A.transpose() + design.Q +
         kMissed * kInputStd * kInputStd * plant.sampled.B * plant.sampled.B.transpose())
            .eval();
  }
  ASSERT_TRUE(filter.follow({.length_s = kMissed * T, .input_std = kInputStd}));
  filter.update(u, y);
  const Eigen::MatrixXd& C = plant.sampled.C;
  EXPECT_NEAR(filter.innovation()(0), y(0) - (C * x)(0), 1e-12);
  const Eigen::VectorXd K = P * C.transpose() / ((C * P * C.transpose())(0, 0) + 1.0);
  EXPECT_LE((filter.K() - K).norm(), 1e-9 * K.norm());

  // The error of the time times the speed is an error of the output. R is in units of its variance.
  for (const double output_std : {0.0, 0.5}) {
    x = filter.extended_state();
    P = filter.P();
    x = (plant.sampled.A * x + plant.sampled.B * u).eval();
    P = (plant.sampled.A * P * plant.sampled.A.transpose() + design.Q).eval();
    filter.follow({.instant_std_s = 2.0, .output_std = output_std});
    filter.update(u, y);
    const double R = 1.0 + (output_std > 0.0 ? 16.0 : 4.0) * x(1) * x(1);
    EXPECT_NEAR(filter.K()(0, 0), P(0, 0) / (P(0, 0) + R), 1e-9);
  }

  // A reset brings back the period of the design.
  Kfd fresh(design);
  filter.follow({.length_s = kMissed * T});
  for (Kfd* one : {&filter, &fresh}) {
    one->reset(Eigen::Vector2d(0.1, 0.3));
    for (int k = 0; k < 3; ++k) one->update(u, y);
  }
  EXPECT_EQ(filter.extended_state(), fresh.extended_state());

  KalmanDesign without = design;
  without.plant.continuous.reset();
  Kfd sampled(without);
  EXPECT_FALSE(sampled.follow({})) << "its plant in continuous time is not known";
}

}  // namespace breakwater::record_intervals_test
