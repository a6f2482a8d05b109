#include <breakwater/rigs/axis_rig.h>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include <breakwater/config/unit_of.h>

namespace breakwater {
namespace {

constexpr int kNoActuator = -1;

// An axis this far from its pose at the end does not hold it: in rad, or a part of the model's
// size.
constexpr double kFar = 0.5;

// "rad", or a list if the positions of the first `joints` have several units.
std::string position_units(const Model& model, int joints) {
  std::vector<std::string> units;
  for (int joint = 0; joint < joints; ++joint) {
    const int type = model->jnt_type[joint];
    const bool has_quaternion = type == mjJNT_FREE || type == mjJNT_BALL;
    if (type == mjJNT_HINGE) units.emplace_back("rad");
    if (type == mjJNT_SLIDE) units.emplace_back("m");
    if (type == mjJNT_FREE) units.insert(units.end(), 3, "m");
    if (has_quaternion) units.insert(units.end(), 4, "1");
  }
  const bool is_one = std::ranges::count(units, units.front()) == std::ssize(units);
  return is_one ? units.front() : fmt::format("{}", fmt::join(units, ", "));
}

}  // namespace

AxisRig::AxisRig(const AxisPlant& plant, Controller& controller)
    : plant_(plant),
      steps_per_sample_(plant.physics.steps_per_sample()),
      controller_(controller),
      has_motors_(std::any_of(plant.axes.begin(), plant.axes.end(),
                              [](const auto& one) { return one.drive.electric.is_on(); })) {
  Model model = plant.load_model();
  const auto rotors = std::count_if(plant.axes.begin(), plant.axes.end(),
                                    [](const auto& one) { return one.transmission.adds_rotor(); });
  positions_of_file_ = static_cast<std::size_t>(model->nq - rotors);
  qpos_units_ = position_units(model, model->njnt - static_cast<int>(rotors));
  std::vector<double> qpos = plant.start_pose(model);
  std::vector<double> qvel(static_cast<std::size_t>(model->nv), 0.0);
  std::vector<Eigen::Index> driven;
  const bool has_friction =
      (model->opt.disableflags & (mjDSBL_FRICTIONLOSS | mjDSBL_CONSTRAINT)) == 0;
  for (const AxisSettings& one : plant.axes) {
    const int joint = model.id(mjOBJ_JOINT, one.axis.joint);
    const auto at = static_cast<std::size_t>(model->jnt_qposadr[joint]);
    const auto rate_at = static_cast<std::size_t>(model->jnt_dofadr[joint]);
    qvel[rate_at] += one.start_velocity;
    std::unique_ptr<Transmission> transmission;
    auto motor_at = at, motor_rate_at = rate_at;
    if (one.transmission.is_elastic()) {
      transmission = one.transmission.make(model, one.axis.joint);
      const int motor = model.id(mjOBJ_JOINT, one.transmission.motor(one.axis.joint));
      motor_at = static_cast<std::size_t>(model->jnt_qposadr[motor]);
      motor_rate_at = static_cast<std::size_t>(model->jnt_dofadr[motor]);
      qpos[motor_at] += one.transmission.design.ratio * one.start_position;
      qvel[motor_rate_at] += one.transmission.design.ratio * one.start_velocity;
    }
    const std::string rubs = one.transmission.friction_joint(one.axis.joint);
    const double coulomb = model->dof_frictionloss[model->jnt_dofadr[model.id(mjOBJ_JOINT, rubs)]];
    std::unique_ptr<FrictionLaw> law = one.drive.friction.make(coulomb);
    // The engine's own friction has the bits of this law, which knows its force.
    if (!law && plant.knows_disturbances && coulomb > 0.0 && has_friction) {
      law = std::make_unique<LoadDependentFriction>(coulomb, 0.0);
    }
    const bool rubs_load = rubs == one.axis.joint;
    const int actuator = one.axis.is_driven() ? actuator_id(model, one.axis) : kNoActuator;
    if (actuator != kNoActuator) driven.push_back(actuator);
    axes_.push_back(
        {at, rate_at, actuator,
         plant.knows_disturbances ? std::make_unique<JointForce>(model, one.axis.joint) : nullptr,
         law ? std::make_unique<JointFriction>(model, rubs, std::move(law),
                                               rubs_load ? transmission.get() : nullptr)
             : nullptr,
         rubs_load, std::move(transmission), motor_at, motor_rate_at,
         Noise(plant.run.seed, one.axis.own("input"))});
  }
  for (const PushSettings& one : plant.pushes) {
    pushes_.push_back({one.disturbance.make(plant.run.seed, "push." + one.name),
                       std::make_unique<BodyForce>(
                           model, one.body, Eigen::Map<const Eigen::Vector3d>(one.along.data()))});
  }
  const auto with_friction = std::ranges::count_if(plant.contacts, &ContactSettings::has_friction);
  for (const ContactSettings& one : plant.contacts) {
    if (std::unique_ptr<WallContact> wall = one.make(model)) {
      wall->set_contacts_with_friction(static_cast<int>(with_friction));
      WallContact* const known = wall.get();
      contacts_.push_back({std::move(wall), &known->force_N(), known});
    } else {
      auto geoms = std::make_unique<GeomContact>(model, one.geom_1, one.geom_2);
      const double* force_N = &geoms->force_N();
      contacts_.push_back({std::move(geoms), force_N, nullptr});
    }
    if (!plant.tip || plant.tip->contact != one.name) continue;
    const WallContact* const wall = contacts_.back().wall;
    if (!one.is_of_engine() || plant.tip->touch.empty()) contact_force_ = contacts_.back().force_N;
    // The contact may begin at a later stage of a step.
    touch_ = wall != nullptr ? &wall->impulse_Ns() : contacts_.back().force_N;
  }
  simulation_ = std::make_unique<Simulation>(std::move(model), controller_,
                                             plant.sensing(contact_force_), steps_per_sample_);
  simulation_->set_commanded(std::move(driven));
  const CommandDelays delays = plant.timing.delays();
  if (delays.is_on()) simulation_->set_timing(delays, plant.run.seed);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const AxisSettings& one = plant.axes[i];
    if (const auto actuator = static_cast<int>(axes_[i].actuator); actuator != kNoActuator) {
      simulation_->set_pwm(actuator, Pwm{one.drive_resolution});
      if (has_motors_) simulation_->set_drive(actuator, one.drive.electric);
    }
    if (axes_[i].force) simulation_->add(*axes_[i].force);
    if (axes_[i].transmission) simulation_->add(*axes_[i].transmission);
  }
  for (const Push& push : pushes_) simulation_->add(*push.force);
  for (const DrivenAxis& axis : axes_) {
    if (axis.friction) simulation_->add(*axis.friction);
  }
  for (const Contact& contact : contacts_) simulation_->add(*contact.part);
  simulation_->set_position(qpos);
  simulation_->set_velocity(qvel);
  for (const ContactSettings& one : plant.contacts) {
    if (one.begins_solid()) continue;
    const int wall = geom_id(simulation_->model(), one.geom_2);
    solid_from_ = plant.physics.step_at(one.solid_from_s);
    if (one.is_of_engine()) collides_ = wall;
    simulation_->set_collidable(wall, false);
  }
  if (contact_force_ == nullptr && plant.tip && !plant.tip->touch.empty()) {
    contact_force_ = &simulation_->sensor(plant.tip->touch);
    // The sensor reads another stage of a step than the geoms.
    if (touch_ != nullptr && wall() == nullptr) touch_ = contact_force_;
  }
}

