#include "scenario/arm_wall_contact.h"

#include <algorithm>
#include <cmath>

#include "scenario/run_loop.h"

namespace breakwater {
namespace {

// What the run is judged by, gathered step by step.
class WallContactMetrics {
 public:
  WallContactMetrics(double force_from_s, double reference_N, double from_s, double to_s,
                     double step_s)
      : force_from_s_(force_from_s),
        reference_N_(reference_N),
        from_s_(from_s),
        to_s_(to_s),
        step_s_(step_s) {}

  void after_step(double time_s, const ArmRig& rig) {
    if (time_s < force_from_s_ - 0.5 * step_s_) return;
    const double force = rig.contact_force_N();
    const double filtered = rig.filtered_force_N();
    follow_contact(time_s, force, rig);
    peak_raw_N_ = std::max(peak_raw_N_, force);
    peak_filtered_N_ = std::max(peak_filtered_N_, filtered);
    if (time_s >= from_s_ && time_s < to_s_) {
      // Welford's running mean and variance.
      const double error = reference_N_ - filtered;
      ++samples_;
      const double step = error - mean_error_N_;
      mean_error_N_ += step / static_cast<double>(samples_);
      squared_deviation_ += step * (error - mean_error_N_);
    }
  }

  void after_sample(double time_s, const ArmRig& rig, const TipPose& start_pose, bool saturated,
                    double period_s) {
    if (time_s < force_from_s_ - 0.5 * step_s_) return;
    if (saturated) saturated_s_ += period_s;
    max_y_error_m_ = std::max(max_y_error_m_, std::abs(rig.tip()[1] - start_pose[1]));
    max_posture_error_rad_ =
        std::max(max_posture_error_rad_, std::abs(rig.tip()[2] - start_pose[2]));
  }

  std::vector<Metric> metrics(double simulated_s) const {
    std::vector<Metric> list;
    if (simulated_s <= force_from_s_) return list;
    if (first_contact_s_) {
      list.push_back({"free_motion_time_s", "s", *first_contact_s_ - force_from_s_});
      list.push_back({"peak_force_raw_N", "N", peak_raw_N_});
      list.push_back({"peak_force_filtered_N", "N", peak_filtered_N_});
    }
    if (simulated_s >= to_s_ - 0.5 * step_s_ && samples_ > 1) {
      list.push_back({"mean_force_error_N", "N", mean_error_N_});
      list.push_back({"std_force_error_N", "N",
                      std::sqrt(squared_deviation_ / static_cast<double>(samples_ - 1))});
    }
    if (first_contact_s_) {
      list.push_back({"impact_velocity_m_s", "m/s", impact_velocity_m_s_});
      if (simulated_s >= *first_contact_s_ + kImpulseWindow_s) {
        list.push_back({"contact_impulse_Ns", "N s", impulse_Ns_});
      }
      list.push_back({"bounce_count", "1", static_cast<double>(onsets_ - 1)});
    }
    list.push_back({"saturated_time_s", "s", saturated_s_});
    list.push_back({"max_posture_error_rad", "rad", max_posture_error_rad_});
    list.push_back({"max_y_error_m", "m", max_y_error_m_});
    return list;
  }

 private:
  static constexpr double kImpulseWindow_s = 0.2;

  void follow_contact(double time_s, double force, const ArmRig& rig) {
    const bool touches = force > 0.0;
    if (touches && !touched_) {
      ++onsets_;
      if (!first_contact_s_) {
        first_contact_s_ = time_s;
        impact_velocity_m_s_ = rig.tip_speed_x_m_s();
      }
    }
    touched_ = touches;
    if (first_contact_s_ && time_s < *first_contact_s_ + kImpulseWindow_s) {
      impulse_Ns_ += force * step_s_;
    }
  }

  double force_from_s_;
  double reference_N_;
  double from_s_;
  double to_s_;
  double step_s_;

