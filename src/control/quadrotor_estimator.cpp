#include <breakwater/control/quadrotor_estimator.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include <breakwater/control/quadrotor_filters.h>

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
  switch (design.noise) {
    case ProcessNoiseSource::printed: {
      q << Eigen::Vector3d::Constant(1e-2), Eigen::Vector3d::Constant(1e-3),
          Eigen::Vector3d::Constant(1.0), Eigen::Vector3d::Constant(0.1),
          Eigen::Vector4d::Constant(5e5), Eigen::Vector4d::Constant(1e6 / delta),
          Eigen::Vector4d::Constant(1e6 / square(delta));
      if (design.noise_mode == ProcessNoiseMode::delta) q *= delta;
      if (design.noise_mode == ProcessNoiseMode::delta_squared) q *= square(delta);
      if (design.noise_states == ProcessNoiseStates::highest)
        q.head<(N > 12 ? N - 4 : 6)>().setZero();
      break;
    }
    case ProcessNoiseSource::tuned:
      q.segment<3>(6).setConstant(square(design.velocity_std_m_s));
      q.segment<3>(9).setConstant(square(design.rate_std_rad_s));
      if (N > 12) q.segment<4>(N - 4).setConstant(square(design.disturbance_std));
      break;
    case ProcessNoiseSource::input:
      break;
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

  void reset(const Vector6d& pose) override {
    typename Filter::State x = Filter::State::Zero();
    x.template head<6>() = pose;
    filter_.reset(x);
    motion_ = x.template head<12>();
    has_prior_ = true;
  }

  void update(const Eigen::Vector4d& held_thrusts, const Vector6d& pose) override {
    if (!has_prior_) filter_.predict(held_thrusts);
    has_prior_ = false;
    filter_.correct(pose);
    motion_ = filter_.x().template head<12>();
  }

  const Motion& motion() const override { return motion_; }
  MotionCovariance motion_covariance() const override {
    return filter_.P().template topLeftCorner<12, 12>();
  }

 protected:
  Filter filter_;

 private:
  Motion motion_ = Motion::Zero();
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
  Eigen::Vector3d force() const override {
    return thrust_disturbance().sum() *
           AttitudeTrig(this->motion().template segment<3>(3)).thrust_axis();
  }
  bool models_world_force() const override { return false; }
  bool models_disturbance() const override { return Filter::N > 12; }
};

// A bank on the vertical axis, whose shapes may change.
WaveForceBankDesign bank_design(const QuadrotorEstimatorDesign& design,
                                const QuadrotorModel& model) {
  WaveForceBankDesign waves = design.waves;
  waves.mass_kg = model.parameters().moving_mass_kg();
  waves.bias_std_N = design.resonator.bias_std_N;
  waves.velocity_std_m_s = design.resonator.velocity_std_m_s;
  waves.position_std_m = design.position_std_m;
  waves.period_s = design.period_s;
  return waves;
}

