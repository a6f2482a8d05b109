# Builds and runs a project that uses installed rooms.
#   cmake -DSOURCE_DIR= -DWORK_DIR= -DPROGRAM= -DARGUMENTS= -DOPTIONS= -P consumer_test.cmake
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)
set(build ${WORK_DIR}/${PROGRAM})
separate_arguments(ARGUMENTS)
separate_arguments(OPTIONS)
list(TRANSFORM ARGUMENTS REPLACE "^PREFIX/" "${prefix}/")
file(REMOVE_RECURSE ${build})
run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${build} -G Ninja -DCMAKE_BUILD_TYPE=Release ${fast}
    ${OPTIONS})
run(${CMAKE_COMMAND} --build ${build})
run(${build}/${PROGRAM} ${ARGUMENTS})
