# Fluid solvers that nobody here wrote, with spar in them (examples/hosts): a few steps on two ranks. Skipped, with a word, where
# the solver is not installed. The checks and their sources are in compare.awk of each case.
if(SPAR_MPI)
  # The light cylinder: the water's added mass is four times its own.
  add_test(NAME host_code_saturne
    COMMAND sh "${PROJECT_SOURCE_DIR}/examples/hosts/code_saturne/run" cylinder --mass 0.2 --steps 20 --ranks 2 --no-install
            --build "${PROJECT_BINARY_DIR}" --out "${PROJECT_BINARY_DIR}/tests/host_code_saturne")
  spar_set_test(host_code_saturne hosts 600)
  set_tests_properties(host_code_saturne PROPERTIES SKIP_RETURN_CODE 77 PROCESSORS 2)
endif()