void AxisRig::step() {
  const std::int64_t k = simulation_->steps();
  const double time_s = simulation_->time_of(k);
  if (k == solid_from_) {
    if (wall() != nullptr) contacts_.front().wall->set_solid(true);
    if (collides_) simulation_->set_collidable(*collides_, true);
  }
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    DrivenAxis& axis = axes_[i];
    axis.reference = plant_.axes[i].reference.at(time_s);
    if (!axis.force) continue;
    axis.disturbance = plant_.axes[i].force.value(time_s);
    const double std = plant_.axes[i].input_noise();
    if (k % steps_per_sample_ == 0 && std > 0.0) {
      axis.input_noise_value =
          std * axis.input_noise(static_cast<std::uint64_t>(k / steps_per_sample_));
    }
    axis.force->hold(axis.input_noise_value - axis.disturbance);
  }
  for (Push& push : pushes_) {
    push.value = push.disturbance.value(time_s);
    push.force->hold(push.value);
  }
  if (plant_.tip) force_reference_ = plant_.tip->reference.at(time_s);
  simulation_->step();
  if (*touch_ > 0.0 && time_s >= plant_.tip->reference.from_s) {
    first_contact_s_ = std::min(first_contact_s_, time_s);
  } else if (time_s >= first_contact_s_) {
    first_separation_s_ = std::min(first_separation_s_, time_s);
  }
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    DrivenAxis& axis = axes_[i];
    if (axis.friction && axis.rubs_load) axis.disturbance -= axis.friction->force();
    if (!axis.transmission) continue;
    axis.torque =
        axis.transmission->torque(motor_position(i), motor_velocity(i), position(i), velocity(i));
  }
  saturated_ = simulation_->saturated() ? 1.0 : 0.0;
}

