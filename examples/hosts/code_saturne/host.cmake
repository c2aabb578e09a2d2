# code_saturne with spar in it, a few steps on two ranks: skipped, with a word, where it is not installed. What is checked, and
# where the figures are from: compare.awk of the flow. The light cylinder: the water's added mass is four times its own.
if(SPAR_BUILD_TESTS AND SPAR_MPI)
  add_test(NAME host_code_saturne
    COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/run" cylinder_light --refine 0.5 --steps 20 --ranks 2 --no-install
            --build "${PROJECT_BINARY_DIR}" --out "${PROJECT_BINARY_DIR}/tests/host_code_saturne")
  # one rank and two, the flow solved to rounding: the same to 1e-9
  set(run sh "${CMAKE_CURRENT_LIST_DIR}/run" cylinder --refine 0.5 --steps 5 --rtol 1e-11 --precision 1e-13 --no-install
      --build "${PROJECT_BINARY_DIR}")
  set(out "${PROJECT_BINARY_DIR}/tests/host_code_saturne_np")
  add_test(NAME host_code_saturne_np1 COMMAND ${run} --out ${out}1)
  add_test(NAME host_code_saturne_np2 COMMAND ${run} --out ${out}2 --ranks 2 --against ${out}1)
  foreach(name IN ITEMS host_code_saturne_np1 host_code_saturne_np2)
    spar_set_test(${name} hosts 1200)
    set_tests_properties(${name} PROPERTIES SKIP_RETURN_CODE 77 PROCESSORS 2)
  endforeach()
  set_tests_properties(host_code_saturne_np2 PROPERTIES DEPENDS host_code_saturne_np1)
  spar_set_test(host_code_saturne hosts 1200)
  set_tests_properties(host_code_saturne PROPERTIES SKIP_RETURN_CODE 77 PROCESSORS 2)
endif()
