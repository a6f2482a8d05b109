# breakwater_room(NAME SOURCES ... [PUBLIC ...] [PRIVATE ...]): one folder of src/ as one library,
# Breakwater::NAME, that links the rooms below it.
function(breakwater_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  if(ROOM_SOURCES)
    add_library(breakwater_${name} STATIC ${ROOM_SOURCES})
    target_link_libraries(breakwater_${name}
      PUBLIC ${ROOM_PUBLIC}
      PRIVATE $<BUILD_INTERFACE:breakwater_options> ${ROOM_PRIVATE})
    target_include_directories(breakwater_${name} PUBLIC
      $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
      $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/breakwater>)
    target_compile_features(breakwater_${name} PUBLIC cxx_std_20)
  else()
    add_library(breakwater_${name} INTERFACE)
    target_link_libraries(breakwater_${name} INTERFACE ${ROOM_PUBLIC})
    target_include_directories(breakwater_${name} INTERFACE
      $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
      $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/breakwater>)
  endif()
  set_target_properties(breakwater_${name} PROPERTIES EXPORT_NAME ${name})
  add_library(Breakwater::${name} ALIAS breakwater_${name})
  set_property(GLOBAL APPEND PROPERTY BREAKWATER_ROOMS breakwater_${name})
endfunction()
