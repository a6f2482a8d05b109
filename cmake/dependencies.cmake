# The packages that the rooms link, all from Debian (`./dev setup` installs them), and how CMake
# finds them. The tree searches for all. An installed Breakwater has the same file and searches for
# those of the wanted rooms.

# breakwater_package(TARGET DEBIAN CODE): CODE makes the imported target. In CODE ${how} is REQUIRED
# or QUIET.
function(breakwater_package target debian code)
  get_property(packages GLOBAL PROPERTY BREAKWATER_PACKAGES)
  if(NOT target IN_LIST packages)
    set_property(GLOBAL APPEND PROPERTY BREAKWATER_PACKAGES ${target})
  endif()
  set_property(GLOBAL PROPERTY BREAKWATER_DEBIAN_${target} ${debian})
  set_property(GLOBAL PROPERTY BREAKWATER_FIND_${target} "${code}")
endfunction()

# breakwater_find(TARGET REQUIRED|QUIET)
function(breakwater_find target how)
  if(NOT TARGET ${target})
    get_property(code GLOBAL PROPERTY BREAKWATER_FIND_${target})
    cmake_language(EVAL CODE "${code}")
  endif()
endfunction()

# breakwater_pkg_config(REQUIRED|QUIET NAME MODULE...): PkgConfig::NAME.
function(breakwater_pkg_config how name)
  find_package(PkgConfig ${how})
  if(PKG_CONFIG_FOUND)
    pkg_check_modules(${name} ${how} IMPORTED_TARGET ${ARGN})
  endif()
endfunction()

breakwater_package(Threads::Threads libc6-dev [[find_package(Threads ${how})]])
breakwater_package(Eigen3::Eigen libeigen3-dev [[find_package(Eigen3 3.4 ${how} NO_MODULE)]])
breakwater_package(fmt::fmt libfmt-dev [[find_package(fmt ${how})]])
breakwater_package(tomlplusplus::tomlplusplus libtomlplusplus-dev
  [[find_package(tomlplusplus ${how})]])
breakwater_package(nlohmann_json::nlohmann_json nlohmann-json3-dev
  [[find_package(nlohmann_json ${how})]])
breakwater_package(CLI11::CLI11 libcli11-dev [[find_package(CLI11 ${how})]])
# Debian's mujoco package names libqhull's headers and OpenGL without depending on them.
breakwater_package(mujoco::mujoco "libmujoco-dev, libqhull-dev, libgl-dev and libopengl-dev"
  [[find_package(mujoco 2.2.2 EXACT ${how} NO_MODULE)]])
breakwater_package(PkgConfig::tinyxml2 libtinyxml2-dev
  [[breakwater_pkg_config(${how} tinyxml2 tinyxml2)]])
breakwater_package(PkgConfig::xxhash libxxhash-dev [[breakwater_pkg_config(${how} xxhash libxxhash)]])
breakwater_package(PkgConfig::hdf5 libhdf5-dev [[breakwater_pkg_config(${how} hdf5 hdf5-serial)]])
breakwater_package(random123::random123 librandom123-dev [[
  find_path(RANDOM123_INCLUDE_DIR Random123/philox.h ${how})
  if(RANDOM123_INCLUDE_DIR)
    add_library(random123::random123 INTERFACE IMPORTED)
    target_include_directories(random123::random123 SYSTEM INTERFACE ${RANDOM123_INCLUDE_DIR})
  endif()]])
breakwater_package(Boost::headers libboost-dev [[find_package(Boost 1.74 ${how})]])
breakwater_package(TBB::tbb libtbb-dev [[find_package(TBB ${how} NO_MODULE)]])
breakwater_package(Pagmo::pagmo libpagmo-dev [[find_package(pagmo 2.18 ${how} NO_MODULE)]])
breakwater_package(PkgConfig::nlopt libnlopt-cxx-dev [[breakwater_pkg_config(${how} nlopt nlopt)]])
breakwater_package(ceres::tiny_solver libceres-dev [[
  find_path(CERES_INCLUDE_DIR ceres/tiny_solver.h ${how})
  if(CERES_INCLUDE_DIR)
    add_library(ceres::tiny_solver INTERFACE IMPORTED)
    target_include_directories(ceres::tiny_solver SYSTEM INTERFACE ${CERES_INCLUDE_DIR})
  endif()]])
breakwater_package(PkgConfig::cairo libcairo2-dev [[breakwater_pkg_config(${how} cairo cairo)]])
breakwater_package(PkgConfig::zlib zlib1g-dev [[breakwater_pkg_config(${how} zlib zlib)]])
