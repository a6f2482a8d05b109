#include <breakwater/record/loaded_library.h>

#include <dlfcn.h>

#include <utility>

namespace breakwater {

LoadedLibrary::LoadedLibrary(std::string file, const std::string& debian_package, bool is_global)
    : file_(std::move(file)),
      handle_(dlopen(file_.c_str(), is_global ? RTLD_NOW | RTLD_GLOBAL : RTLD_LAZY | RTLD_LOCAL)) {
  if (handle_ != nullptr) return;
  complaint_ = std::string(dlerror()) + " (Debian package " + debian_package + ")";
}

void* LoadedLibrary::find(const char* name) const {
  return dlsym(handle_, name);
}

}  // namespace breakwater
