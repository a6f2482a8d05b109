# One program that adds a controller, an estimator and a scenario at once. The scenario is a shipped one
# under another name, in a project outside of the tree.
#   cmake -DSOURCE_DIR= -DSCENARIOS= -DWORK_DIR= -P all_at_once_test.cmake
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)
set(all ${WORK_DIR}/all)
file(REMOVE_RECURSE ${all})
file(MAKE_DIRECTORY ${all})
foreach(kind controller observer)
  run_in(${all} ${prefix}/bin/breakwater new ${kind} own_${kind})
endforeach()
file(COPY ${SOURCE_DIR}/ DESTINATION ${all}/source)
set(folder ${all}/source/own_scenario)
file(READ ${SCENARIOS}/cart_offset_free/cart_offset_free.toml text)
string(REPLACE "cart_offset_free" "own_scenario" text "${text}")
file(WRITE ${folder}/own_scenario.toml "${text}")
file(COPY ${SCENARIOS}/cart_offset_free/shots.toml DESTINATION ${folder})
run(${CMAKE_COMMAND} -S ${all}/source -B ${all}/build -G Ninja -DCMAKE_BUILD_TYPE=Release ${fast}
    -DPROJECTS=${all} -DCMAKE_UNITY_BUILD=ON)  # each compiles alone in its own test
run(${CMAKE_COMMAND} --build ${all}/build)
set(lab ${all}/build/all_lab)
execute_process(COMMAND ${lab} list --parts OUTPUT_VARIABLE parts COMMAND_ERROR_IS_FATAL ANY)
if(NOT parts MATCHES "  own_controller .*  own_observer ")
  message(FATAL_ERROR "${parts}")
endif()
run_in(${all} ${lab} run arm_push --set controller.name=own_controller --duration 0.1 --quiet --out push)
# These commands load libraries that the program does not link.
run_in(${all} ${lab} video push --size 64x64 --to 0.02 --quiet)
expect_file(${all}/push/video.mp4)
file(WRITE ${all}/tune.toml [[
scenario = "cart_position"
algorithm = "cmaes"
budget = 10
population = 5
[set]
"run.duration_s" = 0.6
[search]
"controller.kp" = { uniform = [5, 20] }
[objective]
max_position_m = { goal = "min" }
]])
run_in(${all} ${lab} tune tune.toml --quiet --out tuned)
expect_file(${all}/tuned/tuned.csv)
run_in(${all} ${lab} identify ${prefix}/share/breakwater/data/identify/bench1.csv --quiet --out identified
  --set csv.position_scale=0.00153398 csv.input_scale=0.068)
expect_file(${all}/identified/report.html)
# The scenario chooses the estimator, which came from elsewhere.
run_in(${all} ${lab} run own_scenario --set observer.name=own_observer observer.bandwidth_rad_s=30
  --quiet --out with)
file(READ ${all}/with/metrics.json metrics)
string(JSON error GET "${metrics}" steady_state_error_m)
if(error GREATER 0.002 OR error LESS -0.002)
  message(FATAL_ERROR "the estimator of the one does not serve the other: ${error} m")
endif()
# A program of that scenario alone makes the same run.
run_in(${all} ${all}/build/one_lab --quiet --out alone)
run_in(${all} ${lab} run own_scenario --quiet --out among)
foreach(run alone among)
  file(READ ${all}/${run}/manifest.json manifest)
  string(JSON hash_${run} GET "${manifest}" state_hash)
endforeach()
if(NOT hash_alone STREQUAL hash_among)
  message(FATAL_ERROR "${hash_alone} is not ${hash_among}")
endif()
# Installed, the program finds the scenario without the tree.
run(${CMAKE_COMMAND} --install ${all}/build --prefix ${all}/elsewhere)
file(RENAME ${all}/source ${all}/moved)
run_in(${all} ${all}/elsewhere/bin/all_lab run own_scenario --duration 0.5 --quiet --out installed)
