# code_saturne with spar in it, a few steps on two ranks: skipped, with a word, where it is not installed. What is checked, and
# where the figures are from: compare.awk of the flow. The light cylinder: the water's added mass is four times its own.
if(SPAR_BUILD_TESTS AND SPAR_MPI)
  add_test(NAME host_code_saturne
    COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/run" cylinder_light --refine 0.5 --steps 20 --ranks 2 --no-install
            --build "${PROJECT_BINARY_DIR}" --out "${PROJECT_BINARY_DIR}/tests/host_code_saturne")
  spar_set_test(host_code_saturne hosts 1200)
  set_tests_properties(host_code_saturne PROPERTIES SKIP_RETURN_CODE 77 PROCESSORS 2)
endif()
