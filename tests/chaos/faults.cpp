// Preloaded library between a program and the system. It counts the calls of each class, and lets
// one fail or ends the process there. tests/chaos/chaos.py draws the faults.
//
// - CHAOS_PAGE=FILE: counters of all processes: kClasses numbers, then one for each fired fault
// - CHAOS_PROGRAMS=DIR: counts in the programs below DIR from main() on, in Python from
//   chaos_begin() on
// - CHAOS_FAULTS=CLASS:NUMBER:FAULT,...: the fault at this call. NUMBER+: at all later ones too
// - CHAOS_SPARED=PROGRAM:BEGIN-END,...: code whose allocations do not fail, as offsets in a program
// - CHAOS_SYNCED=DIR: gets what a power cut leaves (power_cut.py)
// - CHAOS_DEFECT=NAME: plants a defect: no_fsync (no file is synced), unchecked_write (a write that
//   fails is taken for a whole one)
//
// Calls inside libc do not pass here. stdio is covered by its own functions.
#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <poll.h>
#include <pthread.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
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

constexpr std::array<std::string_view, 13> kClasses = {
    "write", "open", "rename", "sync",  "mmap",  "fork",  "thread",
    "clock", "read", "remove", "mkdir", "close", "memory"};
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
  kMemory
};
constexpr unsigned kMostFaults = 8;
constexpr unsigned kMostRanges = 64;

struct Page {
  std::array<std::atomic<std::uint64_t>, kClasses.size()> counts;
  std::array<std::atomic<std::uint64_t>, kMostFaults> fired;
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free, "shared between processes");

struct Fault {
  unsigned kind;  // a Class
  std::uint64_t number;
  bool goes_on;
  std::string_view what;
};

struct Range {
  std::uintptr_t begin, end;
};

Page* page = nullptr;
std::array<Fault, kMostFaults> faults;
unsigned fault_count = 0;
std::atomic<bool> counts = false;
struct Ranges {
  std::array<Range, kMostRanges> all;
  unsigned count = 0;

  void add(std::uintptr_t begin, std::uintptr_t end) {
    if (count < kMostRanges) all[count++] = {begin, end};
  }
  bool has(const void* caller) const {
    const auto address = reinterpret_cast<std::uintptr_t>(caller);
    return std::any_of(all.begin(), all.begin() + count, [&](const Range& range) {
      return address >= range.begin && address < range.end;
    });
  }
};

// The code whose allocations count: not that of libraries which end the process without memory.
Ranges own_code, spared_code;
const char* synced = nullptr;
bool syncs_nothing = false;
bool checks_no_write = false;

const char* setting(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr && *value != '\0' ? value : nullptr;
}

struct ErrorName {
  std::string_view name;
  int error;
};
constexpr std::array<ErrorName, 8> kErrors = {{{"ENOSPC", ENOSPC},
                                               {"EIO", EIO},
                                               {"EINTR", EINTR},
                                               {"EACCES", EACCES},
                                               {"EMFILE", EMFILE},
                                               {"ENOMEM", ENOMEM},
                                               {"EAGAIN", EAGAIN},
                                               {"EINVAL", EINVAL}}};

std::string_view take_until(std::string_view& text, char end) {
  const std::size_t at = std::min(text.find(end), text.size());
  const std::string_view part = text.substr(0, at);
  text.remove_prefix(std::min(at + 1, text.size()));
  return part;
}

Fault read_fault(std::string_view text) {
  const auto* const kind = std::find(kClasses.begin(), kClasses.end(), take_until(text, ':'));
  const std::string_view number = take_until(text, ':');
  return {static_cast<unsigned>(kind - kClasses.begin()), std::strtoull(number.data(), nullptr, 10),
          number.ends_with('+'), text};
}

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
  const std::uint64_t number = ++page->counts[kind];
  for (unsigned i = 0; i < fault_count; ++i) {
    const Fault& fault = faults[i];
    if (fault.kind != kind) continue;
    if (number != fault.number && !(fault.goes_on && number > fault.number)) continue;
    ++page->fired[i];
    if (fault.what == "cut") kill(0, SIGKILL);
    if (fault.what == "int") kill(0, SIGINT);  // Ctrl-C reaches all processes of a command
    if (fault.what == "term") raise(SIGTERM);
    if (fault.what == "kill") raise(SIGKILL);
    outcome.is_short |= fault.what == "short";
    for (const ErrorName& error : kErrors) {
      if (error.name == fault.what) outcome.error = error.error;
    }
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
bool fails(Class kind, const void* caller = nullptr) {
  if (!counts || (caller != nullptr && is_spared(caller))) return false;
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
  return checks_no_write ? static_cast<ssize_t>(size) : -1;
}

// Settings of the system's fonts: another system has others, and fontconfig does without them.
bool is_of_fontconfig(std::string_view path) {
  return path.find("/font") != std::string_view::npos &&
         path.find(".ttf") == std::string_view::npos;
}

// Files the content of a synced file, or the inodes and names in a synced folder, under
// KIND-DEVICE-INODE.
void keep(int descriptor) {
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
  const char* const list = setting("CHAOS_SPARED");
  for (std::string_view rest = list != nullptr && is_program ? list : ""; !rest.empty();) {
    std::string_view entry = take_until(rest, ',');
    if (take_until(entry, ':') != program_invocation_short_name) continue;
    char* end = nullptr;
    const std::uintptr_t begin = std::strtoul(entry.data(), &end, 16);
    spared_code.add(info->dlpi_addr + begin, info->dlpi_addr + std::strtoul(end + 1, nullptr, 16));
  }
  return 0;
}

bool lacks_memory(const void* caller) {
  return counts && own_code.has(caller) && !spared_code.has(caller) && fails(kMemory);
}

int (*real_main)(int, char**, char**) = nullptr;

// Programs that Breakwater calls, such as a shell, are left alone.
bool is_counted_program() {
  const char* const below = setting("CHAOS_PROGRAMS");
  char program[PATH_MAX] = "";
  return below != nullptr &&
         syscall(SYS_readlink, "/proc/self/exe", program, sizeof program - 1) > 0 &&
         std::string_view(program).starts_with(below);
}

}  // namespace

