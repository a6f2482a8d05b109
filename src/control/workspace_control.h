// The thesis' two conventional controllers: HPFC and DRAC (2.4.3.1).
#pragma once

#include <breakwater/control/arm_controller.h>

namespace breakwater {

enum class WorkspaceLaw { hpfc, drac };

struct WorkspaceControlDesign {
  WorkspaceLaw law = WorkspaceLaw::drac;
  double k_p = 30.0;                   ///< K_phx or K_px, a multiple of the identity [1/s²]
  double k_f = 40.0;                   ///< K_phf, HPFC only [rad/(s² N m)]
  double singular_value_floor = 0.02;  ///< absolute lower bound in the pseudo-inverse
};

/// HPFC is hybrid position/force control by acceleration control (Eqs. 2.88–2.91):
///     a = J⁺ {K_ph S (X_0^ref − X̂) − K_dh J q̇} + K_phf Jᵀ (I − S) (F^ref − F),  K_dh = 2 √K_ph,
/// S = diag(0, 1, 1) in force control and I before. Eq. 2.90 prints the velocity term as K_ph J⁺
/// K_dh q̇: the dimensions do not fit, and S does not select it. The force term uses Jᵀ, as
/// printed, because J⁺ grows without bound near a singular posture.
///
/// DRAC is IDOB-based resolved acceleration control (Eqs. 2.92, 2.93) with the proposed method's
/// reference:
///     a = J⁺ {K_p (X^ref − X̂) − K_d J q̇ − J̇ q̇},  K_d = 2 √K_p.
/// Eq. 2.93 prints K_d q̇ and J q̇: the dimensions do not fit.
class WorkspaceControl final : public ArmController {
 public:
  /// Throws std::invalid_argument if a gain is negative, and as ArmController does.
  WorkspaceControl(const ArmSetup& arm, const WorkspaceControlDesign& design);

 private:
  void decide(Eigen::Ref<Eigen::VectorXd> a) override;

  WorkspaceControlDesign design_;
  Eigen::MatrixXd J_plus_;
};

}  // namespace breakwater
