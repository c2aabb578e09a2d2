# The turbine of spar for AMR-Wind, compiled against stand-ins of AMR-Wind's headers and driven by a stand-in of its loop.
if(NOT CMAKE_CXX_COMPILER_LOADED)
  message(VERBOSE "AMR-Wind: no C++ compiler, examples/hosts/amr-wind is not built")
  return()
endif()

# AMR-Wind's names for headers: ours where AMR-Wind has them, one line each; the folder of the turbine is this one.
set(tree "${PROJECT_BINARY_DIR}/examples/hosts/amr-wind-tree")
set(turbine "${tree}/amr-wind/wind_energy/actuator/turbine")
foreach(header IN ITEMS AMReX.H AMReX_REAL.H AMReX_ParmParse.H AMReX_Utility.H amr-wind/CFDSim.H
    amr-wind/core/SimTime.H amr-wind/wind_energy/actuator/ActuatorModel.H amr-wind/wind_energy/actuator/ActParser.H
    amr-wind/wind_energy/actuator/turbine/external/external_base_types.H
    amr-wind/wind_energy/actuator/turbine/external/ExtTurbIface.H
    amr-wind/wind_energy/actuator/turbine/external/TurbineExternal.H
    amr-wind/wind_energy/actuator/turbine/external/turbine_external_ops.H)
  file(CONFIGURE OUTPUT "${tree}/${header}" CONTENT "#include \"amr_wind.H\"\n")
endforeach()
foreach(header IN ITEMS actuator.h spar_types.H TurbineSpar.H turbine_spar_ops.H)
  file(CONFIGURE OUTPUT "${turbine}/spar/${header}" CONTENT "#include \"${SPAR_HOST_DIR}/spar/${header}\"\n")
endforeach()

add_library(amr_wind_turbine STATIC EXCLUDE_FROM_ALL "${SPAR_HOST_DIR}/spar/SparIface.cpp" "${SPAR_HOST_DIR}/spar/SparTurbine.cpp"
  "${SPAR_HOST_DIR}/spar/actuator.c" "${SPAR_HOST_DIR}/spar/figures.c")
target_compile_features(amr_wind_turbine PUBLIC cxx_std_17)
target_compile_options(amr_wind_turbine PUBLIC $<$<COMPILE_LANGUAGE:CXX>:-Wall;-Wextra;-Wpedantic>)
target_include_directories(amr_wind_turbine PUBLIC "${tree}" "${SPAR_HOST_DIR}/stand_in" "${SPAR_HOST_DIR}/spar"
  "${PROJECT_SOURCE_DIR}/examples")
target_link_libraries(amr_wind_turbine PUBLIC spar_flags spar_example_parts spar_aero spar m)

function(spar_amr_wind_program target source)
  add_executable(${target} "${SPAR_HOST_DIR}/stand_in/${source}" "${SPAR_HOST_DIR}/spar/TurbineSpar.cpp") # it registers itself
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/examples/hosts")
  target_compile_definitions(${target} PRIVATE SPAR_DATA_DIR="${PROJECT_SOURCE_DIR}/examples/data")
  target_link_libraries(${target} PRIVATE amr_wind_turbine)
endfunction()
spar_amr_wind_program(amr_wind_stand_in flow.cpp)

if(SPAR_BUILD_TESTS)
  spar_amr_wind_program(amr_wind_checks checks.cpp)
  add_test(NAME host_amr_wind COMMAND amr_wind_stand_in --steps 60)
  add_test(NAME host_amr_wind_whole COMMAND amr_wind_stand_in --whole --steps 30)
  set(tests host_amr_wind host_amr_wind_whole)
  foreach(check IN ITEMS order checkpoints refusals restarts coarse direction figures)
    add_test(NAME host_amr_wind_${check} COMMAND amr_wind_checks ${check})
    list(APPEND tests host_amr_wind_${check})
  endforeach()
  foreach(test IN LISTS tests) # each has its own folder of files
    file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/tests/${test}")
    set_tests_properties(${test} PROPERTIES WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests/${test}")
    spar_set_test(${test} hosts 120 ${spar_example_environment})
  endforeach()

  # The recipe's second step: the list of folders in AMR-Wind ends without the end of its line.
  add_test(NAME host_amr_wind_install COMMAND sh -c "rm -rf tree && mkdir -p tree/amr-wind/wind_energy/actuator/turbine/external && \
    cd tree/amr-wind/wind_energy/actuator/turbine && printf 'add_subdirectory(kynema)' > CMakeLists.txt && cd ../../../../.. && \
    '${SPAR_HOST_DIR}/install' tree && '${SPAR_HOST_DIR}/install' tree && cd tree/amr-wind/wind_energy/actuator/turbine && \
    printf 'add_subdirectory(kynema)\nadd_subdirectory(spar)\n' | cmp - CMakeLists.txt && cmp spar/actuator.c '${SPAR_HOST_DIR}/spar/actuator.c'")
  file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/tests/host_amr_wind_install")
  set_tests_properties(host_amr_wind_install PROPERTIES WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests/host_amr_wind_install")
  spar_set_test(host_amr_wind_install hosts 60)
endif()
