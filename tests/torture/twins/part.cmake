# The twins: random scenes, each played again in other ways that must not matter. The short form here, of fixed seeds and
# of some that are new with every change of the sources; long ones are tests/torture/twins/long's.
add_executable(twins "${spar_torture_dir}/twins.c")
set_target_properties(twins PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
target_compile_definitions(twins PRIVATE _GNU_SOURCE)
target_link_libraries(twins PRIVATE spar_flags spar_aero_static spar_static m)
spar_limit_of(limit 240)
add_test(NAME torture_twins COMMAND ${limit} $<TARGET_FILE:twins> --scenes 150 --seed 1)
add_test(NAME torture_twins_fresh COMMAND ${limit} $<TARGET_FILE:twins> --scenes 50 --seed ${spar_torture_seed})
foreach(name IN ITEMS torture_twins torture_twins_fresh)
  spar_set_test(${name} torture 240)
endforeach()
