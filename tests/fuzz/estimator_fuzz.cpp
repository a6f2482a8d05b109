// Sequences of inputs and measurements for every disturbance estimator of an axis. Every estimate
// is finite as long as both are below 1e6.
#include <cmath>
#include <memory>
#include <stdexcept>

#include <breakwater/observers/eso.h>
#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/gsf.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/immkf.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/mckf.h>
#include <breakwater/observers/multiple_model_estimator.h>
#include <breakwater/observers/stf.h>
#include <breakwater/observers/vbakf.h>
#include <breakwater/observers/vfakfd.h>
#include "fuzz/input.h"

namespace breakwater {
namespace {

// A positive number, mostly near 1.
double positive(fuzz::Input& input) {
  const double value = std::abs(input.number());
  return value > 0.0 ? value : 1.0;
}

std::unique_ptr<DisturbanceEstimator> estimator(fuzz::Input& input) {
  const int kind = input.whole(9);
  const double period_s = 0.01 * positive(input);
  StateSpace plant;
  plant.A = Eigen::Matrix2d{{0.0, 1.0}, {0.0, -input.number()}};
  plant.B = Eigen::Vector2d(0.0, positive(input));
  plant.C = Eigen::RowVector2d(1.0, 0.0);
  const SensorError error{
      Eigen::VectorXd::Constant(1, std::abs(input.number()) * 1e-3),
      Eigen::VectorXd::Constant(1, std::abs(input.number()) * 1e-3),
      input.whole(1) == 0 ? EncoderRounding::nearest : EncoderRounding::truncate};
  if (kind == 0) {
    return std::make_unique<Idob>(plant, std::vector<PoleGroup>{{-10.0, -11.0, -12.0}}, period_s);
  }
  if (kind == 1) {
    return std::make_unique<Eso>(plant, EsoDesign{positive(input) * 10.0}, period_s);
  }
  if (kind == 2) return sized_multiple_model({plant, period_s, error, positive(input)});
  KalmanDesign design;
  design.plant = sample_with_disturbance_model(plant, input.whole(2), period_s);
  const Eigen::Index n = design.plant.states();
  design.Q = disturbance_noise(design.plant, positive(input));
  design.R = Eigen::MatrixXd::Constant(1, 1, positive(input) * 1e-4);
  design.P0 = positive(input) * Eigen::MatrixXd::Identity(n, n);
  switch (kind) {
    case 3:
      return std::make_unique<Kfd>(design);
    case 4:
      return std::make_unique<Fakfd>(design,
                                     Eigen::VectorXd::Constant(n, 1.0 + std::abs(input.number())));
    case 5:
      return std::make_unique<Vfakfd>(design, VfakfdDesign{});
    case 6:
      return std::make_unique<Stf>(design, error);
    case 7:
      return sized_immkf(design, error, {});
    case 8:
      return sized_mckf(design, error, {});
    default:
      return input.whole(1) == 0 ? sized_gsf(design, error, 3) : sized_vbakf(design, {});
  }
}

}  // namespace
}  // namespace breakwater

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace breakwater;
  constexpr int kMostSamples = 200;
  fuzz::count("estimator");
  fuzz::Input input(data, size);
  try {
    const auto filter = estimator(input);
    filter->reset(Eigen::VectorXd::Zero(2));
    bool are_finite = true;
    for (int k = 0; k < kMostSamples && !input.is_empty(); ++k) {
      const Eigen::VectorXd u = input.vector(1);
      const Eigen::VectorXd y = input.vector(1);
      filter->update(u, y);
      // Larger values may overflow.
      are_finite = are_finite && std::abs(u(0)) < 1e6 && std::abs(y(0)) < 1e6;
      if (!are_finite) continue;
      fuzz::require(filter->state().allFinite(), "the state is finite");
      fuzz::require(filter->disturbance().allFinite(), "the disturbance is finite");
    }
  } catch (const std::invalid_argument&) {
    // refused
  }
  return 0;
}
