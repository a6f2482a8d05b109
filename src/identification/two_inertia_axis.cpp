#include <breakwater/identification/axis_model.h>

#include <breakwater/identification/axis_start.h>

namespace breakwater {
namespace {

constexpr double kLongestStep = 0.5;      // in time constants
constexpr double kMostSteps = 100.0;      // in a row
constexpr double kTimeTolerance = 1e-13;  // relative to the step that an event ends

// One of the two inertias.
struct Body {
  double inertia;
  double viscous;
  double coulomb;
  double position;
  double velocity;
  double sign = 0.0;  // sign of the friction; 0: it sticks, or there is none
  bool sticks = false;
  Polynomial path{};

  // Sticks or slips while `torque` begins to act.
  void take(double torque) {
    sticks = coulomb > 0.0 && velocity == 0.0 && std::abs(torque) <= coulomb;
    sign = sticks || coulomb == 0.0 ? 0.0 : std::copysign(1.0, velocity == 0.0 ? torque : velocity);
    path[0] = position;
    path[1] = velocity;
  }
  // The next coefficient of the path from coefficient k of the torque.
  void extend(std::size_t k, double torque) {
    const auto n = static_cast<double>(k);
    if (k == 0) torque -= sign * coulomb;
    path[k + 2] =
        sticks ? 0.0
               : (torque - viscous * (n + 1.0) * path[k + 1]) / (inertia * (n + 1.0) * (n + 2.0));
  }
  void move(double t) {
    position = value_at(path, t);
    velocity = sticks ? 0.0 : slope_at(path, t);
  }
};

class Motion {
 public:
  Motion(Side measured, const AxisValues& p, const AxisStart& start)
      : measured_(measured),
        gain_(p[kTorqueConstant]),
        offset_(p[kOffset]),
        stiffness_(p[kStiffness]),
        damping_(p[kDamping]),
        play_(0.5 * std::abs(p[kBacklash])),
        motor_{p[kMotorInertia], p[kMotorViscous], p[kMotorCoulomb], start.position,
               start.velocity},
        load_{p[kLoadInertia], p[kLoadViscous], p[kLoadCoulomb], start.position, start.velocity} {
    if (measured == Side::motor) {
      load_.position -= start.twist;
      load_.velocity -= start.twist_rate;
    } else {
      motor_.position += start.twist;
      motor_.velocity += start.twist_rate;
    }
    if (play_ > 0.0) {
      const double twist = motor_.position - load_.position;
      if (std::abs(twist) > play_) flank_ = std::copysign(1.0, twist);
      if (flank_ * torque() < 0.0) flank_ = 0.0;
    }
    const double both = 1.0 / motor_.inertia + 1.0 / load_.inertia;
    longest_ =
        kLongestStep / std::max({std::sqrt(stiffness_ * both), damping_ * both,
                                 motor_.viscous / motor_.inertia, load_.viscous / load_.inertia});
  }

  double position() const { return measured_ == Side::motor ? motor_.position : load_.position; }

  void advance(double h, double input) {
    const double steps = std::ceil(h / longest_);
    if (!(steps <= kMostSteps)) {
      motor_.position = load_.position = std::numeric_limits<double>::quiet_NaN();
      return;
    }
    const double drive = gain_ * input - offset_;
    for (double step = h / steps; h > 0.5 * kTimeTolerance * step;) {
      h -= move(std::min(step, h), drive);
    }
  }

 private:
  bool touches() const { return play_ == 0.0 || flank_ != 0.0; }

  double torque() const {
    return touches() ? stiffness_ * (motor_.position - load_.position - flank_ * play_) +
                           damping_ * (motor_.velocity - load_.velocity)
                     : 0.0;
  }

