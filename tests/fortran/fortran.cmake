# Bindings against C: the same names and numbers, and the same types.
add_test(NAME fortran_names COMMAND "${CMAKE_COMMAND}" -DSOURCE=${PROJECT_SOURCE_DIR}
  -P "${CMAKE_CURRENT_LIST_DIR}/names.cmake")
spar_set_test(fortran_names fortran 60)

# A whole-program link of C and Fortran compares the types of every call; built when tested, for it takes a while.
if(CMAKE_C_COMPILER_ID STREQUAL "GNU" AND CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
  # the files that define a public function, whose definition begins a line; the library has the rest
  set(public)
  foreach(file IN LISTS spar_sources spar_blade_sources)
    file(STRINGS "${file}" lines REGEX "^[a-z].*[ *]spar_[a-z0-9_]+\\(")
    if(lines)
      list(APPEND public "${file}")
    endif()
  endforeach()
  add_executable(fortran_types EXCLUDE_FROM_ALL ${public}
    "${PROJECT_SOURCE_DIR}/fortran/spar_c.f90" "${PROJECT_SOURCE_DIR}/fortran/spar_aero_c.f90" "${PROJECT_SOURCE_DIR}/tests/fortran/test_bindings.f90")
  set_target_properties(fortran_types PROPERTIES LINKER_LANGUAGE Fortran
    RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests"
    Fortran_MODULE_DIRECTORY "${PROJECT_BINARY_DIR}/tests/modules_types")
  get_target_property(definitions spar_objects COMPILE_DEFINITIONS)
  target_compile_definitions(fortran_types PRIVATE ${definitions})
  target_include_directories(fortran_types PRIVATE "${PROJECT_SOURCE_DIR}/include")
  target_compile_options(fortran_types PRIVATE -flto -O0)
  target_link_options(fortran_types PRIVATE -flto -O0 -Werror=lto-type-mismatch)
  target_link_libraries(fortran_types PRIVATE spar_flags spar_aero_static spar_static spar::algebra Threads::Threads $<$<BOOL:${SPAR_MPI}>:MPI::MPI_C>)
  add_test(NAME fortran_types COMMAND "${CMAKE_COMMAND}" --build "${PROJECT_BINARY_DIR}" --target fortran_types)
  spar_set_test(fortran_types fortran 600)
  set_tests_properties(fortran_types PROPERTIES PROCESSORS 2)
endif()

# Each argument goes where its name says: no compiler sees two of one type exchanged.
find_program(SPAR_AWK awk)
mark_as_advanced(SPAR_AWK)
if(SPAR_AWK)
  add_test(NAME fortran_arguments COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/arguments")
  spar_set_test(fortran_arguments fortran 30)
  add_test(NAME fortran_arguments_fails COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/arguments_fails" "${PROJECT_BINARY_DIR}/tests/arguments_fails")
  spar_set_test(fortran_arguments_fails fortran 60)
endif()

# Sessions in callbacks of others, and in threads, with gfortran's checks.
if(CMAKE_Fortran_COMPILER_ID STREQUAL "GNU" AND NOT CMAKE_CROSSCOMPILING AND NOT CMAKE_C_FLAGS MATCHES "sanitize"
   AND NOT CMAKE_C_FLAGS_DEBUG MATCHES "sanitize")
  add_test(NAME fortran_reentrant COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/reentrant" "${CMAKE_Fortran_COMPILER}" "$<TARGET_FILE:spar>"
    "${PROJECT_BINARY_DIR}/tests/reentrant")
  spar_set_test(fortran_reentrant fortran 120)
  add_test(NAME fortran_fuzz COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/fuzz" "${CMAKE_Fortran_COMPILER}" "$<TARGET_FILE:spar>"
    "${PROJECT_BINARY_DIR}/tests/fortran_fuzz")
  spar_set_test(fortran_fuzz fortran 120)
endif()

# One kind of real in each call.
add_test(NAME fortran_kinds COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/kinds" "${CMAKE_Fortran_COMPILER}"
  "$<TARGET_PROPERTY:spar_fortran,Fortran_MODULE_DIRECTORY>" "${PROJECT_BINARY_DIR}/tests/kinds")
spar_set_test(fortran_kinds fortran 60)
