// Preloaded library between a program and the system. It counts the calls of each class, and lets
// one fail or ends the process there. tests/chaos/chaos.py draws the faults.
//
// - CHAOS_PAGE=FILE: counters of all processes: kClasses numbers, then one for each fired fault
// - CHAOS_PROGRAMS=DIR: counts in the programs below DIR from main() on, in Python from
//   chaos_begin() on
// - CHAOS_FAULTS=CLASS:NUMBER:FAULT,...: the fault at this call. NUMBER+: at all later ones too
// - CHAOS_SPARED=PROGRAM:BEGIN-END,...: code whose allocations do not fail, as offsets in a program
// - CHAOS_JOURNAL=FILE: each change of a file and each sync, for the model of a power cut
// - CHAOS_GRAVES=DIR: with the journal: second names of removed files
// - CHAOS_DEFECT=NAME: plants a defect: no_fsync (no file is synced), in_place (no temporary name)
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
  unsigned kind = 0;  // a Class
  std::uint64_t number = 0;
  bool goes_on = false;
  int signal = 0;
  bool is_cut = false;
  bool is_short = false;
  int error = 0;
  long step_s = 0;
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
int journal = -1;
std::atomic<unsigned> graves = 0;
bool syncs_nothing = false;
bool is_in_place = false;

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

[[noreturn]] void refuse(std::string_view what) {
  std::fprintf(stderr, "CHAOS_FAULTS: %.*s: is no fault\n", static_cast<int>(what.size()),
               what.data());
  _exit(125);
}

std::string_view take_until(std::string_view& text, char end) {
  const std::size_t at = std::min(text.find(end), text.size());
  const std::string_view part = text.substr(0, at);
  text.remove_prefix(std::min(at + 1, text.size()));
  return part;
}

Fault read_fault(std::string_view text) {
  const std::string_view whole = text;
  Fault fault;
  const std::string_view kind = take_until(text, ':');
  const auto* const found = std::find(kClasses.begin(), kClasses.end(), kind);
  if (found == kClasses.end()) refuse(whole);
  fault.kind = static_cast<unsigned>(found - kClasses.begin());
  std::string_view number = take_until(text, ':');
  fault.goes_on = number.ends_with('+');
  fault.number = std::strtoull(number.data(), nullptr, 10);
  if (fault.number == 0) refuse(whole);
  if (text == "kill") {
    fault.signal = SIGKILL;
  } else if (text == "term") {
    fault.signal = SIGTERM;
  } else if (text == "int") {
    fault.signal = SIGINT;
  } else if (text == "cut") {
    fault.is_cut = true;
  } else if (text == "short") {
    fault.is_short = true;
  } else if (text.starts_with("step")) {
    fault.step_s = std::strtol(text.data() + 4, nullptr, 10);
  } else {
    for (const ErrorName& error : kErrors) {
      if (error.name == text) fault.error = error.error;
    }
    if (fault.error == 0) refuse(whole);
  }
  return fault;
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
    if (fault.is_cut) kill(0, SIGKILL);
    // Ctrl-C reaches all processes of a command.
    if (fault.signal == SIGINT) kill(0, SIGINT);
    if (fault.signal == SIGTERM || fault.signal == SIGKILL) raise(fault.signal);
    if (fault.error != 0) outcome.error = fault.error;
    if (fault.is_short) outcome.is_short = true;
  }
  errno = before;
  return outcome;
}

// Whether a call of this class has to fail; errno says how.
bool fails(Class kind) {
  const Outcome outcome = count(kind);
  if (outcome.error == 0) return false;
  errno = outcome.error;
  return true;
}

// ---- The journal --------------------------------------------------------------------------------

void note(const char* format, ...) __attribute__((format(printf, 1, 2)));
void note(const char* format, ...) {
  if (journal < 0) return;
  const int before = errno;
  char line[4 * PATH_MAX];
  va_list values;
  va_start(values, format);
  const int length = std::vsnprintf(line, sizeof line, format, values);
  va_end(values);
  syscall(SYS_write, journal, line, static_cast<std::size_t>(length));
  errno = before;
}

void note_descriptor(char what, int descriptor) {
  if (journal < 0) return;
  const int before = errno;
  struct stat status;
  if (fstat(descriptor, &status) == 0 && (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode))) {
    note("%c\t%lu\t%ld\n", what, static_cast<unsigned long>(status.st_ino),
         static_cast<long>(status.st_size));
  }
  errno = before;
}

// An absolute path, and the inode of its folder.
struct Place {
  char path[PATH_MAX];
  unsigned long folder = 0;
};

