// Preloaded library between a program and the system. It counts the calls of each class, and lets
// one fail or ends the process there. tests/chaos/chaos.py draws the faults.
//
// - CHAOS_PAGE=FILE: the Page of all processes
// - CHAOS_PROGRAMS=DIR: counts in the programs below DIR from main() on, in Python from
//   chaos_begin() on
// - CHAOS_SPARED_PROGRAM=BEGIN-END,...: code whose allocations do not fail, as offsets in a program
// - CHAOS_SYNCED=DIR: gets what a power cut leaves (power_cut.py)
//
// Calls inside libc do not pass here. stdio is covered by its own functions.
#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <new>
#include <string_view>

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace {

enum Class : unsigned {
  kWrite,
  kOpen,
  kRename,
  kSync,
  kMmap,
  kFork,
  kThread,
  kClock,
  kRead,
  kRemove,
  kMkdir,
  kClose,
  kMemory,
  kClasses
};
enum Action : std::int64_t { kError, kShort, kEndProcess, kEndAll, kStepClock };

struct Fault {
  std::int64_t kind;    // a Class
  std::int64_t number;  // its call; 0: there is no fault
  std::int64_t goes_on;
  Action action;
  std::int64_t value;  // an error, a signal or seconds
};
struct Page {
  std::array<std::atomic<std::int64_t>, kClasses> counts;
  std::array<std::atomic<std::int64_t>, 8> fired;
  std::array<Fault, 8> faults;
  std::int64_t syncs_nothing;    // a planted defect: no file is synced
  std::int64_t checks_no_write;  // another one: a write that fails is taken for a whole one
};
static_assert(std::atomic<std::int64_t>::is_always_lock_free, "shared between processes");

Page* page = nullptr;
std::atomic<bool> counts = false;

// The code whose allocations count: not that of libraries which end the process without memory.
struct Ranges {
  std::array<std::array<std::uintptr_t, 2>, 64> all;
  unsigned count = 0;

  void add(std::uintptr_t begin, std::uintptr_t end) {
    if (count < all.size()) all[count++] = {begin, end};
  }
  bool has(const void* caller) const {
    const auto address = reinterpret_cast<std::uintptr_t>(caller);
    return std::any_of(all.begin(), all.begin() + count, [&](const auto& range) {
      return address >= range[0] && address < range[1];
    });
  }
};
Ranges own_code, spared_code;

// Loads the real function of this name.
template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

#define REAL(name) static auto* const real = next<decltype(name)>(#name)

// The outcome of a call that is counted.
struct Outcome {
  int error = 0;
  bool is_short = false;
};

Outcome count(Class kind) {
  if (!counts) return {};
  Outcome outcome;
  const int before = errno;
  const std::int64_t number = ++page->counts[kind];
  for (std::size_t i = 0; i < page->faults.size(); ++i) {
    const auto& [its_kind, first, goes_on, action, value] = page->faults[i];
    if (its_kind != kind || first == 0 || number < first) continue;
    if (number > first && goes_on == 0) continue;
    ++page->fired[i];
    if (action == kEndAll) kill(0, static_cast<int>(value));
    if (action == kEndProcess) raise(static_cast<int>(value));
    if (action == kError) outcome.error = static_cast<int>(value);
    outcome.is_short |= action == kShort;
  }
  errno = before;
  return outcome;
}

// Threads and maps of these libraries do not fail: without them Mesa waits for ever.
bool is_spared(const void* caller) {
  Dl_info info;
  if (dladdr(caller, &info) == 0 || info.dli_fname == nullptr) return false;
  const std::string_view name = info.dli_fname;
  return name.find("swrast_dri") != std::string_view::npos ||
         name.find("libLLVM") != std::string_view::npos ||
         name.find("/python3") != std::string_view::npos;
}

// Whether a call of this class has to fail; errno says how.
bool fails(Class kind) {
  const Outcome outcome = count(kind);
  if (outcome.error != 0) errno = outcome.error;
  return outcome.error != 0;
}

// Whether a write happens, and how much of it; otherwise errno says why.
template <typename Size>
bool is_written(Size& size, int pipe = -1) {
  const Outcome outcome = count(kWrite);
  if (outcome.error != 0) errno = outcome.error;
  // POSIX writes as much to a pipe as a whole.
  struct stat status;
  const bool is_atomic = pipe >= 0 && static_cast<std::size_t>(size) <= PIPE_BUF &&
                         fstat(pipe, &status) == 0 && S_ISFIFO(status.st_mode);
  if (outcome.is_short && !is_atomic) size = (size + 1) / 2;
  return outcome.error == 0;
}

ssize_t unwritten(std::size_t size) {
  return page->checks_no_write != 0 ? static_cast<ssize_t>(size) : -1;
}

// Settings of the system's fonts: another system has others, and fontconfig does without them.
bool is_of_fontconfig(long path) {
  const std::string_view name = reinterpret_cast<const char*>(path);
  return name.find("/font") != std::string_view::npos &&
         name.find(".ttf") == std::string_view::npos;
}

// Files the content of a synced file, or the inodes and names in a synced folder, under
// KIND-DEVICE-INODE.
void keep(int descriptor) {
  static const char* const synced = std::getenv("CHAOS_SYNCED");
  struct stat status;
  if (synced == nullptr || fstat(descriptor, &status) != 0) return;
  char opened[64], made[PATH_MAX], kept[PATH_MAX];
  std::snprintf(opened, sizeof opened, "/proc/self/fd/%d", descriptor);
  std::snprintf(made, sizeof made, "%s/.%d-%lu", synced, gettid(), status.st_ino);
  const bool is_file = S_ISREG(status.st_mode);
  std::snprintf(kept, sizeof kept, "%s/%s-%lu-%lu", synced, is_file ? "file" : "folder",
                status.st_dev, status.st_ino);
  const int from = static_cast<int>(syscall(SYS_open, opened, O_RDONLY | O_CLOEXEC));
  const int to = static_cast<int>(syscall(SYS_open, made, O_WRONLY | O_CREAT | O_CLOEXEC, 0666));
  if (is_file) {
    while (syscall(SYS_sendfile, to, from, nullptr, 1U << 30U) > 0) continue;
    syscall(SYS_close, from);
  } else {
    DIR* const folder = fdopendir(from);
    while (const dirent* entry = readdir(folder)) {
      char line[PATH_MAX];
      const int length = std::snprintf(line, sizeof line, "%lu\t%s\n", entry->d_ino, entry->d_name);
      syscall(SYS_write, to, line, length);
    }
    closedir(folder);
  }
  syscall(SYS_close, to);
  syscall(SYS_rename, made, kept);
}

// ---- Begin and end ------------------------------------------------------------------------------

int add_code(dl_phdr_info* info, std::size_t, void*) {
  const std::string_view name = info->dlpi_name;
  const bool is_program = name.empty();
  if (!is_program && name.find("_breakwater") == std::string_view::npos &&
      name.find("libstdc++") == std::string_view::npos &&
      name.find("libmujoco") == std::string_view::npos) {
    return 0;
  }
  for (unsigned i = 0; i < info->dlpi_phnum; ++i) {
    const auto& part = info->dlpi_phdr[i];
    if (part.p_type != PT_LOAD || (part.p_flags & PF_X) == 0) continue;
    own_code.add(info->dlpi_addr + part.p_vaddr, info->dlpi_addr + part.p_vaddr + part.p_memsz);
  }
  if (!is_program) return 0;
  char setting[NAME_MAX];
  std::snprintf(setting, sizeof setting, "CHAOS_SPARED_%s", program_invocation_short_name);
  for (char* at = std::getenv(setting); at != nullptr && *at != '\0'; at += *at == ',' ? 1 : 0) {
    const std::uintptr_t first = std::strtoul(at, &at, 16);
    spared_code.add(info->dlpi_addr + first, info->dlpi_addr + std::strtoul(at + 1, &at, 16));
  }
  return 0;
}

bool lacks_memory(const void* caller) {
  return counts && own_code.has(caller) && !spared_code.has(caller) && fails(kMemory);
}

int (*real_main)(int, char**, char**) = nullptr;

// Programs that Breakwater calls, such as a shell, are left alone.
bool is_counted_program() {
  const char* const below = std::getenv("CHAOS_PROGRAMS");
  char program[PATH_MAX] = "";
  return below != nullptr &&
         syscall(SYS_readlink, "/proc/self/exe", program, sizeof program - 1) > 0 &&
         std::string_view(program).starts_with(below);
}

}  // namespace

