// The time of one update of an estimator: the median of repeated runs, in nanoseconds.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include <Eigen/LU>

#include <breakwater/control/quadrotor_filters.h>
#include <breakwater/observers/eso.h>
#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/gsf.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/immkf.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/mckf.h>
#include <breakwater/observers/mdob.h>
#include <breakwater/observers/mhe.h>
#include <breakwater/observers/multiple_model_estimator.h>
#include <breakwater/observers/stf.h>
#include <breakwater/observers/tracking_differentiator.h>
#include <breakwater/observers/vbakf.h>
#include <breakwater/observers/vfakfd.h>
#include <breakwater/plants/damped_inertia.h>

using namespace breakwater;

namespace {

constexpr double kPeriod = 1e-3;
constexpr double kQuantum = 1e-3;
constexpr int kUpdates = 1'000'000;
constexpr int kRuns = 9;

// Two masses with a spring and a damper between them. Both positions are measured. The force acts
// on the first mass.
StateSpace two_masses() {
  StateSpace plant{Eigen::MatrixXd::Zero(4, 4), Eigen::MatrixXd::Zero(4, 1),
                   Eigen::MatrixXd::Zero(2, 4)};
  plant.A.topRightCorner(2, 2).setIdentity();
  plant.A.row(2) << -50, 50, -1, 1;
  plant.A.row(3) << 50, -50, 1, -1;
  plant.B(2) = 1.0;
  plant.C.leftCols(2).setIdentity();
  return plant;
}

// The time of this thread, without other load on the machine.
double thread_time_ns() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e9 * static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec);
}

double nanoseconds_per_update(DisturbanceEstimator& estimator, Eigen::Index outputs, int updates) {
  std::vector<double> times;
  Eigen::VectorXd u = Eigen::VectorXd::Zero(1), y = Eigen::VectorXd::Zero(outputs);
  for (int run = 0; run < kRuns; ++run) {
    estimator.reset(Eigen::VectorXd::Zero(estimator.state().size()));
    const double start = thread_time_ns();
    for (int k = 0; k < updates; ++k) {
      y(0) = kQuantum * (k % 7 - 3);
      u(0) = estimator.disturbance()(0);  // a loop, in which an update waits for the last one
      estimator.update(u, y);
    }
    times.push_back((thread_time_ns() - start) / updates);
  }
  std::sort(times.begin(), times.end());
  return times[kRuns / 2];
}

void report(const char* name, DisturbanceEstimator& estimator, Eigen::Index outputs,
            int updates = kUpdates) {
  std::printf("  %-34s %6.1f ns\n", name, nanoseconds_per_update(estimator, outputs, updates));
}

SensorError sensor(Eigen::Index outputs) {
  return {Eigen::VectorXd::Constant(outputs, kQuantum), Eigen::VectorXd::Zero(outputs)};
}

// The bare equations of a filter as in a textbook, with fixed-size matrices.
template <int N, int p>
class PlainFilter final : public DisturbanceEstimator {
 public:
  explicit PlainFilter(const KalmanDesign& design)
      : A_(design.plant.sampled.A),
        B_(design.plant.sampled.B),
        C_(design.plant.sampled.C),
        Q_(design.Q),
        R_(design.R),
        P0_(design.P0) {}

  void reset(const Vector& /*x*/) override {
    x_.setZero();
    P_ = P0_;
  }
  void update(const Vector& u, const Vector& y) override {
    x_ = A_ * x_ + B_ * u(0);
    P_ = A_ * P_ * A_.transpose() + Q_;
    const Eigen::Matrix<double, p, p> D = C_ * P_ * C_.transpose() + R_;
    const Eigen::Matrix<double, N, p> K = P_ * C_.transpose() * D.inverse();
    x_ += K * (Eigen::Map<const Eigen::Matrix<double, p, 1>>(y.data()) - C_ * x_);
    P_ -= K * C_ * P_;
  }
  View state() const override { return {x_.data(), N - 1}; }
  View disturbance() const override { return {x_.data() + N - 1, 1}; }

 private:
  Eigen::Matrix<double, N, N> A_;
  Eigen::Matrix<double, N, 1> B_;
  Eigen::Matrix<double, p, N> C_;
  Eigen::Matrix<double, N, N> Q_;
  Eigen::Matrix<double, p, p> R_;
  Eigen::Matrix<double, N, N> P0_;
  Eigen::Matrix<double, N, 1> x_;
  Eigen::Matrix<double, N, N> P_;
};

template <int N, int p>
void report_filters(const StateSpace& continuous) {
  const ExtendedPlant plant =
      extend_by_disturbance_model(zero_order_hold(continuous, kPeriod), 0, kPeriod);
  const KalmanDesign design{plant, input_noise(plant, 1e-2), Eigen::MatrixXd::Identity(p, p) * 1e-4,
                            Eigen::MatrixXd::Identity(N, N) * 1e-4};
  Kfd kfd(design);
  Fakfd fakfd(design, scalar_gamma(plant, 1.05));
  Vfakfd vfakfd(variable_forgetting_design(plant, 1e-8),
                {Eigen::VectorXd::Constant(p, 0.25), Eigen::VectorXd::Zero(p)});
  Vfakfd qvff(variable_forgetting_design(plant, kQvffInitialCovariance), qvff_design(sensor(p)));
  Stf stf(stf_design(plant, sensor(p), kPeriod), sensor(p));
  PlainFilter<N, p> plain(design);
  std::printf("%d states, %d output%s\n", N, p, p == 1 ? "" : "s");
  report("textbook's Kalman filter in Eigen", plain, p);
  report("KFD (and DKF)", kfd, p);
  report("FAKFD", fakfd, p);
  report("VFAKFD", vfakfd, p);
  report("QVFF", qvff, p);
  report("STF", stf, p);
}