void locate(int folder, const char* path, Place& place) {
  const char* const separator = *path == '/' ? "" : "/";
  char base[PATH_MAX] = "";
  if (*path != '/') {
    char link[64];
    if (folder == AT_FDCWD) {
      std::snprintf(link, sizeof link, "/proc/self/cwd");
    } else {
      std::snprintf(link, sizeof link, "/proc/self/fd/%d", folder);
    }
    const long length = syscall(SYS_readlink, link, base, sizeof base - 1);
    base[std::max(0L, length)] = '\0';
  }
  std::snprintf(place.path, sizeof place.path, "%s%s%s", base, separator, path);
  char above[PATH_MAX];
  std::snprintf(above, sizeof above, "%s", place.path);
  char* const slash = std::strrchr(above, '/');
  if (slash != nullptr) *slash = '\0';
  struct stat status;
  if (stat(above, &status) == 0) place.folder = status.st_ino;
}

// Another name for a file that is about to lose its own; 0 without one.
unsigned bury(const char* path) {
  struct stat status;
  if (lstat(path, &status) != 0 || !S_ISREG(status.st_mode)) return 0;
  const unsigned number = static_cast<unsigned>(getpid()) * 10000 + ++graves;
  char grave[PATH_MAX];
  std::snprintf(grave, sizeof grave, "%s/%u", setting("CHAOS_GRAVES"), number);
  return syscall(SYS_linkat, AT_FDCWD, path, AT_FDCWD, grave, 0) == 0 ? number : 0;
}

void note_name(const char* what, int folder, const char* path) {
  if (journal < 0) return;
  const int before = errno;
  Place place;
  locate(folder, path, place);
  struct stat status = {};
  lstat(place.path, &status);
  note("%s\t%lu\t%lu\t%u\t%s\n", what, place.folder, static_cast<unsigned long>(status.st_ino),
       *what == '-' ? bury(place.path) : 0, place.path);
  errno = before;
}

void note_names(const char* what, int from_folder, const char* from, int to_folder,
                const char* to) {
  if (journal < 0) return;
  const int before = errno;
  Place source, target;
  locate(from_folder, from, source);
  locate(to_folder, to, target);
  struct stat status = {};
  lstat(source.path, &status);
  const unsigned grave = *what == '>' ? bury(target.path) : 0;
  note("%s\t%lu\t%lu\t%lu\t%u\t%s\t%s\n", what, source.folder, target.folder,
       static_cast<unsigned long>(status.st_ino), grave, source.path, target.path);
  errno = before;
}

// Settings of the system's fonts: another system has others, and fontconfig does without them.
bool is_of_fontconfig(const char* path) {
  return std::string_view(path).find("/font") != std::string_view::npos &&
         std::string_view(path).find(".ttf") == std::string_view::npos;
}

// Before a file is opened. Its old content is lost with O_TRUNC.
void note_opening(int folder, const char* path, int flags) {
  if (journal < 0 || (flags & (O_CREAT | O_TRUNC)) == 0) return;
  const int before = errno;
  struct stat status;
  if (fstatat(folder, path, &status, 0) != 0) {
    note_name("+f", folder, path);
  } else if ((flags & O_TRUNC) != 0 && S_ISREG(status.st_mode)) {
    note("T\t%lu\t0\n", static_cast<unsigned long>(status.st_ino));
  }
  errno = before;
}

// ---- Planted defects ----------------------------------------------------------------------------

// The path of a temporary file ".NAME.partial-PROCESS" is that of NAME.
struct Written {
  char path[PATH_MAX];
  explicit Written(const char* given) {
    std::snprintf(path, sizeof path, "%s", given);
    char* const slash = std::strrchr(path, '/');
    char* const name = slash != nullptr ? slash + 1 : path;
    char* const mark = std::strstr(name, ".partial-");
    if (!is_in_place || *name != '.' || mark == nullptr) return;
    *mark = '\0';
    std::memmove(name, name + 1, std::strlen(name));
  }
};

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

