// HDF5, initialised when the first log is written or read.
#pragma once

#include <hdf5.h>

// These macros call the library inside HDF5's constants, to start it. hdf5() starts it instead.
#undef H5OPEN
#define H5OPEN
#undef H5CHECK
#define H5CHECK

namespace breakwater {

// clang-format off
#define BREAKWATER_HDF5_FUNCTIONS(X)                                                              \
  X(H5Aclose) X(H5Acreate2) X(H5Aexists) X(H5Aget_space) X(H5Aget_type) X(H5Aopen) X(H5Aread)     \
  X(H5Awrite) X(H5Dclose) X(H5Dcreate2) X(H5Dget_create_plist) X(H5Dget_offset) X(H5Dget_space)   \
  X(H5Dget_storage_size) X(H5Dget_type) X(H5Dopen2) X(H5Dread) X(H5Dwrite) X(H5Eset_auto2)        \
  X(H5Fclose) X(H5Fcreate) X(H5Fflush) X(H5Fget_file_image) X(H5Fget_filesize) X(H5Fopen)         \
  X(H5Gclose) X(H5Gcreate2) X(H5Gget_info) X(H5Gopen2) X(H5Iget_file_id) X(H5Lget_info)           \
  X(H5Lget_name_by_idx) X(H5Pclose) X(H5Pcreate) X(H5Pget_chunk) X(H5Pget_external_count)         \
  X(H5Pget_filter2) X(H5Pget_layout) X(H5Pget_nfilters) X(H5Pset_chunk) X(H5Pset_deflate)         \
  X(H5Pset_fapl_core) X(H5Pset_fapl_stdio) X(H5Pset_obj_track_times) X(H5Pset_shuffle)            \
  X(H5Sclose) X(H5Screate) X(H5Screate_simple) X(H5Sget_simple_extent_dims)                       \
  X(H5Sget_simple_extent_ndims) X(H5Sget_simple_extent_type) X(H5Sselect_hyperslab) X(H5Tclose)   \
  X(H5Tcopy) X(H5Tequal) X(H5Tget_class) X(H5Tget_size) X(H5Tis_variable_str) X(H5Tset_cset)      \
  X(H5Tset_size) X(H5Tset_strpad) X(H5check_version) X(H5get_libversion) X(H5open)
// clang-format on

/// The functions and identifiers of HDF5 that logs need, by HDF5's own names. Debian's shared
/// library loads thirty other libraries, which costs a quarter of a short run's time. The programs
/// therefore contain the static library (hdf5_linked.cpp). The Python module and users' programs
/// load the shared one on first use (hdf5_loaded.cpp): h5py may be in the same process.
struct Hdf5 {
#define X(name) decltype(&::name) name = nullptr;
  BREAKWATER_HDF5_FUNCTIONS(X)
#undef X
  hid_t C_S1 = 0;  // H5T_...
  hid_t IEEE_F64LE = 0;
  hid_t NATIVE_DOUBLE = 0;
  hid_t FILE_ACCESS = 0;  // H5P_...
  hid_t DATASET_CREATE = 0;
};

/// Throws std::logic_error with the library's name if it is not there.
const Hdf5& hdf5();

}  // namespace breakwater
