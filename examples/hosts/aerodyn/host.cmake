# The rotor on AeroDyn: with the library where the user has one, and with the stand-in in the tests.
function(spar_aerodyn_rotor target)
  add_executable(${target} "${SPAR_HOST_DIR}/rotor.c" "${SPAR_HOST_DIR}/deck.c" "${SPAR_HOST_DIR}/spar_aerodyn.c")
  target_link_libraries(${target} PRIVATE spar_flags spar_example_parts spar_aero spar m)
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/examples/hosts")
endfunction()

spar_aerodyn_rotor(aerodyn_rotor_stand_in)
target_sources(aerodyn_rotor_stand_in PRIVATE "${SPAR_HOST_DIR}/stand_in.c")

# A path that is given is looked at anew each time, and refused where it does not serve; else the library is looked for.
set(SPAR_AERODYN_LIBRARY "" CACHE FILEPATH "libaerodyn_inflow_c_binding of OpenFAST 4.2 or later; empty: looked for")
set(library "${SPAR_AERODYN_LIBRARY}")
set(found)
if(library AND NOT EXISTS "${library}")
  message(FATAL_ERROR "SPAR_AERODYN_LIBRARY is '${library}', which is not there. Give the path of libaerodyn_inflow_c_binding, or "
    "-DSPAR_AERODYN_LIBRARY= to build the stand-in alone.")
elseif(NOT library)
  find_library(found aerodyn_inflow_c_binding NO_CACHE)
  set(library "${found}")
endif()
if(library)
  include(CheckLibraryExists)
  unset(SPAR_AERODYN_IS_4_2 CACHE)
  set(CMAKE_REQUIRED_QUIET ON)
  check_library_exists("${library}" ADI_C_SetFlowFieldPointer "" SPAR_AERODYN_IS_4_2) # the arguments changed there
  unset(CMAKE_REQUIRED_QUIET)
  if(SPAR_AERODYN_IS_4_2)
    spar_aerodyn_rotor(aerodyn_rotor)
    target_link_libraries(aerodyn_rotor PRIVATE "${library}")
  elseif(SPAR_AERODYN_LIBRARY)
    message(FATAL_ERROR "SPAR_AERODYN_LIBRARY: ${library} has no ADI_C_SetFlowFieldPointer, or a program cannot be linked with it: it is "
      "older than OpenFAST 4.2, or is no such library.")
  else()
    message(STATUS "AeroDyn: ${library} is older than OpenFAST 4.2: examples/hosts/aerodyn is built with its stand-in alone")
  endif()
else()
  message(VERBOSE "AeroDyn: no aerodyn_inflow_c_binding found (SPAR_AERODYN_LIBRARY): examples/hosts/aerodyn is built with its stand-in alone")
endif()

if(SPAR_BUILD_TESTS)
  # Against spar's own blade elements with the same plates, without induction: the same equations, but for numbers in single
  # precision between the two (6e-8 each), so 1e-6; the stand-in's impulse counts every step once. The files are written first.
  foreach(kind IN ITEMS 0 1)
    set(test host_aerodyn_rigid${kind})
    add_test(NAME ${test} COMMAND aerodyn_rotor_stand_in --deck "${PROJECT_BINARY_DIR}/tests/${test}" --rigid ${kind}
      --beside plate --seconds 1 --allowed 1e-6)
    spar_set_test(${test} hosts 60 ${spar_example_environment})
  endforeach()
  # what the library refuses ends the run with its own words, of full length: a deep folder and a polar that is not there
  set(deep "${PROJECT_BINARY_DIR}/tests/aerodyn_a_folder_with_a_name_of_some_length/and_another_of_some_length/and_a_third_of_some_length")
  file(MAKE_DIRECTORY "${deep}")
  file(WRITE "${deep}/AeroDyn.dat" "\"no_such_polar.dat\"   AFNames\n")
  add_test(NAME host_aerodyn_refused COMMAND aerodyn_rotor_stand_in --aerodyn "${deep}/AeroDyn.dat" --inflow "${SPAR_HOST_DIR}/stand_in.dat")
  add_test(NAME host_aerodyn_no_wind COMMAND aerodyn_rotor_stand_in --aerodyn "${SPAR_HOST_DIR}/stand_in.dat"
    --inflow "${SPAR_HOST_DIR}/README.md")
  file(WRITE "${deep}/model_2.dat" "2   BEM_Mod   - as OpenFAST's examples have it\n")
  add_test(NAME host_aerodyn_model COMMAND aerodyn_rotor_stand_in --aerodyn "${deep}/model_2.dat" --inflow "${SPAR_HOST_DIR}/stand_in.dat")
  add_test(NAME host_aerodyn_cfl COMMAND aerodyn_rotor_stand_in --cfl 0.5)
  foreach(test IN ITEMS refused no_wind model cfl)
    spar_set_test(host_aerodyn_${test} hosts 60 ${spar_example_environment})
  endforeach()
  set_tests_properties(host_aerodyn_refused PROPERTIES PASS_REGULAR_EXPRESSION "ADI_C_Init: AD_Init:ReadFile: the file .*no_such_polar.dat\" was not found. AD_Init")
  set_tests_properties(host_aerodyn_no_wind PROPERTIES PASS_REGULAR_EXPRESSION "ADI_C_Init: no HWindSpeed in the file of InflowWind")
  set_tests_properties(host_aerodyn_model PROPERTIES PASS_REGULAR_EXPRESSION "the library serves BEM_Mod 1 alone")
  set_tests_properties(host_aerodyn_cfl PROPERTIES PASS_REGULAR_EXPRESSION "counts steps of one dt from t = 0, so that dt cannot follow")

  add_executable(aerodyn_checks "${SPAR_HOST_DIR}/checks.c" "${SPAR_HOST_DIR}/spar_aerodyn.c" "${SPAR_HOST_DIR}/stand_in.c")
  target_compile_definitions(aerodyn_checks PRIVATE STAND_IN_FILE="${SPAR_HOST_DIR}/stand_in.dat")
  target_link_libraries(aerodyn_checks PRIVATE spar_flags spar m)
  add_test(NAME host_aerodyn_checks COMMAND aerodyn_checks)
  spar_set_test(host_aerodyn_checks hosts 60 ${spar_example_environment})

  # The script: a library that is not there is no run of the stand-in with a good end.
  add_test(NAME host_aerodyn_no_library COMMAND "${SPAR_HOST_DIR}/run" "${SPAR_HOST_DIR}/stand_in.dat" "${SPAR_HOST_DIR}/stand_in.dat")
  spar_set_test(host_aerodyn_no_library hosts 60)
  set_tests_properties(host_aerodyn_no_library PROPERTIES WILL_FAIL ON)
endif()
