// Forecasts that know the sea: the true future, and a probe upstream.
#include <breakwater/rigs/sea_forecasts.h>
#include "support.h"

namespace breakwater::sea_forecasts_test {
namespace {

const Eigen::Vector3d kPlace(10.0, 15.0, -10.0);

// A vehicle at rest that knows its place and no force.
class AtRest final : public QuadrotorEstimator {
 public:
  AtRest() { motion_.head<3>() = kPlace; }
  void reset(const Vector&) override {}
  void update(const Vector&, const Vector&) override {}
  View state() const override { return {motion_.data(), 12}; }
  View disturbance() const override { return {force_.data(), 3}; }

  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();

 private:
  Motion motion_ = Motion::Zero();
};

QuadrotorTask task(int components) {
  WaveLoadSetup waves;
  waves.sea.significant_height_m = 2.0;
  waves.sea.heading_rad = 0.6;
  waves.sea.components = components;
  waves.sea.seed = 3;
  return {.plant = QuadrotorModel({}, QuadrotorPhysics::physical),
          .period_s = 0.01,
          .reference_m = kPlace,
          .position_std_m = 0.1,
          .angle_std_rad = 0.01,
          .position_noise = 0.1,
          .angle_noise = 0.01,
          .waves = waves};
}

TEST(SeaForecasts, ToldIsTheClosedFormOfARegularWave) {
  const QuadrotorTask regular = task(1);
  ToldForecast told(regular, 0.1);
  ForceTable forces(3, 31);
  const AtRest vehicle;
  told.update(7.0, vehicle, forces);
  const Waves waves(regular.waves.sea, 0.0);
  const Waves::Component& c = waves.components().front();
  const QuadrotorParameters& p = regular.plant.parameters();
  const double along = waves.direction().dot(kPlace.head<2>());
  const double decay = std::exp(c.wave_number_rad_m * kPlace.z());
  for (int i = 0; i <= 30; ++i) {
    const double theta =
        c.wave_number_rad_m * along - c.omega_rad_s * (7.0 + 0.1 * i) + c.phase_rad;
    const double w = c.amplitude_m * c.omega_rad_s * decay * std::sin(theta);
    const double rise = -c.amplitude_m * c.omega_rad_s * c.omega_rad_s * decay * std::cos(theta);
    const double inertia = p.water_density_kg_m3 * p.volume_m3 * 1.5 * rise;
    const double drag = p.linear_drag(2) * w + p.quadratic_drag(2) * std::abs(w) * w;
    EXPECT_NEAR(forces(2, i), inertia + drag, 1e-12) << i;
  }
}

// The RMS error of the upstream forecast over the RMS of the true force. Element i is that at the
// step i of a horizon of 3 s.
Eigen::VectorXd upstream_error(const QuadrotorTask& sea, double noise_m) {
  UpstreamForecast upstream(sea, {.distance_m = 30.0, .noise_m = noise_m});
  ToldForecast told(sea, 0.1);
  AtRest vehicle;
  ForceTable seen(3, 31), truth(3, 31);
  Eigen::VectorXd error = Eigen::VectorXd::Zero(31), size = error;
  upstream.reset(0.0);
  for (int k = 0; k < 1000; ++k) {
    told.update(0.1 * k, vehicle, truth);
    vehicle.force_ = truth.col(0);
    upstream.update(0.1 * k, vehicle, seen);
    error += (seen - truth).colwise().squaredNorm().transpose();
    size += truth.colwise().squaredNorm().transpose();
  }
  return error.cwiseQuotient(size).cwiseSqrt();
}

// Regular waves near the peak, where the method expects them.
TEST(SeaForecasts, UpstreamForeseesARegularWave) {
  int tried = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    QuadrotorTask regular = task(1);
    regular.waves.sea.seed = seed;
    const double omega = Waves(regular.waves.sea, 0.0).components().front().omega_rad_s;
    if (std::abs(omega - 0.85) > 0.15) continue;
    ++tried;
    EXPECT_LT(upstream_error(regular, 1e-3).maxCoeff(), 0.05) << omega;
  }
  EXPECT_GT(tried, 3);
}

TEST(SeaForecasts, UpstreamForeseesAnIrregularSea) {
  const Eigen::VectorXd error = upstream_error(task(40), 0.02);
  EXPECT_LT(error(0), 0.1);
  EXPECT_LT(error(30), 0.2);
}

TEST(SeaForecasts, UpstreamRemovesAConstantForce) {
  UpstreamForecast upstream(task(40), {});
  ToldForecast told(task(40), 0.1);
  AtRest vehicle;
  ForceTable seen(3, 31), truth(3, 31);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  upstream.reset(0.0);
  for (int k = 0; k < 3000; ++k) {
    told.update(0.1 * k, vehicle, truth);
    vehicle.force_ = truth.col(0) + Eigen::Vector3d(0.1, 0.0, -0.2);
    upstream.update(0.1 * k, vehicle, seen);
    if (k >= 2000) mean += 1e-3 * (seen.col(0) - truth.col(0));
  }
  EXPECT_LT((mean - Eigen::Vector3d(0.1, 0.0, -0.2)).norm(), 0.01);
}

TEST(SeaForecasts, RefuseWhatTheyCannotKnow) {
  QuadrotorTask printed = task(40);
  printed.waves.mode = WaveMode::thesis;
  EXPECT_REFUSED(ToldForecast(printed, 0.1));
  EXPECT_REFUSED(UpstreamForecast(printed, {}));
  EXPECT_REFUSED(UpstreamForecast(task(40), {.window_s = 5.0}));
}

}  // namespace
}  // namespace breakwater::sea_forecasts_test
