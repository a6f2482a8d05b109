#include <breakwater/sim/model_draft.h>

#include <mujoco/mjxmacro.h>

#include <algorithm>
#include <numeric>
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

}  // namespace

ModelDraft::ModelDraft(const mjModel& compiled, const mjModel& sizes, const std::vector<int>& geoms)
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
  if (&compiled.rows == &compiled.ngeom) {                                                \
    copy_rows(compiled.name, model_.name, geoms, columns);                                \
  } else {                                                                                \
    copy_rows(compiled.name, model_.name, std::min(compiled.rows, model_.rows), columns); \
  }
  MJMODEL_POINTERS
#undef X
}

mjModel* ModelDraft::make(std::string& fatal) const {
  mjModel* made = nullptr;
  fatal = call_engine([&] { made = mj_copyModel(nullptr, &model_); });
  return made;
}

std::vector<int> all_geoms(const mjModel& model) {
  std::vector<int> geoms(static_cast<std::size_t>(model.ngeom));
  std::iota(geoms.begin(), geoms.end(), 0);
  return geoms;
}

}  // namespace breakwater
