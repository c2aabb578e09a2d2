# A host's surroundings: see trap.c. The short form runs some of the tests in each of them.
if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
  set(here "${spar_torture_dir}")
  add_library(torture_trap SHARED "${here}/trap.c")
  set_source_files_properties("${here}/trap.c" PROPERTIES COMPILE_DEFINITIONS _GNU_SOURCE=1) # feenableexcept
  target_link_libraries(torture_trap PRIVATE m)
  set_target_properties(torture_trap PROPERTIES LIBRARY_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  set(modes traps upward ftz stack comma)
  if("${CMAKE_C_FLAGS} ${CMAKE_C_FLAGS_DEBUG} ${CMAKE_EXE_LINKER_FLAGS}" MATCHES "sanitize")
    list(REMOVE_ITEM modes stack) # their frames are larger
  endif()
  foreach(mode IN LISTS modes)
    set(programs test_environment test_input test_static test_modes test_fluid test_coupling test_output test_beamdyn
      test_aero test_fidelity)
    if(mode STREQUAL "comma" AND TARGET spar_host_parts)
      list(APPEND programs test_case)
    endif()
    add_test(NAME torture_${mode} COMMAND "${here}/under" ${mode} "${PROJECT_BINARY_DIR}" ${programs})
    # the library is no sanitizer's, and stands before it
    spar_set_test(torture_${mode} torture 300 ASAN_OPTIONS=allocator_may_return_null=1:verify_asan_link_order=0 VERBOSE=1)
    set_tests_properties(torture_${mode} PROPERTIES SKIP_RETURN_CODE 77)
  endforeach()
endif()
