#include <breakwater/plants/tip_chain.h>

namespace breakwater {
namespace {

class PlanarTip final : public TipKinematics {
 public:
  explicit PlanarTip(const PlanarChain& chain) : chain_(chain) {
    coordinates = {{"x", "m", "tip x"}, {"y", "m", "tip y"}, {"phi", "rad", "tip angle"}};
    effort_limits_Nm = chain.effort_limits_Nm();
    velocity_limits_rad_s = chain.velocity_limits_rad_s();
  }
  TipVector pose(const Angles& q_rad) const override { return chain_.tip_pose(q_rad); }
  void jacobian(const Angles& q_rad, TaskJacobian& J) const override {
    chain_.tip_jacobian(q_rad, J);
  }
  TipVector bias_acceleration(const Angles& q_rad, const Angles& dq_rad_s) const override {
    return chain_.tip_bias_acceleration(q_rad, dq_rad_s);
  }
  const PlanarChain* planar() const override { return &chain_; }

 private:
  PlanarChain chain_;
};

}  // namespace

TipChain::TipChain(const PlanarChain& chain) : kinematics_(std::make_shared<PlanarTip>(chain)) {}

}  // namespace breakwater
