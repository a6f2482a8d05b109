# find_package(Breakwater): the rooms as Breakwater::linear, Breakwater::sim, ….
include(${CMAKE_CURRENT_LIST_DIR}/dependencies.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/BreakwaterTargets.cmake)
