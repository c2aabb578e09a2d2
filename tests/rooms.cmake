# The house: rooms on their floors (tests/rooms), and that the test would see an arrow up, a circle, a long function, a
# name or a macro given twice.
find_program(SPAR_AWK awk)
mark_as_advanced(SPAR_AWK)
add_test(NAME setup COMMAND sh "${PROJECT_SOURCE_DIR}/tests/setup" "${PROJECT_BINARY_DIR}/tests/setup")
spar_set_test(setup house 30) # what examples/run cannot do without
if(SPAR_AWK)
  add_test(NAME rooms COMMAND sh "${PROJECT_SOURCE_DIR}/tests/rooms")
  spar_set_test(rooms house 30)
  add_test(NAME rooms_fails COMMAND sh "${PROJECT_SOURCE_DIR}/tests/rooms_fails" "${PROJECT_BINARY_DIR}/tests/rooms")
  spar_set_test(rooms_fails house 60)
endif()
