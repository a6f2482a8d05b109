# `cmake --install build --prefix DIR`: binaries, the data they find from their own place, and the
# rooms as Breakwater::NAME for find_package(Breakwater).
include(CMakePackageConfigHelpers)

get_property(rooms GLOBAL PROPERTY BREAKWATER_ROOMS)

# Says what to do where something is not built yet, before anything is installed.
set(artefacts "")
foreach(target IN LISTS rooms ITEMS breakwater ${BREAKWATER_SCENARIOS})
  get_target_property(type ${target} TYPE)
  if(NOT type STREQUAL "INTERFACE_LIBRARY")
    list(APPEND artefacts "$<TARGET_FILE:${target}>")
  endif()
endforeach()
install(CODE "set(artefacts \"${artefacts}\")
foreach(artefact IN LISTS artefacts)
  if(NOT EXISTS \"\${artefact}\")
    message(FATAL_ERROR \"Not all is built yet: there is no \${artefact}. First run\\n  cmake --build ${PROJECT_BINARY_DIR}\")
  endif()
endforeach()")

install(TARGETS ${rooms} EXPORT BreakwaterTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS breakwater ${BREAKWATER_SCENARIOS} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY src/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/breakwater
  FILES_MATCHING PATTERN "*.h")
install(FILES ${PROJECT_BINARY_DIR}/generated/include/breakwater/version.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/breakwater)
install(DIRECTORY models data scenarios renders docs DESTINATION ${CMAKE_INSTALL_DATADIR}/breakwater
  FILES_MATCHING PATTERN "*.xml" PATTERN "*.urdf" PATTERN "*.toml" PATTERN "*.md"
                 PATTERN "*.mustache" PATTERN "*.css" PATTERN "*.js")
# libbreakwater_math.a, and so every program, holds a part of musl (MIT).
install(FILES /usr/share/doc/musl-dev/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME musl-copyright)
install(PROGRAMS scripts/figures.py DESTINATION ${CMAKE_INSTALL_DATADIR}/breakwater/scripts)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Breakwater)
install(EXPORT BreakwaterTargets NAMESPACE Breakwater:: DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/BreakwaterConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES cmake/BreakwaterConfig.cmake cmake/dependencies.cmake
              ${PROJECT_BINARY_DIR}/BreakwaterConfigVersion.cmake
  DESTINATION ${package_dir})
