# OpenFOAM with spar in it, a few steps: skipped, with a word, where it or its headers are not installed. What is checked, and where
# the figures are from: ../code_saturne/cylinder/compare.awk, and here.
if(NOT SPAR_BUILD_TESTS OR NOT SPAR_MPI)
  return()
endif()
set(out "${PROJECT_BINARY_DIR}/tests/host_openfoam")
# foam_test(<name> <case> <options>...)
function(foam_test name case)
  add_test(NAME host_openfoam${name}
    COMMAND sh "${SPAR_HOST_DIR}/run" ${case} --no-install --headers "${PROJECT_SOURCE_DIR}/build/openfoam" --build "${PROJECT_BINARY_DIR}"
            --out "${out}${name}" ${ARGN})
  spar_set_test(host_openfoam${name} hosts 1200)
  set_tests_properties(host_openfoam${name} PROPERTIES SKIP_RETURN_CODE 77)
endfunction()

foam_test("" cylinder --refine 0.5 --steps 20 --ranks 2)
set_tests_properties(host_openfoam PROPERTIES PROCESSORS 2)

# A run that goes on half-way has the digits of one in one go; where the structure's file is missing or is another's, it is refused.
foam_test(_whole cylinder --no-vorticity --refine 0.5 --steps 8)
foam_test(_half cylinder --no-vorticity --refine 0.5 --steps 4)
foam_test(_restart cylinder --no-vorticity --refine 0.5 --steps 8 --restart "${out}_half" --against "${out}_whole" --within 0)
add_test(NAME host_openfoam_refused COMMAND sh "${SPAR_HOST_DIR}/refused" "${out}_restart")
spar_set_test(host_openfoam_refused hosts 300)
set_tests_properties(host_openfoam_refused PROPERTIES SKIP_RETURN_CODE 77)

# One body on two patches moves as on one; two bodies, each on a patch, tied together, as the one that has both masses. (explicit:
# where the iteration of two bodies ends is rounded otherwise)
foam_test(_patches cylinder --no-vorticity --refine 0.5 --steps 8 --set halves=1 --against "${out}_whole")
file(READ "${SPAR_HOST_DIR}/../cases/cylinder.case" text)
file(WRITE "${out}_cases/one.case" "${text}")
string(REPLACE "mass 2 2 2 0.25 0.25 0.25" "mass 1 1 1 0.125 0.125 0.125" text "${text}")
file(WRITE "${out}_cases/members.case" "${text}
[rigid other]
place 0 0 0.5
mass 1 1 1 0.125 0.125 0.125
velocity 0 0.05 0

[joint weld]
a cylinder first
b other first

[host openfoam]
half other
")
foam_test(_one "${out}_cases/one.case" --no-vorticity --refine 0.5 --steps 4 --scheme explicit --correctors 1)
foam_test(_members "${out}_cases/members.case" --no-vorticity --refine 0.5 --steps 4 --scheme explicit --correctors 1 --set halves=1
  --against "${out}_one" --columns 7)

# Two members on three patches: each flap is the mirror image of the other (../code_saturne/flaps/compare.awk).
foam_test(_flaps flaps --no-vorticity --refine 0.5 --steps 12)

# In a mesh of empty patches a pressure of 10 kPa on all sides neither twists the flag out of the plane nor ends the run, also where
# the case file does not hold the flag in the plane.
file(READ "${SPAR_HOST_DIR}/../cases/flag.case" text)
string(REGEX REPLACE "\nplane [^\n]*" "" text "${text}")
string(REPLACE "[host openfoam]" "[host openfoam]\npressure 10000" text "${text}")
file(WRITE "${out}_cases/flag_pressure.case" "${text}")
foam_test(_plane "${out}_cases/flag_pressure.case" --no-vorticity --refine 0.4 --steps 64)

set_tests_properties(host_openfoam_restart PROPERTIES DEPENDS "host_openfoam_whole;host_openfoam_half")
set_tests_properties(host_openfoam_refused PROPERTIES DEPENDS host_openfoam_restart)
set_tests_properties(host_openfoam_patches PROPERTIES DEPENDS host_openfoam_whole)
set_tests_properties(host_openfoam_members PROPERTIES DEPENDS host_openfoam_one)
