# How every target is compiled: target `breakwater_options`.
find_program(CCACHE ccache)
if(CCACHE)
  # Nothing of what is hashed names the clone.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}
      CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
endif()

set(BREAKWATER_SANITIZER "" CACHE STRING "address or thread; empty for none")
option(BREAKWATER_NATIVE "Compile for this machine's processor: for benchmarks, not for goldens" OFF)
option(BREAKWATER_PYTHON "The Python module (Debian: pybind11-dev)" ON)
option(BREAKWATER_WARNINGS_AS_ERRORS "As the presets that are tested have it" OFF)

add_library(breakwater_options INTERFACE)
target_compile_features(breakwater_options INTERFACE cxx_std_20)
# No fused multiply-add: our arithmetic gives the same bits on any x86-64 machine, as the functions
# of math/ do (docs/explanation/reproducibility.md: what MuJoCo's own leave).
target_compile_options(breakwater_options INTERFACE -ffp-contract=off)
target_compile_options(breakwater_options INTERFACE
  $<BUILD_INTERFACE:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wconversion;-Wno-sign-conversion>
  $<$<BOOL:${BREAKWATER_WARNINGS_AS_ERRORS}>:$<BUILD_INTERFACE:-Werror>>)
# Eigen can then be told to stop where it allocates (the allocation tests do).
target_compile_definitions(breakwater_options INTERFACE
  $<BUILD_INTERFACE:$<$<CONFIG:Debug>:EIGEN_RUNTIME_NO_MALLOC>>)
# Members left out of a designated initialiser take their defaults: that is what they are for.
target_compile_options(breakwater_options INTERFACE
  $<BUILD_INTERFACE:-Wno-missing-field-initializers>)
# GCC 12 sees overlaps and overflows where there are none: in `"x" + std::string` (GCC bugs 105329,
# 105651), and in Eigen's vectorised copies of small matrices. The sanitizers see real ones.
target_compile_options(breakwater_options INTERFACE
  $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-array-bounds;-Wno-stringop-overflow>>)
# A program loads only what it uses: those that only simulate, no encoder.
target_link_options(breakwater_options INTERFACE $<BUILD_INTERFACE:-Wl,--as-needed>)
if(BREAKWATER_NATIVE)
  # GCC 12 takes its own AVX-512 intrinsics for uninitialised (GCC bug 105593). Fused multiply-adds
  # are allowed: no golden is made of this build.
  target_compile_options(breakwater_options INTERFACE -march=native -ffp-contract=fast
    $<$<CXX_COMPILER_ID:GNU>:-Wno-uninitialized;-Wno-maybe-uninitialized>)
endif()
if(BREAKWATER_SANITIZER STREQUAL "address")
  # Instrumented, GCC 12 takes libstdc++'s own std::regex for uninitialised.
  target_compile_options(breakwater_options INTERFACE -Wno-maybe-uninitialized)
  target_compile_options(breakwater_options INTERFACE -fsanitize=address,undefined,float-cast-overflow
    -fno-sanitize-recover=all -fno-omit-frame-pointer)
  # Eigen would put its own aligned blocks into malloc()'s here, and pagmo's library, which is not
  # built so, hands over and takes plain ones. The sanitizer's blocks are aligned as it needs.
  target_compile_definitions(breakwater_options INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
  target_link_options(breakwater_options INTERFACE -fsanitize=address,undefined)
elseif(BREAKWATER_SANITIZER STREQUAL "thread")
  target_compile_options(breakwater_options INTERFACE -fsanitize=thread)
  target_link_options(breakwater_options INTERFACE -fsanitize=thread)
endif()
