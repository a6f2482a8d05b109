# Installs the build into a fresh folder and runs an installed binary.
#   cmake -DBUILD_DIR= -DWORK_DIR= -P install_test.cmake
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${WORK_DIR})
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix})
file(GLOB binaries ${prefix}/bin/*)
foreach(binary IN LISTS binaries)
  execute_process(COMMAND readelf --dynamic --wide ${binary} OUTPUT_VARIABLE section
    COMMAND_ERROR_IS_FATAL ANY)
  if(section MATCHES "RUNPATH|RPATH")
    message(FATAL_ERROR "${binary} tells the loader where to look")
  endif()
endforeach()
run(${prefix}/bin/breakwater run arm_push --duration 0.1 --quiet --out ${WORK_DIR}/run)
