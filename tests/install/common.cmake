# What the install tests share: WORK_DIR/prefix is the installation.
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# run_in(FOLDER COMMAND...)
function(run_in folder)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${folder} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

function(expect_file file)
  if(NOT EXISTS ${file})
    message(FATAL_ERROR "there is no ${file}")
  endif()
endfunction()

set(prefix ${WORK_DIR}/prefix)
set(ENV{CMAKE_PREFIX_PATH} ${prefix})
unset(ENV{BREAKWATER_PATH})
# Users' sources compile three times as fast, and what they do takes no time.
set(fast -DCMAKE_CXX_FLAGS_RELEASE=-O0)
