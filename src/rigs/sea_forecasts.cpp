#include <breakwater/rigs/sea_forecasts.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

constexpr int kComponents = 40;
constexpr double kLowest = 0.5, kHighest = 3.0;  // the band of the waves, divided by ω_p
constexpr double kConstant_s = 30.0;

const WaveLoadSetup& physical(const QuadrotorTask& task) {
  if (task.waves.mode != WaveMode::physical) {
    throw std::invalid_argument("forecasts told and upstream need wave.mode = \"physical\"");
  }
  return task.waves;
}

// The components' frequencies, with the standard deviation of each in a sea of 1 m as amplitude.
std::vector<Waves::Component> expected_components(SeaState sea) {
  sea.significant_height_m = 1.0;
  const JonswapSpectrum spectrum(sea);
  const double width = (kHighest - kLowest) * spectrum.peak_rad_s() / kComponents;
  std::vector<Waves::Component> components;
  for (int i = 0; i < kComponents; ++i) {
    const double from = kLowest * spectrum.peak_rad_s() + width * i;
    const double omega = from + 0.5 * width;
    components.push_back({std::sqrt(spectrum.variance(from, from + width)), omega,
                          wave_number(omega, sea.water_depth_m, sea.gravity_m_s2), 0.0});
  }
  return components;
}

}  // namespace

ToldForecast::ToldForecast(const QuadrotorTask& task, double period_s)
    : vehicle_(task.plant.parameters()),
      setup_(physical(task)),
      sea_(setup_.water()),
      period_s_(period_s) {}

void ToldForecast::update(double time_s, const QuadrotorEstimator& estimator, ForceTable& forces) {
  const Eigen::Vector3d position = estimator.motion().head<3>();
  const Eigen::Vector3d velocity = estimator.motion().segment<3>(6);
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    const double there_s = time_s + period_s_ * static_cast<double>(i);
    forces.col(i) = wave_force(vehicle_, setup_, sea_.water(there_s, position), velocity);
  }
}

UpstreamForecast::UpstreamForecast(const QuadrotorTask& task, const UpstreamDesign& design)
    : vehicle_(task.plant.parameters()),
      setup_(physical(task)),
      design_(design),
      sea_(setup_.water()),
      noise_(setup_.sea.seed, "wave probe"),
      probe_m_(task.reference_m.head<2>() - design.distance_m * sea_.first().direction()),
      fitted_(expected_components(setup_.sea), setup_.sea.heading_rad, setup_.sea.water_depth_m) {
  const double samples = std::round(design.window_s / design.period_s);
  if (!(samples >= 2.0 * kComponents && samples <= 1e4 && design.noise_m > 0.0)) {
    throw std::invalid_argument("upstream forecast: the window must have 80 to 10000 samples");
  }
  record_.setZero(static_cast<Eigen::Index>(samples));
  parts_.setZero(2 * kComponents);
  Eigen::MatrixXd columns(record_.size(), 2 * kComponents);
  Eigen::VectorXd weights(2 * kComponents);
  for (Eigen::Index i = 0; i < kComponents; ++i) {
    const Waves::Component& c = fitted_.components()[static_cast<std::size_t>(i)];
    const double variance = c.amplitude_m * c.amplitude_m;
    weights(i) = weights(kComponents + i) = design.noise_m * design.noise_m / variance;
    for (Eigen::Index j = 0; j < record_.size(); ++j) {
      const auto [sine, cosine] =
          math::sincos(-c.omega_rad_s * design.period_s * static_cast<double>(j));
      columns(j, i) = cosine;
      columns(j, kComponents + i) = sine;
    }
  }
  // The rounding of Eigen's other product depends on the processor's caches.
  Eigen::MatrixXd normal = columns.transpose().lazyProduct(columns);
  normal.diagonal() += weights;
  fit_ = normal.llt().solve(columns.transpose());
}

double UpstreamForecast::measured(double time_s) const {
  const auto sample = static_cast<std::int64_t>(std::llround(time_s / design_.period_s));
  return sea_.elevation(time_s, probe_m_.x(), probe_m_.y()) +
         design_.noise_m * noise_(static_cast<std::uint64_t>(sample + record_.size()));
}

void UpstreamForecast::reset(double time_s) {
  for (Eigen::Index j = 0; j < record_.size(); ++j) {
    record_(j) = measured(time_s - design_.period_s * static_cast<double>(j + 1));
  }
  constant_.setZero();
}

void UpstreamForecast::update(double time_s, const QuadrotorEstimator& estimator,
                              ForceTable& forces) {
  std::copy_backward(record_.begin(), record_.end() - 1, record_.end());
  record_(0) = measured(time_s);
  parts_.noalias() = fit_ * record_;
  const double along = probe_m_.dot(fitted_.direction());
  for (Eigen::Index i = 0; i < kComponents; ++i) {
    // A cos(k s − ω τ + ε) at the probe, with k s + ε = ψ: a = A cos ψ, b = A sin ψ.
    const double a = parts_(i), b = parts_(kComponents + i);
    const auto at = static_cast<std::size_t>(i);
    fitted_.set(at, std::hypot(a, b),
                math::atan2(b, a) - fitted_.components()[at].wave_number_rad_m * along);
  }
  const Eigen::Vector3d position = estimator.motion().head<3>();
  const Eigen::Vector3d velocity = estimator.motion().segment<3>(6);
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    const double ahead_s = design_.period_s * static_cast<double>(i);
    forces.col(i) = wave_force(vehicle_, setup_, fitted_.at(ahead_s, position), velocity);
  }
  constant_ += design_.period_s / kConstant_s * (estimator.force() - forces.col(0) - constant_);
  forces.colwise() += constant_;
}

}  // namespace breakwater