  // Up to the first event, if one is on the way. Returns the time that this took.
  double move(double h, double drive) {
    const double now = torque();
    motor_.take(drive - now);
    load_.take(now);
    for (std::size_t k = 0; k + 2 <= kOrder; ++k) {
      double T = 0.0;
      if (touches()) {
        T = stiffness_ * (motor_.path[k] - load_.path[k]) +
            damping_ * static_cast<double>(k + 1) * (motor_.path[k + 1] - load_.path[k + 1]);
        if (k == 0) T -= stiffness_ * flank_ * play_;
      }
      motor_.extend(k, (k == 0 ? drive : 0.0) - T);
      load_.extend(k, T);
    }
    const auto twist = [&](double t) { return value_at(motor_.path, t) - value_at(load_.path, t); };
    const auto spring = [&](double t, double flank) {
      return stiffness_ * (twist(t) - flank * play_) +
             damping_ * (slope_at(motor_.path, t) - slope_at(load_.path, t));
    };
    enum class Event { none, motor, load, contact };
    Event event = Event::none;
    double first = h;
    double next_flank = flank_;
    // The event at which g falls below 0, if it is the first one.
    const auto meet = [&](Event one, const auto& g) {
      if (!(g(first) < 0.0)) return false;
      first = time_of(g, first);
      event = one;
      return true;
    };
    const auto meet_body = [&](Event one, const Body& body, double pushed, double sense) {
      if (body.sticks) {
        meet(one, [&](double t) {
          const double on_body = pushed + sense * (touches() ? spring(t, flank_) : 0.0);
          return body.coulomb - std::abs(on_body);
        });
      } else if (body.sign != 0.0) {
        meet(one, [&](double t) { return body.sign * slope_at(body.path, t); });
      }
    };
    meet_body(Event::motor, motor_, drive, -1.0);
    meet_body(Event::load, load_, 0.0, 1.0);
    if (play_ > 0.0 && flank_ != 0.0) {
      if (meet(Event::contact, [&](double t) { return flank_ * spring(t, flank_); })) {
        next_flank = 0.0;
      }
    } else if (play_ > 0.0) {
      for (const double flank : {-1.0, 1.0}) {
        const bool touched = meet(Event::contact, [&](double t) {
          return -std::min(flank * twist(t) - play_, flank * spring(t, flank) / stiffness_);
        });
        if (touched) next_flank = flank;
      }
    }
    motor_.move(first);
    load_.move(first);
    if (event == Event::motor) motor_.velocity = 0.0;
    if (event == Event::load) load_.velocity = 0.0;
    if (event == Event::contact) flank_ = next_flank;
    return first;
  }

