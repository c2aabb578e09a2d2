add_executable(torture_files "${spar_torture_dir}/files.c")
set_target_properties(torture_files PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
target_link_libraries(torture_files PRIVATE ${spar_test_libraries})
spar_limit_of(limit 120)
add_test(NAME torture_files COMMAND ${limit} $<TARGET_FILE:torture_files> 4 ${spar_torture_seed} WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
spar_set_test(torture_files torture 120)

# text files of others, with mistakes
add_executable(torture_texts "${spar_torture_dir}/texts.c")
set_target_properties(torture_texts PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
target_link_libraries(torture_texts PRIVATE ${spar_test_libraries})
add_test(NAME torture_texts COMMAND ${limit} $<TARGET_FILE:torture_texts> 900 ${spar_torture_seed} WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
spar_set_test(torture_texts torture 120)
