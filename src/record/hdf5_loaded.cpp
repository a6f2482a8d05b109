// HDF5, loaded when the first log is written or read.
#include <breakwater/record/hdf5_library.h>

#include <stdexcept>

#include <breakwater/record/loaded_library.h>

namespace breakwater {
namespace {

Hdf5 load() {
  const LoadedLibrary library(BREAKWATER_HDF5, "libhdf5-103-1");
  Hdf5 all;
#define X(name) all.name = library.symbol<std::logic_error, decltype(::name)>(#name);
  BREAKWATER_HDF5_FUNCTIONS(X)
#undef X
  all.H5check_version(H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE);
  if (all.H5open() < 0) throw std::logic_error(BREAKWATER_HDF5 ": cannot be started");
  const auto value = [&](const char* name) {
    return *library.symbol<std::logic_error, const hid_t>(name);
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
