// HDF5, loaded when the first log is written or read.
#include <breakwater/record/hdf5_library.h>

#include <dlfcn.h>

#include <stdexcept>
#include <string>

namespace breakwater {
namespace {

constexpr const char* kLibrary = BREAKWATER_HDF5;  // the version of the headers

template <typename Pointer>
void find(void* library, const char* name, Pointer& found) {
  found = reinterpret_cast<Pointer>(dlsym(library, name));
  if (found == nullptr) throw std::logic_error(std::string(kLibrary) + " has no " + name);
}

Hdf5 load() {
  // The high-level library links HDF5, so it gives the names of both.
  void* const library = dlopen(kLibrary, RTLD_LAZY | RTLD_LOCAL);
  if (library == nullptr) {
    throw std::logic_error(std::string(dlerror()) + " (Debian package libhdf5-hl-100)");
  }
  Hdf5 all;
#define X(name) find(library, #name, all.name);
  BREAKWATER_HDF5_FUNCTIONS(X)
#undef X
  all.H5check_version(H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE);
  if (all.H5open() < 0) throw std::logic_error(std::string(kLibrary) + ": cannot be started");
  const auto value = [&](const char* name) {
    const hid_t* id = nullptr;
    find(library, name, id);
    return *id;
  };
  all.C_S1 = value("H5T_C_S1_g");
  all.IEEE_F64LE = value("H5T_IEEE_F64LE_g");
  all.NATIVE_DOUBLE = value("H5T_NATIVE_DOUBLE_g");
  all.FILE_ACCESS = value("H5P_CLS_FILE_ACCESS_ID_g");
  all.DATASET_CREATE = value("H5P_CLS_DATASET_CREATE_ID_g");
  return all;
}

}  // namespace

const Hdf5& hdf5() {
  static const Hdf5 loaded = load();
  return loaded;
}

}  // namespace breakwater
