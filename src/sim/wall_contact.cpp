#include <breakwater/sim/wall_contact.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <breakwater/sim/engine_guard.h>

namespace breakwater {
namespace {

using Eigen::Vector3d;

// MuJoCo's RK4: stage i starts from kFrom[i] times the rate of the stage before.
constexpr std::array<double, 4> kFrom = {0.0, 0.5, 0.5, 1.0};
constexpr std::array<double, 4> kWeights = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};

double weight(std::size_t stages, std::size_t stage) {
  return stages == 1 ? 1.0 : kWeights[stage];
}

Vector3d row_of(const mjtNum* vectors, int row) {
  return Vector3d(vectors + static_cast<std::ptrdiff_t>(3) * row);
}

// The sum has a fixed order.
double dot(const Vector3d& a, const Vector3d& b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

}  // namespace

WallContact::WallContact(const Model& model, const std::string& sphere, const std::string& plane,
                         std::unique_ptr<ContactForceLaw> law, WallMotion motion,
                         const ContactFriction& friction)
    : sphere_(model.id(mjOBJ_GEOM, sphere)),
      plane_(world_plane(model, plane)),
      body_(model->geom_bodyid[sphere_]),
      radius_m_(model->geom_size[3 * sphere_]),
      integrator_(model.integrator()),
      timestep_s_(model->opt.timestep),
      stages_(integrator_ == Integrator::rk4 ? kMostStages : 1),
      law_(std::move(law)),
      motion_(std::move(motion)),
      friction_(friction),
      wall_(motion_.at(0.0)),
      jacobian_(static_cast<std::size_t>(3 * model->nv)),
      along_(static_cast<std::size_t>(model->nv)),
      recoil_(along_) {
  if (model->geom_type[sphere_] != mjGEOM_SPHERE) {
    throw std::invalid_argument(model.file() + ": geom \"" + sphere + "\" must be a sphere");
  }
}

void WallContact::begin_step() {
  number_ = 0;
  impulse_Ns_ = 0.0;
  mass_across_kg_ = 0.0;
}

WallPosition WallContact::wall_at_stage() const {
  if (number_ == 0) return wall_;
  const Stage& before = stage_[number_ - 1];
  const double step_s = kFrom[number_] * timestep_s_;
  return {wall_.position_m + step_s * before.wall.speed_m_s,
          wall_.speed_m_s + step_s * before.wall_acceleration_m_s2};
}

ContactState WallContact::state_at_stage() const {
  ContactState state = state_;
  if (number_ == 0) return state;
  const double step_s = kFrom[number_] * timestep_s_;
  for (std::size_t i = 0; i < law_->states(); ++i) {
    state.value[i] += step_s * stage_[number_ - 1].state.rate[i];
  }
  return state;
}

void WallContact::find_normal(const mjData& data) {
  const mjtNum* frame = data.geom_xmat + static_cast<std::ptrdiff_t>(9) * plane_;
  normal_ << frame[2], frame[5], frame[8];
}

void WallContact::find_geometry(double time_s, const mjModel& model, const mjData& data,
                                Stage& stage) {
  find_normal(data);
  mjtNum velocity[6];
  mj_objectVelocity(&model, &data, mjOBJ_GEOM, sphere_, velocity, 0);
  const Vector3d turns(velocity), moves(velocity + 3);
  stage.wall = motion_.kind == WallMotionKind::free ? wall_at_stage() : motion_.at(time_s);
  stage.penetration_m = radius_m_ - dot(normal_, row_of(data.geom_xpos, sphere_)) +
                        dot(normal_, row_of(data.geom_xpos, plane_)) - stage.wall.position_m;
  const double away_m_s = dot(normal_, moves);
  stage.approach_m_s = -away_m_s - stage.wall.speed_m_s;
  if (!has_friction()) return;
  stage.sliding_m_s = moves - away_m_s * normal_ + turns.cross(-radius_m_ * normal_);
}

void WallContact::find_friction(const mjModel& model, const mjData& data, Stage& stage) {
  const double squared = dot(stage.sliding_m_s, stage.sliding_m_s);
  if (mass_across_kg_ == 0.0 && stage.force_N > 0.0) find_mass_across(model, data);
  // A larger damping than m/h would turn the velocity around within a step.
  stage.drag_Ns_m = std::min(friction_.coefficient * stage.force_N /
                                 std::sqrt(squared + friction_.stick_m_s * friction_.stick_m_s),
                             mass_across_kg_ / timestep_s_ / contacts_with_friction_);
  stage.friction_N = stage.drag_Ns_m * std::sqrt(squared);
}

double WallContact::force_of_law(Stage& stage) const {
  const bool touches = is_solid_ && stage.penetration_m > 0.0;
  if (!touches && law_->states() == 0) return 0.0;
  const double force_N = law_->force(touches ? stage.penetration_m : 0.0,
                                     touches ? stage.approach_m_s : 0.0, stage.state);
  return touches ? std::max(force_N, 0.0) : 0.0;
}

void WallContact::apply(double time_s, const mjModel& model, mjData& data) {
  Stage& stage = stage_[number_];
  find_geometry(time_s, model, data, stage);
  if (law_->for_engine() != nullptr) {
    if (number_ > 0) {
      impulse_Ns_ += timestep_s_ * weight(stages_, number_ - 1) * engine_force_N(data);
    }
    const bool begins = stage.penetration_m > 0.0 && first_.penetration_m <= 0.0;
    if (number_ == 0 || begins) {
      const ContactSlopes found = slopes(model, data, 0.0, 0.0);  // and the direction of the force
      if (stage.penetration_m > 0.0) check_stability(time_s, found);
    }
  } else {
    stage.state = state_at_stage();
    stage.force_N = force_of_law(stage);
    if (has_friction()) find_friction(model, data, stage);
    impulse_Ns_ += timestep_s_ * weight(stages_, number_) * stage.force_N;
    if (motion_.kind == WallMotionKind::free) {
      stage.wall_acceleration_m_s2 =
          (stage.force_N - motion_.stiffness_N_m * stage.wall.position_m -
           motion_.damping_Ns_m * stage.wall.speed_m_s) /
          motion_.mass_kg;
    }
    if (stage.force_N > 0.0) {
      if (number_ == 0) {
        find_mass(time_s, model, data, stage);
      } else if (first_.force_N == 0.0) {
        check_stability(time_s, slopes(model, data, stage.penetration_m, stage.approach_m_s));
      }
      add_wrench(data, stage);
    }
  }
  if (number_ == 0) first_ = stage;
  number_ = std::min(number_ + 1, stages_ - 1);
}

void WallContact::add_wrench(mjData& data, const Stage& stage) const {
  const Vector3d force = stage.force_N * normal_ - stage.drag_Ns_m * stage.sliding_m_s;
  const Vector3d arm =
      row_of(data.geom_xpos, sphere_) - radius_m_ * normal_ - row_of(data.xipos, body_);
  mjtNum* wrench = data.xfrc_applied + static_cast<std::ptrdiff_t>(6) * body_;
  Eigen::Map<Vector3d>(wrench) += force;
  Eigen::Map<Vector3d>(wrench + 3) += arm.cross(force);
}

double WallContact::engine_force_N(const mjData& data) const {
  double force = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < along_.size(); ++i) {
    force += along_[i] * data.qfrc_constraint[i];
    square += along_[i] * along_[i];
  }
  return square > 0.0 ? force / square : 0.0;
}

