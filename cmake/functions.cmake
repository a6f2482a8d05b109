# Functions for programs with Breakwater's commands: our own and those of users.
set(BREAKWATER_FUNCTIONS_DIR ${CMAKE_CURRENT_LIST_DIR})

# breakwater_program(NAME [ONE_SCENARIO] [CATALOGUE ROOM] SOURCES FILE...): a program whose main()
# passes a catalogue to breakwater::program() (docs/tutorials/own-controller.md). It links
# Breakwater::program and the room of the catalogue: ::scenarios, or ::axes_scenarios, which has no
# quadrotor. With ONE_SCENARIO main() passes it to breakwater::scenario_program(). The program then
# runs one scenario, and links ::scenario_program without pages, pictures and studies.
function(breakwater_program name)
  cmake_parse_arguments(PROGRAM "ONE_SCENARIO" "CATALOGUE" "SOURCES" ${ARGN})
  add_executable(${name} ${PROGRAM_SOURCES})
  set(main program)
  if(PROGRAM_ONE_SCENARIO)
    set(main scenario_program)
  endif()
  if(NOT PROGRAM_CATALOGUE)
    set(PROGRAM_CATALOGUE scenarios)
  endif()
  target_link_libraries(${name} PRIVATE Breakwater::${PROGRAM_CATALOGUE} Breakwater::${main})
endfunction()

# breakwater_scenario(TARGET NAME [SOURCES FILE...]): adds the scenario in the folder NAME to a
# program or library. The folder has NAME.cpp, NAME.toml, shots.toml, models and further SOURCES. In
# an external project the macro NAME_FOLDER (in capitals) is the folder's path, for ScenarioKind.
# The installed data are in share/breakwater/scenarios/NAME, where the installed program finds them.
function(breakwater_scenario target name)
  cmake_parse_arguments(SCENARIO "" "" "SOURCES" ${ARGN})
  set(folder ${CMAKE_CURRENT_SOURCE_DIR}/${name})
  list(TRANSFORM SCENARIO_SOURCES PREPEND ${folder}/)
  if(EXISTS ${folder}/${name}.cpp)  # a file of plant has none
    target_sources(${target} PRIVATE ${folder}/${name}.cpp ${SCENARIO_SOURCES})
  endif()
  # Breakwater's own programs find their data from their own location, so no installed program reads
  # the tree.
  if(NOT PROJECT_NAME STREQUAL "Breakwater")
    string(TOUPPER ${name} capitals)
    target_compile_definitions(${target} PRIVATE ${capitals}_FOLDER="${folder}")
  endif()
  include(GNUInstallDirs)
  install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_DATADIR}/breakwater/scenarios
    COMPONENT runtime PATTERN "*.cpp" EXCLUDE PATTERN "*.h" EXCLUDE)
endfunction()

# breakwater_run_test(NAME PROGRAM ARGUMENTS ARG... [METRICS "free_motion_time_s < 10"...]): a test
# that runs `PROGRAM run ARG...`. It then checks the METRICS: NAME < NUMBER or NAME > NUMBER.
function(breakwater_run_test name program)
  cmake_parse_arguments(TEST "" "" "ARGUMENTS;METRICS" ${ARGN})
  string(REPLACE ";" "|" metrics "${TEST_METRICS}")
  add_test(NAME ${name} COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${program}>
    "-DMETRICS=${metrics}" -DOUT=${CMAKE_CURRENT_BINARY_DIR}/test-runs/${name}
    -P ${BREAKWATER_FUNCTIONS_DIR}/run_test.cmake -- run ${TEST_ARGUMENTS})
endfunction()
