# Makes a plant by the installed `breakwater new`, and does with it what its README says.
#   cmake -DWORK_DIR= -P new_plant_test.cmake
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)
set(folder ${WORK_DIR}/own_plant)
set(breakwater ${prefix}/bin/breakwater)
file(REMOVE_RECURSE ${folder})
execute_process(COMMAND ${breakwater} new scenario own_plant WORKING_DIRECTORY ${WORK_DIR}
  OUTPUT_VARIABLE said COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCH "\ncd [^\n]*" pasted "${said}")
set(ENV{PATH} "${prefix}/bin:$ENV{PATH}")
run_in(${WORK_DIR} sh -c "${pasted} --quiet --duration 0.5 --out a")
run_in(${folder} ${CMAKE_COMMAND} --preset release)
run_in(${folder} ${CMAKE_COMMAND} --build --preset release)
run_in(${folder} ${CMAKE_CTEST_COMMAND} --preset release)
run_in(${folder} ${breakwater} run own_plant.toml --case kfd --duration 0.5 --out b --quiet --video)
run_in(${folder} ${breakwater} compare a b --quiet)
foreach(file b/video.mp4 compare.html)
  expect_file(${folder}/${file})
endforeach()
# A plant with a mesh.
file(READ ${folder}/own_plant.xml model)
string(REPLACE "<worldbody>" "<asset><mesh name='bob' vertex='-.06 0 0 .06 0 0 0 -.06 0 0 .06 0 0 0 .08'/></asset><worldbody>"
  meshed "${model}")
string(REPLACE "type=\"box\" size=\"0.1 0.06 0.04\"" "type=\"mesh\" mesh=\"bob\"" meshed "${meshed}")
file(WRITE ${folder}/meshed.xml "${meshed}")
run_in(${folder} ${breakwater} run own_plant.toml --set model.mjcf=meshed.xml --duration 0.5
  --out meshed --quiet)
run_in(${folder} ${breakwater} replay meshed --quiet)
execute_process(COMMAND python3 -c "
import base64, re, sys, zlib
page = open(sys.argv[1], encoding='utf-8').read()
packed = re.search('id=.packed.>([^<]*)<', page)[1]
sys.exit(b'\"kind\":\"mesh\"' not in zlib.decompress(base64.b64decode(packed)))" ${folder}/meshed/replay.html
  COMMAND_ERROR_IS_FATAL ANY)
