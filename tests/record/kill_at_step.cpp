// Preloaded library between a program and the file system. It counts and logs the calls that change
// or sync files. The environment can refuse a call or kill the process at one.
//
//   STEPS_LOG=FILE       each call is appended to FILE
//   STEPS_NO_EXCHANGE=1  renameat2() fails, as on NFS
//   STEPS_REFUSE=TEXT    renames to a path that ends with TEXT ("all": any) fail with EACCES
//   STEPS_BAD_DISK=TEXT  fsync() of a path that ends with TEXT fails with EIO
//   STEPS_KILL_BEFORE=N, STEPS_KILL_AFTER=N  SIGKILL before or after the Nth call
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

int calls = 0;

const char* setting(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : "";
}

void kill_at(const char* name) {
  if (std::atoi(setting(name)) == calls) std::raise(SIGKILL);
}

template <typename Call>
int step(const std::string& what, Call&& call) {
  ++calls;
  if (const std::string log = setting("STEPS_LOG"); !log.empty()) {
    std::FILE* const file = std::fopen(log.c_str(), "a");
    std::fprintf(file, "%s\n", what.c_str());
    std::fclose(file);
  }
  kill_at("STEPS_KILL_BEFORE");
  const int status = call();
  const int error = errno;
  kill_at("STEPS_KILL_AFTER");
  errno = error;
  return status;
}

int fail(int error) {
  errno = error;
  return -1;
}

bool is_set_for(const char* name, const std::string& path) {
  const std::string text = setting(name);
  return !text.empty() && (text == "all" || path.ends_with(text));
}

template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int renameat2(int from_folder, const char* from, int to_folder, const char* to,
              unsigned flags) noexcept {
  return step(std::string("exchange ") + from + " " + to, [&] {
    if (*setting("STEPS_NO_EXCHANGE") != '\0') return fail(EINVAL);
    if (is_set_for("STEPS_REFUSE", to)) return fail(EACCES);
    return next<decltype(renameat2)>("renameat2")(from_folder, from, to_folder, to, flags);
  });
}

int rename(const char* from, const char* to) noexcept {
  return step(std::string("rename ") + from + " " + to, [&] {
    if (is_set_for("STEPS_REFUSE", to)) return fail(EACCES);
    return next<decltype(rename)>("rename")(from, to);
  });
}

int unlinkat(int folder, const char* path, int flags) noexcept {
  return step(std::string("unlink ") + path,
              [&] { return next<decltype(unlinkat)>("unlinkat")(folder, path, flags); });
}

int fsync(int descriptor) {
  std::array<char, PATH_MAX> path = {};
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  if (readlink(link.c_str(), path.data(), path.size() - 1) < 0) return fail(EBADF);
  return step(std::string("sync ") + path.data(), [&] {
    if (is_set_for("STEPS_BAD_DISK", path.data())) return fail(EIO);
    return next<decltype(fsync)>("fsync")(descriptor);
  });
}

}  // extern "C"
