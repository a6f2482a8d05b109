// The keys of a real drive: friction, motor, timing, encoder scale. All are off by default.
#pragma once

#include <memory>
#include <string>

#include <breakwater/experiment/settings.h>
#include <breakwater/rigs/friction_parts.h>
#include <breakwater/signals/axis_units.h>
#include <breakwater/world/command_timing.h>
#include <breakwater/world/encoder.h>
#include <breakwater/world/motor_drive.h>

namespace breakwater {

/// Friction law and motor of a joint: keys friction.… and drive.…
class DriveSettings {
 public:
  explicit DriveSettings(const Catalogue& catalogue);

  void bind(Fields& fields, const AxisUnits& units);
  /// Throws std::invalid_argument `ORIGIN: KEY: reason` if friction or motor is wrong. `coulomb` is
  /// the joint's Coulomb friction.
  void check(const Config& config, double coulomb) const;

  /// Null: the engine's Coulomb friction.
  std::unique_ptr<FrictionLaw> make_friction(double coulomb) const;
  const ElectricDrive& electric() const { return electric_; }

 private:
  // Shared by copies of the settings, which are equal once they are read.
  std::shared_ptr<PartChoice<FrictionKind>> friction_;
  ElectricDrive electric_;
};

/// The errors of an encoder's scale.
struct ScaleSettings {
  PositionSine eccentricity;
  PositionSine interpolation;

  void bind(Fields& fields, const AxisUnits& units);
  void apply(Encoder& encoder) const;
};

/// When commands reach the drives: keys control.…
class TimingSettings {
 public:
  void bind(Fields& fields);
  /// Throws std::invalid_argument `ORIGIN: KEY: reason` if the file or a delay is wrong.
  void check(const Config& config, const PhysicsSettings& physics) const;
  /// With the values of the file.
  CommandDelays delays() const;

 private:
  enum class Jitter { uniform, csv };

  Jitter jitter_ = Jitter::uniform;
  CommandDelays delays_;  // without the file
  std::string file_;
};

}  // namespace breakwater
