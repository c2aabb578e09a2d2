# The rotor on AeroDyn: with the library where the user has one, and with the stand-in in the tests.
function(spar_aerodyn_rotor target)
  add_executable(${target} "${SPAR_HOST_DIR}/rotor.c" "${SPAR_HOST_DIR}/spar_aerodyn.c")
  target_link_libraries(${target} PRIVATE spar_flags spar_example_parts spar_aero spar m)
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/examples/hosts")
endfunction()

spar_aerodyn_rotor(aerodyn_rotor_stand_in)
target_sources(aerodyn_rotor_stand_in PRIVATE "${SPAR_HOST_DIR}/stand_in.c")

find_library(SPAR_AERODYN_LIBRARY aerodyn_inflow_c_binding)
mark_as_advanced(SPAR_AERODYN_LIBRARY)
if(SPAR_AERODYN_LIBRARY)
  include(CheckLibraryExists)
  check_library_exists("${SPAR_AERODYN_LIBRARY}" ADI_C_SetFlowFieldPointer "" SPAR_AERODYN_IS_4_2) # the arguments changed there
endif()
if(SPAR_AERODYN_IS_4_2)
  spar_aerodyn_rotor(aerodyn_rotor)
  target_link_libraries(aerodyn_rotor PRIVATE "${SPAR_AERODYN_LIBRARY}")
elseif(SPAR_AERODYN_LIBRARY)
  message(STATUS "AeroDyn: ${SPAR_AERODYN_LIBRARY} is older than OpenFAST 4.2: examples/hosts/aerodyn is built with its stand-in alone")
else()
  message(STATUS "AeroDyn: no aerodyn_inflow_c_binding found (SPAR_AERODYN_LIBRARY): examples/hosts/aerodyn is built with its stand-in alone")
endif()

# Against spar's own blade elements with the same plates, without induction: the same equations, but for numbers in single
# precision between the two (6e-8 each), so 1e-6; the stand-in's impulse counts every step once.
if(SPAR_BUILD_TESTS)
  add_test(NAME host_aerodyn COMMAND aerodyn_rotor_stand_in --aerodyn "${SPAR_HOST_DIR}/stand_in.dat"
    --inflow "${SPAR_HOST_DIR}/stand_in.dat" --beside plate --seconds 1 --allowed 1e-6)
  spar_set_test(host_aerodyn hosts 60 ${spar_example_environment})
  # what the library refuses ends the run with its own words
  add_test(NAME host_aerodyn_refused COMMAND aerodyn_rotor_stand_in --aerodyn "${SPAR_HOST_DIR}/stand_in.dat"
    --inflow "${SPAR_HOST_DIR}/README.md")
  spar_set_test(host_aerodyn_refused hosts 60 ${spar_example_environment})
  set_tests_properties(host_aerodyn_refused PROPERTIES PASS_REGULAR_EXPRESSION "ADI_C_Init: no HWindSpeed in the file of InflowWind")
endif()
