# Everything comes from Debian packages; `./dev setup` installs them. An installed Breakwater finds
# them by this same file.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)

# Debian's mujoco package names libqhull's headers and OpenGL without depending on them.
find_package(mujoco 2.2.2 EXACT REQUIRED NO_MODULE)

find_package(PkgConfig REQUIRED)
pkg_check_modules(urdfdom REQUIRED IMPORTED_TARGET urdfdom)
pkg_check_modules(tinyxml2 REQUIRED IMPORTED_TARGET tinyxml2)
pkg_check_modules(xxhash REQUIRED IMPORTED_TARGET libxxhash)
pkg_check_modules(hdf5 REQUIRED IMPORTED_TARGET hdf5-serial)
# The high-level library (dimension scales) has no pkg-config file.
find_library(HDF5_HL_LIBRARY NAMES hdf5_serial_hl REQUIRED)
add_library(hdf5::hl INTERFACE IMPORTED)
target_link_libraries(hdf5::hl INTERFACE ${HDF5_HL_LIBRARY} PkgConfig::hdf5)

find_path(RANDOM123_INCLUDE_DIR Random123/philox.h REQUIRED)
add_library(random123::random123 INTERFACE IMPORTED)
target_include_directories(random123::random123 SYSTEM INTERFACE ${RANDOM123_INCLUDE_DIR})

# Pictures. Mesa's OSMesa is not linked: render/ loads it when the first picture is drawn.
pkg_check_modules(osmesa REQUIRED IMPORTED_TARGET osmesa)
pkg_check_modules(cairo REQUIRED IMPORTED_TARGET cairo)
pkg_check_modules(ffmpeg REQUIRED IMPORTED_TARGET libavformat libavcodec libswscale libavutil)

# Reports. dygraphs is read when a page is written, and goes into it whole.
find_path(MUSTACHE_INCLUDE_DIR kainjow/mustache.hpp REQUIRED)
find_path(DYGRAPHS_DIR dygraph.min.js PATHS /usr/share/javascript/dygraphs NO_DEFAULT_PATH REQUIRED)
