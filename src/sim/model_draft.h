// A changed copy of a compiled model, with other sizes.
#pragma once

#include <mujoco/mujoco.h>

#include <cstddef>
#include <string>
#include <vector>

#include <breakwater/sim/model.h>

namespace breakwater {

/// A copy of a compiled model. Throws as made_by_engine() does.
ModelPointer copy_of(const mjModel& model, const std::string& file);

/// The engine can compile and copy a model, but not resize it. Its copy function reads a struct of
/// sizes and arrays, in the order of mjxmacro.h. A draft is such a struct.
class ModelDraft {
 public:
  /// Takes the sizes from `sizes` and the contents from `compiled`. These are the rows `geoms` of
  /// the geom arrays (null: all), and the first rows of all others, filled up with zeros.
  /// `compiled` must outlive only the constructor. Throws std::logic_error if the engine's memory
  /// differs from mjxmacro.h.
  ModelDraft(const mjModel& compiled, const mjModel& sizes,
             const std::vector<int>* geoms = nullptr);
  ModelDraft(const ModelDraft&) = delete;
  ModelDraft& operator=(const ModelDraft&) = delete;

  mjModel* operator->() { return &model_; }
  mjModel& operator*() { return model_; }

  /// The engine's model of the draft. Throws as made_by_engine() does.
  ModelPointer make(const std::string& file) const { return copy_of(model_, file); }

 private:
  mjModel model_;
  std::vector<std::byte> buffer_;
};

/// The place of a row in an array of the engine.
inline std::ptrdiff_t at(int row, int columns) {
  return static_cast<std::ptrdiff_t>(row) * columns;
}

/// A copy of the model with one more body in the world, behind all others, with one joint of the
/// kind of `load`. Body and joint have the name `name`. The joint has an inertia and no mass, so
/// that gravity does not act on it. In the pose of the model and in each keyframe it is at `ratio`
/// times the load's position. Throws as made_by_engine() does.
///
/// The rotor does not move with the link that carries its motor. Its motion relative to this link
/// thus counts as its motion in the world (Spong, ASME J. Dyn. Syst. Meas. Control 109, 1987):
/// rotor and load are coupled by the transmission alone. The derived constants are not set.
ModelPointer with_rotor(const mjModel& model, int load, double ratio, double inertia,
                        const std::string& name, const std::string& file);

}  // namespace breakwater
