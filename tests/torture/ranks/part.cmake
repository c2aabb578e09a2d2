# The short form: on 2 ranks what comes first in some seconds, on 3 what chance takes, by a seed that is new with every
# change of the sources; and on 2 with sums that go over to other nodes.
if(SPAR_MPI)
  add_executable(torture_ranks "${spar_torture_dir}/ranks.c")
  set_target_properties(torture_ranks PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  target_link_libraries(torture_ranks PRIVATE ${spar_test_libraries} MPI::MPI_C)
  target_link_options(torture_ranks PRIVATE "LINKER:--wrap=malloc,--wrap=calloc,--wrap=realloc")
  set(case_np2 2 8 all)
  set(case_np3 3 6 all)
  set(case_binned_np2 2 6 binned spar_trial_advise)
  foreach(case IN ITEMS np2 np3 binned_np2)
    list(GET case_${case} 0 ranks)
    list(GET case_${case} 1 seconds)
    list(SUBLIST case_${case} 2 2 state)
    add_test(NAME torture_ranks_${case}
      COMMAND ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} ${ranks}
              $<TARGET_FILE:torture_ranks> ${seconds} ${spar_torture_seed} ${state}
      WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
    spar_set_test(torture_ranks_${case} torture 120 ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=0)
    set_tests_properties(torture_ranks_${case} PROPERTIES PROCESSORS 2)
  endforeach()
endif()
