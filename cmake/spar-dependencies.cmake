# Target spar::gsl: GSL with a fast CBLAS under it. Sets SPAR_CBLAS_LIBRARY, SPAR_OPENBLAS and SPAR_LAPACK. Used by the build
# and, for the static library, by the installed package.
find_package(GSL REQUIRED)

# The one-thread build of OpenBLAS first: the members are small, and the host owns the threads.
find_library(SPAR_OPENBLAS_LIBRARY NAMES openblas PATH_SUFFIXES openblas-serial)
mark_as_advanced(SPAR_OPENBLAS_LIBRARY)

if(SPAR_OPENBLAS_LIBRARY)
  set(SPAR_OPENBLAS ON)
  set(SPAR_CBLAS_LIBRARY "${SPAR_OPENBLAS_LIBRARY}")
  include(CheckFunctionExists)
  set(CMAKE_REQUIRED_LIBRARIES "${SPAR_OPENBLAS_LIBRARY}")
  check_function_exists(dgetrf_ SPAR_OPENBLAS_HAS_LAPACK)
  unset(CMAKE_REQUIRED_LIBRARIES)
  if(SPAR_OPENBLAS_HAS_LAPACK)
    set(SPAR_LAPACK ON)
  else()
    set(SPAR_LAPACK OFF)
  endif()
else()
  set(SPAR_OPENBLAS OFF)
  set(SPAR_LAPACK OFF)
  set(SPAR_CBLAS_LIBRARY "${GSL_CBLAS_LIBRARY}")
endif()

if(NOT TARGET spar::gsl)
  add_library(spar::gsl INTERFACE IMPORTED)
  target_include_directories(spar::gsl SYSTEM INTERFACE ${GSL_INCLUDE_DIRS})
  target_link_libraries(spar::gsl INTERFACE "${GSL_LIBRARY}" "${SPAR_CBLAS_LIBRARY}" m)
endif()
