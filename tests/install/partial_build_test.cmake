# What `cmake --install` says before anything is built.
#   cmake -DPROJECT_DIR= -DWORK_DIR= -P partial_build_test.cmake
file(REMOVE_RECURSE ${WORK_DIR})
execute_process(COMMAND ${CMAKE_COMMAND} -S ${PROJECT_DIR} -B ${WORK_DIR}/build -G Ninja
    -DBUILD_TESTING=OFF -Wno-dev OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --install ${WORK_DIR}/build --prefix ${WORK_DIR}/prefix
  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(status EQUAL 0)
  message(FATAL_ERROR "nothing was built, and it was installed")
endif()
if(NOT output MATCHES "cmake --build")
  message(FATAL_ERROR "it does not say what to do: ${output}")
endif()
if(EXISTS ${WORK_DIR}/prefix)
  message(FATAL_ERROR "something was left behind")
endif()
file(REMOVE_RECURSE ${WORK_DIR})