ContactSlopes WallContact::slopes(const mjModel& model, const mjData& data, double penetration_m,
                                  double speed_m_s) {
  find_normal(data);
  const mjtNum* center = data.geom_xpos + static_cast<std::ptrdiff_t>(3) * sphere_;
  mj_jac(&model, &data, jacobian_.data(), nullptr, center, body_);
  const double mass_kg = mass_along(model, data, normal_);
  return with_wall(slopes_of(*law_, state_, penetration_m, speed_m_s, mass_kg), motion_);
}

// Needs the Jacobian.
double WallContact::mass_along(const mjModel& model, const mjData& data,
                               const Vector3d& direction) {
  const std::size_t n = along_.size();
  for (std::size_t i = 0; i < n; ++i) {
    along_[i] = direction[0] * jacobian_[i] + direction[1] * jacobian_[n + i] +
                direction[2] * jacobian_[2 * n + i];
  }
  // The engine's solver writes through a pointer to data that it does not change.
  mj_solveM(&model, const_cast<mjData*>(&data), recoil_.data(), along_.data(), 1);
  double inverse_mass = 0.0;
  for (std::size_t i = 0; i < n; ++i) inverse_mass += along_[i] * recoil_[i];
  return 1.0 / inverse_mass;
}

// At most the mass of any direction across the normal, and at least half of the smallest one.
void WallContact::find_mass_across(const mjModel& model, const mjData& data) {
  const Vector3d point = row_of(data.geom_xpos, sphere_) - radius_m_ * normal_;
  mj_jac(&model, &data, jacobian_.data(), nullptr, point.data(), body_);
  double inverse_mass = 0.0;
  for (const int axis : {0, 1, 2}) {
    const Vector3d across = Vector3d::Unit(axis) - normal_(axis) * normal_;
    inverse_mass += 1.0 / mass_along(model, data, across);
  }
  mass_across_kg_ = 1.0 / inverse_mass;
}

void WallContact::find_mass(double time_s, const mjModel& model, const mjData& data,
                            const Stage& stage) {
  const ContactSlopes found = slopes(model, data, stage.penetration_m, stage.approach_m_s);
  mass_kg_ = found.mass_kg;
  if (first_.force_N == 0.0 && stage.approach_m_s > 0.0) {  // that of the step before
    transient_N_ = stage.approach_m_s * std::sqrt(found.stiffness_N_m * found.mass_kg);
  }
  check_stability(time_s, found);
}

void WallContact::check_stability(double time_s, const ContactSlopes& found) const {
  if (is_stable(integrator_, timestep_s_, found)) return;
  throw RunFailure(time_s, limit_in_words(integrator_, timestep_s_, found));
}

void WallContact::end_step(const mjModel&, const mjData& data) {
  if (law_->for_engine() != nullptr) {
    impulse_Ns_ += timestep_s_ * weight(stages_, stages_ - 1) * engine_force_N(data);
    return;
  }
  double speed_change = 0.0;
  double position_change = 0.0;
  for (std::size_t s = 0; s < stages_; ++s) {
    const double step_s = timestep_s_ * weight(stages_, s);
    speed_change += step_s * stage_[s].wall_acceleration_m_s2;
    position_change += step_s * stage_[s].wall.speed_m_s;
    for (std::size_t i = 0; i < law_->states(); ++i) {
      state_.value[i] += step_s * stage_[s].state.rate[i];
    }
  }
  if (motion_.kind != WallMotionKind::free) return;
  // Like the engine's Euler, which moves by the new speed.
  if (stages_ == 1) position_change += timestep_s_ * speed_change;
  wall_.position_m += position_change;
  wall_.speed_m_s += speed_change;
}

}  // namespace breakwater