  std::optional<double> first_contact_s_;
  bool touched_ = false;
  int onsets_ = 0;
  double impact_velocity_m_s_ = 0.0;
  double impulse_Ns_ = 0.0;
  double peak_raw_N_ = 0.0;
  double peak_filtered_N_ = 0.0;
  std::int64_t samples_ = 0;
  double mean_error_N_ = 0.0;
  double squared_deviation_ = 0.0;
  double saturated_s_ = 0.0;
  double max_y_error_m_ = 0.0;
  double max_posture_error_rad_ = 0.0;
};

// Puts the wall's face where it belongs and gives it its stiffness.
void place_wall(Model& model, double face_x_m, const ContactLaw& law) {
  const int wall = model.id(mjOBJ_GEOM, "wall");
  const int tip = model.id(mjOBJ_GEOM, "tip");
  if (model->geom_type[wall] != mjGEOM_PLANE || model->geom_bodyid[wall] != 0) {
    throw std::invalid_argument(model.file() + ": geom \"wall\" must be a plane of the world body");
  }
  const double moved_m = face_x_m - model->geom_pos[3 * wall];
  for (const int part : model.geoms_named("wall")) model.get()->geom_pos[3 * part] += moved_m;
  model.get()->geom_pos[3 * wall] = face_x_m;
  author_contact(model, tip, wall, law);
}

}  // namespace

Fields ArmWallContact::fields() {
  Fields fields;
  arm_.bind(fields);
  fields.number("wall.distance_m", wall_distance_m_, positive(),
                "from the tip at the start pose to the wall's face [m]");
  fields.number("wall.solid_from_s", wall_solid_from_s_, not_negative(),
                "the wall collides from here on: the stretched arm starts inside it [s]");
  fields.number("contact.stiffness_N_m", contact_.stiffness_N_m, positive(),
                "K of the chain sensor, end effector, gears, links: not of the steel [N/m]");
  fields.number("contact.damping_Ns_m", contact_.damping_Ns_m, not_negative(),
                "B of the same chain [N s/m]");
  fields.number("force.reference_N", force_reference_N_, positive(), "F_x^ref [N]");
  fields.number("force.from_s", force_from_s_, not_negative(),
                "position control before, force control from here on [s]");
  fields.number("force.convert_gain_per_m", convert_gain_per_m_, positive(),
                "K_f = this times F_x^ref [1/m]");
  fields.number("force.filter_time_constant_s", filter_time_constant_s_, not_negative(),
                "of the force sensor's low-pass; 0: none [s]");
  fields.number("metrics.from_s", metrics_from_s_, not_negative(),
                "the force error is taken from here [s]");
  fields.number("metrics.to_s", metrics_to_s_, positive(), "to here [s]");
  fields.number("record.fine_from_s", fine_from_s_, not_negative(),
                "forces are logged at the physics rate from here [s]");
  fields.number("record.fine_to_s", fine_to_s_, not_negative(), "to here [s]");
  return fields;
}

ArmRole ArmWallContact::role() const {
  ArmRole role;
  role.force_control_from_s = force_from_s_;
  role.force_reference_N = force_reference_N_;
  role.convert_gain_N_m = convert_gain_per_m_ * force_reference_N_;
  role.force_filter_time_constant_s = filter_time_constant_s_;
  role.prepare_model = [this](Model& model) {
    place_wall(model, start_pose(arm_)[0] + wall_distance_m_, contact_);
  };
  return role;
}

void ArmWallContact::check(const Config& config) {
  check_arm(arm_, role(), config);
  if (wall_solid_from_s_ > force_from_s_) {
    config.fail("wall.solid_from_s", "must not be after force.from_s");
  }
  if (metrics_to_s_ <= metrics_from_s_) {
    config.fail("metrics.to_s", "must be after metrics.from_s");
  }
}

void ArmWallContact::prepare_scene(Model& model) const {
  role().prepare_model(model);
}

void ArmWallContact::animate_scene(Model& model, double time_s) const {
  show_geoms(model, "wall_", time_s >= wall_solid_from_s_);
}

Recording ArmWallContact::run(const RunControl& control) const {
  ArmRig rig(arm_, role());
  Simulation& sim = rig.simulation();
  const TipPose start = start_pose(arm_);
  const int wall = sim.model().id(mjOBJ_GEOM, "wall");
  sim.set_collidable(wall, false);

  const PhysicsSettings& physics = arm_.physics;
  const std::int64_t steps = physics.step_at(arm_.run.duration_s);
  const std::int64_t solid_step = physics.step_at(wall_solid_from_s_);
  const std::int64_t fine_from = physics.step_at(fine_from_s_);
  const std::int64_t fine_to = std::min(physics.step_at(fine_to_s_), steps);

  Track log("control", rig.signals(),
            static_cast<std::size_t>(steps / physics.steps_per_sample() + 1));
  Track fine("physics", rig.fine_signals(),
             static_cast<std::size_t>(std::max<std::int64_t>(fine_to - fine_from, 0)));
  WallContactMetrics metrics(force_from_s_, force_reference_N_, metrics_from_s_, metrics_to_s_,
                             physics.timestep_s);

  Recording recording;
  recording.failure = run_loop(steps, control, [&](std::int64_t k) {
    if (k == solid_step) sim.set_collidable(wall, true);
    sim.step();
    metrics.after_step(sim.time_s(), rig);
    if (sim.sampled()) {
      rig.observe();
      metrics.after_sample(sim.time_s(), rig, start, sim.saturated(), physics.control_period_s);
      log.append(sim.time_s());
    }
    if (k >= fine_from && k < fine_to) fine.append(sim.time_s());
  });

  conclude(recording, sim);
  if (!recording.failure) recording.metrics = metrics.metrics(recording.simulated_s);
  recording.tracks.push_back(std::move(log));
  if (fine.rows() > 0) recording.tracks.push_back(std::move(fine));
  return recording;
}

}  // namespace breakwater
