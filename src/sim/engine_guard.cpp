#include <breakwater/sim/engine_guard.h>

#include <mujoco/mujoco.h>
#include <sys/mman.h>

#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <new>
#include <stdexcept>

#include <breakwater/sim/engine_functions.h>

namespace breakwater {
namespace {

constexpr std::size_t kTextSize = 1000;
// The engine's own text for the same case.
constexpr const char* kNoMemory = "could not allocate memory for a model of this size";

struct ThreadState {
  std::jmp_buf* return_point = nullptr;
  char error[kTextSize] = "";
  char warning[kTextSize] = "";
};

thread_local ThreadState state;

void on_error(const char* message) {
  std::snprintf(state.error, kTextSize, "%s", message);
  // Outside call_engine() there is no return point, and the engine must not continue.
  if (state.return_point == nullptr) {
    std::fprintf(stderr, "MuJoCo: %s\n", state.error);
    std::abort();
  }
  std::longjmp(*state.return_point, 1);
}

void on_warning(const char* message) {
  std::snprintf(state.warning, kTextSize, "%s", message);
}

// The engine's compiler fills data of 3 MB for every model, whatever its size. Large pages save 770
// page faults, half of those of a short run. Larger blocks are stacks, which are hardly touched.
void* allocate(std::size_t bytes) {
  constexpr std::size_t kLargePage = std::size_t{1} << 21, kMost = 4 * kLargePage;
  constexpr std::size_t kAlignment = 64;
  const std::size_t alignment = bytes > kLargePage && bytes <= kMost ? kLargePage : kAlignment;
  const std::size_t size = (bytes + alignment - 1) / alignment * alignment;
  void* block = size < bytes ? nullptr : std::aligned_alloc(alignment, size);
  if (block != nullptr && alignment == kLargePage) madvise(block, size, MADV_HUGEPAGE);
  return block;
}

// Before the first call of the engine.
void prepare_engine() {
  static std::once_flag once;
  std::call_once(once, [] {
    mju_user_error = on_error;
    mju_user_warning = on_warning;
    mju_user_malloc = allocate;
    mju_user_free = std::free;
    engine_functions();
  });
}

}  // namespace

std::string call_engine(void (*body)(void*), void* argument) {
  prepare_engine();
  std::jmp_buf here;
  std::jmp_buf* const outer = state.return_point;
  state.return_point = &here;
  state.error[0] = '\0';
  if (setjmp(here) == 0) {
    try {
      body(argument);
    } catch (const std::bad_alloc&) {
      std::strcpy(state.error, kNoMemory);
    } catch (const std::length_error&) {  // larger than any memory
      std::strcpy(state.error, kNoMemory);
    }
  }
  state.return_point = outer;
  return state.error;
}

std::string engine_version() {
  return mj_versionString();
}

std::string take_engine_warning() {
  std::string text = state.warning;
  state.warning[0] = '\0';
  return text;
}

}  // namespace breakwater
