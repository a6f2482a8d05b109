# Installs the build into a fresh folder, runs an installed binary, and builds and runs a project
# that uses the installed rooms.
#   cmake -DBUILD_DIR= -DSOURCE_DIR= -DWORK_DIR= -P install_test.cmake
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
set(prefix ${WORK_DIR}/prefix)
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
run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK_DIR}/consumer -G Ninja
    -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${WORK_DIR}/consumer)
run(${WORK_DIR}/consumer/consumer ${prefix}/share/breakwater/models/motor.xml shaft_pos)
file(REMOVE_RECURSE ${WORK_DIR})
