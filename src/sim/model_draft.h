// A model of other sizes, made of a compiled one.
#pragma once

#include <mujoco/mujoco.h>

#include <cstddef>
#include <string>
#include <vector>

namespace breakwater {

/// The engine compiles a model once and for all, and only copies it; but what its copy copies is a
/// struct of sizes and arrays, whose order in memory mjxmacro.h tells. A draft is such a struct.
class ModelDraft {
 public:
  /// Of the sizes of `sizes`, and otherwise `compiled`, which outlives the constructor alone: of
  /// geoms the rows `geoms`, of all else the first rows, and zeros where it had fewer. Throws
  /// std::logic_error if the engine's memory is not as mjxmacro.h says.
  ModelDraft(const mjModel& compiled, const mjModel& sizes, const std::vector<int>& geoms);
  ModelDraft(const ModelDraft&) = delete;
  ModelDraft& operator=(const ModelDraft&) = delete;

  mjModel* operator->() { return &model_; }
  mjModel& operator*() { return model_; }

  /// The engine's own model of the draft, for mj_deleteModel(); null, and `fatal` says why, if it
  /// cannot make one.
  mjModel* make(std::string& fatal) const;

 private:
  mjModel model_;
  std::vector<std::byte> buffer_;
};

/// The numbers of all geoms.
std::vector<int> all_geoms(const mjModel& model);

}  // namespace breakwater