  Side measured_;
  double gain_;
  double offset_;
  double stiffness_;
  double damping_;
  double play_;  // half of the backlash
  Body motor_;
  Body load_;
  double flank_ = 0.0;    // sign of the twist while a flank bears; 0: free, or there is no play
  double longest_ = 0.0;  // longest step
};

constexpr double kMotorShares[] = {0.3, 0.7};
constexpr std::size_t kRigidPlants = 3;
constexpr double kResonances_rad_s[] = {50.0, 200.0};

// φ = p⁵ with p = s (1 − s).
WindowWeights weights(double s, double length_s) {
  const double p = s * (1.0 - s), r = 1.0 - 2.0 * s, n = 1.0 / length_s;
  const double p2 = p * p, r2 = r * r, n2 = n * n;
  return {p2 * p2 * p, -5.0 * p2 * p2 * r * n, (20.0 * p * r2 - 10.0 * p2) * p2 * n2,
          -(60.0 * r2 - 120.0 * p) * p2 * r * n2 * n,
          (120.0 * r2 * r2 - 720.0 * p * r2 + 240.0 * p2) * p * n2 * n2};
}

// The unknowns are β₀, β₁, at the motor β₂, then α₃, α₂, α₁, f and d.
bool vibrates(const Eigen::VectorXd& x) {
  return x(0) > 0.0 && x.tail<5>()(1) > 0.0;
}

void add_plants(const StartSolution& solution, Side measured, std::vector<AxisValues>& candidates) {
  const auto rest = solution.x.tail<5>();
  const double beta = solution.x(0), square = rest(1);  // β₀ and ω_r²
  const double inertia = square / beta;
  AxisValues values{};
  values[kMotorViscous] = values[kLoadViscous] = std::max(0.0, 0.5 * rest(2) / beta);
  values[kMotorCoulomb] = values[kLoadCoulomb] = std::max(0.0, 0.5 * rest(3) / beta);
  values[kOffset] = rest(4) / beta;
  values[kDelay] = solution.delay_s;
  values[kTorqueConstant] = values[kStribeckSpeed] = 1.0;
  const auto add = [&](double motor_share) {
    if (!(motor_share > 0.0) || !(motor_share < 1.0)) return;
    const double reduced = motor_share * (1.0 - motor_share) * inertia;
    values[kMotorInertia] = motor_share * inertia;
    values[kLoadInertia] = inertia - values[kMotorInertia];
    values[kStiffness] = square * reduced;
    values[kDamping] = std::max(0.0, rest(0)) * reduced;
    candidates.push_back(values);
  };
  if (measured == Side::motor) add(1.0 / (solution.x(2) * inertia));
  for (const double share : kMotorShares) add(share);
}

// A plant that a record without vibration shows as one inertia.
void add_rigid_plants(const std::vector<AxisValues>& rigid, std::vector<AxisValues>& candidates) {
  const std::size_t first = rigid.size() > kRigidPlants ? rigid.size() - kRigidPlants : 0;
  for (std::size_t i = first; i < rigid.size(); ++i) {
    AxisValues values = rigid[i];
    values[kMotorInertia] = values[kLoadInertia] = 0.5 * rigid[i][kInertia];
    values[kMotorViscous] = values[kLoadViscous] = 0.5 * rigid[i][kViscous];
    values[kMotorCoulomb] = values[kLoadCoulomb] = 0.5 * rigid[i][kCoulomb];
    values[kInertia] = values[kViscous] = values[kCoulomb] = 0.0;
    for (const double resonance : kResonances_rad_s) {
      const double reduced = 0.25 * rigid[i][kInertia];
      values[kStiffness] = resonance * resonance * reduced;
      values[kDamping] = 0.1 * resonance * reduced;
      candidates.push_back(values);
    }
  }
}

// Candidates for the fit, from the transfer function of the measured position without backlash,
//     q⁗ + α₃ q‴ + α₂ q″ + α₁ q′ + f sgn v + d = β₂ u″ + β₁ u′ + β₀ u   (β₂ = 0 at the load),
// weighted with windows as in start_candidates(). Then J_m + J_l = α₂/β₀, the resonance is at √α₂,
// and at the motor J_m = 1/β₂. Other candidates share the whole inertia between both in fixed
// ratios, or come from the fit of one inertia. None has a backlash.
//
// Source: M. Shinbrot, Trans. ASME 79 (1957) 547–552 (modulating functions).
template <Side measured>
std::vector<AxisValues> two_inertia_candidates(const AxisData& data) {
  std::vector<AxisValues> candidates;
  for (const StartSolution& one :
       start_solutions(data, {4, measured == Side::motor ? 3U : 2U, weights, vibrates})) {
    add_plants(one, measured, candidates);
  }
  add_rigid_plants(start_candidates(data), candidates);
  return candidates;
}

template <Side measured>
AxisModel model() {
  return {.parameters = {kMotorInertia, kLoadInertia, kStiffness, kDamping, kMotorViscous,
                         kLoadViscous, kMotorCoulomb, kLoadCoulomb, kOffset, kDelay},
          .known_inertia = kMotorInertia,
          .start_values = 4,
          .has_backlash = true,
          .move =
              [](const AxisValues& p, const AxisStart& start, const AxisStretch& stretch,
                 std::span<double> positions) {
                follow(stretch, p[kDelay], Motion(measured, p, start), positions);
              },
          .candidates = two_inertia_candidates<measured>};
}

}  // namespace

const AxisModel& two_inertia_axis(Side measured) {
  static const AxisModel motor = model<Side::motor>();
  static const AxisModel load = model<Side::load>();
  return measured == Side::motor ? motor : load;
}

}  // namespace breakwater
