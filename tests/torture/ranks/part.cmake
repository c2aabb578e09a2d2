# The short form: on 2 ranks what comes first in some seconds, on 3 what chance takes, by a seed that is new with every
# change of the sources.
if(SPAR_MPI)
  add_executable(torture_ranks "${spar_torture_dir}/ranks.c")
  set_target_properties(torture_ranks PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  target_link_libraries(torture_ranks PRIVATE ${spar_test_libraries} MPI::MPI_C)
  target_link_options(torture_ranks PRIVATE "LINKER:--wrap=malloc,--wrap=calloc,--wrap=realloc")
  set(seconds_2 8)
  set(seconds_3 6)
  foreach(ranks IN ITEMS 2 3)
    add_test(NAME torture_ranks_np${ranks}
      COMMAND ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} ${ranks}
              $<TARGET_FILE:torture_ranks> ${seconds_${ranks}} ${spar_torture_seed}
      WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
    spar_set_test(torture_ranks_np${ranks} torture 120 ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=0)
    set_tests_properties(torture_ranks_np${ranks} PROPERTIES PROCESSORS 2)
  endforeach()
endif()
