# SparFSI for Nalu-Wind: the script `apply` patches a stand-in of Nalu-Wind's tree, which is compiled with stand-ins of STK and
# yaml-cpp and driven by a stand-in of the flow.
if(NOT CMAKE_CXX_COMPILER_LOADED OR NOT SPAR_MPI)
  message(VERBOSE "Nalu-Wind: no C++ compiler or no MPI, examples/hosts/nalu-wind is not built")
  return()
endif()

# The tree of our stand-in, with the names of Nalu-Wind and with those of Kynema-UGF, patched by `apply`.
function(spar_nalu_wind_program name target define)
  set(tree "${PROJECT_BINARY_DIR}/examples/hosts/${name}-tree")
  set(names "${PROJECT_BINARY_DIR}/examples/hosts/${name}-names") # of headers that the stand-ins stand for, one line each
  foreach(header IN ITEMS stk_mesh/base/BulkData.hpp stk_mesh/base/MetaData.hpp stk_mesh/base/Field.hpp FieldTypeDef.h
      aero/fsi/CalcLoads.h master_element/MasterElement.h master_element/MasterElementRepo.h utils/ComputeVectorDivergence.h)
    file(CONFIGURE OUTPUT "${names}/${header}" CONTENT "#include \"${tree}/stk_nalu.h\"\n")
  endforeach()
  file(CONFIGURE OUTPUT "${names}/yaml-cpp/yaml.h" CONTENT "#include \"${SPAR_HOST_DIR}/stand_in/yaml_cpp.h\"\n")
  set(patched "${tree}/flow.cpp" "${tree}/src/Realm.C" "${tree}/src/aero/AeroContainer.C" "${tree}/src/aero/spar/SparFSI.C"
    "${tree}/src/aero/spar/fsi_turbine.c")
  file(GLOB_RECURSE parts CONFIGURE_DEPENDS "${SPAR_HOST_DIR}/nalu/*" "${SPAR_HOST_DIR}/stand_in/*")
  file(GLOB models CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/examples/nrel5mw.*" "${PROJECT_SOURCE_DIR}/examples/turbine_*.[ch]")
  add_custom_command(OUTPUT ${patched}
    COMMAND sh "${SPAR_HOST_DIR}/stand_in/make_tree" "${SPAR_HOST_DIR}" ${name} "${tree}"
    COMMAND sh "${SPAR_HOST_DIR}/apply" "${tree}"
    DEPENDS "${SPAR_HOST_DIR}/apply" "${SPAR_HOST_DIR}/names.sed" ${parts} ${models} VERBATIM)
  add_executable(${target} ${patched})
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/examples/hosts")
  target_compile_features(${target} PRIVATE cxx_std_17)
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wall;-Wextra;-Wpedantic>)
  target_compile_definitions(${target} PRIVATE SPAR_DATA_DIR="${PROJECT_SOURCE_DIR}/examples/data" ${define}_SPAR
    ${define}_OPENFAST OMPI_SKIP_MPICXX MPICH_SKIP_MPICXX)
  target_include_directories(${target} PRIVATE "${tree}/include" "${tree}/include/aero/spar" "${names}" "${PROJECT_SOURCE_DIR}/examples")
  target_link_libraries(${target} PRIVATE spar_flags spar_example_parts spar_aero spar m MPI::MPI_C)
endfunction()
spar_nalu_wind_program(nalu-wind nalu_wind_stand_in NALU_USES)
spar_nalu_wind_program(kynema-ugf kynema_ugf_stand_in KYNEMA_UGF_USES)

function(spar_nalu_wind_test target ranks)
  set(folder "${PROJECT_BINARY_DIR}/tests/${target}_np${ranks}")
  file(MAKE_DIRECTORY "${folder}")
  add_test(NAME host_${target}_np${ranks}
    COMMAND ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} ${ranks} $<TARGET_FILE:${target}_stand_in> WORKING_DIRECTORY "${folder}")
  spar_set_test(host_${target}_np${ranks} hosts 120 ${spar_example_environment})
  set_tests_properties(host_${target}_np${ranks} PROPERTIES PROCESSORS ${ranks})
endfunction()
if(SPAR_BUILD_TESTS)
  spar_nalu_wind_test(nalu_wind 1)
  spar_nalu_wind_test(nalu_wind 2)
  spar_nalu_wind_test(kynema_ugf 2)
  add_test(NAME host_nalu_wind_apply COMMAND sh "${SPAR_HOST_DIR}/stand_in/check_apply" "${SPAR_HOST_DIR}"
    "${PROJECT_BINARY_DIR}/tests/nalu_wind_apply")
  spar_set_test(host_nalu_wind_apply hosts 60 ${spar_example_environment})
endif()