extern "C" {

void chaos_begin() {
  const char* const file = setting("CHAOS_PAGE");
  if (file == nullptr || counts) return;
  const int descriptor = static_cast<int>(syscall(SYS_open, file, O_RDWR | O_CLOEXEC));
  page = static_cast<Page*>(reinterpret_cast<void*>(
      syscall(SYS_mmap, nullptr, sizeof(Page), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0)));
  syscall(SYS_close, descriptor);
  if (page == MAP_FAILED) _exit(125);
  const char* const list = setting("CHAOS_FAULTS");
  for (std::string_view rest = list != nullptr ? list : ""; !rest.empty();) {
    faults[fault_count++] = read_fault(take_until(rest, ','));
  }
  synced = setting("CHAOS_SYNCED");
  const char* const defect = setting("CHAOS_DEFECT");
  syncs_nothing = defect != nullptr && std::strcmp(defect, "no_fsync") == 0;
  checks_no_write = defect != nullptr && std::strcmp(defect, "unchecked_write") == 0;
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

// A function that is counted and may fail. The last argument is the caller if it may be spared.
#define COUNTED(kind, failure, result, name, parameters, arguments, ...)      \
  result name parameters {                                                    \
    static auto* const real = next<result parameters>(#name);                 \
    return fails(kind __VA_OPT__(, ) __VA_ARGS__) ? failure : real arguments; \
  }

// ---- Writing ------------------------------------------------------------------------------------

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

ssize_t pwrite(int descriptor, const void* bytes, std::size_t size, off_t offset) {
  return pwrite64(descriptor, bytes, size, offset);
}

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

COUNTED(kWrite, -1, int, ftruncate64, (int descriptor, off64_t size) noexcept, (descriptor, size))

int ftruncate(int descriptor, off_t size) noexcept {
  return ftruncate64(descriptor, size);
}

// A stream that cannot be written has its error flag set.
bool stream_fails(std::FILE* file) {
  if (!counts || file == nullptr || file == stderr) return false;
  const Outcome outcome = count(kWrite);
  if (outcome.error == 0 || outcome.error == EINTR) return false;
  constexpr int kErrorSeen = 0x20;  // _IO_ERR_SEEN
  file->_flags |= kErrorSeen;
  errno = outcome.error;
  return true;
}

std::size_t fwrite(const void* bytes, std::size_t size, std::size_t number, std::FILE* file) {
  REAL(fwrite);
  return stream_fails(file) ? 0 : real(bytes, size, number, file);
}

int fputs(const char* text, std::FILE* file) {
  REAL(fputs);
  return stream_fails(file) ? EOF : real(text, file);
}

int fflush(std::FILE* file) {
  REAL(fflush);
  const bool has_bytes = file != nullptr && file->_IO_write_ptr > file->_IO_write_base;
  return has_bytes && stream_fails(file) ? EOF : real(file);
}

int fsync(int descriptor) {
  REAL(fsync);
  if (fails(kSync)) return -1;
  if (syncs_nothing) return 0;
  const int status = real(descriptor);
  if (status == 0) keep(descriptor);
  return status;
}

int fdatasync(int descriptor) {
  return fsync(descriptor);
}

// ---- Names --------------------------------------------------------------------------------------

int openat64(int folder, const char* path, int flags, ...) {
  REAL(openat64);
  va_list values;
  va_start(values, flags);
  const mode_t mode = va_arg(values, mode_t);  // any value if the caller passes none
  va_end(values);
  if (!is_of_fontconfig(path) && fails(kOpen)) return -1;
  return real(folder, path, flags, mode);
}

#define OPENING(name, folder, ...)                                        \
  int name(__VA_ARGS__ __VA_OPT__(, ) const char* path, int flags, ...) { \
    va_list values;                                                       \
    va_start(values, flags);                                              \
    const mode_t mode = va_arg(values, mode_t);                           \
    va_end(values);                                                       \
    return openat64(folder, path, flags, mode);                           \
  }
OPENING(openat, folder, int folder)
OPENING(open64, AT_FDCWD)
OPENING(open, AT_FDCWD)

std::FILE* fopen64(const char* path, const char* mode) {
  REAL(fopen64);
  return !is_of_fontconfig(path) && fails(kOpen) ? nullptr : real(path, mode);
}

std::FILE* fopen(const char* path, const char* mode) {
  return fopen64(path, mode);
}

DIR* opendir(const char* path) {
  REAL(opendir);
  return !is_of_fontconfig(path) && fails(kOpen) ? nullptr : real(path);
}

COUNTED(kRename, -1, int, renameat2,
        (int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept,
        (from_folder, from, to_folder, to, flags))
COUNTED(kRename, -1, int, rename, (const char* from, const char* to) noexcept, (from, to))
COUNTED(kRename, -1, int, link, (const char* from, const char* to) noexcept, (from, to))
COUNTED(kRemove, -1, int, unlinkat, (int folder, const char* path, int flags) noexcept,
        (folder, path, flags))
COUNTED(kMkdir, -1, int, mkdir, (const char* path, mode_t mode) noexcept, (path, mode))

int unlink(const char* path) noexcept {
  return unlinkat(AT_FDCWD, path, 0);
}

int rmdir(const char* path) noexcept {
  return unlinkat(AT_FDCWD, path, AT_REMOVEDIR);
}

int remove(const char* path) noexcept {
  const int status = unlinkat(AT_FDCWD, path, 0);
  return status != 0 && errno == EISDIR ? unlinkat(AT_FDCWD, path, AT_REMOVEDIR) : status;
}

// ---- Closing and waiting: here only signals arrive ----------------------------------------------

COUNTED(kClose, EOF, int, fclose, (std::FILE * file), (file))
COUNTED(kClose, -1, int, close, (int descriptor), (descriptor))
COUNTED(kRead, -1, ssize_t, read, (int descriptor, void* bytes, std::size_t size),
        (descriptor, bytes, size))
COUNTED(kRead, -1, ssize_t, pread64,
        (int descriptor, void* bytes, std::size_t size, off64_t offset),
        (descriptor, bytes, size, offset))
COUNTED(kRead, -1, pid_t, waitpid, (pid_t process, int* status, int options),
        (process, status, options))
COUNTED(kRead, -1, int, poll, (pollfd * descriptors, nfds_t number, int timeout),
        (descriptors, number, timeout))

ssize_t pread(int descriptor, void* bytes, std::size_t size, off_t offset) {
  return pread64(descriptor, bytes, size, offset);
}

// ---- Processes, threads, memory, time -----------------------------------------------------------

COUNTED(kFork, -1, pid_t, fork, () noexcept, ())
COUNTED(kFork, errno, int, posix_spawn,
        (pid_t * process, const char* path, const posix_spawn_file_actions_t* actions,
         const posix_spawnattr_t* attributes, char* const* words, char* const* environment),
        (process, path, actions, attributes, words, environment))
COUNTED(kFork, errno, int, posix_spawnp,
        (pid_t * process, const char* path, const posix_spawn_file_actions_t* actions,
         const posix_spawnattr_t* attributes, char* const* words, char* const* environment),
        (process, path, actions, attributes, words, environment))
COUNTED(kThread, errno, int, pthread_create,
        (pthread_t * thread, const pthread_attr_t* attributes, void* (*body)(void*), void* data),
        (thread, attributes, body, data), __builtin_return_address(0))
COUNTED(kMmap, MAP_FAILED, void*, mmap64,
        (void* address, std::size_t size, int protection, int flags, int descriptor,
         off64_t offset) noexcept,
        (address, size, protection, flags, descriptor, offset), __builtin_return_address(0))
COUNTED(kMmap, MAP_FAILED, void*, mmap,
        (void* address, std::size_t size, int protection, int flags, int descriptor,
         off_t offset) noexcept,
        (address, size, protection, flags, descriptor, offset), __builtin_return_address(0))

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
  for (unsigned i = 0; i < fault_count; ++i) {
    const bool has_come = faults[i].kind == kClock && page->counts[kClock] >= faults[i].number;
    if (has_come && faults[i].what.starts_with("step")) {
      step += std::strtol(faults[i].what.data() + 4, nullptr, 10);
    }
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
