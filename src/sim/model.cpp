#include <breakwater/sim/model.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <utility>

#include <breakwater/math/refuse_unless.h>
#include <breakwater/plants/mjcf_tree.h>
#include <breakwater/sim/engine_guard.h>
#include <breakwater/sim/mjcf_conversion.h>
#include <breakwater/sim/model_draft.h>
#include <breakwater/sim/physics_part.h>

namespace breakwater {
namespace {

// Limits that a typing error exceeds, but no arm, cart or vehicle.
constexpr double kLargestMass_kg = 1e9;
constexpr double kLargestSize_m = 1e6;

// The file with the line of an engine message, which ends in "…, line 12, column 3".
std::string located(const std::string& file, const std::string& message) {
  std::string line;
  for (const char* words : {"ine ", "ine=", "ine number ", "ine number="}) {
    const std::size_t at = message.find(words);
    if (at == std::string::npos) continue;
    const std::size_t digits = at + std::strlen(words);
    const std::size_t end = message.find_first_not_of("0123456789", digits);
    const std::string number = message.substr(digits, end - digits);
    if (!number.empty() && number != "0") line = ":" + number;
  }
  return file + line;
}

std::string name_of(const mjModel& m, mjtObj kind, int id) {
  const char* name = mj_id2name(&m, kind, id);
  return name != nullptr ? "\"" + std::string(name) + "\"" : "number " + std::to_string(id);
}

[[noreturn]] void refuse(const std::string& file, const std::string& what) {
  throw std::invalid_argument(file + ": " + what);
}

int id_of(const mjModel& m, const std::string& file, mjtObj kind, const std::string& name) {
  const int id = mj_name2id(&m, kind, name.c_str());
  if (id >= 0) return id;
  constexpr int kFew = 12;
  int named = 0;
  std::string names;
  // Each element has a letter or more in the model's list of names.
  for (int i = 0; i < m.nnames; ++i) {
    const char* const one = mj_id2name(&m, kind, i);
    if (one == nullptr || *one == '\0') continue;
    names += (named++ == 0 ? " (it has " : ", ") + std::string(one);
  }
  if (named == 0) names = " (it has none with a name";
  if (named <= kFew && kind == mjOBJ_GEOM) {
    names += ". With discardvisual, as in a URDF, the compiler drops geoms that cannot collide";
  }
  refuse(file, std::string("has no ") + mju_type2Str(kind) + " named \"" + name + '"' +
                   (named <= kFew ? names + ")" : ""));
}

void check_bodies(const mjModel& m, const std::string& file) {
  for (int i = 1; i < m.nbody; ++i) {
    const bool mass_fits = m.body_mass[i] >= 0.0 && m.body_mass[i] <= kLargestMass_kg;
    if (!mass_fits) refuse(file, "body " + name_of(m, mjOBJ_BODY, i) + ": mass is out of range");
    for (int k = 0; k < 3; ++k) {
      const double inertia = m.body_inertia[3 * i + k];
      if (!(inertia >= 0.0 && inertia <= kLargestMass_kg)) {
        refuse(file, "body " + name_of(m, mjOBJ_BODY, i) + ": inertia is out of range");
      }
    }
  }
}

void check_geoms(const mjModel& m, const std::string& file) {
  for (int i = 0; i < m.ngeom; ++i) {
    for (int k = 0; k < 3; ++k) {
      const double size = m.geom_size[3 * i + k];
      const double position = m.geom_pos[3 * i + k];
      if (!(size >= 0.0 && size <= kLargestSize_m) || !(std::abs(position) <= kLargestSize_m)) {
        refuse(file, "geom " + name_of(m, mjOBJ_GEOM, i) + ": size or position is out of range");
      }
    }
  }
}

// Whether the engine gives another meaning than MuJoCo 3 to a file that it accepts.
bool has_gap_outside(const mjModel& m) {
  const std::less_equal<> fits;
  return !std::equal(m.geom_gap, m.geom_gap + m.ngeom, m.geom_margin, fits) ||
         !std::equal(m.pair_gap, m.pair_gap + m.npair, m.pair_margin, fits);
}

void check_timestep(double timestep_s, const std::string& file) {
  if (!is_positive(timestep_s)) refuse(file, "option timestep must be positive and finite");
}

// The data that all SharedModels share. Its models never change: each user gets a copy.
struct Shared {
  std::mutex compiling;
  std::mutex mutex;
  std::vector<const SharedModels*> owners;
  std::map<std::string, std::shared_ptr<const mjModel>> models;  // by their files
};

Shared& shared() {
  static Shared all;
  return all;
}

std::vector<const SharedModels*> owners() {
  const std::lock_guard lock(shared().mutex);
  return shared().owners;
}

std::shared_ptr<const mjModel> find_shared(const std::string& file) {
  const std::lock_guard lock(shared().mutex);
  const auto found = shared().models.find(file);
  return found == shared().models.end() ? nullptr : found->second;
}

}  // namespace

Model Model::compile(const ModelFile& mjcf) {
  const std::string& mjcf_file = mjcf.path;
  check_mjcf(mjcf_file, mjcf.most_elements);
  std::string fatal;
  ModelPointer loaded = load_mjcf(mjcf_file, "", fatal);
  bool is_converted = false;
  if (loaded == nullptr || has_gap_outside(*loaded)) {
    const ConvertedMjcf converted = convert_mjcf(mjcf_file, mjcf.most_elements);
    is_converted = !converted.changes.empty();
    if (is_converted) loaded = load_mjcf(mjcf_file, mjcf_text(converted.root), fatal);
  }
  if (loaded == nullptr) {
    std::replace(fatal.begin(), fatal.end(), '\n', ' ');
    // The engine counts the lines of the text that it was given.
    check_engine(located(is_converted ? mjcf_file + " (converted)" : mjcf_file, fatal), fatal);
  }
  add_missing_forces(*loaded);

  Model model(std::move(loaded), mjcf_file);
  check_timestep(model->opt.timestep, mjcf_file);
  check_bodies(*model.get(), mjcf_file);
  check_geoms(*model.get(), mjcf_file);
  return model;
}

Model Model::load(const ModelFile& mjcf) {
  if (owners().empty()) return compile(mjcf);
  return {copy_of(*whole_model(mjcf), mjcf.path), mjcf.path};
}

Model Model::load_physics(const ModelFile& mjcf, const std::vector<std::string>& geoms) {
  if (models_stay_whole) return load(mjcf);
  const std::shared_ptr<const mjModel> full = whole_model(mjcf);
  std::vector<int> ids;
  for (const std::string& name : geoms) {
    const int id = mj_name2id(full.get(), mjOBJ_GEOM, name.c_str());
    if (id < 0) return {copy_of(*full, mjcf.path), mjcf.path};  // the caller's error names them all
    ids.push_back(id);
  }
  return {physics_part(*full, ids, mjcf.path), mjcf.path};
}

std::shared_ptr<const mjModel> Model::whole_model(const ModelFile& mjcf) {
  if (owners().empty()) return compile(mjcf).model_;
  if (auto model = find_shared(mjcf.path)) return model;
  const std::lock_guard compiling(shared().compiling);
  // Another thread may have compiled it during the wait.
  if (auto model = find_shared(mjcf.path)) return model;
  for (const SharedModels* owner : owners()) {
    if (owner->before_compiling_) owner->before_compiling_(mjcf.path);
  }
  std::shared_ptr<const mjModel> model = compile(mjcf).model_;
  const std::lock_guard lock(shared().mutex);
  shared().models.emplace(mjcf.path, model);
  return model;
}

SharedModels::SharedModels(std::function<void(const std::string&)> before_compiling)
    : before_compiling_(std::move(before_compiling)) {
  const std::lock_guard lock(shared().mutex);
  // Makes the engine compile known files again, so that before_compiling_ gets their names.
  if (before_compiling_) shared().models.clear();
  shared().owners.push_back(this);
}

SharedModels::~SharedModels() {
  // A thread that compiles may be in this owner's before_compiling_.
  const std::lock_guard compiling(shared().compiling);
  const std::lock_guard lock(shared().mutex);
  std::erase(shared().owners, this);
  if (shared().owners.empty()) shared().models.clear();
}

int Model::id(mjtObj kind, const std::string& name) const {
  return id_of(*model_, file_, kind, name);
}

bool Model::has(mjtObj kind, const std::string& name) const {
  return mj_name2id(model_.get(), kind, name.c_str()) >= 0;
}

std::string Model::name(mjtObj kind, int id) const {
  const char* const name = mj_id2name(model_.get(), kind, id);
  return name != nullptr ? name : "";
}

int Model::axis(const std::string& joint) const {
  const int found = id(mjOBJ_JOINT, joint);
  if (!is_axis(found)) refuse(file_, "joint \"" + joint + "\" is no hinge or slide");
  return found;
}

bool Model::is_axis(int joint) const {
  return model_->jnt_type[joint] == mjJNT_HINGE || model_->jnt_type[joint] == mjJNT_SLIDE;
}

std::vector<int> Model::geoms_named(const std::string& prefix) const {
  std::vector<int> geoms;
  for (int i = 0; i < model_->ngeom; ++i) {
    if (name(mjOBJ_GEOM, i).starts_with(prefix)) geoms.push_back(i);
  }
  return geoms;
}

DataPointer Model::make_data() const {
  return DataPointer(made_by_engine(file_, [&] { return mj_makeData(model_.get()); }));
}

void Model::set_physics(double timestep_s, Integrator integrator) {
  check_timestep(timestep_s, file_);
  model_->opt.timestep = timestep_s;
  model_->opt.integrator = static_cast<int>(integrator);
}

void Model::scale_inertia(double ratio) {
  if (!is_positive(ratio)) refuse(file_, "the ratio of inertias must be positive and finite");
  if (ratio == 1.0) return;
  mjModel& m = *model_;
  for (int i = 0; i < m.nbody; ++i) m.body_mass[i] *= ratio;
  for (int i = 0; i < 3 * m.nbody; ++i) m.body_inertia[i] *= ratio;
  derive_constants();
}

void Model::add_mass(int body, double mass_kg) {
  mjModel& m = *model_;
  const double mass = m.body_mass[body] + mass_kg;
  if (!(mass >= 0.0 && mass <= kLargestMass_kg)) {
    refuse(file_, "body " + name_of(m, mjOBJ_BODY, body) + ": mass is out of range");
  }
  m.body_mass[body] = mass;
  derive_constants();
}

void Model::add_gear(int actuator, int joint, double ratio, double motor_inertia) {
  model_->actuator_gear[static_cast<std::ptrdiff_t>(6) * actuator] *= ratio;
  add_armature(joint, ratio * ratio * motor_inertia);
}

void Model::add_armature(int joint, double inertia) {
  model_->dof_armature[model_->jnt_dofadr[joint]] += inertia;
  derive_constants();
}

void Model::add_rotor(int actuator, int joint, double ratio, double inertia,
                      const std::string& name) {
  if (has(mjOBJ_JOINT, name) || has(mjOBJ_BODY, name)) {
    refuse(file_, "has a joint or body named \"" + name + "\", the name of a rotor to be added");
  }
  if (!is_positive(inertia)) refuse(file_, "the inertia of a rotor must be positive and finite");
  model_ = with_rotor(*model_, joint, ratio, inertia, name, file_);
  model_->actuator_trnid[static_cast<std::ptrdiff_t>(2) * actuator] = id(mjOBJ_JOINT, name);
  derive_constants();
}

// The constants that the engine derives from mass and inertia.
void Model::derive_constants() {
  const DataPointer data = make_data();
  check_engine(file_, call_engine([&] { mj_setConst(model_.get(), data.get()); }));
}

void Model::list_contacts() {
  if (lists_contacts_ || models_stay_whole) return;
  ModelPointer listed = with_contact_pairs(*model_, file_);
  if (listed == nullptr) return;
  model_ = std::move(listed);
  lists_contacts_ = true;
}

void Model::set_collidable(int geom, bool collidable) {
  model_->geom_contype[geom] = collidable ? 1 : 0;
  model_->geom_conaffinity[geom] = collidable ? 1 : 0;
  if (lists_contacts_) switch_contact_pairs(*model_);
}

void Model::separate(int geom, int plane) {
  mjModel& m = *model_;
  for (int i = 0; i < m.npair; ++i) {
    if (std::minmax(m.pair_geom1[i], m.pair_geom2[i]) == std::minmax(geom, plane)) {
      refuse(file_, "has a <pair> of two geoms whose contact is a force");
    }
  }
  std::uint32_t taken = 0;
  for (int i = 0; i < m.ngeom; ++i) {
    taken |= static_cast<std::uint32_t>(m.geom_contype[i] | m.geom_conaffinity[i]);
  }
  if (taken == ~0U) refuse(file_, "needs a free bit of contype for a contact that is a force");
  // The plane then touches the geoms with this bit alone: all that it could touch but the one.
  const int bit = static_cast<int>(1U << static_cast<unsigned>(std::countr_one(taken)));
  for (int i = 0; i < m.ngeom; ++i) {
    if (bits_match(m, i, plane) && i != geom && i != plane) m.geom_contype[i] |= bit;
  }
  m.geom_contype[plane] = 0;
  m.geom_conaffinity[plane] = bit;
}

bool Model::drives(int actuator, int joint) const {
  return model_->actuator_trntype[actuator] == mjTRN_JOINT &&
         model_->actuator_trnid[at(actuator, 2)] == joint;
}

bool Model::is_motor(int actuator) const {
  const mjModel& m = *model_;
  return m.actuator_trntype[actuator] == mjTRN_JOINT && m.actuator_gear[at(actuator, 6)] == 1.0 &&
         m.actuator_dyntype[actuator] == mjDYN_NONE &&
         m.actuator_gaintype[actuator] == mjGAIN_FIXED &&
         m.actuator_gainprm[at(actuator, mjNGAIN)] == 1.0 &&
         m.actuator_biastype[actuator] == mjBIAS_NONE;
}

void Model::make_motor(int actuator) {
  mjModel& m = *model_;
  if (m.actuator_dyntype[actuator] != mjDYN_NONE) {
    refuse(file_, "actuator " + name_of(m, mjOBJ_ACTUATOR, actuator) +
                      " has a state of its own, so no motor can replace it");
  }
  const double gear = std::abs(m.actuator_gear[at(actuator, 6)]);
  const double gain = std::abs(m.actuator_gainprm[at(actuator, mjNGAIN)]);
  const auto smaller = [&](const mjtNum* range) {
    return gear * std::min(std::abs(range[0]), std::abs(range[1]));
  };
  double limit = std::numeric_limits<double>::infinity();
  if (m.actuator_forcelimited[actuator] != 0) {
    limit = smaller(m.actuator_forcerange + at(actuator, 2));
  }
  // The command of a servo is no force.
  if (m.actuator_ctrllimited[actuator] != 0 && m.actuator_biastype[actuator] == mjBIAS_NONE) {
    limit = std::min(limit, gain * smaller(m.actuator_ctrlrange + at(actuator, 2)));
  }
  if (limit == 0.0) {
    refuse(file_, "actuator " + name_of(m, mjOBJ_ACTUATOR, actuator) +
                      " has a force in one direction alone, so no motor can replace it");
  }
  std::fill_n(m.actuator_gear + at(actuator, 6), 6, 0.0);
  m.actuator_gear[at(actuator, 6)] = 1.0;
  m.actuator_gaintype[actuator] = mjGAIN_FIXED;
  m.actuator_gainprm[at(actuator, mjNGAIN)] = 1.0;
  m.actuator_biastype[actuator] = mjBIAS_NONE;
  m.actuator_forcelimited[actuator] = 0;
  limit_actuator(actuator, limit);
}

void Model::limit_actuator(int actuator, double limit) {
  if (!(limit > 0.0)) refuse(file_, "an actuator's limit must be positive");
  mjModel& m = *model_;
  m.actuator_ctrllimited[actuator] = std::isfinite(limit) ? 1 : 0;
  if (!std::isfinite(limit)) return;
  m.actuator_ctrlrange[2 * actuator] = -limit;
  m.actuator_ctrlrange[2 * actuator + 1] = limit;
}

}  // namespace breakwater
