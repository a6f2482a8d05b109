#include <breakwater/sim/engine_guard.h>

#include <dlfcn.h>
#include <link.h>
#include <mujoco/mujoco.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <charconv>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <breakwater/math/functions.h>
#include <breakwater/signals/environment.h>

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

template <typename Function>
ElfW(Addr) address(Function* function) {
  return reinterpret_cast<ElfW(Addr)>(function);
}

// These are all double-precision functions of MuJoCo that glibc selects by processor (a house test
// checks this). Functions of single precision only draw.
const std::map<std::string_view, ElfW(Addr)>& replacements() {
  static const std::map<std::string_view, ElfW(Addr)> table = {
      {"acos", address(breakwater_acos)},     {"asin", address(breakwater_asin)},
      {"atan2", address(breakwater_atan2)},   {"cos", address(breakwater_cos)},
      {"exp", address(breakwater_exp)},       {"log", address(breakwater_log)},
      {"pow", address(breakwater_pow)},       {"sin", address(breakwater_sin)},
      {"sincos", address(breakwater_sincos)}, {"tan", address(breakwater_tan)}};
  return table;
}

// An entry of the tables by which the loader joins a library with the functions of others; 0 if
// there is none. The loader has added the library's address to those that are addresses.
ElfW(Addr) entry_of(const link_map& library, ElfW(Sxword) tag) {
  for (const ElfW(Dyn)* entry = library.l_ld; entry->d_tag != DT_NULL; ++entry) {
    if (entry->d_tag == tag) return entry->d_un.d_ptr;
  }
  return 0;
}

template <typename T>
const T* table_of(const link_map& library, ElfW(Sxword) tag) {
  return reinterpret_cast<const T*>(entry_of(library, tag));
}

void write(ElfW(Addr) & slot, ElfW(Addr) function, const std::string& library) {
  const auto page_size = static_cast<ElfW(Addr)>(sysconf(_SC_PAGESIZE));
  auto* const page = reinterpret_cast<void*>(address(&slot) / page_size * page_size);
  // The loader makes these pages read-only in libraries that are linked so.
  if (mprotect(page, page_size, PROT_READ | PROT_WRITE) != 0) {
    throw std::runtime_error(library + ": the system does not allow to redirect its functions");
  }
  // A thread that calls the function meanwhile calls either one.
  std::atomic_ref(slot).store(function);
}

constexpr const char* kLibraryKey = "MUJOCO_GL";
constexpr const char* kDeviceKey = "MUJOCO_EGL_DEVICE_ID";

// The value of MUJOCO_GL in lower case.
std::string library_asked() {
  const std::string text = environment(kLibraryKey).value_or("");
  std::string name = text;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (name.empty() || name == "osmesa" || name == "egl") return name;
  throw std::invalid_argument(std::string(kLibraryKey) + ": \"" + text +
                              "\": must be egl or osmesa, which need no screen, or unset");
}

std::optional<int> device_asked() {
  const auto text = environment(kDeviceKey);
  if (!text) return std::nullopt;
  int number = 0;
  const char* const end = text->data() + text->size();
  const auto read = std::from_chars(text->data(), end, number);
  if (read.ec != std::errc() || read.ptr != end || number < 0) {
    throw std::invalid_argument(std::string(kDeviceKey) + ": \"" + *text +
                                "\": must be a whole number: which of EGL's devices, from 0");
  }
  return number;
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

void check_engine(const std::string& file, const std::string& fatal) {
  // All engine messages on a lack of memory contain these words.
  if (fatal.find("ould not allocate") != std::string::npos) throw OutOfMemory(file + ": " + fatal);
  if (!fatal.empty()) throw std::invalid_argument(file + ": " + fatal);
}

std::string engine_version() {
  return mj_versionString();
}

std::string take_engine_warning() {
  std::string text = state.warning;
  state.warning[0] = '\0';
  return text;
}

std::vector<std::string> redirect_elementary_functions(const void* inside) {
  Dl_info place{};
  link_map* library = nullptr;
  if (dladdr1(inside, &place, reinterpret_cast<void**>(&library), RTLD_DL_LINKMAP) == 0) {
    throw std::runtime_error("elementary functions: the address is in no shared library");
  }
  const auto* const symbols = table_of<ElfW(Sym)>(*library, DT_SYMTAB);
  const auto* const names = table_of<char>(*library, DT_STRTAB);
  std::vector<std::string> redirected;
  for (const auto& [table, bytes] : {std::pair(DT_RELA, DT_RELASZ), {DT_JMPREL, DT_PLTRELSZ}}) {
    const std::span relocations(table_of<ElfW(Rela)>(*library, table),
                                entry_of(*library, bytes) / sizeof(ElfW(Rela)));
    for (const ElfW(Rela) & relocation : relocations) {
      const auto type = ELF64_R_TYPE(relocation.r_info);
      if (type != R_X86_64_JUMP_SLOT && type != R_X86_64_GLOB_DAT) continue;
      const ElfW(Sym)& symbol = symbols[ELF64_R_SYM(relocation.r_info)];
      const auto found = replacements().find(names + symbol.st_name);
      if (found == replacements().end()) continue;
      write(*reinterpret_cast<ElfW(Addr)*>(library->l_addr + relocation.r_offset), found->second,
            place.dli_fname);
      redirected.emplace_back(found->first);
    }
  }
  std::sort(redirected.begin(), redirected.end());
  if (redirected.empty()) {
    throw std::runtime_error(std::string(place.dli_fname) +
                             ": calls no elementary functions that can be redirected, so the bits "
                             "of runs would depend on the processor");
  }
  return redirected;
}

const std::vector<std::string>& engine_functions() {
  // This text lies in the engine's library. The address of a function may lie in the program.
  static const std::vector<std::string> functions =
      redirect_elementary_functions(mj_versionString());
  return functions;
}

OpenGlAsked opengl_asked() {
  const std::string library = library_asked();
  const std::optional<int> device = device_asked();
  // MuJoCo's programs read the device only for EGL. A machine may set it for them.
  if (library == "osmesa") return {};
  return {device, library.empty()};
}

}  // namespace breakwater
