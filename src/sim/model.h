// Loading an MJCF model, with the checks that MuJoCo omits.
#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace breakwater {

enum class Integrator { euler, rk4, implicit };

struct DeleteData {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using DataPointer = std::unique_ptr<mjData, DeleteData>;

/// An MJCF file, and how large the model may be: the engine's compiler is slow with very many
/// elements, and cannot be stopped.
struct ModelFile {
  ModelFile() = default;
  ModelFile(std::string its_path) : path(std::move(its_path)) {}  // NOLINT: a path will do
  ModelFile(const char* its_path) : path(its_path) {}             // NOLINT
  ModelFile(std::string its_path, std::uint64_t most)
      : path(std::move(its_path)), most_elements(most) {}

  static constexpr std::uint64_t kMostElements = 20000;

  std::string path;
  std::uint64_t most_elements = kMostElements;  ///< key model.most_elements
};

/// A compiled MuJoCo model that this object owns, and where it came from.
class Model {
 public:
  /// Compiles an MJCF file. Throws std::invalid_argument with one line, `FILE[:LINE]: reason`, if
  /// it cannot be read or compiled, has too many elements, or if a number of it is not finite or
  /// beyond 1e30, or its timestep, a mass, an inertia or a size is not a sensible number: the
  /// engine itself accepts NaN, a timestep of −1 s and a mass of 1e300 kg; OutOfMemory if the
  /// machine has none. While there are SharedModels, a copy of what was compiled first.
  /// Thread-safe.
  static Model load(const ModelFile& mjcf);

  /// What of load() its motion depends on: the same states to the bit, in less time and memory. It
  /// has no cameras, lights, textures, materials and skins, and no geoms that can touch nothing as
  /// they stand in the file (by contype, conaffinity and <pair>) unless a sensor, tendon, <pair> or
  /// tuple names them or a fluid acts on them. `geoms` names those that must stay nevertheless, as
  /// the run looks them up or makes them collide; they count as able to touch what touches
  /// anything. The ids of geoms are not those of load(), which pictures are drawn of. Throws as
  /// load() does, and std::invalid_argument if there is no such geom.
  static Model load_physics(const ModelFile& mjcf, const std::vector<std::string>& geoms = {});

  /// Whether any thread waits for the engine's compiler, which goes on whatever happens. May be
  /// asked in a signal handler.
  static bool is_compiling();

  mjModel* get() { return model_.get(); }
  const mjModel* get() const { return model_.get(); }
  const mjModel* operator->() const { return model_.get(); }
  const std::string& file() const { return file_; }

  /// The id of a named element. Throws std::invalid_argument `FILE: has no KIND named "NAME"`.
  int id(mjtObj kind, const std::string& name) const;
  bool has(mjtObj kind, const std::string& name) const;

  /// The geoms whose names begin so.
  std::vector<int> geoms_named(const std::string& prefix) const;

  /// A simulation's state and memory, all zeros. Throws std::invalid_argument `FILE: reason` if the
  /// engine cannot make one.
  DataPointer make_data() const;

  /// Replaces the model's own timestep [s] and integrator. Throws std::invalid_argument unless the
  /// timestep is positive and finite.
  void set_physics(double timestep_s, Integrator integrator);

  /// Multiplies every body's mass and inertia. Throws std::invalid_argument unless the ratio is
  /// positive and finite, and the engine can derive what follows from them.
  void scale_inertia(double ratio);

  /// Adds a point mass at a body's centre of mass, or takes one away. Throws std::invalid_argument
  /// if there is no such body, the mass that results is negative, or the engine cannot derive what
  /// follows from it.
  void add_mass(const std::string& body, double mass_kg);

  /// Lets the engine look for contacts faster, where that changes none: with_contact_pairs(). What
  /// it knows of the geoms' contacts does not change any more but by set_collidable().
  void list_contacts();

  /// Makes a geom collide with those whose contype has bit 1, or with nothing.
  void set_collidable(int geom, bool collidable);

  /// Limits an actuator's command to ±limit; infinity: not at all. Throws std::invalid_argument
  /// unless the limit is positive.
  void limit_actuator(int actuator, double limit);

 private:
  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
  };

  static Model compile(const ModelFile& mjcf);
  static std::shared_ptr<const mjModel> shared_model(const ModelFile& mjcf);
  static Model copy(const mjModel& model, const std::string& file);
  static Model physics(const mjModel& full, const std::string& file,
                       const std::vector<std::string>& geoms);

  void derive_constants();

  Model(mjModel* model, std::string file) : model_(model), file_(std::move(file)) {}

  std::unique_ptr<mjModel, Delete> model_;
  std::string file_;
  bool lists_contacts_ = false;
};

/// While one lives, Model::load() and load_physics() compile each file once, in this process: for
/// thousands of runs of the same files, which must not change meanwhile.
class SharedModels {
 public:
  /// `before_compiling` is told each file just before it is read; one at a time, from any thread.
  explicit SharedModels(std::function<void(const std::string& file)> before_compiling = {});
  ~SharedModels();
  SharedModels(const SharedModels&) = delete;
  SharedModels& operator=(const SharedModels&) = delete;

 private:
  friend class Model;
  std::function<void(const std::string& file)> before_compiling_;
};

}  // namespace breakwater
