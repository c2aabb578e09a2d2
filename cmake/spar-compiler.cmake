# What the compiler must be able to do: refuses 32-bit processors, sets SPAR_MAXIMA_IN_LOOPS.
include(CheckCSourceCompiles)

# Byte counts of arrays are computed in 64 bits, and the old coprocessor of 32-bit x86 does not round to double.
if(CMAKE_SIZEOF_VOID_P LESS 8)
  math(EXPR spar_bits "8 * ${CMAKE_SIZEOF_VOID_P}")
  message(FATAL_ERROR "spar needs a 64-bit target, but ${CMAKE_C_COMPILER} builds for ${spar_bits} bits: choose a 64-bit compiler or remove -m32 from CMAKE_C_FLAGS.")
endif()

# gcc 12.2 for arm64 stops with an internal compiler error (in vect_transform_reduction) on this loop, which takes a maximum by
# fmax. -O2 and -O3 vectorise loops, and -fno-trapping-math admits conditional ones.
function(spar_check_maxima)
  set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY) # compile, do not link
  set(CMAKE_REQUIRED_FLAGS "-O3 -fno-trapping-math")
  check_c_source_compiles("
#include <math.h>
double spar_check(const double *v, double size);
double spar_check(const double *v, double size) {
    double most = 0;
    for (int j = 0; j < 12; j++) {
        most = fmax(most, fabs(v[j]) / (j % 6 < 3 ? size : 1));
    }
    return most;
}" SPAR_MAXIMA_IN_LOOPS)
endfunction()
if(CMAKE_C_COMPILER_ID STREQUAL "GNU")
  spar_check_maxima()
endif()