const double& AxisRig::current_A(std::size_t axis) const {
  return simulation_->motor(static_cast<int>(axes_[axis].actuator)).current_A();
}

RigRun::Judged AxisRig::judged_force(const TimeWindow& window) const {
  HeldReference held(window, "the force of the tip", "N");
  held.ask(plant_.tip->reference.value);
  return {std::move(held),
          [this, &force = contact_force_ != nullptr ? *contact_force_ : filtered_force_N()](
              HeldReference& reference, double time_s) {
            reference.add(time_s, force_reference_ - force);
          }};
}

std::vector<RigRun::Judged> AxisRig::judged() const {
  const double end_s = plant_.run.duration_s >= plant_.judged_to_s ? plant_.run.duration_s : 0.0;
  std::vector<RigRun::Judged> judged;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const AxisSettings& one = plant_.axes[i];
    HeldReference held(
        {one.reference.from_s, end_s},
        one.axis.name.empty() ? "the position" : "the position of axis " + one.axis.name,
        one.axis.units.position);
    if (one.reference.kind == ReferenceShape::step) {
      held.ask(one.reference.value - one.reference.before);
    } else if (one.reference.kind == ReferenceShape::hold && one.is_controlled) {
      held.ask(one.start_position);
      held.stay_within(kFar * (one.axis.units.turns() ? 1.0 : simulation_->model()->stat.extent));
    }
    judged.push_back({std::move(held), [this, &one, i](HeldReference& position, double time_s) {
                        position.add(time_s, one.reference.at(time_s) -
                                                 measured(i) / one.transmission.measured_ratio());
                      }});
  }
  if (plant_.tip) judged.push_back(judged_force({plant_.tip->reference.from_s, end_s}));
  return judged;
}

std::vector<std::string> AxisRig::overlaps() const {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const WallContact* const wall = contacts_[i].wall;
    if (wall == nullptr || !(*contacts_[i].force_N > 0.0)) continue;
    const ContactSettings& one = plant_.contacts[i];
    lines.push_back(
        fmt::format("geoms \"{}\" and \"{}\" begin {:.3g} m deep in each other, with a force of "
                    "{:.3g} N",
                    one.geom_1, one.geom_2, wall->penetration_m(), *contacts_[i].force_N));
  }
  return lines;
}

