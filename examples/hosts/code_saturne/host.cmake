# code_saturne with spar in it, a few steps on two ranks: skipped, with a word, where it is not installed. What is checked, and
# where the figures are from: compare.awk of the flow. The light cylinder: the water's added mass is four times its own.
if(SPAR_BUILD_TESTS)
  add_test(NAME host_cycles COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/../common/test_cycles")
  spar_set_test(host_cycles hosts 60)
endif()
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
  # several members: two flaps, each the other's mirror image, one of them with two groups of faces
  add_test(NAME host_code_saturne_flaps COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/run" flaps --refine 0.5 --ranks 2 --no-install
           --build "${PROJECT_BINARY_DIR}" --out "${PROJECT_BINARY_DIR}/tests/host_code_saturne_flaps")
  # members that are joined: a hub with three blades. Their loads are the flow's force, their roots turn with the hub
  add_test(NAME host_code_saturne_hub COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/run" hub --refine 0.5 --ranks 2 --no-install
           --build "${PROJECT_BINARY_DIR}" --out "${PROJECT_BINARY_DIR}/tests/host_code_saturne_hub")
  # half of a run, and the rest of it from code_saturne's checkpoint: every digit of the whole run; without the structure's
  # file, or with that of another step, the rest is refused
  set(run sh "${CMAKE_CURRENT_LIST_DIR}/run" flag --refine 0.4 --no-install --build "${PROJECT_BINARY_DIR}")
  set(out "${PROJECT_BINARY_DIR}/tests/host_code_saturne_")
  add_test(NAME host_code_saturne_whole COMMAND ${run} --steps 6 --out ${out}whole)
  add_test(NAME host_code_saturne_half COMMAND ${run} --steps 3 --out ${out}half)
  add_test(NAME host_code_saturne_rest COMMAND ${run} --steps 6 --restart ${out}half --out ${out}rest --against ${out}whole)
  foreach(what IN ITEMS without other)
    add_test(NAME host_code_saturne_${what} COMMAND sh -c "
      rm -rf '${out}${what}' && cp -r '${out}half' '${out}${what}' && cd '${out}${what}/checkpoint' && rm spar || exit 77
      [ ${what} = without ] || cp '${out}whole/checkpoint/spar' .
      exec sh '${CMAKE_CURRENT_LIST_DIR}/run' flag --refine 0.4 --no-install --build '${PROJECT_BINARY_DIR}' \\
        --steps 6 --restart '${out}${what}' --out '${out}${what}_rest'")
  endforeach()
  set_tests_properties(host_code_saturne_without PROPERTIES
    PASS_REGULAR_EXPRESSION "the flow continues from t = 0.0075 s, and the structure cannot")
  set_tests_properties(host_code_saturne_other PROPERTIES
    PASS_REGULAR_EXPRESSION "from t = 0.0075 s .step 3., and the structure in restart/spar from 0.015 s .step 6.")
  # groups that the mesh does not have
  file(READ "${CMAKE_CURRENT_LIST_DIR}/../cases/flag.case" text)
  foreach(change IN ITEMS "wetted 6|wetted 66|wetted '66': the mesh has no boundary face of '66'"
          "fixed \"1 or 2|fixed \"1 or 77 or 2|fixed '1 or 77 or 2 or 3 or 4': the mesh has no boundary face of '77'")
    string(REPLACE "|" ";" change "${change}")
    list(GET change 0 old)
    list(GET change 1 new)
    list(GET change 2 message)
    string(REGEX MATCH "^[a-z]+" name "${old}")
    string(REPLACE "${old}" "${new}" other "${text}")
    file(WRITE "${PROJECT_BINARY_DIR}/tests/${name}.case" "${other}")
    add_test(NAME host_code_saturne_${name} COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/run" "${PROJECT_BINARY_DIR}/tests/${name}.case"
      --refine 0.4 --steps 2 --no-install --build "${PROJECT_BINARY_DIR}" --out ${out}${name})
    set_tests_properties(host_code_saturne_${name} PROPERTIES PASS_REGULAR_EXPRESSION "${message}")
  endforeach()
  # a mesh that folds: code_saturne itself ends with the status 0
  file(READ "${CMAKE_CURRENT_LIST_DIR}/../cases/cylinder.case" text)
  string(REPLACE "velocity 0 0.05 0" "velocity 0 30 0" text "${text}")
  string(REPLACE "stiffness 0 4.93" "stiffness 0 0.93" text "${text}")
  file(WRITE "${PROJECT_BINARY_DIR}/tests/fast.case" "${text}")
  add_test(NAME host_code_saturne_fold COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/run" "${PROJECT_BINARY_DIR}/tests/fast.case"
    --refine 0.5 --steps 30 --no-install --build "${PROJECT_BINARY_DIR}" --out ${out}fold)
  set_tests_properties(host_code_saturne_fold PROPERTIES
    PASS_REGULAR_EXPRESSION "the mesh has folded at step [0-9]+.*the run has ended early.*drawn:.*only [0-9]+ of 30 steps")
  foreach(name IN ITEMS _fold _np1 _np2 _flaps _hub _whole _half _rest _without _other _wetted _fixed "")
    spar_set_test(host_code_saturne${name} hosts 1200)
    set_tests_properties(host_code_saturne${name} PROPERTIES SKIP_RETURN_CODE 77)
  endforeach()
  set_tests_properties(host_code_saturne host_code_saturne_np2 host_code_saturne_flaps host_code_saturne_hub PROPERTIES PROCESSORS 2)
  set_tests_properties(host_code_saturne_np2 PROPERTIES DEPENDS host_code_saturne_np1)
  set_tests_properties(host_code_saturne_rest host_code_saturne_without host_code_saturne_other PROPERTIES
    DEPENDS "host_code_saturne_whole;host_code_saturne_half")
endif()
