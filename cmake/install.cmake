# `cmake --install build --prefix DIR`: binaries, their data, and the rooms as Breakwater::NAME for
# find_package(Breakwater).
include(CMakePackageConfigHelpers)

get_property(rooms GLOBAL PROPERTY BREAKWATER_ROOMS)

# Fails with advice, before anything is installed, if a file is not built yet.
set(artefacts "")
set(libraries ${rooms})
list(TRANSFORM libraries PREPEND breakwater_)
if(TARGET breakwater_python)
  set(python breakwater_python)
endif()
foreach(target IN LISTS libraries python
    ITEMS breakwater breakwater_search_engines ${BREAKWATER_SCENARIOS})
  get_target_property(type ${target} TYPE)
  if(NOT type STREQUAL "INTERFACE_LIBRARY")
    list(APPEND artefacts "$<TARGET_FILE:${target}>")
  endif()
endforeach()
file(GENERATE OUTPUT ${BREAKWATER_ALL_IS_BUILT} CONTENT "set(artefacts \"${artefacts}\")
foreach(artefact IN LISTS artefacts)
  if(NOT EXISTS \"\${artefact}\")
    message(FATAL_ERROR \"Not all is built yet: there is no \${artefact}. First run\\n  cmake --build ${PROJECT_BINARY_DIR}\")
  endif()
endforeach()
")

install(TARGETS breakwater ${BREAKWATER_SCENARIOS} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
  COMPONENT runtime)
install(TARGETS breakwater_search_engines LIBRARY DESTINATION lib/breakwater COMPONENT runtime)
install(DIRECTORY src/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/breakwater COMPONENT development
  FILES_MATCHING PATTERN "*.h")
install(DIRECTORY templates DESTINATION ${CMAKE_INSTALL_DATADIR}/breakwater COMPONENT runtime)
install(DIRECTORY models data renders docs DESTINATION ${CMAKE_INSTALL_DATADIR}/breakwater
  COMPONENT runtime FILES_MATCHING PATTERN "*.xml" PATTERN "*.urdf" PATTERN "*.toml" PATTERN "*.md"
                 PATTERN "*.mustache" PATTERN "*.css" PATTERN "*.js"
                 PATTERN "*.csv")  # the tables of docs/, and the record of a tutorial
file(GLOB studies CONFIGURE_DEPENDS studies/*.toml)  # not what they left beside them
install(FILES ${studies} DESTINATION ${CMAKE_INSTALL_DATADIR}/breakwater/studies COMPONENT runtime)
# libbreakwater_math.a, and so every program, contains a part of musl (MIT).
install(FILES /usr/share/doc/musl-dev/copyright
  DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/breakwater RENAME musl-copyright COMPONENT runtime)
install(PROGRAMS scripts/figures.py scripts/results_sqlite.py scripts/slurm.py
  DESTINATION ${CMAKE_INSTALL_DATADIR}/breakwater/scripts COMPONENT runtime)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Breakwater)
# A separate export for each room, so that a room does not need the packages of others.
set(needs "set(Breakwater_ROOMS ${rooms})\n")
foreach(room IN LISTS rooms)
  install(TARGETS breakwater_${room} EXPORT Breakwater-${room}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  install(EXPORT Breakwater-${room} NAMESPACE Breakwater:: DESTINATION ${package_dir}
    COMPONENT development)
  get_property(needs_of_room GLOBAL PROPERTY BREAKWATER_NEEDS_${room})
  string(APPEND needs "set(Breakwater_${room}_NEEDS ${needs_of_room})\n")
endforeach()
file(WRITE ${PROJECT_BINARY_DIR}/generated/BreakwaterRooms.cmake
  "# The rooms, from the bottom up, and what each links: written by cmake/install.cmake.\n${needs}")
write_basic_package_version_file(${PROJECT_BINARY_DIR}/BreakwaterConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES cmake/BreakwaterConfig.cmake cmake/dependencies.cmake cmake/run_test.cmake
              ${PROJECT_BINARY_DIR}/generated/BreakwaterRooms.cmake
              ${PROJECT_BINARY_DIR}/BreakwaterConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT development)
install(FILES cmake/functions.cmake DESTINATION ${package_dir} RENAME BreakwaterFunctions.cmake
  COMPONENT development)
