// Loads an MJCF model with the checks that MuJoCo omits.
#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace breakwater {

enum class Integrator { euler = mjINT_EULER, rk4 = mjINT_RK4, implicit = mjINT_IMPLICIT };

struct DeleteData {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using DataPointer = std::unique_ptr<mjData, DeleteData>;

struct DeleteModel {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};
using ModelPointer = std::unique_ptr<mjModel, DeleteModel>;

/// Whether contype and conaffinity let two geoms collide.
inline bool bits_match(const mjModel& m, int a, int b) {
  return (m.geom_contype[a] & m.geom_conaffinity[b]) != 0 ||
         (m.geom_contype[b] & m.geom_conaffinity[a]) != 0;
}

/// An MJCF file and the largest size of its model. The engine's compiler is slow with very many
/// elements and cannot be stopped.
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

/// A compiled MuJoCo model that this object owns, and its file.
class Model {
 public:
  /// Compiles an MJCF file. Throws std::invalid_argument with one line, `FILE[:LINE]: reason`, if
  /// the file cannot be read or compiled or has too many elements. All numbers must be finite and
  /// at most 1e30. Timestep, masses, inertias and sizes must be in a sensible range. (The engine
  /// accepts NaN, a timestep of −1 s and a mass of 1e300 kg.) Throws OutOfMemory if the machine has
  /// too little memory. While there are SharedModels, returns a copy of the first compilation.
  /// Thread-safe.
  static Model load(const ModelFile& mjcf);

  /// Like load(), but only with the parts that affect the motion: the same states to the bit, in
  /// less time and memory. Cameras, lights, textures, materials and skins are missing. Geoms that
  /// can touch nothing are missing too, by contype, conaffinity and <pair> in the file. A geom
  /// stays if a sensor, tendon, <pair> or tuple names it or a fluid acts on it. The geoms in
  /// `geoms` also stay, because the run needs them or makes them collide. They count as able to
  /// touch every geom that can touch something. The ids of geoms differ from those of load(), which
  /// pictures use. With a name in `geoms` that the model lacks it is that of load(). Throws as
  /// load() does.
  static Model load_physics(const ModelFile& mjcf, const std::vector<std::string>& geoms = {});

  mjModel* get() { return model_.get(); }
  const mjModel* get() const { return model_.get(); }
  const mjModel* operator->() const { return model_.get(); }
  const std::string& file() const { return file_; }

  /// The id of a named element. Throws std::invalid_argument `FILE: has no KIND named "NAME"`.
  int id(mjtObj kind, const std::string& name) const;
  /// The index of a joint's first velocity. Throws as id().
  int dof(const std::string& joint) const { return model_->jnt_dofadr[id(mjOBJ_JOINT, joint)]; }
  bool has(mjtObj kind, const std::string& name) const;
  /// The name of an element; empty: it has none.
  std::string name(mjtObj kind, int id) const;

  /// The id of a hinge or slide. Throws std::invalid_argument if there is none of this name.
  int axis(const std::string& joint) const;
  bool is_axis(int joint) const;

  /// The geoms whose names begin with `prefix`.
  std::vector<int> geoms_named(const std::string& prefix) const;

  /// State and memory of a simulation, all zeros. Throws std::invalid_argument `FILE: reason` if
  /// the engine cannot make them.
  DataPointer make_data() const;

  /// Replaces the timestep [s] and the integrator of the file. Throws std::invalid_argument unless
  /// the timestep is positive and finite.
  void set_physics(double timestep_s, Integrator integrator);
  Integrator integrator() const { return static_cast<Integrator>(model_->opt.integrator); }

  /// Multiplies the mass and inertia of every body. Throws std::invalid_argument unless the ratio
  /// is positive and finite and the engine can compute the derived constants.
  void scale_inertia(double ratio);

  /// Adds a point mass at a body's centre of mass, or removes one. Throws std::invalid_argument if
  /// the resulting mass is negative, or the engine cannot compute the derived constants.
  void add_mass(int body, double mass_kg);

  /// Puts a rigid gear between an actuator and its hinge or slide: the actuator's force counts
  /// `ratio` times, and its motor adds ratio² · `motor_inertia`. Throws std::invalid_argument if
  /// the engine cannot compute the derived constants.
  void add_gear(int actuator, int joint, double ratio, double motor_inertia);

  /// Adds to the armature of a hinge or slide, or takes from it. Throws as add_gear().
  void add_armature(int joint, double inertia);

  /// Gives an actuator of a hinge or slide a rotor of its own (with_rotor()), which it then drives
  /// in place of the joint. The ids of all other elements stay. Throws std::invalid_argument if the
  /// name is taken, the inertia is not positive or the engine cannot make the model.
  void add_rotor(int actuator, int joint, double ratio, double inertia, const std::string& name);

  /// Speeds up the search for contacts by with_contact_pairs(), if this changes no contact. After
  /// that, only set_collidable() can change the contact parameters of geoms.
  void list_contacts();

  /// Lets a geom collide with the geoms whose contype has bit 1, or with nothing.
  void set_collidable(int geom, bool collidable);

  /// Ends the contact of a geom and a plane, and no other contact. Call it before list_contacts().
  /// Throws std::invalid_argument if a <pair> makes the contact, or if no bit of contype is free.
  void separate(int geom, int plane);

  /// Whether an actuator acts on a joint itself.
  bool drives(int actuator, int joint) const;
  /// Whether an actuator is a <motor> with gear 1 of a hinge or slide.
  bool is_motor(int actuator) const;
  /// Makes an actuator of a hinge or slide such a motor. It has the limit of the old one's force at
  /// the joint, the smaller one if they differ. Throws std::invalid_argument if the actuator has a
  /// state of its own or acts in one direction alone.
  void make_motor(int actuator);

  /// Limits an actuator's command to ±limit; infinity: no limit. Throws std::invalid_argument
  /// unless the limit is positive.
  void limit_actuator(int actuator, double limit);

 private:
  static Model compile(const ModelFile& mjcf);
  static std::shared_ptr<const mjModel> whole_model(const ModelFile& mjcf);

  void derive_constants();

  Model(ModelPointer model, std::string file) : model_(std::move(model)), file_(std::move(file)) {}

  ModelPointer model_;
  std::string file_;
  bool lists_contacts_ = false;
};

/// During its lifetime, Model::load() and load_physics() compile each file once in this process,
/// for thousands of runs. The files must not change meanwhile.
class SharedModels {
 public:
  /// `before_compiling` gets each file just before it is read, one at a time, from any thread.
  explicit SharedModels(std::function<void(const std::string& file)> before_compiling = {});
  ~SharedModels();
  SharedModels(const SharedModels&) = delete;
  SharedModels& operator=(const SharedModels&) = delete;

 private:
  friend class Model;
  std::function<void(const std::string& file)> before_compiling_;
};

/// The id of a named element. Throws std::invalid_argument `FILE: has no KIND named "NAME"`.
inline int geom_id(const Model& model, const std::string& name) {
  return model.id(mjOBJ_GEOM, name);
}
inline int site_id(const Model& model, const std::string& name) {
  return model.id(mjOBJ_SITE, name);
}

}  // namespace breakwater
