# OpenFOAM with spar in it, a few steps on two ranks: skipped, with a word, where it or its headers are not installed. What is
# checked, and where the figures are from: ../code_saturne/cylinder/compare.awk.
if(SPAR_BUILD_TESTS AND SPAR_MPI)
  add_test(NAME host_openfoam
    COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/run" cylinder --refine 0.5 --steps 20 --ranks 2 --no-install --headers "${PROJECT_SOURCE_DIR}/build/openfoam"
            --build "${PROJECT_BINARY_DIR}" --out "${PROJECT_BINARY_DIR}/tests/host_openfoam")
  spar_set_test(host_openfoam hosts 1200)
  set_tests_properties(host_openfoam PROPERTIES SKIP_RETURN_CODE 77 PROCESSORS 2)
endif()
