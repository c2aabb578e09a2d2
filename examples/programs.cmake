# tests/test_rotor.c runs the program as a user does, alone and on several ranks.
if(TARGET test_rotor AND TARGET examples_rotor)
  add_dependencies(test_rotor examples_rotor)
  target_compile_definitions(test_rotor PRIVATE ROTOR_PROGRAM="$<TARGET_FILE:examples_rotor>")
  if(SPAR_MPI)
    target_compile_definitions(test_rotor PRIVATE ROTOR_LAUNCHER="${MPIEXEC_EXECUTABLE} --allow-run-as-root --oversubscribe ${MPIEXEC_NUMPROC_FLAG}")
  endif()
endif()
