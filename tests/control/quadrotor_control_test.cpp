// Backstepping gains and law and the processes of the filters, against the thesis' numbers and an
// ODE.
#include <breakwater/control/backstepping.h>
#include <breakwater/control/quadrotor_filters.h>
#include <breakwater/control/wave_mpc.h>
#include "support.h"

namespace breakwater::quadrotor_control_test {

constexpr double kPeriod_s = 0.01;

Backstepping law(QuadrotorPhysics physics, const BacksteppingGains& alpha) {
  return {QuadrotorModel({}, physics), {.alpha = alpha}};
}

TEST(BacksteppingGains, DlqrGivesThePrintedGainsWithAHeavierZ) {
  const BacksteppingGains alpha = dlqr_gains({}, kPeriod_s);
  EXPECT_LT((alpha - printed_gains()).cwiseAbs().maxCoeff(), 2e-4) << alpha.transpose();
  EXPECT_NEAR(dlqr_gains({}, kPeriod_s, 1e3)(2), 0.994, 5e-4);  // as printed
}

// x and θ form a chain of four integrators. The attitude loop s² + (α5 + α11) s + 1 + α5 α11 must
// be faster than the position loop. On the thesis' plant the body-fixed weight doubles the lateral
// force. The law removes half of it, which stabilises the loop.
TEST(BacksteppingGains, PrintedGainsAreUnstableOnThePhysicalPlant) {
  const auto pole = [](QuadrotorPhysics physics, const BacksteppingGains& alpha) {
    return slowest_pole(law(physics, alpha), QuadrotorModel({}, physics));
  };
  QuadrotorParameters no_drag;
  no_drag.linear_drag.setZero();
  EXPECT_NEAR(slowest_pole(law(QuadrotorPhysics::physical, printed_gains()),
                           QuadrotorModel(no_drag, QuadrotorPhysics::physical)),
              0.069, 0.005);
  EXPECT_NEAR(pole(QuadrotorPhysics::physical, printed_gains()), 0.053, 0.005);  // with drag
  EXPECT_LT(pole(QuadrotorPhysics::thesis, printed_gains()), -0.1);
  EXPECT_LT(pole(QuadrotorPhysics::physical, retuned_gains({}, kPeriod_s)), -0.1);
  BacksteppingGains alpha = printed_gains();
  alpha(3) = alpha(4) = alpha(9) = alpha(10) = 2.3;
  EXPECT_GT(pole(QuadrotorPhysics::physical, alpha), 0.0);
  alpha(3) = alpha(4) = alpha(9) = alpha(10) = 2.5;
  EXPECT_LT(pole(QuadrotorPhysics::physical, alpha), 0.0);
}

// V = (Z1² + Z2²)/2 falls at the rate α Z1² + α' Z2² if the axis follows the law; here z at level
// attitude.
TEST(Backstepping, LyapunovFunctionFalls) {
  const BacksteppingGains alpha = printed_gains();
  const QuadrotorModel plant({}, QuadrotorPhysics::physical);
  testing::Random random;
  for (int i = 0; i < 20; ++i) {
    Eigen::Matrix<double, 12, 1> motion = Eigen::Matrix<double, 12, 1>::Zero();
    motion(2) = random.uniform(-3, 3);
    motion(8) = random.uniform(-3, 3);
    const Eigen::Vector4d U = law(QuadrotorPhysics::physical, alpha).wrench(motion, {0, 0, 0});
    const double drag = plant.parameters().drag(motion.tail<6>())(2);  // the modelling error
    Vector6d outside = Vector6d::Zero();
    outside(2) = drag;
    const double a =
        plant.acceleration(AttitudeTrig(Eigen::Vector3d::Zero()), motion.tail<6>(), U, outside)(2);
    const double Z1 = -motion(2), Z2 = motion(8) - alpha(2) * Z1;
    const double rate = Z1 * -motion(8) + Z2 * (a + alpha(2) * motion(8));
    EXPECT_NEAR(rate, -alpha(2) * Z1 * Z1 - alpha(8) * Z2 * Z2, 1e-10);
  }
}

TEST(Backstepping, HoldsAKnownForceAndLimitsTheTilt) {
  const Backstepping control = law(QuadrotorPhysics::physical, retuned_gains({}, kPeriod_s));
  Eigen::Matrix<double, 12, 1> rest = Eigen::Matrix<double, 12, 1>::Zero();
  const double weight = QuadrotorParameters().net_weight_N();
  EXPECT_NEAR(control.wrench(rest, {0, 0, 1.0})(0), weight - 1.0, 1e-12);
  // Far away it commands the largest tilt, 45°.
  rest(0) = -10.0;
  const double near_limit = control.wrench(rest, {0, 0, 0})(2);
  rest(0) = -100.0;
  EXPECT_DOUBLE_EQ(control.wrench(rest, {0, 0, 0})(2), near_limit);
}

// A = linear() and g = nonlinear() together are one Euler step of the model with T + d.
TEST(QuadrotorProcesses, AreEulerStepsOfTheModel) {
  const QuadrotorModel model({}, QuadrotorPhysics::thesis);
  const ThrusterDisturbance<2> process(model, kPeriod_s);
  testing::Random random;
  const Eigen::Matrix<double, 24, 1> x = random.vector(24, 0.5);
  const Eigen::Vector4d T = random.vector(4);
  Vector6d g;
  process.nonlinear(x, T, g);
  Eigen::Matrix<double, 24, 1> next = process.linear() * x;
  next.segment<6>(6) += g;
  const Vector6d v = x.segment<6>(6);
  const Eigen::Vector4d U = thruster_matrix(0.109) * (T + x.segment<4>(12));
  Eigen::Matrix<double, 24, 1> expected;
  expected << x.head<6>() + kPeriod_s * v,
      v + kPeriod_s * model.acceleration(AttitudeTrig(x.segment<3>(3)), v, U),
      x.segment<8>(12) + kPeriod_s * x.segment<8>(16), x.tail<4>();
  EXPECT_NEAR((next - expected).norm(), 0.0, 1e-14);
}

// The stationary variance of the resonators is σ²: the fixed point of V = Φ V Φᵀ + Q.
TEST(QuadrotorProcesses, ResonatorsHaveTheirVariance) {
  const ResonatorDesign design;
  for (const double omega : {0.4, 0.8, 1.3}) {
    const WaveForces<1, 1> process(QuadrotorModel({}, QuadrotorPhysics::physical), design,
                                   {{{omega, design.damping, design.force_std_N}}}, 1.0, kPeriod_s,
                                   AttitudeKinematics::level);
    Eigen::Matrix2d phi, Q = Eigen::Matrix2d::Zero();
    phi << process.linear()(12, 12), process.linear()(12, 21), process.linear()(21, 12),
        process.linear()(21, 21);
    Q(1, 1) = process.Q()(21, 21);
    Eigen::Matrix2d V = Eigen::Matrix2d::Zero();
    for (int i = 0; i < 20000; ++i) V = phi * V * phi.transpose() + Q;
    EXPECT_NEAR(std::sqrt(V(0, 0)), design.force_std_N, 0.01 * design.force_std_N);
    // The poles are those of the sampled continuous resonator.
    const double modulus = std::sqrt(phi.determinant());
    EXPECT_NEAR(modulus, std::exp(-design.damping * omega * kPeriod_s), 1e-12);
  }
}

// ---- long runs of the filters in a loop that holds the vehicle under a wave

template <typename Process>
NonlinearKalmanDesign<24, 6> endurance_design(const Process&) {
  // Q_ukf of 3.4.3.1, times δ², with R = diag(V).
  NonlinearKalmanDesign<24, 6> design;
  Eigen::Matrix<double, 24, 1> q;
  q << Eigen::Vector3d::Constant(1e-2), Eigen::Vector3d::Constant(1e-3),
      Eigen::Vector3d::Constant(1.0), Eigen::Vector3d::Constant(0.1),
      Eigen::Vector4d::Constant(5e5), Eigen::Vector4d::Constant(1e8),
      Eigen::Vector4d::Constant(1e10);
  design.Q = (1e-4 * q).asDiagonal();
  Vector6d r;
  r << 0.1, 0.1, 0.1, 0.01, 0.01, 0.01;
  design.R = r.asDiagonal();
  design.P0.setIdentity();
  return design;
}

template <>
NonlinearKalmanDesign<24, 6> endurance_design(const WaveForces<1, 1>& process) {
  NonlinearKalmanDesign<24, 6> design = endurance_design(0);
  design.Q = process.Q();
  design.R *= 0.01;
  design.P0 *= 0.1;
  return design;
}

NonlinearKalmanDesign<30, 6> endurance_design(const WaveForces<2, 2>& process) {
  NonlinearKalmanDesign<30, 6> design;
  design.Q = process.Q();
  design.R = endurance_design(0).R * 0.01;
  design.P0 = 0.1 * Eigen::Matrix<double, 30, 30>::Identity();
  return design;
}

// The vehicle of the filter's model under a vertical and a lateral force of 0.2 N and 6 s. The
// filter's estimates hold it. P must stay symmetric, finite and positive.
template <typename Filter>
void endures(Filter filter, int steps) {
  const QuadrotorModel model({}, QuadrotorPhysics::physical);
  BacksteppingDesign law_design{.alpha = retuned_gains({}, 0.01), .position_clamp_m = 1.5};
  const Backstepping law(model, law_design);
  const Eigen::Matrix4d B = thruster_matrix(0.109), to_thrusts = B.inverse();
  testing::Random random(5);
  const auto deviate = [&] {  // with variance 1
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) sum += random.uniform(-1.0, 1.0);
    return sum;
  };
  Eigen::Matrix<double, 12, 1> x = Eigen::Matrix<double, 12, 1>::Zero();
  Eigen::Vector4d T = Eigen::Vector4d::Zero();
  double smallest = 1.0;
  for (int k = 0; k < steps; ++k) {
    Vector6d y = x.head<6>();
    for (int i = 0; i < 6; ++i) y(i) += (i < 3 ? 0.1 : 0.01) * deviate();
    if (k > 0) filter.predict(T);
    filter.correct(y);
    ASSERT_TRUE(filter.P() == filter.P().transpose()) << k;
    smallest = std::min(smallest, filter.P().diagonal().minCoeff());
    T = to_thrusts * law.wrench(filter.x().template head<12>(), Eigen::Vector3d::Zero());
    T = T.cwiseMax(-25.0).cwiseMin(25.0);
    Vector6d outside = Vector6d::Zero();
    const double phase = 2.0 * M_PI / 6.0 * 0.01 * k;
    outside.head<3>() << 0.2 * std::sin(phase), 0.0, 0.2 * std::cos(phase);
    const Vector6d velocity = x.tail<6>();
    const Vector6d a = model.acceleration(AttitudeTrig(x.segment<3>(3)), velocity, B * T, outside);
    x.head<6>() += 0.01 * velocity;
    x.tail<6>() += 0.01 * a;
    ASSERT_LT(x.head<3>().norm(), 5.0) << k;
  }
  EXPECT_GT(smallest, 0.0);
  EXPECT_TRUE(filter.x().allFinite());
  if constexpr (requires { filter.repairs(); }) {
    EXPECT_EQ(filter.repairs(), 0);
  }
}

