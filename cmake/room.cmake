# What most sources include, compiled once: headers of the standard library and Eigen. No header may
# rely on it: the lint preset does without.
file(WRITE ${PROJECT_BINARY_DIR}/precompiled.cpp "")
add_library(breakwater_precompiled STATIC ${PROJECT_BINARY_DIR}/precompiled.cpp)
target_link_libraries(breakwater_precompiled PRIVATE Eigen3::Eigen breakwater_options)
target_precompile_headers(breakwater_precompiled PRIVATE
  <algorithm> <filesystem> <functional> <map> <memory> <stdexcept> <string> <vector>
  <Eigen/Cholesky> <Eigen/Core> <Eigen/LU>)

# breakwater_room(NAME SOURCES ... [PUBLIC ...] [PRIVATE ...] [FOLDER DIR]): one folder as one library,
# Breakwater::NAME, that links the rooms below it. Headers are included from DIR, or else from src/.
function(breakwater_room name)
  cmake_parse_arguments(ROOM "" "FOLDER" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  if(NOT ROOM_FOLDER)
    set(ROOM_FOLDER ${PROJECT_SOURCE_DIR}/src)
  endif()
  if(ROOM_SOURCES)
    add_library(breakwater_${name} STATIC ${ROOM_SOURCES})
    target_precompile_headers(breakwater_${name} REUSE_FROM breakwater_precompiled)
    target_link_libraries(breakwater_${name}
      PUBLIC ${ROOM_PUBLIC}
      PRIVATE $<BUILD_INTERFACE:breakwater_options> ${ROOM_PRIVATE})
    target_include_directories(breakwater_${name} PUBLIC
      $<BUILD_INTERFACE:${ROOM_FOLDER}>
      $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/breakwater>)
    target_compile_features(breakwater_${name} PUBLIC cxx_std_20)
  else()
    add_library(breakwater_${name} INTERFACE)
    target_link_libraries(breakwater_${name} INTERFACE ${ROOM_PUBLIC})
    target_include_directories(breakwater_${name} INTERFACE
      $<BUILD_INTERFACE:${ROOM_FOLDER}>
      $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/breakwater>)
  endif()
  set_target_properties(breakwater_${name} PROPERTIES EXPORT_NAME ${name})
  add_library(Breakwater::${name} ALIAS breakwater_${name})
  set_property(GLOBAL APPEND PROPERTY BREAKWATER_ROOMS breakwater_${name})
endfunction()
