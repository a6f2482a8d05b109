#include <breakwater/identification/axis_model.h>

#include <breakwater/identification/axis_start.h>
#include <breakwater/math/functions.h>

namespace breakwater {

std::size_t AxisData::rows() const {
  std::size_t rows = 0;
  for (const AxisStretch& stretch : stretches) rows += stretch.positions.size();
  return rows;
}

namespace {

constexpr const char *kAccelerate = "accelerate: steps, a sine or a multisine of the torque",
                     *kReverse = "move at several speeds in both directions, and reverse often",
                     *kStandStill = "pass through standstill often and slowly",
                     *kResonate =
                         "a larger chirp or multisine through the resonance, with the "
                         "encoder on the motor";

constexpr auto kPlain = ParameterScale::plain, kPositive = ParameterScale::positive,
               kLogarithmic = ParameterScale::logarithmic;

constexpr KnownParameter kKnown[] = {
    {kInertia, kLogarithmic, true, "inertia_kgm2", "kg m^2", "inertia", 0.25, kAccelerate},
    {kViscous, kPositive, true, "viscous_Nms", "N m s/rad", "viscous friction", 0.15, kReverse},
    {kCoulomb, kPositive, true, "coulomb_Nm", "N m", "Coulomb friction", 0.15, kReverse},
    {kBreakaway, kPositive, true, "breakaway_Nm", "N m", "breakaway friction", 0.15, kStandStill},
    {kStribeckSpeed, kLogarithmic, false, "stribeck_speed_rad_s", "rad/s", "Stribeck speed", 0.5,
     kStandStill},
    {kMotorInertia, kLogarithmic, true, "motor_inertia_kgm2", "kg m^2", "inertia of the motor",
     0.25, kResonate},
    {kLoadInertia, kLogarithmic, true, "load_inertia_kgm2", "kg m^2", "inertia of the load", 0.25,
     kResonate},
    {kStiffness, kLogarithmic, true, "stiffness_Nm_rad", "N m/rad", "stiffness", 0.25, kResonate},
    {kDamping, kPositive, true, "damping_Nms_rad", "N m s/rad", "damping", 0.15, kResonate},
    {kBacklash, kPositive, false, "backlash_rad", "rad", "backlash",
     std::numeric_limits<double>::infinity(), "let torque and motion reverse often"},
    {kMotorViscous, kPositive, true, "motor_viscous_Nms", "N m s/rad",
     "viscous friction of the motor", 0.15, kReverse},
    {kLoadViscous, kPositive, true, "load_viscous_Nms", "N m s/rad", "viscous friction of the load",
     0.15, kReverse},
    {kMotorCoulomb, kPositive, true, "motor_coulomb_Nm", "N m", "Coulomb friction of the motor",
     0.15, kReverse},
    {kLoadCoulomb, kPositive, true, "load_coulomb_Nm", "N m", "Coulomb friction of the load", 0.15,
     kReverse},
    {kOffset, kPlain, true, "offset_Nm", "N m", "offset torque", 0.15, kReverse},
    {kDelay, kPlain, false, "delay_s", "s", "delay", 1.0,
     "change the torque often: steps or a multisine"},
    {kTorqueConstant, kLogarithmic, true, "torque_constant", "N m", "torque constant", 0.25,
     kAccelerate}};

constexpr double kSmall = 1e-2;         // below which a series replaces expm1
constexpr double kStribeckEnd = 5.0;    // in v_s: the friction is that of Coulomb beyond
constexpr double kTruncation = 1e-12;   // error of a step, in v_s
constexpr double kShortestStep = 1e-3;  // relative to the interval
constexpr Polynomial kInverse = {0.0,     1.0,     1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5,
                                 1.0 / 6, 1.0 / 7, 1.0 / 8, 1.0 / 9, 1.0 / 10};

// φ₁ = (1 − e^(−λh))/λ and φ₂ = (h − φ₁)/λ.
struct Integrals {
  double first;
  double second;
};

Integrals integrals(double rate, double h) {
  const double x = rate * h;
  if (std::abs(x) < kSmall) {
    // The sixth terms are below 1e-14.
    const double first =
        1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0))));
    const double second =
        0.5 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0))));
    return {h * first, h * h * second};
  }
  const double first = -math::expm1(-x) / rate;
  return {first, (h - first) / rate};
}

class Motion {
 public:
  Motion(const AxisValues& p, const AxisStart& start)
      : p_(p), position_(start.position), velocity_(start.velocity) {}

