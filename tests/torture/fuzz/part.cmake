# The fuzzer: one program; 10^5 calls here, of a fixed seed, and some of one that is new with every change of the sources:
# the same commit fails or passes the same way wherever it is tested. Seeds of the clock are tests/torture/fuzz/long's.
file(GLOB spar_fuzz_files CONFIGURE_DEPENDS "${spar_torture_dir}/*.c")
add_executable(fuzz ${spar_fuzz_files})
set_target_properties(fuzz PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
target_compile_definitions(fuzz PRIVATE _GNU_SOURCE SPAR_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
target_link_libraries(fuzz PRIVATE spar_flags spar_aero_static spar_static m)
add_test(NAME torture_fuzz_complete COMMAND fuzz --names)
add_test(NAME torture_fuzz_shrinks COMMAND fuzz --fault --calls 200000)
add_test(NAME torture_fuzz COMMAND fuzz --calls 100000 --jobs 2 --all)
add_test(NAME torture_fuzz_fresh COMMAND fuzz --calls 10000 --seed ${spar_torture_seed})
foreach(name IN ITEMS torture_fuzz_complete torture_fuzz_shrinks torture_fuzz torture_fuzz_fresh)
  spar_set_test(${name} torture 120)
endforeach()