void RigRun::compute(std::string name, std::string unit, std::string text,
                     std::function<double(double time_s, std::size_t i)> value, std::size_t size) {
  computed_.push_back({std::vector<double>(size), std::move(value)});
  std::vector<Signal>& of_kind = text.empty() ? for_metrics : signals;
  of_kind.push_back({std::move(name), std::move(unit), std::move(text), computed_.back().now});
}

Recording AxisRig::run(const RunControl& control, const MetricRows& rows, RigRun run) {
  const PhysicsSettings& physics = plant_.physics;
  const double duration_s = plant_.run.duration_s;
  const std::int64_t steps = physics.step_at(duration_s);
  const std::int64_t fine_from = physics.step_at(plant_.fine_from_s);
  const std::int64_t fine_to =
      control.logs ? std::min(physics.step_at(plant_.fine_to_s), steps) : fine_from;
  for (const std::vector<Signal>* more : {&run.fine, &run.signals}) {
    run.for_metrics.insert(run.for_metrics.end(), more->begin(), more->end());
  }
  MetricValues values(
      rows, run.for_metrics, duration_s,
      {{"first_contact", &first_contact_s_}, {"first_separation", &first_separation_s_}});
  std::optional<Track> fine;
  if (fine_to > fine_from) {
    fine.emplace("physics", std::move(run.fine), static_cast<std::size_t>(fine_to - fine_from),
                 control.stream);
  }
  std::vector<RigRun::Judged> judged = run.judged ? std::move(*run.judged) : this->judged();
  std::int64_t samples = 0, saturated = 0;
  std::vector<std::string> warnings;
  const auto whole_step = [&](std::int64_t k) {
    controller_.set_watched(control.logs || values.watches(simulation_->time_of(k)));
    step();
    if (k == 0) warnings = overlaps();
    if (run.after_step) run.after_step();
    if (k >= fine_from && k < fine_to) fine->append(simulation_->time_s());
  };
  const auto sample = [&](double time_s) {
    for (RigRun::Computed& one : run.computed_) {
      for (std::size_t i = 0; i < one.now.size(); ++i) one.now[i] = one.value(time_s, i);
    }
    for (RigRun::Judged& one : judged) one.add(one.held, time_s);
    ++samples;
    if (saturated_ > 0.0) ++saturated;
  };
  Recording recording = record_run(*simulation_, physics, steps + (run.samples_end ? 1 : 0),
                                   std::move(run.signals), control, whole_step, sample, &values);
  recording.warnings.insert(recording.warnings.end(), warnings.begin(), warnings.end());
  if (!recording.failure) {
    for (std::size_t i = 0; i < judged.size(); ++i) {
      const std::size_t before = recording.warnings.size();
      judged[i].held.warn(recording.warnings);
      const bool has_loop = std::find(run.loops.begin(), run.loops.end(), i) != run.loops.end();
      if (has_loop && recording.warnings.size() > before) {
        recording.warnings.back() += "; breakwater analyze says whether its loop is stable";
      }
    }
    if (!run.judged && 2 * saturated > samples) {
      recording.warnings.push_back(fmt::format(
          "a drive is at its limit in {:.0f} % of the samples (signal saturated): the controller "
          "cannot act on its feedback then",
          100.0 * static_cast<double>(saturated) / static_cast<double>(samples)));
    }
  }
  // The last step only shows the values at the end.
  recording.simulated_s = std::min(recording.simulated_s, duration_s);
  if (fine && fine->rows() > 0) recording.tracks.push_back(std::move(*fine));
  return recording;
}

std::vector<Signal> AxisRig::tip_signals() const {
  const std::span<const double> measured = view(simulation_->sample().y).last(2);
  const Sensing& sensing = simulation_->sensing();
  std::vector<Signal> signals = {
      {"force_sensor_N", "N", "force sensor, before its low-pass",
       view(sensing.filtered(sensing.size() - 1))},
      {"force_filtered_N", "N", "force sensor, behind its low-pass", view(filtered_force_N())},
      {"force_measured_N", "N", "sampled force behind the low-pass", measured.first(1)},
      {"force_raw_measured_N", "N", "sampled force before the low-pass", measured.last(1)},
      {"force_reference_N", "N", "reference of the force", view(force_reference_)}};
  if (contact_force_ == nullptr) return signals;
  signals.insert(signals.begin(),
                 {"force_true_N", "N", "true normal contact force", view(*contact_force_)});
  return signals;
}

