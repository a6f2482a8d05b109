// The minimal-order disturbance observer (MDOB) as a disturbance estimator.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/mdob.h>

namespace breakwater {

/// One joint's MDOB. It does not estimate the angle: its x̂ = [y; G_d(s) y] (below Eq. 4.22).
class MdobEstimator final : public DisturbanceEstimator {
 public:
  /// Throws std::invalid_argument as Mdob does.
  MdobEstimator(const MdobDesign& design, double period_s);

  void reset(const Vector& x) override;
  void update(const Vector& held_input, const Vector& y) override;
  bool follow(const SampleInterval& interval) override;

  View state() const override { return {estimate_.data(), 2}; }
  View disturbance() const override { return {estimate_.data() + 2, 1}; }
  std::span<const Signal> signals() const override { return {}; }

  /// Those of its two filters; a raw difference has none.
  Eigen::Index poles() const override { return mdob_.derivative_pole() > 0.0 ? 2 : 1; }
  void pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const override;

 private:
  void publish();

  Mdob mdob_;
  bool has_begun_ = false;
  Eigen::Vector3d estimate_ = Eigen::Vector3d::Zero();
};

}  // namespace breakwater
