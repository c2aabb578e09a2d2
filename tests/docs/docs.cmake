# Figures quoted in docs/ are those that the programs print.
add_test(NAME docs_faq COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/faq")
spar_set_test(docs_faq docs 30)
find_program(SPAR_PYTHON python3)
if(SPAR_PYTHON) # the reference is what the headers, settings and messages give; every public name has words
  add_test(NAME docs_reference COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/reference" "${PROJECT_BINARY_DIR}/tests/docs/reference")
  spar_set_test(docs_reference docs 30)
  find_program(SPAR_PANDOC pandoc)
  mark_as_advanced(SPAR_PANDOC)
  if(SPAR_PANDOC) # the book has no link that leads nowhere, and no markup that is left as it stands
    add_test(NAME docs_book COMMAND sh "${PROJECT_SOURCE_DIR}/docs/book" "${PROJECT_BINARY_DIR}/tests/docs/book")
    spar_set_test(docs_book docs 120)
  endif()
endif()
find_program(SPAR_AWK awk)
mark_as_advanced(SPAR_AWK SPAR_PYTHON)
if(SPAR_AWK)
  add_test(NAME docs_sentences COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/sentences")
  spar_set_test(docs_sentences docs 30)
  if(NOT CMAKE_C_FLAGS_DEBUG MATCHES "sanitize")
    add_test(NAME docs_languages COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/languages" "${PROJECT_SOURCE_DIR}" "${PROJECT_BINARY_DIR}"
      "${PROJECT_BINARY_DIR}/tests/docs/languages" "${CMAKE_C_COMPILER}" ${CMAKE_Fortran_COMPILER})
    spar_set_test(docs_languages docs 60)
    add_test(NAME docs_programs COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/programs" "${PROJECT_SOURCE_DIR}" "${PROJECT_BINARY_DIR}"
      "${PROJECT_BINARY_DIR}/tests/docs/programs" "${CMAKE_C_COMPILER}" ${CMAKE_Fortran_COMPILER})
    spar_set_test(docs_programs docs 60)
    add_test(NAME docs_tutorial COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/tutorial" "${PROJECT_SOURCE_DIR}" "${PROJECT_BINARY_DIR}"
      "${PROJECT_BINARY_DIR}/tests/docs/tutorial" "${CMAKE_C_COMPILER}")
    spar_set_test(docs_tutorial docs 60)
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
if(SPAR_BUILD_BENCHMARKS AND SPAR_BUILD_EXAMPLES)
  add_test(NAME docs_summary COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/summary" "${PROJECT_SOURCE_DIR}" "${PROJECT_BINARY_DIR}")
  spar_set_test(docs_summary docs 300)
endif()
add_test(NAME docs_verification COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/verification" "${PROJECT_BINARY_DIR}")
spar_set_test(docs_verification docs 60)
file(GLOB files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/verification/*.c")
list(TRANSFORM files REPLACE ".*/(.*)\\.c" "\\1")
set_tests_properties(docs_verification PROPERTIES DEPENDS "${files}" SKIP_RETURN_CODE 77) # 77: none has run
