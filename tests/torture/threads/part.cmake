# Sessions of several threads: see threads.c.
add_executable(torture_threads "${spar_torture_dir}/threads.c" "${spar_torture_dir}/../memory/scenario.c")
set_target_properties(torture_threads PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
target_link_libraries(torture_threads PRIVATE ${spar_test_libraries} Threads::Threads $<$<BOOL:${SPAR_MPI}>:MPI::MPI_C>)
spar_limit_of(limit 300)
add_test(NAME torture_threads COMMAND ${limit} $<TARGET_FILE:torture_threads> WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
spar_set_test(torture_threads torture 300)
set_tests_properties(torture_threads PROPERTIES PROCESSORS 2)