extern "C" {

void chaos_begin() {
  const char* const file = std::getenv("CHAOS_PAGE");
  if (file == nullptr || counts) return;
  const int descriptor = static_cast<int>(syscall(SYS_open, file, O_RDWR | O_CLOEXEC));
  page = static_cast<Page*>(reinterpret_cast<void*>(
      syscall(SYS_mmap, nullptr, sizeof(Page), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0)));
  syscall(SYS_close, descriptor);
  if (page == MAP_FAILED) _exit(125);
  dl_iterate_phdr(add_code, nullptr);
  counts = true;
}

void chaos_end() {
  counts = false;
}

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(),
                      void (*fini)(), void (*rtld_fini)(), void* stack_end) {
  real_main = main;
  const auto counted_main = [](int count, char** words, char** environment) {
    if (is_counted_program()) chaos_begin();
    return real_main(count, words, environment);
  };
  return next<decltype(__libc_start_main)>("__libc_start_main")(counted_main, argc, argv, init,
                                                                fini, rtld_fini, stack_end);
}

// A table of functions: each fails if the condition holds. Arguments are whole numbers and pointers
// alone, which pass in registers as they came.
#define FAILING(name, failure, condition)                                            \
  long failing_##name(long a, long b, long c, long d, long e, long f) asm(#name);    \
  long failing_##name(long a, long b, long c, long d, long e, long f) {              \
    static auto* const real = next<long(long, long, long, long, long, long)>(#name); \
    return counts && (condition) ? (failure) : real(a, b, c, d, e, f);               \
  }

