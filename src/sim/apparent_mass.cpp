#include <breakwater/sim/apparent_mass.h>

#include <stdexcept>

namespace breakwater {

ApparentMass::ApparentMass(const Model& model, const std::string& site,
                           const Eigen::Vector3d& direction)
    : site_(model.id(mjOBJ_SITE, site)),
      direction_(direction),
      jacobian_(3, model->nv),
      inertia_(model->nv, model->nv),
      cholesky_(model->nv),
      along_(model->nv),
      recoil_(model->nv) {
  if (model->nv == 0) throw std::invalid_argument(model.file() + ": has no joint");
}

double ApparentMass::operator()(const Model& model, const mjData& data) {
  mj_jacSite(model.get(), &data, jacobian_.data(), nullptr, site_);
  mj_fullM(model.get(), inertia_.data(), data.qM);
  cholesky_.compute(inertia_);
  along_.noalias() = jacobian_.transpose() * direction_;
  recoil_ = along_;
  cholesky_.solveInPlace(recoil_);
  return 1.0 / along_.dot(recoil_);
}

}  // namespace breakwater
