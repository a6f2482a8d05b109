# Packages that only the tree needs. An installed Breakwater does not.
get_property(packages GLOBAL PROPERTY BREAKWATER_PACKAGES)
if(NOT BREAKWATER_TOOLS)
  list(REMOVE_ITEM packages Boost::headers ceres::tiny_solver Pagmo::pagmo PkgConfig::cairo
    PkgConfig::nlopt TBB::tbb)
endif()
foreach(package IN LISTS packages)
  breakwater_find(${package} REQUIRED)
endforeach()

find_package(PkgConfig REQUIRED)
if(BREAKWATER_TOOLS)
  # OpenGL is not linked: render/ loads EGL for the first picture.
  find_path(EGL_INCLUDE_DIR EGL/egl.h REQUIRED)
  # dygraphs and three.js go into each page as a whole.
  find_path(MUSTACHE_INCLUDE_DIR kainjow/mustache.hpp REQUIRED)
  find_path(THREE_DIR three.min.js PATHS /usr/share/javascript/three NO_DEFAULT_PATH REQUIRED)
  find_path(DYGRAPHS_DIR dygraph.min.js PATHS /usr/share/javascript/dygraphs NO_DEFAULT_PATH REQUIRED)
endif()
# The static HDF5 of the programs, with its compression libraries.
find_library(HDF5_STATIC_LIBRARY libhdf5_serial.a REQUIRED)
find_library(SZ_STATIC_LIBRARY libsz.a REQUIRED)
find_library(AEC_STATIC_LIBRARY libaec.a REQUIRED)
set(HDF5_STATIC_LIBRARIES ${HDF5_STATIC_LIBRARY} ${SZ_STATIC_LIBRARY} ${AEC_STATIC_LIBRARY}
    PkgConfig::zlib ${CMAKE_DL_LIBS})
