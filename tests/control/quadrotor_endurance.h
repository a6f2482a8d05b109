// Long runs of the quadrotor's filters in a loop that holds the vehicle under a wave.
#pragma once

#include <breakwater/control/backstepping.h>
#include <breakwater/control/quadrotor_filters.h>
#include "support.h"

namespace breakwater::testing {

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
inline NonlinearKalmanDesign<24, 6> endurance_design(const WaveResonators& process) {
  NonlinearKalmanDesign<24, 6> design = endurance_design(0);
  design.Q = process.Q();
  design.R *= 0.01;
  design.P0 *= 0.1;
  return design;
}

inline NonlinearKalmanDesign<30, 6> endurance_design(const WaveForces<2, 2>& process) {
  NonlinearKalmanDesign<30, 6> design;
  design.Q = process.Q();
  design.R = endurance_design(0).R * 0.01;
  design.P0 = 0.1 * Eigen::Matrix<double, 30, 30>::Identity();
  return design;
}

/// The vehicle of the filter's model under a vertical and a lateral force of 0.2 N and 6 s. The
/// filter's estimates hold it. P must stay symmetric, finite and positive.
template <typename Filter>
void endures(Filter filter, int steps) {
  const QuadrotorModel model({}, QuadrotorPhysics::physical);
  BacksteppingDesign law_design{.alpha = retuned_gains({}, 0.01), .position_clamp_m = 1.5};
  const Backstepping law(model, law_design);
  const Eigen::Matrix4d B = thruster_matrix(0.109), to_thrusts = B.inverse();
  Random random(5);
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

/// The 24- and 30-state models in the UKF, and the thesis' model in the EKF.
inline void all_endure(int steps) {
  const QuadrotorModel model({}, QuadrotorPhysics::physical);
  const WaveResonators resonators(model, {}, 1.0, 0.01);
  const ThrusterDisturbance<2> polynomial(model, 0.01);
  const WaveForces<2, 2> spectrum(model, ProcessNoiseStd{2e-4, 1e-4, 5e-4, 5e-4},
                                  {{{0.81, 0.03, 0.11}, {1.13, 0.09, 0.07}}}, 0.5, 0.01,
                                  AttitudeKinematics::exact);
  endures(Ukf<WaveForces<2, 2>, 6>(spectrum, endurance_design(spectrum)), steps);
  endures(Ukf<WaveResonators, 6>(resonators, endurance_design(resonators)), steps);
  endures(Ukf<ThrusterDisturbance<2>, 6>(polynomial, endurance_design(polynomial)), steps);
  endures(Ekf<ThrusterDisturbance<2>, 6>(polynomial, endurance_design(polynomial), 0.0), steps);
}

}  // namespace breakwater::testing
