# Figures quoted in docs/ are those that the programs print.
add_test(NAME docs_faq COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/faq")
spar_set_test(docs_faq docs 30)
find_program(SPAR_AWK awk)
mark_as_advanced(SPAR_AWK)
if(NOT SPAR_AWK OR CMAKE_C_FLAGS_DEBUG MATCHES "sanitize")
  return()
endif()
add_test(NAME docs_verification COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/verification" "${PROJECT_BINARY_DIR}")
spar_set_test(docs_verification docs 60)
file(GLOB files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/verification/*.c")
list(TRANSFORM files REPLACE ".*/(.*)\\.c" "\\1")
set_tests_properties(docs_verification PROPERTIES DEPENDS "${files}" SKIP_RETURN_CODE 77) # 77: none has run
