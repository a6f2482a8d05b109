#include <breakwater/control/quadrotor_estimator.h>

#include <cmath>
#include <numbers>
#include <optional>

#include <breakwater/control/quadrotor_filters.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

double square(double value) {
  return value * value;
}

// R_ukf = diag(V_m, V_m, V_m, V_p, V_p, V_p).
Eigen::Matrix<double, 6, 6> measurement_covariance(const QuadrotorEstimatorDesign& design) {
  Vector6d r;
  r << Eigen::Vector3d::Constant(square(design.position_std_m)),
      Eigen::Vector3d::Constant(square(design.angle_std_rad));
  return r.asDiagonal();
}

// P_0 of 3.4.3.1 for [ζ, ζ̇].
Eigen::Matrix<double, 12, 1> first_variances() {
  Eigen::Matrix<double, 12, 1> p;
  p << Eigen::Vector3d::Constant(0.1), Eigen::Vector3d::Constant(0.01),
      Eigen::Vector3d::Constant(10.0), Eigen::Vector3d::Constant(1.0);
  return p;
}

// P_0 and Q_ukf of 3.4.3.1, or the tuned Q, for [ζ, ζ̇, d, ḋ, d̈] up to the model's order.
template <int N>
NonlinearKalmanDesign<N, 6> thruster_design(const QuadrotorEstimatorDesign& design) {
  const double delta = design.period_s;
  Eigen::Matrix<double, 24, 1> p, q;
  p << first_variances(), Eigen::Vector4d::Constant(1.0), Eigen::Vector4d::Constant(10.0),
      Eigen::Vector4d::Constant(100.0);
  q.setZero();
  if (design.noise == ProcessNoiseSource::printed) {
    q << Eigen::Vector3d::Constant(1e-2), Eigen::Vector3d::Constant(1e-3),
        Eigen::Vector3d::Constant(1.0), Eigen::Vector3d::Constant(0.1),
        Eigen::Vector4d::Constant(5e5), Eigen::Vector4d::Constant(1e6 / delta),
        Eigen::Vector4d::Constant(1e6 / square(delta));
    if (design.noise_power > 0) q *= design.noise_power == 1 ? delta : square(delta);
    if (design.only_highest_has_noise) q.head<(N > 12 ? N - 4 : 6)>().setZero();
  } else if (design.noise == ProcessNoiseSource::tuned) {
    q.segment<3>(6).setConstant(square(design.velocity_std_m_s));
    q.segment<3>(9).setConstant(square(design.rate_std_rad_s));
    if (N > 12) q.segment<4>(N - 4).setConstant(square(design.disturbance_std));
  }
  NonlinearKalmanDesign<N, 6> kalman;
  kalman.Q = q.head<N>().asDiagonal();
  kalman.R = measurement_covariance(design);
  kalman.P0 = p.head<N>().asDiagonal();
  return kalman;
}

template <typename Filter>
class FilterEstimator : public QuadrotorEstimator {
 public:
  template <typename... Arguments>
  explicit FilterEstimator(Arguments&&... arguments)
      : filter_(std::forward<Arguments>(arguments)...) {}

  void reset(const Vector& pose) override {
    typename Filter::State x = Filter::State::Zero();
    x.template head<6>() = pose;
    filter_.reset(x);
    has_prior_ = true;
    estimate();
  }

  void update(const Vector& held_thrusts, const Vector& pose) override {
    if (!has_prior_) filter_.predict(held_thrusts);
    has_prior_ = false;
    filter_.correct(pose);
    estimate();
  }

  View state() const override { return {estimate_.data(), 12}; }
  View disturbance() const override { return {estimate_.data() + 12, 3}; }
  MotionCovariance motion_covariance() const override {
    return filter_.P().template topLeftCorner<12, 12>();
  }

 protected:
  virtual Eigen::Vector3d present_force() const = 0;

  Filter filter_;

 private:
  void estimate() {
    estimate_.head<12>() = filter_.x().template head<12>();
    estimate_.tail<3>() = present_force();
  }

  Eigen::Matrix<double, 15, 1> estimate_ = Eigen::Matrix<double, 15, 1>::Zero();
  bool has_prior_ = true;
};

