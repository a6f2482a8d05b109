#include <breakwater/record/process_name.h>

#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <climits>
#include <csignal>

namespace breakwater {

std::string host_name() {
  std::array<char, HOST_NAME_MAX + 1> name = {};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

std::string process_name(pid_t process) {
  return host_name() + "-" + std::to_string(process);
}

bool is_of_dead_process(const std::string& name) {
  const std::string begin = host_name() + "-";
  if (!name.starts_with(begin)) return false;
  pid_t pid = 0;
  const char* const end = name.data() + name.size();
  const auto read = std::from_chars(name.data() + begin.size(), end, pid);
  if (read.ec != std::errc() || (read.ptr != end && *read.ptr != kCopyMark)) return false;
  return pid == getpid() || (pid > 0 && kill(pid, 0) != 0 && errno == ESRCH);
}

}  // namespace breakwater