// The 24- and 30-state models in the UKF, and the thesis' model in the EKF. A million steps are
// three hours.
TEST(QuadrotorProcesses, PropertyFiltersNeedNoRepair) {
  const int steps = 10 * testing::property_count(5'000);
  const QuadrotorModel model({}, QuadrotorPhysics::physical);
  const WaveForces<1, 1> resonators(model, {}, {{{1.0, 0.08, 0.13}}}, 1.0, 0.01,
                                    AttitudeKinematics::level);
  const ThrusterDisturbance<2> polynomial(model, 0.01);
  const WaveForces<2, 2> spectrum(model, ProcessNoiseStd{2e-4, 1e-4, 5e-4, 5e-4},
                                  {{{0.81, 0.03, 0.11}, {1.13, 0.09, 0.07}}}, 0.5, 0.01,
                                  AttitudeKinematics::exact);
  endures(Ukf<WaveForces<2, 2>, 6>(spectrum, endurance_design(spectrum)), steps);
  endures(Ukf<WaveForces<1, 1>, 6>(resonators, endurance_design(resonators)), steps);
  endures(Ukf<ThrusterDisturbance<2>, 6>(polynomial, endurance_design(polynomial)), steps);
  endures(Ekf<ThrusterDisturbance<2>, 6>(polynomial, endurance_design(polynomial), 0.0), steps);
}

// The printed Q of the highest derivative alone makes it a random walk. It can also be given by
// standard deviations.
TEST(QuadrotorEstimators, NoiseOnTheHighestStateMakesItARandomWalk) {
  const QuadrotorModel model({}, QuadrotorPhysics::thesis);
  const auto after_a_climb = [&](const QuadrotorEstimatorDesign& design) {
    auto estimator = make_quadrotor_estimator(design, model);
    Vector6d pose = Vector6d::Zero();
    estimator->reset(pose);
    for (int k = 0; k < 20; ++k) {
      pose(2) = 0.01 * k * k;
      estimator->update(Eigen::Vector4d::Constant(0.1 * k), pose);
    }
    return estimator;
  };
  const double delta_s = QuadrotorEstimatorDesign().period_s;
  for (const auto& [order, walk] : {std::pair{DisturbanceOrder::zero, std::sqrt(5e5) * delta_s},
                                    std::pair{DisturbanceOrder::second, std::sqrt(1e6)}}) {
    QuadrotorEstimatorDesign all;
    all.order = order;
    QuadrotorEstimatorDesign highest = all;
    highest.only_highest_has_noise = true;
    QuadrotorEstimatorDesign tuned = all;
    tuned.noise = ProcessNoiseSource::tuned;
    tuned.velocity_std_m_s = tuned.rate_std_rad_s = 0.0;
    tuned.disturbance_std = walk;
    const auto one = after_a_climb(highest);
    const auto other = after_a_climb(tuned);
    EXPECT_LT((one->motion() - other->motion()).norm(), 1e-9);
    EXPECT_LT((one->thrust_disturbance() - other->thrust_disturbance()).norm(), 1e-6);
    EXPECT_GT((one->motion() - after_a_climb(all)->motion()).norm(), 1e-6);
  }
}

TEST(QuadrotorEstimators, TheTrackedFrequencyDependsOnEachValueOfItsDesign) {
  const QuadrotorModel model({}, QuadrotorPhysics::physical);
  const auto frequency = [&](auto&& change) {
    QuadrotorEstimatorDesign design;
    design.order = DisturbanceOrder::resonator;
    design.estimates_wave_frequency = true;
    change(design);
    const auto estimator = make_quadrotor_estimator(design, model);
    const Eigen::Vector4d hover =
        Eigen::Vector4d::Constant(0.25 * model.parameters().net_weight_N());
    Vector6d pose = Vector6d::Zero();
    estimator->reset(pose);
    for (int k = 0; k < 1800; ++k) {
      pose(2) = 0.2 * std::sin(0.008 * k) + 0.05 * std::sin(0.9 * k);
      estimator->update(hover, pose);
    }
    return estimator->wave_frequency_rad_s();
  };
  using D = QuadrotorEstimatorDesign;
  const double standard = frequency([](D&) {});
  EXPECT_NE(frequency([](D& d) { d.resonator.damping *= 2.0; }), standard);
  EXPECT_NE(frequency([](D& d) { d.resonator.force_std_N *= 2.0; }), standard);
  EXPECT_NE(frequency([](D& d) { d.resonator.bias_std_N *= 2.0; }), standard);
  EXPECT_NE(frequency([](D& d) { d.resonator.velocity_std_m_s *= 2.0; }), standard);
  EXPECT_NE(frequency([](D& d) { d.position_std_m *= 2.0; }), standard);
}

// 0.55 kg of added mass are like 0.55 kg of the body with as much more buoyancy, to every part.
TEST(QuadrotorEstimators, AddedMassIsMassWithoutWeight) {
  QuadrotorParameters added, heavy;
  added.added_mass_coefficient = 0.5;
  heavy.mass_kg += 0.55;
  heavy.volume_m3 *= 1.5;
  ASSERT_NEAR(added.net_weight_N(), heavy.net_weight_N(), 1e-12);

  EXPECT_LT((retuned_gains(added, 0.01) - retuned_gains(heavy, 0.01)).norm(), 1e-9);
  EXPECT_NEAR(horizontal_axis(added, 1.0, 6.0).B(1, 1), 1.0 / 1.93, 1e-12);
  EXPECT_NEAR(horizontal_axis(added, 1.0, 6.0).A(1, 1), -added.linear_drag(0) / 1.93, 1e-12);
  EXPECT_NEAR(vertical_axis(added).B(1, 0), 1.0 / 1.93, 1e-12);
  Eigen::Matrix<double, 12, 1> motion = Eigen::Matrix<double, 12, 1>::Zero();
  motion.head<3>() << 0.3, -0.2, 0.5;
  const auto wrench = [&](const QuadrotorParameters& vehicle) {
    const QuadrotorModel model(vehicle, QuadrotorPhysics::physical);
    return Backstepping(model, {.alpha = retuned_gains({}, 0.01)}).wrench(motion, {0.1, 0.2, 0.3});
  };
  EXPECT_LT((wrench(added) - wrench(heavy)).norm(), 1e-9);
  EXPECT_GT((wrench(added) - wrench({})).norm(), 0.1);

  for (const DisturbanceOrder order :
       {DisturbanceOrder::none, DisturbanceOrder::zero, DisturbanceOrder::second,
        DisturbanceOrder::resonator, DisturbanceOrder::spectrum}) {
    QuadrotorEstimatorDesign design;
    design.order = order;
    design.estimates_wave_frequency = true;
    design.waves.shapes = {{{{0.8, 0.03, 0.8}, {1.1, 0.09, 0.6}}},
                           {{{0.6, 0.03, 0.8}, {0.8, 0.09, 0.6}}}};
    const auto after_waves = [&](const QuadrotorParameters& vehicle) {
      auto estimator =
          make_quadrotor_estimator(design, QuadrotorModel(vehicle, QuadrotorPhysics::physical));
      Vector6d pose = Vector6d::Zero();
      estimator->reset(pose);
      for (int k = 0; k < 2000; ++k) {
        pose.head<3>() = Eigen::Vector3d(0.2, 0.1, 0.3) * std::sin(0.008 * k);
        estimator->update(Eigen::Vector4d::Constant(0.7 + 0.2 * std::sin(0.01 * k)), pose);
      }
      return estimator;
    };
    const auto one = after_waves(added), other = after_waves(heavy), without = after_waves({});
    EXPECT_LT((one->motion() - other->motion()).norm(), 1e-8);
    EXPECT_LT((one->force() - other->force()).norm(), 1e-8);
    EXPECT_NEAR(one->wave_frequency_rad_s(), other->wave_frequency_rad_s(), 1e-8);
    EXPECT_GT((one->motion() - without->motion()).norm(), 1e-6);
  }
}

TEST(QuadrotorEstimators, RefuseNonsense) {
  const QuadrotorModel model({}, QuadrotorPhysics::physical);
  QuadrotorEstimatorDesign design;
  design.noise = ProcessNoiseSource::input;
  EXPECT_REFUSED(make_quadrotor_estimator(design, model));
  design = {};
  design.order = DisturbanceOrder::resonator;
  design.filter = QuadrotorFilter::ekf;
  EXPECT_REFUSED(make_quadrotor_estimator(design, model));
  design = {};
  design.position_std_m = 0.0;
  EXPECT_REFUSED(make_quadrotor_estimator(design, model));
}

}  // namespace breakwater::quadrotor_control_test
