# Debian packages, made by `./dev package`: breakwater (programs, data, pages), libbreakwater-dev
# (the rooms, for users' programs) and python3-breakwater (the Python module).
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME breakwater)
set(CPACK_PACKAGE_VENDOR "The Breakwater developers")
set(CPACK_PACKAGE_CONTACT "The Breakwater developers <breakwater@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_OUTPUT_FILE_PREFIX ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime development)
if(TARGET breakwater_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME breakwater)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
# Packages that are loaded or read at run time, which shlibdeps cannot detect.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS "libcairo2, libegl1, libgl1-mesa-dri, fonts-dejavu-core, libjs-dygraphs, libjs-three")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS "ffmpeg, python3, python3-h5py, python3-matplotlib")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS libbreakwater-dev)
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "testbed for robust model-based motion control
 Runs experiments of motion control in MuJoCo without a screen: a plant,
 a disturbance, an observer and a controller, each chosen by name. Leaves
 numbers, a log, pictures and videos, and compares runs. It has disturbance
 observers, Kalman filters that estimate disturbances, constrained
 predictive control, force control of an arm and an underwater quadrotor.")

# A user's program is built against them: the build's packages without the tools, and without the
# libraries that are loaded.
file(STRINGS ${PROJECT_SOURCE_DIR}/cmake/packages/demo.txt lines REGEX "^[a-z]")
file(STRINGS ${PROJECT_SOURCE_DIR}/cmake/packages/build.txt more REGEX "^[a-z]")
set(depends "breakwater (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
foreach(line IN LISTS lines more)
  string(REGEX MATCH "^[a-z0-9.+-]+" package "${line}")
  if(NOT package MATCHES "^(ccache|git|musl-dev|libegl-dev|libgl1-mesa-dri|fonts-dejavu-core|libjs-dygraphs|libjs-three)$"
     AND NOT package MATCHES "^lib(cairo2|nlopt-cxx|pagmo|tbb)-dev$")
    string(APPEND depends ", ${package}")
  endif()
endforeach()
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libbreakwater-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${depends}")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "testbed for robust model-based motion control (library)
 The rooms of Breakwater as static libraries with headers and CMake files, for
 controllers, observers and scenarios of one's own: `breakwater new' writes a
 project that uses them.")
set(CPACK_COMPONENT_RUNTIME_REQUIRED ON)

# The compiled part works with one version of the interpreter.
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-breakwater)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
if(TARGET breakwater_python)
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "breakwater (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}), \
python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next_minor}), python3-numpy")
endif()
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-pandas, python3-xarray, python3-h5netcdf")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "testbed for robust model-based motion control (Python module)
 Runs Breakwater's experiments from Python, under controllers and estimators
 of one's own, with results in NumPy, pandas and xarray. Its disturbance
 observers and Kalman filters work on recorded data, too.")
include(CPack)

# All packages have their licences and changes at Debian's places. The programs have man pages,
# which `./dev package` makes from the help texts.
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} name)
  set(doc ${CMAKE_INSTALL_DATAROOTDIR}/doc/${CPACK_DEBIAN_${name}_PACKAGE_NAME})
  install(FILES cmake/debian/${CPACK_DEBIAN_${name}_PACKAGE_NAME}.lintian-overrides
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/lintian/overrides
    RENAME ${CPACK_DEBIAN_${name}_PACKAGE_NAME} COMPONENT ${component})
  install(FILES cmake/debian/copyright DESTINATION ${doc} COMPONENT ${component})
  install(FILES ${PROJECT_BINARY_DIR}/package/changelog.Debian.gz DESTINATION ${doc}
    COMPONENT ${component} OPTIONAL)
endforeach()
install(DIRECTORY ${PROJECT_BINARY_DIR}/package/man1 DESTINATION ${CMAKE_INSTALL_MANDIR}
  COMPONENT runtime OPTIONAL)
set(completions ${CMAKE_INSTALL_DATAROOTDIR}/bash-completion/completions)
install(FILES scripts/completion.bash DESTINATION ${completions} RENAME breakwater COMPONENT runtime)
