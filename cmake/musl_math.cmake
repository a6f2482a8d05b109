# The code of math/functions.h: musl's elementary functions, extracted from its static library and
# renamed. musl has no other code for processors with fused multiply-add, so they give the same bits
# everywhere (docs/explanation/decisions/0011-one-path-for-elementary-functions.md). They are part
# of breakwater_math, so users of an installed Breakwater need no musl.
set(functions sin cos sincos tan asin acos atan2 exp expm1 log pow tanh erfc)
set(members sin cos sincos tan asin acos atan2 exp expm1 log pow tanh erf __sin __cos __tan __rem_pio2
    __rem_pio2_large atan exp_data log_data pow_data __math_divzero __math_invalid __math_oflow
    __math_uflow __math_xflow)
list(TRANSFORM members APPEND .lo)

string(REPLACE -gnu -musl musl_architecture "${CMAKE_LIBRARY_ARCHITECTURE}")
find_file(MUSL_LIBC libc.a PATHS /usr/lib/${musl_architecture} NO_DEFAULT_PATH REQUIRED)

# In two steps: LLVM's objcopy selects symbols by their old names.
set(renamed)
set(kept)
foreach(name IN LISTS functions)
  list(APPEND renamed --redefine-sym ${name}=breakwater_${name})
  list(APPEND kept --keep-global-symbol=breakwater_${name})
endforeach()

set(work ${PROJECT_BINARY_DIR}/generated/musl_math)
set(BREAKWATER_MUSL_MATH ${work}/musl_math.o)  # what breakwater_math is made of
file(MAKE_DIRECTORY ${work})
add_custom_command(OUTPUT ${BREAKWATER_MUSL_MATH}
  COMMAND ${CMAKE_AR} x ${MUSL_LIBC} ${members}
  COMMAND ${CMAKE_LINKER} -r ${members} -o joined.o
  COMMAND ${CMAKE_OBJCOPY} ${renamed} joined.o renamed.o
  COMMAND ${CMAKE_OBJCOPY} ${kept} renamed.o ${BREAKWATER_MUSL_MATH}
  DEPENDS ${MUSL_LIBC} ${CMAKE_CURRENT_LIST_FILE}
  WORKING_DIRECTORY ${work}
  COMMENT "Taking the elementary functions out of musl"
  VERBATIM)
