# SparFSI for Nalu-Wind, compiled against stand-ins of its headers and driven by a stand-in of its loop.
if(NOT CMAKE_CXX_COMPILER_LOADED OR NOT SPAR_MPI)
  message(STATUS "Nalu-Wind: no C++ compiler or no MPI, examples/hosts/nalu-wind is not built")
  return()
endif()

# The names of their headers, one line each; aero/fsi has this folder's own.
set(tree "${PROJECT_BINARY_DIR}/examples/hosts/nalu-wind-tree")
foreach(header IN ITEMS stk_mesh/base/BulkData.hpp stk_mesh/base/MetaData.hpp stk_mesh/base/Field.hpp yaml-cpp/yaml.h
    FieldTypeDef.h aero/fsi/CalcLoads.h master_element/MasterElement.h master_element/MasterElementRepo.h
    utils/ComputeVectorDivergence.h)
  file(CONFIGURE OUTPUT "${tree}/${header}" CONTENT "#include \"nalu_wind.h\"\n")
endforeach()
foreach(header IN ITEMS fsi_rotor.h SparFSI.h)
  file(CONFIGURE OUTPUT "${tree}/aero/fsi/${header}" CONTENT "#include \"${SPAR_HOST_DIR}/nalu/${header}\"\n")
endforeach()

add_executable(nalu_wind_stand_in "${SPAR_HOST_DIR}/stand_in/flow.cpp" "${SPAR_HOST_DIR}/nalu/SparFSI.C"
  "${SPAR_HOST_DIR}/nalu/fsi_rotor.c")
set_target_properties(nalu_wind_stand_in PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/examples/hosts")
target_compile_features(nalu_wind_stand_in PRIVATE cxx_std_17)
target_compile_options(nalu_wind_stand_in PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wall;-Wextra;-Wpedantic>)
target_compile_definitions(nalu_wind_stand_in PRIVATE SPAR_DATA_DIR="${PROJECT_SOURCE_DIR}/examples/data" OMPI_SKIP_MPICXX
  MPICH_SKIP_MPICXX)
target_include_directories(nalu_wind_stand_in PRIVATE "${tree}" "${SPAR_HOST_DIR}/stand_in" "${PROJECT_SOURCE_DIR}/examples")
target_link_libraries(nalu_wind_stand_in PRIVATE spar_flags spar_example_parts spar_aero spar m MPI::MPI_C)

if(SPAR_BUILD_TESTS)
  foreach(ranks IN ITEMS 1 2)
    add_test(NAME host_nalu_wind_np${ranks}
      COMMAND ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} ${ranks} $<TARGET_FILE:nalu_wind_stand_in>
      WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
    spar_set_test(host_nalu_wind_np${ranks} hosts 120 ${spar_example_environment})
    set_tests_properties(host_nalu_wind_np${ranks} PROPERTIES RESOURCE_LOCK spar_fsi PROCESSORS ${ranks}) # its files
  endforeach()
endif()
