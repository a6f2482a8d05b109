#include <breakwater/world/contact_law.h>

#include <cmath>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
KelvinVoigt::KelvinVoigt(double stiffness_N_m, double damping_Ns_m, By by)
    : stiffness_N_m_(stiffness_N_m), damping_Ns_m_(damping_Ns_m), by_(by) {
  refuse_unless(is_positive(stiffness_N_m) && is_not_negative(damping_Ns_m),
                "Kelvin-Voigt: needs a stiffness > 0 and a damping >= 0");
}

HuntCrossley::HuntCrossley(double stiffness_N_mn, double exponent, double dissipation_s_m)
    : stiffness_(stiffness_N_mn), exponent_(exponent), dissipation_(dissipation_s_m) {
  refuse_unless(is_positive(stiffness_N_mn) && std::isfinite(exponent) && exponent >= 1.0 &&
                    is_not_negative(dissipation_s_m),
                "Hunt-Crossley: needs a stiffness > 0, an exponent >= 1 and a dissipation >= 0");
}

double HuntCrossley::force(double penetration_m, double speed_m_s, ContactState&) const {
  return stiffness_ * math::pow(penetration_m, exponent_) * (1.0 + dissipation_ * speed_m_s);
}

double dissipation_of_restitution(double restitution, double speed_m_s) {
  refuse_unless(restitution > 0.0 && restitution <= 1.0,
                "a restitution must be above 0 and at most 1");
  refuse_unless(is_positive(speed_m_s), "the speed of a restitution must be positive");
  // The left side minus the right one is positive for a small β, and negative near 1/e.
  double low = 0.0, high = 1.0 / restitution;
  for (int i = 0; i < 200; ++i) {
    const double beta = 0.5 * (low + high);
    const double excess =
        beta * (1.0 + restitution) - math::log((1.0 + beta) / (1.0 - restitution * beta));
    (excess > 0.0 ? low : high) = beta;
  }
  return restitution == 1.0 ? 0.0 : low / speed_m_s;
}

LayeredContact::LayeredContact(std::vector<Point> points, double dissipation_s_m)
    : points_(std::move(points)), dissipation_(dissipation_s_m) {
  refuse_unless(is_not_negative(dissipation_s_m), "a dissipation must not be negative");
  refuse_unless(!points_.empty(), "needs a point [depth_m, force_N]");
  points_.insert(points_.begin(), Point(0.0, 0.0));
  for (std::size_t i = 1; i < points_.size(); ++i) {
    refuse_unless(
        points_[i].first > points_[i - 1].first && points_[i].second > points_[i - 1].second,
        "depths and forces must rise from 0");
  }
}

double LayeredContact::force(double penetration_m, double speed_m_s, ContactState&) const {
  std::size_t layer = 1;
  while (layer + 1 < points_.size() && penetration_m > points_[layer].first) ++layer;
  const auto& [x0, f0] = points_[layer - 1];
  const auto& [x1, f1] = points_[layer];
  const double elastic = f0 + (f1 - f0) / (x1 - x0) * (penetration_m - x0);
  return elastic * (1.0 + dissipation_ * speed_m_s);
}

StandardLinearSolid::StandardLinearSolid(double stiffness_N_m, double maxwell_stiffness_N_m,
                                         double relaxation_s)
    : stiffness_N_m_(stiffness_N_m),
      maxwell_N_m_(maxwell_stiffness_N_m),
      relaxation_s_(relaxation_s) {
  refuse_unless(
      is_positive(stiffness_N_m) && is_positive(maxwell_stiffness_N_m) && is_positive(relaxation_s),
      "standard linear solid: needs two stiffnesses > 0 and a relaxation time > 0");
}

double StandardLinearSolid::force(double penetration_m, double, ContactState& state) const {
  const double z = state.value[0];
  const double force_N = stiffness_N_m_ * penetration_m + maxwell_N_m_ * (penetration_m - z);
  // Where the surface does not reach the other body it moves freely.
  const double free_m = maxwell_N_m_ * z / (stiffness_N_m_ + maxwell_N_m_);
  state.rate[0] = ((force_N > 0.0 ? penetration_m : free_m) - z) / relaxation_s_;
  return force_N;
}

}  // namespace breakwater
