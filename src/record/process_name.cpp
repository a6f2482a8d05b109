#include <breakwater/record/process_name.h>

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <climits>
#include <csignal>
#include <fstream>
#include <iterator>
#include <random>

#include <breakwater/record/file_hash.h>

namespace breakwater {
namespace {

// In a container without an init process, the orphans that ended stay zombies.
bool is_zombie(pid_t process) {
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  const std::string text(std::istreambuf_iterator<char>(file), {});
  return text.substr(std::min(text.rfind(')'), text.size())).starts_with(") Z ");
}

}  // namespace

std::string host_name() {
  std::array<char, HOST_NAME_MAX + 1> name = {};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

std::string process_name(pid_t process) {
  return host_name() + "-" + std::to_string(process);
}

std::string unique_name() {
  std::random_device random;
  return fmt::format("{}{}{:08x}{:08x}", process_name(), kCopyMark, random(), random());
}

std::string hidden_name(const std::filesystem::path& target, const std::string& mark) {
  // NAME_MAX less the dot, the mark, the host, the number and the random end.
  constexpr std::size_t kMostBytes = NAME_MAX - 1 - 9 - HOST_NAME_MAX - 11 - 17;
  constexpr std::size_t kHashed = 17;
  std::string name = target.filename().string();
  if (name.size() > kMostBytes) {
    std::size_t kept = kMostBytes - kHashed;
    while ((name[kept] & 0xC0) == 0x80) --kept;  // not within a letter of UTF-8
    name = name.substr(0, kept) + "~" + text_hash(name);
  }
  return "." + name + mark;
}

std::filesystem::path followed(std::filesystem::path path) {
  constexpr int kMostLinks = 40;  // as the kernel
  std::error_code error;
  for (int i = 0; i < kMostLinks && std::filesystem::is_symlink(path, error); ++i) {
    const auto next = std::filesystem::read_symlink(path, error);
    if (error) break;
    path = next.is_absolute() ? next : path.parent_path() / next;
  }
  return path;
}

bool is_of_dead_process(const std::string& name) {
  const std::string begin = host_name() + "-";
  if (!name.starts_with(begin)) return false;
  pid_t pid = 0;
  const char* const end = name.data() + name.size();
  const auto read = std::from_chars(name.data() + begin.size(), end, pid);
  if (read.ec != std::errc() || (read.ptr != end && *read.ptr != kCopyMark)) return false;
  return pid == getpid() || (pid > 0 && ((kill(pid, 0) != 0 && errno == ESRCH) || is_zombie(pid)));
}

}  // namespace breakwater
