# Serial tests of transfer, coupling, stability and what hangs on them, once more on several ranks (spread.h). In the suite those that take
# seconds, on 2 and 3 ranks; tests/ranks spread: all, on 1, 2, 3, 4 and 7, with every deal of the nodes.
set(spar_spread_tests fluid/test_fluid fluid/test_weights fluid/test_sections member/test_plane solve/test_energy session/test_start session/test_static_coupled assembly/test_joint assembly/test_turning)
set(spar_spread_more stability/test_floquet stability/coupling member/test_learned_mass_life coupling/test_coupling coupling/test_coupling_tied member/test_learned_mass member/test_added_mass member/test_added_mass_life assembly/test_assembly trial/test_joint_trial
  trial/test_trial stability/substeps)
add_library(spar_spread OBJECT "${CMAKE_CURRENT_LIST_DIR}/spread.c")
target_link_libraries(spar_spread PRIVATE spar_test_base spar_static MPI::MPI_C)
foreach(test IN LISTS spar_spread_tests spar_spread_more)
  get_filename_component(name ${test} NAME)
  set(name spread_${name})
  add_executable(${name} "${PROJECT_SOURCE_DIR}/tests/${test}.c" $<TARGET_OBJECTS:spar_spread>)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  target_compile_options(${name} PRIVATE "SHELL:-include \"${CMAKE_CURRENT_LIST_DIR}/spread.h\"")
  target_link_libraries(${name} PRIVATE ${spar_test_libraries} MPI::MPI_C)
endforeach()
foreach(test IN LISTS spar_spread_tests)
  get_filename_component(name ${test} NAME)
  set(name spread_${name})
  add_test(NAME ${name}
    COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/run" "${PROJECT_BINARY_DIR}/tests/spread" $<TARGET_FILE:${name}> 3:shuffled:1 2:shuffled:0 -- ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG}
    WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  spar_set_test(${name} mpi 120 ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=0)
  set_tests_properties(${name} PROPERTIES PROCESSORS 2)
endforeach()