FAILING(open, -1, !is_of_fontconfig(a) && fails(kOpen))
FAILING(open64, -1, !is_of_fontconfig(a) && fails(kOpen))
FAILING(openat, -1, !is_of_fontconfig(b) && fails(kOpen))
FAILING(openat64, -1, !is_of_fontconfig(b) && fails(kOpen))
FAILING(fopen, 0, !is_of_fontconfig(a) && fails(kOpen))
FAILING(fopen64, 0, !is_of_fontconfig(a) && fails(kOpen))
FAILING(opendir, 0, !is_of_fontconfig(a) && fails(kOpen))
FAILING(rename, -1, fails(kRename))
FAILING(renameat2, -1, fails(kRename))
FAILING(link, -1, fails(kRename))
FAILING(unlink, -1, fails(kRemove))
FAILING(unlinkat, -1, fails(kRemove))
FAILING(rmdir, -1, fails(kRemove))
FAILING(remove, -1, fails(kRemove))
FAILING(mkdir, -1, fails(kMkdir))
FAILING(ftruncate, -1, fails(kWrite))
FAILING(ftruncate64, -1, fails(kWrite))
FAILING(fork, -1, fails(kFork))
FAILING(posix_spawn, errno, fails(kFork))
FAILING(posix_spawnp, errno, fails(kFork))
FAILING(pthread_create, errno, !is_spared(__builtin_return_address(0)) && fails(kThread))
FAILING(mmap, -1, !is_spared(__builtin_return_address(0)) && fails(kMmap))
FAILING(mmap64, -1, !is_spared(__builtin_return_address(0)) && fails(kMmap))
// Closing and waiting: here only signals arrive.
FAILING(fclose, EOF, fails(kClose))
FAILING(close, -1, fails(kClose))
FAILING(read, -1, fails(kRead))
FAILING(pread, -1, fails(kRead))
FAILING(pread64, -1, fails(kRead))
FAILING(waitpid, -1, fails(kRead))
FAILING(poll, -1, fails(kRead))

// ---- Writing ------------------------------------------------------------------------------------

// A stream that cannot be written has its error flag set.
bool stream_fails(long stream) {
  auto* const file = reinterpret_cast<std::FILE*>(stream);
  if (file == nullptr || file == stderr) return false;
  const Outcome outcome = count(kWrite);
  if (outcome.error == 0 || outcome.error == EINTR) return false;
  constexpr int kErrorSeen = 0x20;  // _IO_ERR_SEEN
  file->_flags |= kErrorSeen;
  errno = outcome.error;
  return true;
}