// The published estimators, in the cases of motor_estimation.
void report_published() {
  const StateSpace motor = damped_inertia(1.0, 0.0);
  const ExtendedPlant plant = sample_with_disturbance_model(motor, 0, kPeriod);
  const auto design = [&](double q) {
    return known_sensor_design(plant, sensor(1), q, Eigen::Vector3d::Constant(1e-6));
  };
  const ImmDesign imm{.noise_ratio = 1e4, .stays_quiet = 0.999};
  ImmDesign imm_code = imm;
  imm_code.likelihood = Likelihood::code;
  constexpr int kFew = 20'000;
  report("IMMKF", *sized_immkf(design(1e-8), sensor(1), imm), 1, kFew);
  report("IMMKF, code", *sized_immkf(design(1e-8), sensor(1), imm_code), 1, kFew);
  report("MCKF", *sized_mckf(design(1e-6), sensor(1), {}), 1, kFew);
  report("MCKF, code", *sized_mckf(design(1e-6), sensor(1), {.likelihood = Likelihood::code}), 1,
         kFew);
  Eso linear(motor, {20.0}, kPeriod);
  report("ESO, linear", linear, 1, kFew);
  Eso eso(motor, {20.0, 1e-3}, kPeriod);
  report("ESO, nonlinear", eso, 1, kFew);
  TrackingDifferentiator differentiator({1.0, 100.0, 10.0, 2.0}, kPeriod);
  report("tracking differentiator", differentiator, 1, kFew);
  report("VBAKF, 10 iterations", *sized_vbakf(design(1e-4), {}), 1, kFew);
  report("GSF, 5 parts", *sized_gsf(design(1e-4), sensor(1), 5), 1, kFew);
  Mhe mhe(design(1e-4), sensor(1), 10, true);
  report("MHE, 10 samples", mhe, 1, kFew);
}

// The filters of the underwater quadrotor, with measurements of a vehicle at rest.
template <typename Filter>
void report_nonlinear(const char* name, Filter filter) {
  constexpr int kSteps = 20'000;
  std::vector<double> times;
  typename Filter::Output y = Filter::Output::Zero();
  Eigen::Vector4d thrusts = Eigen::Vector4d::Constant(0.7);
  for (int run = 0; run < kRuns; ++run) {
    filter.reset(Filter::State::Zero());
    const double start = thread_time_ns();
    for (int k = 0; k < kSteps; ++k) {
      y(0) = 0.1 * (k % 7 - 3);
      y(4) = 0.01 * (k % 5 - 2);
      thrusts(0) = 0.7 - 0.1 * filter.x()(4);
      filter.predict(thrusts);
      filter.correct(y);
    }
    times.push_back((thread_time_ns() - start) / kSteps);
  }
  std::sort(times.begin(), times.end());
  std::printf("  %-34s %6.2f us\n", name, 1e-3 * times[kRuns / 2]);
}

void report_quadrotor() {
  const QuadrotorModel model({}, QuadrotorPhysics::physical);
  const WaveForces<1, 1> resonators(model, {}, {{{1.0, 0.08, 0.13}}}, 1.0, 0.01,
                                    AttitudeKinematics::level);
  const ThrusterDisturbance<2> polynomial(model, 0.01);
  NonlinearKalmanDesign<24, 6> design;
  design.Q = resonators.Q();
  Eigen::Matrix<double, 6, 1> r;
  r << 1e-2, 1e-2, 1e-2, 1e-4, 1e-4, 1e-4;
  design.R = r.asDiagonal();
  design.P0 = 0.1 * Eigen::Matrix<double, 24, 24>::Identity();
  const WaveForces<2, 2> spectrum(model, ProcessNoiseStd{},
                                  {{{0.81, 0.03, 0.11}, {1.13, 0.09, 0.07}}}, 0.5, 0.01,
                                  AttitudeKinematics::exact);
  NonlinearKalmanDesign<30, 6> spectrum_design;
  spectrum_design.Q = spectrum.Q();
  spectrum_design.R = design.R;
  spectrum_design.P0 = 0.1 * Eigen::Matrix<double, 30, 30>::Identity();
  std::puts("24 states, 6 outputs: the underwater quadrotor (goal for the UKF: 6 us)");
  report_nonlinear("UKF, resonators", Ukf<WaveForces<1, 1>, 6>(resonators, design));
  report_nonlinear("UKF, second order", Ukf<ThrusterDisturbance<2>, 6>(polynomial, design));
  report_nonlinear("EKF, second order", Ekf<ThrusterDisturbance<2>, 6>(polynomial, design, 0.0));
  std::puts("30 states, 6 outputs: the underwater quadrotor");
  report_nonlinear("UKF, spectrum", Ukf<WaveForces<2, 2>, 6>(spectrum, spectrum_design));
}

}  // namespace

int main() {
  report_filters<3, 1>(damped_inertia(1.0, 0.0));
  report_filters<5, 2>(two_masses());
  Idob idob(damped_inertia(1.0, 0.0), {{-10.0, -20.0, -30.0}}, kPeriod);
  std::puts("3 states, 1 output");
  report("IDOB, sizes known at run time", idob, 1);
  Mdob mdob({1.0, 100.0, 10.0}, kPeriod);
  report("MDOB", mdob, 1);
  MultipleModelEstimator bank({damped_inertia(1.0, 0.0), kPeriod, sensor(1), 10.0});
  const std::string name = "QBANK, " + std::to_string(bank.models().size()) + " models";
  report(name.c_str(), bank, 1);
  report_published();
  report_quadrotor();
  return 0;
}