template <typename Filter>
class ThrusterEstimator final : public FilterEstimator<Filter> {
 public:
  using FilterEstimator<Filter>::FilterEstimator;

  Eigen::Vector4d thrust_disturbance() const override {
    if constexpr (Filter::N > 12) return this->filter_.x().template segment<4>(12);
    return Eigen::Vector4d::Zero();
  }
  bool models_world_force() const override { return false; }
  bool models_disturbance() const override { return Filter::N > 12; }

 private:
  Eigen::Vector3d present_force() const override {
    return thrust_disturbance().sum() *
           AttitudeTrig(this->motion().template segment<3>(3)).thrust_axis();
  }
};

// A bank on the vertical axis, whose shapes may change. For one resonator the shapes are the
// candidates of its frequency: two equal resonators of half its variance.
WaveForceBank bank_of(const QuadrotorEstimatorDesign& design, const QuadrotorModel& model) {
  WaveForceBankDesign waves = design.waves;
  waves.mass_kg = model.parameters().moving_mass_kg();
  waves.bias_std_N = design.resonator.bias_std_N;
  waves.velocity_std_m_s = design.resonator.velocity_std_m_s;
  waves.position_std_m = design.position_std_m;
  waves.period_s = design.period_s;
  if (design.order == DisturbanceOrder::spectrum) return WaveForceBank(waves);
  waves.shapes.clear();
  for (const double period_s : candidate_periods()) {
    const Resonator half{2.0 * std::numbers::pi / period_s, design.resonator.damping,
                         std::sqrt(0.5)};
    waves.shapes.push_back({half, half});
  }
  waves.weakest_N = design.resonator.force_std_N;
  waves.strengths = 1;
  return WaveForceBank(waves);
}

// K resonators per axis. A WaveForceBank on the vertical axis, if it is there, adapts a pair to the
// sea state, or the frequency of one.
template <int K, int Order>
class WaveEstimator final : public FilterEstimator<Ukf<WaveForces<K, Order>, 6>> {
 public:
  using Process = WaveForces<K, Order>;
  using Base = FilterEstimator<Ukf<Process, 6>>;
  using typename Base::Vector;

  WaveEstimator(const QuadrotorEstimatorDesign& design, const QuadrotorModel& model,
                const std::optional<WaveForceBank>& bank,
                const typename Process::Resonators& resonators, double horizontal_share)
      : Base(filter_of(design,
                       Process(model, design.resonator, resonators, horizontal_share,
                               design.period_s, design.kinematics),
                       resonators)),
        bank_(bank),
        resonators_(resonators),
        parameters_(model.parameters()),
        design_(design) {}

  void reset(const Vector& pose) override {
    Base::reset(pose);
    if (!bank_) return;
    bank_->reset(pose(2));
    assume();
  }

  void update(const Vector& held_thrusts, const Vector& pose) override {
    if (bank_) {
      const Eigen::Vector4d thrusts = held_thrusts;
      const double up = AttitudeTrig(this->motion().template segment<3>(3)).thrust_axis().z();
      bank_->update(thrusts.sum() * up - parameters_.net_weight_N(), pose(2));
      assume();
    }
    Base::update(held_thrusts, pose);
  }

  Eigen::Vector3d force_ahead(double ahead_s) const override {
    const auto& x = filter_.x();
    Eigen::Vector3d sum = x.template segment<3>(Process::kBias);
    for (int i = 0; i < K; ++i) {
      const Resonator& r = resonators_[static_cast<std::size_t>(i)];
      const Eigen::RowVector2d free = resonator_step(r.omega_rad_s, r.damping, ahead_s).row(0);
      sum += free(0) * x.template segment<3>(Process::force_row(i)) +
             free(1) * x.template segment<3>(Process::rate_row(i));
    }
    return sum;
  }
  double wave_frequency_rad_s() const override { return mean_frequency(resonators_); }
  double wave_force_std_N() const override { return total_std(resonators_); }

 private:
  using Base::filter_;

