# The turbine of spar for AMR-Wind, compiled against stand-ins of AMR-Wind's headers and driven by a stand-in of its loop.
if(NOT CMAKE_CXX_COMPILER_LOADED)
  message(STATUS "AMR-Wind: no C++ compiler, examples/hosts/amr-wind is not built")
  return()
endif()

# AMR-Wind's names for headers: ours where AMR-Wind has them, one line each; the folder of the turbine is this one.
set(tree "${PROJECT_BINARY_DIR}/examples/hosts/amr-wind-tree")
set(turbine "${tree}/amr-wind/wind_energy/actuator/turbine")
foreach(header IN ITEMS AMReX.H AMReX_REAL.H AMReX_FileSystem.H AMReX_ParmParse.H AMReX_Utility.H amr-wind/CFDSim.H
    amr-wind/core/SimTime.H amr-wind/wind_energy/actuator/ActuatorModel.H
    amr-wind/wind_energy/actuator/turbine/external/external_base_types.H
    amr-wind/wind_energy/actuator/turbine/external/ExtTurbIface.H
    amr-wind/wind_energy/actuator/turbine/external/TurbineExternal.H
    amr-wind/wind_energy/actuator/turbine/external/turbine_external_ops.H)
  file(CONFIGURE OUTPUT "${tree}/${header}" CONTENT "#include \"amr_wind.H\"\n")
endforeach()
foreach(header IN ITEMS actuator.h spar_types.H TurbineSpar.H turbine_spar_ops.H)
  file(CONFIGURE OUTPUT "${turbine}/spar/${header}" CONTENT "#include \"${SPAR_HOST_DIR}/spar/${header}\"\n")
endforeach()

add_executable(amr_wind_stand_in "${SPAR_HOST_DIR}/stand_in/flow.cpp" "${SPAR_HOST_DIR}/spar/SparIface.cpp"
  "${SPAR_HOST_DIR}/spar/TurbineSpar.cpp" "${SPAR_HOST_DIR}/spar/actuator.c")
set_target_properties(amr_wind_stand_in PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/examples/hosts")
target_compile_features(amr_wind_stand_in PRIVATE cxx_std_17)
target_compile_options(amr_wind_stand_in PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wall;-Wextra;-Wpedantic>)
target_compile_definitions(amr_wind_stand_in PRIVATE SPAR_DATA_DIR="${PROJECT_SOURCE_DIR}/examples/data")
target_include_directories(amr_wind_stand_in PRIVATE "${tree}" "${SPAR_HOST_DIR}/stand_in" "${SPAR_HOST_DIR}/spar"
  "${PROJECT_SOURCE_DIR}/examples")
target_link_libraries(amr_wind_stand_in PRIVATE spar_flags spar_example_parts spar_aero spar m)

if(SPAR_BUILD_TESTS)
  add_test(NAME host_amr_wind COMMAND amr_wind_stand_in --steps 60 WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  add_test(NAME host_amr_wind_whole COMMAND amr_wind_stand_in --whole --steps 30
    WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  spar_set_test(host_amr_wind hosts 120 ${spar_example_environment})
  spar_set_test(host_amr_wind_whole hosts 120 ${spar_example_environment})
  set_tests_properties(host_amr_wind host_amr_wind_whole PROPERTIES RESOURCE_LOCK spar_amr_wind) # one folder of files
endif()
