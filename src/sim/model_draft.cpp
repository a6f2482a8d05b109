#include <breakwater/sim/model_draft.h>

#include <mujoco/mjxmacro.h>

#include <algorithm>
#include <stdexcept>

#include <breakwater/sim/engine_guard.h>

namespace breakwater {
namespace {

constexpr std::size_t kAlignment = 64;  // alignment of each array in a model's buffer

// Sets a model's array pointers as the engine does in its buffer, and returns the buffer's length.
// Without a buffer it returns the length alone.
std::size_t lay_out(mjModel& m, std::byte* buffer) {
  MJMODEL_POINTERS_PREAMBLE((&m))
  std::size_t size = 0;
#define X(type, name, rows, columns)                                      \
  size = (size + kAlignment - 1) / kAlignment * kAlignment;               \
  if (buffer != nullptr) m.name = reinterpret_cast<type*>(buffer + size); \
  size += sizeof(type) * static_cast<std::size_t>(m.rows) * static_cast<std::size_t>(columns);
  MJMODEL_POINTERS
#undef X
  m.buffer = buffer;
  return size;
}

template <typename T>
void copy_rows(const T* from, T* to, int count, int columns) {
  std::copy_n(from, static_cast<std::size_t>(count) * static_cast<std::size_t>(columns), to);
}

template <typename T>
void copy_rows(const T* from, T* to, const std::vector<int>& rows, int columns) {
  for (const int row : rows) {
    to = std::copy_n(from + at(row, columns), columns, to);
  }
}

mjModel sizes_of(const mjModel& model, const std::string& name) {
  mjModel sizes = model;
  ++sizes.nbody;
  ++sizes.njnt;
  ++sizes.nq;
  ++sizes.nv;
  ++sizes.nM;
  ++sizes.nD;
  sizes.nnames += static_cast<int>(name.size()) + 1;
  sizes.njmax += 3;  // friction and both limits
  // The engine's own rule for the stack: 5 (njmax + neq + nv)² + 20 elements.
  const int rows = model.njmax + model.neq + model.nv, more = rows + 4;
  sizes.nstack += 5 * (more * more - rows * rows) + 20 * 4;
  return sizes;
}

// The rows of the keyframes have become longer by one.
void copy_keys(const mjtNum* from, mjtNum* to, int keys, int columns, int load, double ratio) {
  for (int key = 0; key < keys; ++key) {
    std::copy_n(from + at(key, columns), columns, to + at(key, columns + 1));
    to[at(key, columns + 1) + columns] = ratio * from[at(key, columns) + load];
  }
}

}  // namespace

ModelDraft::ModelDraft(const mjModel& compiled, const mjModel& sizes, const std::vector<int>* geoms)
    : model_(sizes) {
  mjModel expected = compiled;
  const std::size_t size = lay_out(expected, static_cast<std::byte*>(compiled.buffer));
  if (size != static_cast<std::size_t>(compiled.nbuffer) || expected.names != compiled.names) {
    throw std::logic_error("the engine lays its models out otherwise than its mjxmacro.h says");
  }
  buffer_.resize(lay_out(model_, nullptr));
  model_.nbuffer = static_cast<int>(lay_out(model_, buffer_.data()));
  MJMODEL_POINTERS_PREAMBLE((&compiled))
#define X(type, name, rows, columns)                                                      \
  if (geoms != nullptr && &compiled.rows == &compiled.ngeom) {                            \
    copy_rows(compiled.name, model_.name, *geoms, columns);                               \
  } else {                                                                                \
    copy_rows(compiled.name, model_.name, std::min(compiled.rows, model_.rows), columns); \
  }
  MJMODEL_POINTERS
#undef X
}

ModelPointer copy_of(const mjModel& model, const std::string& file) {
  return ModelPointer(made_by_engine(file, [&] { return mj_copyModel(nullptr, &model); }));
}

ModelPointer with_rotor(const mjModel& model, int load, double ratio, double inertia,
                        const std::string& name, const std::string& file) {
  ModelDraft draft(model, sizes_of(model, name));
  mjModel& m = *draft;
  const int body = model.nbody, joint = model.njnt, position = model.nq, dof = model.nv;
  const int load_position = model.jnt_qposadr[load], load_dof = model.jnt_dofadr[load];

  std::copy_n(name.c_str(), name.size() + 1, m.names + model.nnames);
  m.name_bodyadr[body] = m.name_jntadr[joint] = model.nnames;

  // A child of the world. All other numbers of the body are 0.
  m.body_rootid[body] = m.body_weldid[body] = body;
  m.body_mocapid[body] = m.body_geomadr[body] = -1;
  m.body_jntnum[body] = m.body_dofnum[body] = 1;
  m.body_jntadr[body] = joint;
  m.body_dofadr[body] = dof;
  m.body_sameframe[body] = 1;
  m.body_quat[at(body, 4)] = m.body_iquat[at(body, 4)] = 1.0;

  m.jnt_type[joint] = model.jnt_type[load];
  m.jnt_qposadr[joint] = position;
  m.jnt_dofadr[joint] = dof;
  m.jnt_bodyid[joint] = body;
  m.jnt_axis[at(joint, 3) + 2] = 1.0;
  std::copy_n(model.jnt_solref + at(load, mjNREF), mjNREF, m.jnt_solref + at(joint, mjNREF));
  std::copy_n(model.jnt_solimp + at(load, mjNIMP), mjNIMP, m.jnt_solimp + at(joint, mjNIMP));
  m.qpos0[position] = ratio * model.qpos0[load_position];
  m.qpos_spring[position] = ratio * model.qpos_spring[load_position];

  m.dof_bodyid[dof] = body;
  m.dof_jntid[dof] = joint;
  m.dof_parentid[dof] = -1;
  m.dof_Madr[dof] = model.nM;
  m.dof_armature[dof] = inertia;
  std::copy_n(model.dof_solref + at(load_dof, mjNREF), mjNREF, m.dof_solref + at(dof, mjNREF));
  std::copy_n(model.dof_solimp + at(load_dof, mjNIMP), mjNIMP, m.dof_solimp + at(dof, mjNIMP));

  copy_keys(model.key_qpos, m.key_qpos, m.nkey, model.nq, load_position, ratio);
  copy_keys(model.key_qvel, m.key_qvel, m.nkey, model.nv, load_dof, ratio);
  return draft.make(file);
}

}  // namespace breakwater
