# Every test's name is made of letters, digits and _ . / -: one that can be read and typed.
#   cmake -DBUILD_DIR= -P test_names.cmake
execute_process(COMMAND ${CMAKE_CTEST_COMMAND} --test-dir ${BUILD_DIR} -N
  OUTPUT_VARIABLE list COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "Test +#[0-9]+: [^\n]*" tests "${list}")
list(LENGTH tests count)
if(count LESS 100)
  message(FATAL_ERROR "only ${count} tests are listed")
endif()
foreach(test IN LISTS tests)
  if(NOT test MATCHES "^Test +#[0-9]+: [A-Za-z0-9_./-]+$")
    message(SEND_ERROR "unreadable: ${test}")
  endif()
endforeach()
