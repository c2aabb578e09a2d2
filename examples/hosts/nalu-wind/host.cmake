# SparFSI for Nalu-Wind: the script `apply` patches a stand-in of Nalu-Wind's tree, which is compiled with stand-ins of STK and
# yaml-cpp and driven by a stand-in of the flow.
if(NOT CMAKE_CXX_COMPILER_LOADED OR NOT SPAR_MPI)
  message(VERBOSE "Nalu-Wind: no C++ compiler or no MPI, examples/hosts/nalu-wind is not built")
  return()
endif()

# The names of headers that the stand-ins stand for, one line each.
set(names "${PROJECT_BINARY_DIR}/examples/hosts/nalu-wind-names")
foreach(header IN ITEMS stk_mesh/base/BulkData.hpp stk_mesh/base/MetaData.hpp stk_mesh/base/Field.hpp FieldTypeDef.h
    aero/fsi/CalcLoads.h master_element/MasterElement.h master_element/MasterElementRepo.h utils/ComputeVectorDivergence.h)
  file(CONFIGURE OUTPUT "${names}/${header}" CONTENT "#include \"${SPAR_HOST_DIR}/stand_in/stk_nalu.h\"\n")
endforeach()
file(CONFIGURE OUTPUT "${names}/yaml-cpp/yaml.h" CONTENT "#include \"${SPAR_HOST_DIR}/stand_in/yaml_cpp.h\"\n")

# The tree, patched.
set(tree "${PROJECT_BINARY_DIR}/examples/hosts/nalu-wind-tree")
set(patched "${tree}/src/Realm.C" "${tree}/src/aero/AeroContainer.C" "${tree}/src/aero/spar/SparFSI.C"
  "${tree}/src/aero/spar/fsi_turbine.c")
file(GLOB_RECURSE parts CONFIGURE_DEPENDS "${SPAR_HOST_DIR}/nalu/*" "${SPAR_HOST_DIR}/stand_in/tree/*")
file(GLOB models CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/examples/nrel5mw.*" "${PROJECT_SOURCE_DIR}/examples/turbine_*.[ch]")
add_custom_command(OUTPUT ${patched}
  COMMAND ${CMAKE_COMMAND} -E rm -rf "${tree}"
  COMMAND ${CMAKE_COMMAND} -E copy_directory "${SPAR_HOST_DIR}/stand_in/tree" "${tree}"
  COMMAND sh "${SPAR_HOST_DIR}/apply" "${tree}"
  DEPENDS "${SPAR_HOST_DIR}/apply" ${parts} ${models} VERBATIM)

add_executable(nalu_wind_stand_in "${SPAR_HOST_DIR}/stand_in/flow.cpp" ${patched})
set_target_properties(nalu_wind_stand_in PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/examples/hosts")
target_compile_features(nalu_wind_stand_in PRIVATE cxx_std_17)
target_compile_options(nalu_wind_stand_in PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wall;-Wextra;-Wpedantic>)
target_compile_definitions(nalu_wind_stand_in PRIVATE SPAR_DATA_DIR="${PROJECT_SOURCE_DIR}/examples/data" NALU_USES_SPAR
  NALU_USES_OPENFAST OMPI_SKIP_MPICXX MPICH_SKIP_MPICXX)
target_include_directories(nalu_wind_stand_in PRIVATE "${tree}/include" "${tree}/include/aero/spar" "${names}" "${PROJECT_SOURCE_DIR}/examples")
target_link_libraries(nalu_wind_stand_in PRIVATE spar_flags spar_example_parts spar_aero spar m MPI::MPI_C)

if(SPAR_BUILD_TESTS)
  foreach(ranks IN ITEMS 1 2)
    set(folder "${PROJECT_BINARY_DIR}/tests/nalu_wind_np${ranks}")
    file(MAKE_DIRECTORY "${folder}")
    add_test(NAME host_nalu_wind_np${ranks}
      COMMAND ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} ${ranks} $<TARGET_FILE:nalu_wind_stand_in>
      WORKING_DIRECTORY "${folder}")
    spar_set_test(host_nalu_wind_np${ranks} hosts 120 ${spar_example_environment})
    set_tests_properties(host_nalu_wind_np${ranks} PROPERTIES PROCESSORS ${ranks})
  endforeach()
  add_test(NAME host_nalu_wind_apply COMMAND sh "${SPAR_HOST_DIR}/stand_in/check_apply" "${SPAR_HOST_DIR}"
    "${PROJECT_BINARY_DIR}/tests/nalu_wind_apply")
  spar_set_test(host_nalu_wind_apply hosts 60 ${spar_example_environment})
endif()