  double position() const { return position_; }

  // Under the constant torque k u − d₀.
  void advance(double h, double input) {
    const double torque = p_[kTorqueConstant] * input - p_[kOffset];
    const double shortest = kShortestStep * h;
    while (h > 0.0) {
      if (velocity_ == 0.0 && std::abs(torque) <= p_[kCoulomb] + p_[kBreakaway]) return;
      const double direction = std::copysign(1.0, velocity_ == 0.0 ? torque : velocity_);
      const double net = torque - direction * p_[kCoulomb];
      const double acceleration = (net - p_[kViscous] * velocity_) / p_[kInertia];
      // The bump is not seen from far, so a step ends where it begins.
      const double far =
          p_[kBreakaway] == 0.0
              ? std::numeric_limits<double>::infinity()
              : (std::abs(velocity_) - kStribeckEnd * p_[kStribeckSpeed]) / std::abs(acceleration);
      h -= far > shortest
               ? move(acceleration, p_[kViscous] / p_[kInertia], direction, std::min(h, far))
               : move_by_series(net, direction, shortest, h);
    }
  }

 private:
  // Up to v = 0 if it is on the way. Returns the time that this took.
  double move(double acceleration, double rate, double direction, double h) {
    Integrals phi = integrals(rate, h);
    const double velocity = velocity_ + acceleration * phi.first;
    const bool stops = velocity * direction <= 0.0;
    if (stops) {
      const auto forward = [&](double t) {
        return direction * (velocity_ + acceleration * integrals(rate, t).first);
      };
      h = time_of(forward, h);
      phi = integrals(rate, h);
    }
    position_ += velocity_ * h + acceleration * phi.second;
    velocity_ = stops ? 0.0 : velocity;
    return h;
  }

  // The same with the breakaway friction, for a step of at most h.
  double move_by_series(double net, double direction, double shortest, double h) {
    // s = |v|/v_s, b = exp(−s²) and e = −ḃ/b = 2 s ṡ over the time.
    const double unit = direction * p_[kStribeckSpeed], rate = 1.0 / (p_[kInertia] * unit);
    Polynomial path{position_, velocity_}, s{velocity_ / unit}, e{}, b{math::exp(-s[0] * s[0])};
    for (std::size_t k = 0; k + 2 <= kOrder; ++k) {
      for (std::size_t i = 0; i < k; ++i) {
        e[k - 1] += 2.0 * static_cast<double>(k - i) * s[i] * s[k - i];
      }
      for (std::size_t i = 0; i < k; ++i) b[k] -= e[i] * b[k - 1 - i] * kInverse[k];
      const double bump = direction * p_[kBreakaway] * b[k];
      const double torque = (k == 0 ? net : 0.0) - bump - p_[kViscous] * unit * s[k];
      s[k + 1] = torque * rate * kInverse[k + 1];
      path[k + 2] = unit * s[k + 1] * kInverse[k + 2];
    }
    h = std::min(h, std::max(shortest, 1.0 / std::abs(s[1])));
    const double square = h * h, last = square * square * square * square;
    const double error = last * std::max(std::abs(s[kOrder - 2]), h * std::abs(s[kOrder - 1]));
    if (error > kTruncation) {
      h = std::max(shortest, h * math::pow(kTruncation / error, 1.0 / (kOrder - 2)));
    }
    const auto forward = [&](double t) { return direction * slope_at(path, t); };
    const bool stops = forward(h) <= 0.0;
    if (stops) h = time_of(forward, h);
    position_ = value_at(path, h);
    velocity_ = stops ? 0.0 : slope_at(path, h);
    return h;
  }

  const AxisValues& p_;
  double position_;
  double velocity_;
};

}  // namespace

const KnownParameter& known_parameter(AxisParameter parameter) {
  return kKnown[parameter];
}

const AxisModel& friction_axis() {
  static const AxisModel model{.parameters = {kInertia, kViscous, kCoulomb, kOffset, kDelay},
                               .known_inertia = kInertia,
                               .start_values = 2,
                               .has_backlash = false,
                               .move =
                                   [](const AxisValues& p, const AxisStart& start,
                                      const AxisStretch& stretch, std::span<double> positions) {
                                     follow(stretch, p[kDelay], Motion(p, start), positions);
                                   },
                               .candidates = start_candidates};
  return model;
}

}  // namespace breakwater