std::vector<Signal> AxisRig::signals() const {
  std::vector<Signal> signals = {
      {"qpos", qpos_units_, "the engine's generalised positions", positions()}};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const Axis& axis = plant_.axes[i].axis;
    const AxisUnits& u = axis.units;
    const auto add = [&](const std::string& name, const std::string& unit, const std::string& what,
                         const double& value) {
      signals.push_back({axis.own(name + unit_suffix(unit)), unit, what, view(value)});
    };
    add("position_true", u.position, "position, true", position(i));
    add("velocity_true", u.velocity, "velocity, true", velocity(i));
    add("d_true", u.force,
        "true disturbance with the dry friction of the joint, which opposes the drive",
        disturbance(i));
    add("position_measured", u.position, "sampled position", measured(i));
    if (!axis.name.empty()) add("reference", u.position, "reference", axes_[i].reference);
    if (axis.is_driven()) {
      add("command", u.force, "commanded input", command(i));
      add("applied", u.force, "applied input, saturated and rounded", actuation(i));
    }
    if (axis.is_driven() && plant_.axes[i].drive.electric.is_on()) {
      add("current", "A", "current of the motor", current_A(i));
      add("motor", u.force, "true force of the motor", motor_force(i));
    }
    if (axes_[i].friction) add("friction", u.force, "dry friction", friction(i));
    if (!axes_[i].transmission) continue;
    add("motor_position", u.position, "position of the motor, true", motor_position(i));
    add("motor_velocity", u.velocity, "velocity of the motor, true", motor_velocity(i));
    add("transmission", u.force, "the transmission's force on the load", transmitted(i));
  }
  signals.push_back({"saturated", "1", "1 where the drive is at its limit", view(saturated_)});
  for (std::size_t i = 0; i < pushes_.size(); ++i) {
    signals.push_back({"push_" + plant_.pushes[i].name + "_N", "N",
                       "force on body " + plant_.pushes[i].body, view(pushes_[i].value)});
  }
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const ContactSettings& one = plant_.contacts[i];
    const auto add = [&](const std::string& what, const std::string& unit, const std::string& text,
                         const double& value) {
      signals.push_back({one.signal(what), unit, text, view(value)});
    };
    add("N", "N", "normal force between the geoms " + one.geom_1 + " and " + one.geom_2,
        *contacts_[i].force_N);
    const WallContact* wall = contacts_[i].wall;
    if (wall == nullptr) continue;
    add("penetration_m", "m", "penetration; negative: the gap", wall->penetration_m());
    add("wall_m", "m", "how far the wall has moved", wall->wall_m());
    add("approach_m_s", "m/s", "velocity of the geom towards the wall", wall->approach_m_s());
    add("mass_kg", "kg", "effective mass at the last contact, with every joint free to recoil",
        wall->mass_kg());
    add("transient_N", "N", "v sqrt(k m) at the beginning of the last contact (ISO/TS 15066)",
        wall->transient_N());
    if (!wall->has_friction()) continue;
    add("friction_N", "N", "friction across the wall's normal", wall->friction_N());
  }
  if (plant_.tip) {
    for (Signal& signal : tip_signals()) signals.push_back(std::move(signal));
  }
  // A controller may publish the reference too.
  for (const Signal& signal : controller_.signals()) {
    const bool is_there = std::any_of(signals.begin(), signals.end(), [&](const Signal& other) {
      return other.name == signal.name && other.name.find("reference_") != other.name.npos;
    });
    if (!is_there) signals.push_back(signal);
  }
  return signals;
}

}  // namespace breakwater
