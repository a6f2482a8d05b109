# Makes a project by the installed `breakwater new`, builds and tests it, and does with its program
# what its README says.
#   cmake -DWORK_DIR= -DKIND=controller|observer -P new_project_test.cmake
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)
set(name own_${KIND})
set(folder ${WORK_DIR}/${name})
# Both kinds run at the same time.
set(elsewhere ${WORK_DIR}/elsewhere-${KIND})
file(REMOVE_RECURSE ${folder} ${WORK_DIR}/${name}-moved ${elsewhere})
unset(ENV{CMAKE_PREFIX_PATH})  # what is printed is enough
execute_process(COMMAND ${prefix}/bin/breakwater new ${KIND} ${name} WORKING_DIRECTORY ${WORK_DIR}
  OUTPUT_VARIABLE said COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCH "\ncd [^\n]*" pasted "${said}")
string(REPLACE " cmake --preset release" " cmake --preset release ${fast}" pasted "${pasted}")
run_in(${WORK_DIR} sh -c "${pasted}")

set(lab ${folder}/build/${name}_lab)
if(KIND STREQUAL "controller")
  set(scenario arm_wall_contact)
  set(chosen --set controller.name=${name} --duration 0.5)
  set(other --set controller.name=hpfc --duration 0.5)
elseif(KIND STREQUAL "observer")
  set(scenario motor_estimation)
  set(chosen --set observer.name=${name} --duration 0.5)
  set(other --case stf --duration 0.5)
endif()
run_in(${folder} ${lab} run ${scenario} ${chosen} --out a --video)
run_in(${folder} ${lab} run ${scenario} ${other} --out b --quiet)
run_in(${folder} ${lab} report a --quiet)
run_in(${folder} ${lab} compare a b --quiet)
run_in(${folder} ${lab} replay a b --out replay.html --quiet)
foreach(file a/video.mp4 report.html compare.html replay.html)
  expect_file(${folder}/${file})
endforeach()
# The same bits of its own config.toml; and who else has the run sees it, without the part.
run_in(${folder} ${lab} run ${scenario} --config a/config.toml --out again --quiet)
file(READ ${folder}/a/manifest.json a)
file(READ ${folder}/again/manifest.json again)
string(JSON a GET "${a}" state_hash)
string(JSON again GET "${again}" state_hash)
if(NOT a STREQUAL again)
  message(FATAL_ERROR "config.toml gives another run: ${a}, ${again}")
endif()
run_in(${folder} ${prefix}/bin/breakwater still a --at 0.2 --size 320x180 --quiet)
expect_file(${folder}/a/still.png)

# Help and messages name the program.
foreach(words "--help" "video;--help" "compare;--help" "run;${scenario};--help" "new;--help")
  execute_process(COMMAND ${lab} ${words} OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
  if(help MATCHES "breakwater (run|video|new|compare|report|list)")
    message(FATAL_ERROR "${words}: ${help}")
  endif()
endforeach()
execute_process(COMMAND ${lab} rum RESULT_VARIABLE status ERROR_VARIABLE error)
if(NOT status EQUAL 2 OR NOT error MATCHES "^${name}_lab: there is no command \"rum\"[^\n]*\n$")
  message(FATAL_ERROR "${status}: ${error}")
endif()

# Installed, it needs its own tree no more.
run(${CMAKE_COMMAND} --install ${folder}/build --prefix ${elsewhere})
file(RENAME ${folder} ${WORK_DIR}/${name}-moved)
run_in(${WORK_DIR} ${elsewhere}/bin/${name}_lab run ${scenario} ${chosen}
  --out ${elsewhere}/run --quiet)
file(RENAME ${WORK_DIR}/${name}-moved ${folder})