// Threads and maps of these libraries do not fail: without them Mesa waits for ever.
bool is_spared(const void* caller) {
  Dl_info info;
  if (dladdr(caller, &info) == 0 || info.dli_fname == nullptr) return false;
  const std::string_view name = info.dli_fname;
  return name.find("libOSMesa") != std::string_view::npos ||
         name.find("libLLVM") != std::string_view::npos ||
         name.find("/python3") != std::string_view::npos;
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
  if (descriptor < 0) refuse(file);
  page = static_cast<Page*>(reinterpret_cast<void*>(
      syscall(SYS_mmap, nullptr, sizeof(Page), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0)));
  syscall(SYS_close, descriptor);
  if (page == MAP_FAILED) refuse(file);
  const char* const list = setting("CHAOS_FAULTS");
  for (std::string_view rest = list != nullptr ? list : ""; !rest.empty();) {
    if (fault_count == kMostFaults) refuse(rest);
    faults[fault_count++] = read_fault(take_until(rest, ','));
  }
  if (const char* const name = setting("CHAOS_JOURNAL")) {
    journal =
        static_cast<int>(syscall(SYS_open, name, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
  }
  const char* const defect = setting("CHAOS_DEFECT");
  syncs_nothing = defect != nullptr && std::strcmp(defect, "no_fsync") == 0;
  is_in_place = defect != nullptr && std::strcmp(defect, "in_place") == 0;
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

// ---- Writing ------------------------------------------------------------------------------------

// POSIX writes as much to a pipe as a whole.
bool is_atomic(int descriptor, std::size_t size) {
  struct stat status;
  return size <= PIPE_BUF && fstat(descriptor, &status) == 0 && S_ISFIFO(status.st_mode);
}

ssize_t write(int descriptor, const void* bytes, std::size_t size) {
  REAL(write);
  // Standard error is a terminal in the model: a full disk does not stop it.
  const Outcome outcome = descriptor == STDERR_FILENO ? Outcome() : count(kWrite);
  if (outcome.error != 0) return errno = outcome.error, -1;
  note_descriptor('W', descriptor);
  const bool is_short = outcome.is_short && !is_atomic(descriptor, size);
  return real(descriptor, bytes, is_short ? (size + 1) / 2 : size);
}

ssize_t pwrite64(int descriptor, const void* bytes, std::size_t size, off64_t offset) {
  REAL(pwrite64);
  const Outcome outcome = count(kWrite);
  if (outcome.error != 0) return errno = outcome.error, -1;
  note_descriptor('W', descriptor);
  return real(descriptor, bytes, outcome.is_short ? (size + 1) / 2 : size, offset);
}

ssize_t pwrite(int descriptor, const void* bytes, std::size_t size, off_t offset) {
  return pwrite64(descriptor, bytes, size, offset);
}

ssize_t writev(int descriptor, const iovec* parts, int number) {
  REAL(writev);
  const Outcome outcome = count(kWrite);
  if (outcome.error != 0) return errno = outcome.error, -1;
  note_descriptor('W', descriptor);
  return real(descriptor, parts, outcome.is_short ? (number + 1) / 2 : number);
}

ssize_t sendfile(int out, int in, off_t* offset, std::size_t size) noexcept {
  REAL(sendfile);
  const Outcome outcome = count(kWrite);
  if (outcome.error != 0) return errno = outcome.error, -1;
  note_descriptor('W', out);
  return real(out, in, offset, outcome.is_short ? (size + 1) / 2 : size);
}

int ftruncate64(int descriptor, off64_t size) noexcept {
  REAL(ftruncate64);
  if (fails(kWrite)) return -1;
  note_descriptor('W', descriptor);
  return real(descriptor, size);
}

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
  if (stream_fails(file)) return 0;
  if (counts) note_descriptor('W', fileno(file));
  return real(bytes, size, number, file);
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

// ---- Names --------------------------------------------------------------------------------------

int openat64(int folder, const char* path, int flags, ...) {
  REAL(openat64);
  va_list values;
  va_start(values, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(values, mode_t) : 0;
  va_end(values);
  if (!counts || is_of_fontconfig(path)) return real(folder, path, flags, mode);
  if (fails(kOpen)) return -1;
  const Written written(path);
  note_opening(folder, written.path, flags);
  return real(folder, written.path, flags, mode);
}

int openat(int folder, const char* path, int flags, ...) {
  va_list values;
  va_start(values, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(values, mode_t) : 0;
  va_end(values);
  return openat64(folder, path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list values;
  va_start(values, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(values, mode_t) : 0;
  va_end(values);
  return openat64(AT_FDCWD, path, flags, mode);
}

int open(const char* path, int flags, ...) {
  va_list values;
  va_start(values, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(values, mode_t) : 0;
  va_end(values);
  return openat64(AT_FDCWD, path, flags, mode);
}

std::FILE* fopen64(const char* path, const char* mode) {
  REAL(fopen64);
  if (!counts || is_of_fontconfig(path)) return real(path, mode);
  if (fails(kOpen)) return nullptr;
  const Written written(path);
  note_opening(AT_FDCWD, written.path,
               *mode == 'w' ? O_CREAT | O_TRUNC : (*mode == 'a' ? O_CREAT : 0));
  return real(written.path, mode);
}

std::FILE* fopen(const char* path, const char* mode) {
  return fopen64(path, mode);
}

DIR* opendir(const char* path) {
  REAL(opendir);
  return counts && !is_of_fontconfig(path) && fails(kOpen) ? nullptr : real(path);
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to,
              unsigned flags) noexcept {
  REAL(renameat2);
  if (fails(kRename)) return -1;
  note_names((flags & RENAME_EXCHANGE) != 0 ? "x" : ">", from_folder, from, to_folder, to);
  return real(from_folder, from, to_folder, to, flags);
}

int rename(const char* from, const char* to) noexcept {
  REAL(rename);
  if (fails(kRename)) return -1;
  const Written written(from);
  if (std::strcmp(written.path, from) != 0 && std::strcmp(written.path, to) == 0) return 0;
  note_names(">", AT_FDCWD, from, AT_FDCWD, to);
  return real(from, to);
}

int link(const char* from, const char* to) noexcept {
  REAL(link);
  if (fails(kRename)) return -1;
  const Written written(from);
  if (std::strcmp(written.path, from) != 0 && std::strcmp(written.path, to) == 0) return 0;
  note_names("&", AT_FDCWD, from, AT_FDCWD, to);
  return real(from, to);
}

int unlinkat(int folder, const char* path, int flags) noexcept {
  REAL(unlinkat);
  if (fails(kRemove)) return -1;
  note_name((flags & AT_REMOVEDIR) != 0 ? "-d" : "-f", folder, path);
  return real(folder, path, flags);
}

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

int mkdir(const char* path, mode_t mode) noexcept {
  REAL(mkdir);
  if (fails(kMkdir)) return -1;
  struct stat status;
  if (journal >= 0 && stat(path, &status) != 0) note_name("+d", AT_FDCWD, path);
  return real(path, mode);
}

int fsync(int descriptor) {
  REAL(fsync);
  if (fails(kSync)) return -1;
  if (syncs_nothing) return 0;
  const int status = real(descriptor);
  if (status == 0) note_descriptor('S', descriptor);
  return status;
}

int fdatasync(int descriptor) {
  return fsync(descriptor);
}

int fclose(std::FILE* file) {
  REAL(fclose);
  count(kClose);
  return real(file);
}

int close(int descriptor) {
  REAL(close);
  count(kClose);
  return real(descriptor);
}

// ---- Waiting: here only signals arrive ----------------------------------------------------------

ssize_t read(int descriptor, void* bytes, std::size_t size) {
  REAL(read);
  count(kRead);
  return real(descriptor, bytes, size);
}

ssize_t pread64(int descriptor, void* bytes, std::size_t size, off64_t offset) {
  REAL(pread64);
  count(kRead);
  return real(descriptor, bytes, size, offset);
}

ssize_t pread(int descriptor, void* bytes, std::size_t size, off_t offset) {
  return pread64(descriptor, bytes, size, offset);
}

pid_t waitpid(pid_t process, int* status, int options) {
  REAL(waitpid);
  count(kRead);
  return real(process, status, options);
}

int poll(pollfd* descriptors, nfds_t number, int timeout) {
  REAL(poll);
  count(kRead);
  return real(descriptors, number, timeout);
}

// ---- Processes, threads, memory, time -----------------------------------------------------------

void* mmap64(void* address, std::size_t size, int protection, int flags, int descriptor,
             off64_t offset) noexcept {
  REAL(mmap64);
  if (counts && !is_spared(__builtin_return_address(0)) && fails(kMmap)) return MAP_FAILED;
  return real(address, size, protection, flags, descriptor, offset);
}

void* mmap(void* address, std::size_t size, int protection, int flags, int descriptor,
           off_t offset) noexcept {
  REAL(mmap);
  if (counts && !is_spared(__builtin_return_address(0)) && fails(kMmap)) return MAP_FAILED;
  return real(address, size, protection, flags, descriptor, offset);
}

pid_t fork() noexcept {
  REAL(fork);
  return fails(kFork) ? -1 : real();
}

int posix_spawn(pid_t* process, const char* path, const posix_spawn_file_actions_t* actions,
                const posix_spawnattr_t* attributes, char* const* words, char* const* environment) {
  REAL(posix_spawn);
  const int error = count(kFork).error;
  return error != 0 ? error : real(process, path, actions, attributes, words, environment);
}

int posix_spawnp(pid_t* process, const char* path, const posix_spawn_file_actions_t* actions,
                 const posix_spawnattr_t* attributes, char* const* words,
                 char* const* environment) {
  REAL(posix_spawnp);
  const int error = count(kFork).error;
  return error != 0 ? error : real(process, path, actions, attributes, words, environment);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*body)(void*),
                   void* data) {
  REAL(pthread_create);
  const int error = counts && !is_spared(__builtin_return_address(0)) ? count(kThread).error : 0;
  return error != 0 ? error : real(thread, attributes, body, data);
}

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
    if (faults[i].kind == kClock && page->counts[kClock] >= faults[i].number)
      step += faults[i].step_s;
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
