# ctest prints the table of the verification figures it has just run, and only those.
file(WRITE "${PROJECT_BINARY_DIR}/CTestCustom.cmake"
  "set(CTEST_CUSTOM_PRE_TEST [[\"${CMAKE_COMMAND}\" -E rm -rf \"${PROJECT_BINARY_DIR}/tests/verification\"]])\n"
  "set(CTEST_CUSTOM_POST_TEST [[\"${PROJECT_SOURCE_DIR}/tests/verification/table\" \"${PROJECT_BINARY_DIR}\"]])\n")
# Builds and runs the verification tests and keeps their table.
add_custom_target(verification-table
  COMMAND "${CMAKE_COMMAND}" --build "${PROJECT_BINARY_DIR}"
  COMMAND "${CMAKE_CTEST_COMMAND}" -L verification --output-on-failure
  COMMAND "${PROJECT_SOURCE_DIR}/tests/verification/table" --markdown "${PROJECT_BINARY_DIR}"
          > "${PROJECT_SOURCE_DIR}/docs/evidence/verification.md"
  WORKING_DIRECTORY "${PROJECT_BINARY_DIR}" VERBATIM USES_TERMINAL)
