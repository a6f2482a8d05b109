// HDF5, linked into the program.
#include <breakwater/record/hdf5_library.h>

#include <stdexcept>

namespace breakwater {
namespace {

Hdf5 start() {
  if (H5open() < 0) throw std::logic_error("HDF5: cannot be started");
  Hdf5 all;
#define X(name) all.name = &::name;
  BREAKWATER_HDF5_FUNCTIONS(X)
#undef X
  all.C_S1 = H5T_C_S1_g;
  all.IEEE_F64LE = H5T_IEEE_F64LE_g;
  all.NATIVE_DOUBLE = H5T_NATIVE_DOUBLE_g;
  all.FILE_ACCESS = H5P_CLS_FILE_ACCESS_ID_g;
  all.DATASET_CREATE = H5P_CLS_DATASET_CREATE_ID_g;
  return all;
}

}  // namespace

const Hdf5& hdf5() {
  static const Hdf5 started = start();
  return started;
}

}  // namespace breakwater
