# Figures quoted in docs/ are those that the programs print.
add_test(NAME docs_faq COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/faq")
spar_set_test(docs_faq docs 30)
find_program(SPAR_AWK awk)
mark_as_advanced(SPAR_AWK)
if(SPAR_AWK)
  # every public name has words; the book has no page with a link that leads nowhere
  add_test(NAME docs_names COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/names" "${PROJECT_BINARY_DIR}/tests/docs/names")
  spar_set_test(docs_names docs 30)
  find_program(SPAR_DOXYGEN doxygen)
  mark_as_advanced(SPAR_DOXYGEN)
  if(SPAR_DOXYGEN)
    add_test(NAME docs_book COMMAND sh "${PROJECT_SOURCE_DIR}/docs/book" "${PROJECT_BINARY_DIR}/tests/docs/book")
    spar_set_test(docs_book docs 60)
  endif()
  if(NOT CMAKE_C_FLAGS_DEBUG MATCHES "sanitize")
    add_test(NAME docs_languages COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/languages" "${PROJECT_SOURCE_DIR}" "${PROJECT_BINARY_DIR}"
      "${PROJECT_BINARY_DIR}/tests/docs/languages" "${CMAKE_C_COMPILER}" ${CMAKE_Fortran_COMPILER})
    spar_set_test(docs_languages docs 60)
  endif()
endif()
if(NOT SPAR_AWK OR CMAKE_C_FLAGS_DEBUG MATCHES "sanitize")
  return()
endif()
if(SPAR_BUILD_BENCHMARKS) # the quickest scene; tests/docs/accuracy compares all
  add_test(NAME docs_accuracy COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/accuracy" "${PROJECT_BINARY_DIR}/benchmarks/accuracy"
    "${PROJECT_BINARY_DIR}/tests/docs/accuracy" body)
  spar_set_test(docs_accuracy docs 120)
endif()
add_test(NAME docs_verification COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/verification" "${PROJECT_BINARY_DIR}")
spar_set_test(docs_verification docs 60)
file(GLOB files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/verification/*.c")
list(TRANSFORM files REPLACE ".*/(.*)\\.c" "\\1")
set_tests_properties(docs_verification PROPERTIES DEPENDS "${files}" SKIP_RETURN_CODE 77) # 77: none has run
