# The turbine of spar for AMR-Wind, called Kynema-SGF since April 2026: compiled against a stand-in of their headers, with the
# names of either, and driven by a stand-in of their loop.
if(NOT CMAKE_CXX_COMPILER_LOADED)
  message(VERBOSE "AMR-Wind: no C++ compiler, examples/hosts/amr-wind is not built")
  return()
endif()

# The programs TARGET_stand_in and, for tests, TARGET_checks, from the tree of our stand-in after `install`.
function(spar_amr_wind_programs name folder target)
  set(tree "${PROJECT_BINARY_DIR}/examples/hosts/${name}-tree")
  set(turbine "${tree}/${folder}/wind_energy/actuator/turbine/spar")
  set(sources "${turbine}/SparIface.cpp" "${turbine}/SparTurbine.cpp" "${turbine}/TurbineSpar.cpp" "${turbine}/actuator.c"
    "${turbine}/figures.c")
  file(GLOB parts CONFIGURE_DEPENDS "${SPAR_HOST_DIR}/spar/*" "${SPAR_HOST_DIR}/stand_in/*")
  add_custom_command(OUTPUT ${sources} "${tree}/flow.cpp" "${tree}/checks.cpp"
    COMMAND sh "${SPAR_HOST_DIR}/stand_in/make_tree" "${SPAR_HOST_DIR}" ${name} "${tree}"
    COMMAND sh "${SPAR_HOST_DIR}/install" "${tree}"
    DEPENDS "${SPAR_HOST_DIR}/install" "${SPAR_HOST_DIR}/names.sed" ${parts} VERBATIM)
  add_custom_target(${target}_tree DEPENDS ${sources} "${tree}/flow.cpp" "${tree}/checks.cpp")
  # objects: the actuator models register themselves
  add_library(${target}_turbine OBJECT EXCLUDE_FROM_ALL ${sources})
  add_dependencies(${target}_turbine ${target}_tree)
  target_compile_features(${target}_turbine PUBLIC cxx_std_17)
  target_compile_options(${target}_turbine PUBLIC $<$<COMPILE_LANGUAGE:CXX>:-Wall;-Wextra;-Wpedantic>)
  target_compile_definitions(${target}_turbine PUBLIC ${ARGN})
  target_include_directories(${target}_turbine PUBLIC "${tree}" "${turbine}" "${PROJECT_SOURCE_DIR}/examples")
  target_link_libraries(${target}_turbine PUBLIC spar_flags spar_example_parts spar_aero spar m)
  set(programs flow:stand_in)
  if(SPAR_BUILD_TESTS)
    list(APPEND programs checks:checks)
  endif()
  foreach(program IN LISTS programs)
    string(REPLACE ":" ";" program ${program})
    list(GET program 0 source)
    list(GET program 1 suffix)
    add_executable(${target}_${suffix} "${tree}/${source}.cpp")
    add_dependencies(${target}_${suffix} ${target}_tree)
    set_target_properties(${target}_${suffix} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/examples/hosts")
    target_compile_definitions(${target}_${suffix} PRIVATE SPAR_DATA_DIR="${PROJECT_SOURCE_DIR}/examples/data"
      SPAR_HOST_DIR="${SPAR_HOST_DIR}")
    target_link_libraries(${target}_${suffix} PRIVATE ${target}_turbine)
  endforeach()
endfunction()
spar_amr_wind_programs(amr-wind amr-wind amr_wind)
spar_amr_wind_programs(kynema-sgf src kynema_sgf STAND_IN_SGF)

function(spar_amr_wind_test test)
  add_test(NAME ${test} COMMAND ${ARGN})
  file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/tests/${test}") # each has its own folder of files
  set_tests_properties(${test} PROPERTIES WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests/${test}")
  spar_set_test(${test} hosts 120 ${spar_example_environment})
endfunction()
if(SPAR_BUILD_TESTS)
  spar_amr_wind_test(host_amr_wind amr_wind_stand_in --steps 60)
  spar_amr_wind_test(host_amr_wind_whole amr_wind_stand_in --whole --steps 30)
  foreach(check IN ITEMS order checkpoints refusals restarts coarse direction figures input balance)
    spar_amr_wind_test(host_amr_wind_${check} amr_wind_checks ${check})
  endforeach()
  foreach(check IN ITEMS order checkpoints refusals restarts wall)
    spar_amr_wind_test(host_kynema_sgf_${check} kynema_sgf_checks ${check})
  endforeach()
  # saved with the kernels of this processor, read with those of another
  spar_amr_wind_test(host_amr_wind_processor sh -c "'$<TARGET_FILE:amr_wind_checks>' one_processor && \
    OPENBLAS_CORETYPE=Nehalem '$<TARGET_FILE:amr_wind_checks>' another_processor")
  spar_amr_wind_test(host_amr_wind_install sh "${SPAR_HOST_DIR}/stand_in/check_install" "${SPAR_HOST_DIR}" tree)
endif()