// The candidates of the frequency of one resonator, which two equal ones of half its variance are.
WaveForceBank frequency_bank(const QuadrotorEstimatorDesign& design, const QuadrotorModel& model) {
  WaveForceBankDesign waves = bank_design(design, model);
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

// The known vertical force on the vehicle at this motion [N].
double known_vertical_force(const Eigen::Vector4d& thrusts,
                            const QuadrotorEstimator::Motion& motion,
                            const QuadrotorParameters& parameters) {
  const double up = AttitudeTrig(motion.segment<3>(3)).thrust_axis().z();
  return thrusts.sum() * up - parameters.net_weight_N();
}

class ResonatorEstimator final : public FilterEstimator<Ukf<WaveResonators, 6>> {
 public:
  ResonatorEstimator(const QuadrotorEstimatorDesign& design, const QuadrotorModel& model,
                     const WaveResonators& process, const NonlinearKalmanDesign<24, 6>& kalman)
      : FilterEstimator(process, kalman),
        guess_rad_s_(design.wave_frequency_rad_s),
        force_std_N_(design.resonator.force_std_N),
        damping_(design.resonator.damping),
        parameters_(model.parameters()) {
    if (design.estimates_wave_frequency) bank_.emplace(frequency_bank(design, model));
  }

  void reset(const Vector6d& pose) override {
    FilterEstimator::reset(pose);
    if (!bank_) return;
    bank_->reset(pose(2));
    assume(guess_rad_s_);
  }

  void update(const Eigen::Vector4d& held_thrusts, const Vector6d& pose) override {
    if (bank_) {
      bank_->update(known_vertical_force(held_thrusts, motion(), parameters_), pose(2));
      assume(wave_frequency_rad_s());
    }
    FilterEstimator::update(held_thrusts, pose);
  }

  Eigen::Vector4d thrust_disturbance() const override { return Eigen::Vector4d::Zero(); }
  Eigen::Vector3d force() const override {
    return filter_.x().segment<3>(12) + filter_.x().segment<3>(15);
  }
  Eigen::Vector3d force_ahead(double ahead_s) const override {
    const Eigen::RowVector2d free =
        resonator_step(wave_frequency_rad_s(), damping_, ahead_s).row(0);
    const auto& x = filter_.x();
    return free(0) * x.segment<3>(12) + free(1) * x.segment<3>(21) + x.segment<3>(15);
  }
  bool models_world_force() const override { return true; }
  bool models_disturbance() const override { return true; }
  double wave_force_std_N() const override { return force_std_N_; }
  double wave_frequency_rad_s() const override {
    return bank_ && !bank_->is_settling() ? mean_frequency(bank_->resonators()) : guess_rad_s_;
  }

 private:
  void assume(double omega_rad_s) {
    filter_.change_process([&](WaveResonators& p) { p.set_frequency(omega_rad_s); });
    filter_.set_process_noise(filter_.process().Q());
  }

  double guess_rad_s_;
  double force_std_N_;
  double damping_;
  QuadrotorParameters parameters_;
  std::optional<WaveForceBank> bank_;  // if the frequency is estimated
};

// Two resonators per axis. A WaveForceBank on the vertical axis adapts them to the sea state.
class SpectrumEstimator final : public FilterEstimator<Ukf<WaveForces<2, 2>, 6>> {
 public:
  using Process = WaveForces<2, 2>;

  SpectrumEstimator(const QuadrotorEstimatorDesign& design, const QuadrotorModel& model,
                    const WaveForceBank& bank, const Process& process,
                    const NonlinearKalmanDesign<Process::kStates, 6>& kalman)
      : FilterEstimator(process, kalman),
        bank_(bank),
        parameters_(model.parameters()),
        torque_walk_Nm_(design.resonator.torque_std_Nm),
        torque_walk_per_force_m_(design.torque_walk_per_force_m) {}

  void reset(const Vector6d& pose) override {
    FilterEstimator::reset(pose);
    bank_.reset(pose(2));
    assume();
  }

  void update(const Eigen::Vector4d& held_thrusts, const Vector6d& pose) override {
    bank_.update(known_vertical_force(held_thrusts, motion(), parameters_), pose(2));
    assume();
    FilterEstimator::update(held_thrusts, pose);
  }

  Eigen::Vector4d thrust_disturbance() const override { return Eigen::Vector4d::Zero(); }
  Eigen::Vector3d force() const override {
    const auto& x = filter_.x();
    return x.segment<3>(Process::force_row(0)) + x.segment<3>(Process::force_row(1)) +
           x.segment<3>(Process::kBias);
  }
  Eigen::Vector3d force_ahead(double ahead_s) const override {
    const auto& x = filter_.x();
    Eigen::Vector3d sum = x.segment<3>(Process::kBias);
    for (int i = 0; i < 2; ++i) {
      const Resonator& r = bank_.resonators()[static_cast<std::size_t>(i)];
      const Eigen::RowVector2d free = resonator_step(r.omega_rad_s, r.damping, ahead_s).row(0);
      sum += free(0) * x.segment<3>(Process::force_row(i)) +
             free(1) * x.segment<3>(Process::rate_row(i));
    }
    return sum;
  }
  bool models_world_force() const override { return true; }
  bool models_disturbance() const override { return true; }
  double wave_frequency_rad_s() const override { return mean_frequency(bank_.resonators()); }
  double wave_force_std_N() const override { return total_std(bank_.resonators()); }

 private:
  void assume() {
    filter_.change_process([&](Process& process) {
      process.set_resonators(bank_.resonators());
      process.set_torque_noise(
          std::hypot(torque_walk_Nm_, torque_walk_per_force_m_ * wave_force_std_N()));
    });
    filter_.set_process_noise(filter_.process().Q());
  }

  WaveForceBank bank_;
  QuadrotorParameters parameters_;
  double torque_walk_Nm_;
  double torque_walk_per_force_m_;
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

std::unique_ptr<QuadrotorEstimator> make_resonator(const QuadrotorEstimatorDesign& design,
                                                   const QuadrotorModel& model) {
  const WaveResonators process(model, design.resonator, design.wave_frequency_rad_s,
                               design.period_s, design.kinematics);
  NonlinearKalmanDesign<24, 6> kalman;
  kalman.Q = process.Q();
  kalman.R = measurement_covariance(design);
  const double force = square(design.resonator.force_std_N);
  Eigen::Matrix<double, 24, 1> p;
  p << first_variances(), Eigen::Vector3d::Constant(force), Eigen::Vector3d::Constant(force),
      Eigen::Vector3d::Constant(square(0.05)), Eigen::Vector3d::Constant(force);
  kalman.P0 = p.asDiagonal();
  return std::make_unique<ResonatorEstimator>(design, model, process, kalman);
}

std::unique_ptr<QuadrotorEstimator> make_spectrum(const QuadrotorEstimatorDesign& design,
                                                  const QuadrotorModel& model) {
  using Process = SpectrumEstimator::Process;
  const WaveForceBank bank(bank_design(design, model));
  const ResonatorPair& first = bank.resonators();
  const Process process(model, design.resonator.process_noise(), first, kHorizontalShare,
                        design.period_s, design.kinematics);
  NonlinearKalmanDesign<Process::kStates, 6> kalman;
  kalman.Q = process.Q();
  kalman.R = measurement_covariance(design);
  const auto variance = [&](std::size_t i) {
    return Eigen::Vector3d::Constant(square(first[i].std));
  };
  Eigen::Matrix<double, Process::kStates, 1> p;
  p << first_variances(), variance(0), Eigen::Vector3d::Constant(square(total_std(first))),
      Eigen::Vector3d::Constant(square(0.05)), variance(0), variance(1), variance(1);
  kalman.P0 = p.asDiagonal();
  return std::make_unique<SpectrumEstimator>(design, model, bank, process, kalman);
}

}  // namespace

std::unique_ptr<QuadrotorEstimator> make_quadrotor_estimator(const QuadrotorEstimatorDesign& design,
                                                             const QuadrotorModel& model) {
  if (!(design.position_std_m > 0.0 && design.angle_std_rad > 0.0)) {
    throw std::invalid_argument("quadrotor estimator: the noise's deviations must be positive");
  }
  if (design.noise == ProcessNoiseSource::input && design.filter != QuadrotorFilter::ekf) {
    throw std::invalid_argument("quadrotor estimator: process noise by the input needs the EKF");
  }
  switch (design.order) {
    case DisturbanceOrder::none:
      return make_thruster_estimator<-1>(design, model);
    case DisturbanceOrder::zero:
      return make_thruster_estimator<0>(design, model);
    case DisturbanceOrder::second:
      return make_thruster_estimator<2>(design, model);
    case DisturbanceOrder::resonator:
      if (design.filter != QuadrotorFilter::ukf) {
        throw std::invalid_argument("quadrotor estimator: the resonators need the UKF");
      }
      return make_resonator(design, model);
    case DisturbanceOrder::spectrum:
      if (design.filter != QuadrotorFilter::ukf) {
        throw std::invalid_argument("quadrotor estimator: the spectrum needs the UKF");
      }
      return make_spectrum(design, model);
  }
  throw std::logic_error("unknown disturbance model");
}

}  // namespace breakwater
