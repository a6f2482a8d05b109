# The compiler options of all targets: target `breakwater_options`.
find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Hashed files do not contain the path of the clone.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}
      CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
endif()

set(BREAKWATER_SANITIZER "" CACHE STRING "address, fuzzer (Clang) or thread; empty for none")
# Both link faster than GNU's linker.
find_program(FASTER_LINKER NAMES mold ld.lld)
if(FASTER_LINKER MATCHES "mold$")
  add_link_options(-fuse-ld=mold)
elseif(FASTER_LINKER)
  add_link_options(-fuse-ld=lld)
endif()
add_link_options(-Wl,--build-id=sha1)  # manifests have its hash

option(BREAKWATER_TOOLS "All but the programs of the arm: other scenarios, pages, studies, tests, ..." ON)
option(BREAKWATER_NATIVE "Compile for this machine's processor: for benchmarks, not for goldens" OFF)
option(BREAKWATER_PYTHON "The Python module (Debian: pybind11-dev)" ON)
option(BREAKWATER_WARNINGS_AS_ERRORS "As the presets that are tested have it" OFF)

add_library(breakwater_options INTERFACE)
target_compile_features(breakwater_options INTERFACE cxx_std_20)
# Without fused multiply-add our arithmetic gives the same bits on any x86-64 machine, like the
# functions of math/.
target_compile_options(breakwater_options INTERFACE -ffp-contract=off)
target_compile_options(breakwater_options INTERFACE
  $<BUILD_INTERFACE:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wconversion;-Wno-sign-conversion>
  $<$<BOOL:${BREAKWATER_WARNINGS_AS_ERRORS}>:$<BUILD_INTERFACE:-Werror>>)
# The allocation tests can then make Eigen stop at an allocation.
target_compile_definitions(breakwater_options INTERFACE
  $<BUILD_INTERFACE:$<$<CONFIG:Debug>:EIGEN_RUNTIME_NO_MALLOC>>)
# Missing members of a designated initialiser have their default values on purpose.
target_compile_options(breakwater_options INTERFACE
  $<BUILD_INTERFACE:-Wno-missing-field-initializers>)
# GCC 12 warns of overlaps and overflows that do not exist: in `"x" + std::string` (GCC bugs 105329,
# 105651), and in Eigen's vectorised copies of small matrices. The sanitizers find real ones.
target_compile_options(breakwater_options INTERFACE
  $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-array-bounds;-Wno-stringop-overflow>>)
# GCC collects its garbage when the heap has half a gigabyte: collecting earlier takes 7 to 13 % of
# the time of a unit.
target_compile_options(breakwater_options INTERFACE
  $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=524288>>)
# A program loads only the libraries that it uses, so simulations load no encoder. The loader searches
# libstdc++ first: most symbols are there.
target_link_options(breakwater_options INTERFACE $<BUILD_INTERFACE:-Wl,--no-as-needed,-lstdc++,--as-needed>)
if(BREAKWATER_NATIVE)
  # GCC 12 treats its own AVX-512 intrinsics as uninitialised (GCC bug 105593). Fused multiply-adds
  # are allowed: this build makes no golden.
  target_compile_options(breakwater_options INTERFACE -march=native -ffp-contract=fast
    $<$<CXX_COMPILER_ID:GNU>:-Wno-uninitialized;-Wno-maybe-uninitialized>)
endif()
if(BREAKWATER_SANITIZER MATCHES "^(address|fuzzer)$")
  # With instrumentation GCC 12 treats libstdc++'s std::regex as uninitialised.
  target_compile_options(breakwater_options INTERFACE
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>
    $<$<STREQUAL:${BREAKWATER_SANITIZER},fuzzer>:-fsanitize=fuzzer-no-link>)
  target_compile_options(breakwater_options INTERFACE -fsanitize=address,undefined,float-cast-overflow
    -fno-sanitize-recover=all -fno-omit-frame-pointer)
  # Eigen would store its own aligned blocks inside those of malloc(). pagmo's library is built
  # without this and exchanges plain blocks. The sanitizer's blocks have the necessary alignment.
  target_compile_definitions(breakwater_options INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
  target_link_options(breakwater_options INTERFACE -fsanitize=address,undefined)
elseif(BREAKWATER_SANITIZER STREQUAL "thread")
  target_compile_options(breakwater_options INTERFACE -fsanitize=thread)
  target_link_options(breakwater_options INTERFACE -fsanitize=thread)
endif()
