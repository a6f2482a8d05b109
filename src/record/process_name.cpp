#include <breakwater/record/process_name.h>

#include <unistd.h>

#include <array>
#include <climits>

namespace breakwater {

std::string host_name() {
  std::array<char, HOST_NAME_MAX + 1> name = {};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

std::string process_name(pid_t process) {
  return host_name() + "-" + std::to_string(process);
}

}  // namespace breakwater