  static Ukf<Process, 6> filter_of(const QuadrotorEstimatorDesign& design, const Process& process,
                                   const typename Process::Resonators& resonators) {
    Eigen::Matrix<double, Process::kStates, 1> p;
    p.template head<12>() = first_variances();
    p.template segment<3>(Process::kBias).setConstant(square(total_std(resonators)));
    p.template segment<3>(Process::kTorque).setConstant(square(0.05));
    for (int i = 0; i < K; ++i) {
      const double variance = square(resonators[static_cast<std::size_t>(i)].std);
      p.template segment<3>(Process::force_row(i)).setConstant(variance);
      p.template segment<3>(Process::rate_row(i)).setConstant(variance);
    }
    return {process, {process.Q(), measurement_covariance(design), p.asDiagonal()}};
  }
  Eigen::Vector3d present_force() const override {
    const auto& x = filter_.x();
    Eigen::Vector3d sum = x.template segment<3>(Process::force_row(0));
    for (int i = 1; i < K; ++i) sum += x.template segment<3>(Process::force_row(i));
    return sum + x.template segment<3>(Process::kBias);
  }
  void assume() {
    if constexpr (K == 2) {
      resonators_ = bank_->resonators();
    } else {
      resonators_[0].omega_rad_s =
          bank_->is_settling() ? design_.wave_frequency_rad_s : mean_frequency(bank_->resonators());
    }
    filter_.change_process([&](Process& process) {
      process.set_resonators(resonators_);
      process.set_torque_noise(std::hypot(design_.resonator.torque_std_Nm,
                                          design_.torque_walk_per_force_m * wave_force_std_N()));
    });
  }

  std::optional<WaveForceBank> bank_;
  typename Process::Resonators resonators_;
  QuadrotorParameters parameters_;
  QuadrotorEstimatorDesign design_;
};

template <int Order>
std::unique_ptr<QuadrotorEstimator> make_thruster_estimator(const QuadrotorEstimatorDesign& design,
                                                            const QuadrotorModel& model) {
  using Process = ThrusterDisturbance<Order>;
  const Process process(model, design.period_s, design.kinematics);
  const auto kalman = thruster_design<Process::kStates>(design);
  if (design.filter == QuadrotorFilter::ukf) {
    return std::make_unique<ThrusterEstimator<Ukf<Process, 6>>>(process, kalman);
  }
  return std::make_unique<ThrusterEstimator<Ekf<Process, 6>>>(
      process, kalman, design.noise == ProcessNoiseSource::input ? design.input_noise : 0.0);
}

}  // namespace

std::unique_ptr<QuadrotorEstimator> make_quadrotor_estimator(const QuadrotorEstimatorDesign& design,
                                                             const QuadrotorModel& model) {
  refuse_unless(design.position_std_m > 0.0 && design.angle_std_rad > 0.0,
                "quadrotor estimator: the noise's deviations must be positive");
  refuse_unless(design.noise != ProcessNoiseSource::input || design.filter == QuadrotorFilter::ekf,
                "quadrotor estimator: process noise by the input needs the EKF");
  const bool is_of_waves =
      design.order == DisturbanceOrder::resonator || design.order == DisturbanceOrder::spectrum;
  refuse_unless(!is_of_waves || design.filter == QuadrotorFilter::ukf,
                "quadrotor estimator: resonator and spectrum need the UKF");
  switch (design.order) {
    case DisturbanceOrder::none:
      return make_thruster_estimator<-1>(design, model);
    case DisturbanceOrder::zero:
      return make_thruster_estimator<0>(design, model);
    case DisturbanceOrder::second:
      return make_thruster_estimator<2>(design, model);
    case DisturbanceOrder::resonator: {
      std::optional<WaveForceBank> bank;
      if (design.estimates_wave_frequency) bank.emplace(bank_of(design, model));
      const ResonatorDesign& one = design.resonator;
      return std::make_unique<WaveEstimator<1, 1>>(
          design, model, bank,
          std::array{Resonator{design.wave_frequency_rad_s, one.damping, one.force_std_N}}, 1.0);
    }
    case DisturbanceOrder::spectrum:
      break;
  }
  const WaveForceBank bank = bank_of(design, model);
  return std::make_unique<WaveEstimator<2, 2>>(design, model, bank, bank.resonators(),
                                               kHorizontalShare);
}

}  // namespace breakwater