bool has_bytes(long stream) {
  const auto* const file = reinterpret_cast<const std::FILE*>(stream);
  return file != nullptr && file->_IO_write_ptr > file->_IO_write_base;
}

FAILING(fwrite, 0, stream_fails(d))
FAILING(fputs, EOF, stream_fails(b))
FAILING(fflush, EOF, has_bytes(a) && stream_fails(a))

ssize_t write(int descriptor, const void* bytes, std::size_t size) {
  REAL(write);
  // Standard error is a terminal in the model: a full disk does not stop it.
  if (descriptor != STDERR_FILENO && !is_written(size, descriptor)) return unwritten(size);
  return real(descriptor, bytes, size);
}

ssize_t pwrite64(int descriptor, const void* bytes, std::size_t size, off64_t offset) {
  REAL(pwrite64);
  return is_written(size) ? real(descriptor, bytes, size, offset) : unwritten(size);
}

extern decltype(pwrite64) pwrite [[gnu::alias("pwrite64")]];

ssize_t writev(int descriptor, const iovec* parts, int number) {
  REAL(writev);
  std::size_t size = 0;
  for (int i = 0; i < number; ++i) size += parts[i].iov_len;
  return is_written(number) ? real(descriptor, parts, number) : unwritten(size);
}

ssize_t sendfile(int out, int in, off_t* offset, std::size_t size) noexcept {
  REAL(sendfile);
  return is_written(size) ? real(out, in, offset, size) : -1;
}

int fsync(int descriptor) {
  REAL(fsync);
  if (fails(kSync)) return -1;
  if (counts && page->syncs_nothing != 0) return 0;
  const int status = real(descriptor);
  if (status == 0) keep(descriptor);
  return status;
}
extern decltype(fsync) fdatasync [[gnu::alias("fsync")]];

// ---- Memory and time ----------------------------------------------------------------------------

void* malloc(std::size_t size) {
  return lacks_memory(__builtin_return_address(0)) ? nullptr : __libc_malloc(size);
}

void* calloc(std::size_t number, std::size_t size) {
  return lacks_memory(__builtin_return_address(0)) ? nullptr : __libc_calloc(number, size);
}

void* realloc(void* old, std::size_t size) {
  return lacks_memory(__builtin_return_address(0)) ? nullptr : __libc_realloc(old, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return lacks_memory(__builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, size);
}

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  if (lacks_memory(__builtin_return_address(0))) return ENOMEM;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}

// From the fault's call on, the clock is wrong.
long stepped_s() {
  if (!counts) return 0;
  count(kClock);
  long step = 0;
  for (const Fault& fault : page->faults) {
    const bool has_come = fault.action == kStepClock && page->counts[kClock] >= fault.number;
    if (has_come) step += fault.value;
  }
  return step;
}

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  REAL(clock_gettime);
  const int status = real(clock, time);
  if (clock == CLOCK_REALTIME && status == 0) time->tv_sec += stepped_s();
  return status;
}

int gettimeofday(timeval* time, void* zone) noexcept {
  REAL(gettimeofday);
  const int status = real(time, zone);
  if (status == 0) time->tv_sec += stepped_s();
  return status;
}

std::time_t time(std::time_t* result) noexcept {
  timespec now = {};
  clock_gettime(CLOCK_REALTIME, &now);
  if (result != nullptr) *result = now.tv_sec;
  return now.tv_sec;
}

}  // extern "C"

namespace {

void* memory_of(std::size_t size, std::size_t alignment, const void* caller) {
  if (lacks_memory(caller)) return nullptr;
  return alignment == 0 ? __libc_malloc(std::max<std::size_t>(size, 1))
                        : __libc_memalign(alignment, size);
}

}  // namespace

void* operator new(std::size_t size) {
  void* const memory = memory_of(size, 0, __builtin_return_address(0));
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void* operator new(std::size_t size, std::align_val_t alignment) {
  void* const memory =
      memory_of(size, static_cast<std::size_t>(alignment), __builtin_return_address(0));
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return memory_of(size, 0, __builtin_return_address(0));
}
