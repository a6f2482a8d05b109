# breakwater_shareable(TARGET): code that may be part of the Python module. It exports no symbols
# there, so the loader searches for none.
function(breakwater_shareable target)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endfunction()

# breakwater_outside_loop(TARGET): code that no control step calls, and the Python module, whose
# steps wait for Python. It compiles in two thirds of the time with less optimisation.
function(breakwater_outside_loop target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# Precompiled headers. No header may depend on this: the lint preset builds without them. GCC keeps
# the optimisation that they were compiled with, so those of code outside of the loop are others.
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/precompiled.cpp CONTENT "")  # as old as it is
function(breakwater_precompile name)
  add_library(${name} STATIC ${PROJECT_BINARY_DIR}/precompiled.cpp)
  target_link_libraries(${name} PRIVATE Eigen3::Eigen breakwater_options)
  breakwater_shareable(${name})
  target_precompile_headers(${name} PRIVATE
    <algorithm> <filesystem> <functional> <map> <memory> <stdexcept> <string> <vector>
    ${PROJECT_SOURCE_DIR}/src/linear/eigen_kernels.h ${ARGN})
endfunction()
breakwater_precompile(breakwater_precompiled)
breakwater_precompile(breakwater_precompiled_outside_loop <fmt/format.h> <nlohmann/json.hpp>)
target_link_libraries(breakwater_precompiled_outside_loop PRIVATE fmt::fmt nlohmann_json::nlohmann_json)
breakwater_outside_loop(breakwater_precompiled_outside_loop)

# Headers are included as <breakwater/ROOM/NAME.h>, in the tree and when installed.
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/include)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/src ${PROJECT_BINARY_DIR}/include/breakwater SYMBOLIC)

# breakwater_room(NAME [OUTSIDE_LOOP] SOURCES ... [BEYOND_ARM ...] [PUBLIC ...] [PRIVATE ...]): a
# folder as the library Breakwater::NAME, which links the rooms below it. The programs of the arm
# link none of the sources BEYOND_ARM, so the demo does not compile them.
function(breakwater_room name)
  cmake_parse_arguments(ROOM "OUTSIDE_LOOP" "" "SOURCES;BEYOND_ARM;PUBLIC;PRIVATE" ${ARGN})
  if(BREAKWATER_TOOLS)
    list(APPEND ROOM_SOURCES ${ROOM_BEYOND_ARM})
  endif()
  if(ROOM_SOURCES)
    set(scope PUBLIC)
    add_library(breakwater_${name} STATIC ${ROOM_SOURCES})
    breakwater_shareable(breakwater_${name})
    set(precompiled breakwater_precompiled)
    if(ROOM_OUTSIDE_LOOP)
      breakwater_outside_loop(breakwater_${name})
      set(precompiled breakwater_precompiled_outside_loop)
    endif()
    target_precompile_headers(breakwater_${name} REUSE_FROM ${precompiled})
    # Eigen's templates take most of the time there: smaller units, for two cores and for a change of
    # one file.
    if(name MATCHES "^(published|linear)$")
      set_target_properties(breakwater_${name} PROPERTIES UNITY_BUILD_BATCH_SIZE 2)
    elseif(name STREQUAL experiment)
      set_target_properties(breakwater_${name} PROPERTIES UNITY_BUILD_BATCH_SIZE 7)
    elseif(name MATCHES "^(observers|control|quadrotor|rigs|identification)$")
      set_target_properties(breakwater_${name} PROPERTIES UNITY_BUILD_BATCH_SIZE 4)
    endif()
    target_link_libraries(breakwater_${name}
      PRIVATE $<BUILD_INTERFACE:breakwater_options> ${ROOM_PRIVATE})
  else()
    set(scope INTERFACE)
    add_library(breakwater_${name} INTERFACE)
  endif()
  target_link_libraries(breakwater_${name} ${scope} ${ROOM_PUBLIC})
  target_compile_features(breakwater_${name} ${scope} cxx_std_20)
  target_include_directories(breakwater_${name} ${scope}
    $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  set_target_properties(breakwater_${name} PROPERTIES EXPORT_NAME ${name})
  add_library(Breakwater::${name} ALIAS breakwater_${name})
  set_property(GLOBAL APPEND PROPERTY BREAKWATER_ROOMS ${name})
  # The packages for find_package(Breakwater COMPONENTS name).
  set(needs ${ROOM_PUBLIC} ${ROOM_PRIVATE})
  list(FILTER needs INCLUDE REGEX "^[A-Za-z0-9_]+::")
  set_property(GLOBAL PROPERTY BREAKWATER_NEEDS_${name} ${needs})
endfunction()
