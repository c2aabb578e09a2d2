# Failed allocations: see memory.c. Sanitizers have an allocator of their own, there only the library's calls are seen.
set(here "${spar_torture_dir}")
set_source_files_properties("${here}/alloc.c" PROPERTIES COMPILE_DEFINITIONS _GNU_SOURCE=1) # dl_iterate_phdr
add_executable(torture_memory "${here}/memory.c" "${here}/scenario.c" "${here}/alloc.c")
set_target_properties(torture_memory PROPERTIES ENABLE_EXPORTS ON RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
target_link_libraries(torture_memory PRIVATE ${spar_test_libraries} $<$<BOOL:${SPAR_MPI}>:MPI::MPI_C>)
if("${CMAKE_C_FLAGS} ${CMAKE_C_FLAGS_DEBUG} ${CMAKE_EXE_LINKER_FLAGS}" MATCHES "sanitize")
  target_link_options(torture_memory PRIVATE LINKER:--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=free)
  add_test(NAME torture_memory_shortest COMMAND torture_memory shortest WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  spar_set_test(torture_memory_shortest torture 300)
endif()
add_test(NAME torture_memory COMMAND torture_memory short WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
spar_set_test(torture_memory torture 300)
if(SPAR_MPI)
  add_test(NAME torture_memory_np2
    COMMAND ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} 2 $<TARGET_FILE:torture_memory> short
    WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  # as with the tests of many ranks: Open MPI leaves what the leak checker cannot tell from ours
  spar_set_test(torture_memory_np2 torture 300 ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=0)
  set_tests_properties(torture_memory_np2 PROPERTIES PROCESSORS 2)
endif()
