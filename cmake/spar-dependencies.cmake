# Target spar::gsl: GSL with a fast CBLAS under it. Sets SPAR_CBLAS_LIBRARY, SPAR_OPENBLAS and SPAR_OPENBLAS_FOLDER (empty where
# the loader looks anyway). Used by the build and, for the static library, by the installed package.
find_package(GSL REQUIRED)

# The one-thread build of OpenBLAS first: the members are small, and the host owns the threads.
find_library(SPAR_OPENBLAS_LIBRARY NAMES openblas PATH_SUFFIXES openblas-serial)
mark_as_advanced(SPAR_OPENBLAS_LIBRARY)
set(SPAR_OPENBLAS_FOLDER)

if(SPAR_OPENBLAS_LIBRARY AND (SPAR_OPENBLAS OR NOT DEFINED SPAR_OPENBLAS))
  set(SPAR_OPENBLAS ON)
  get_filename_component(SPAR_OPENBLAS_FOLDER "${SPAR_OPENBLAS_LIBRARY}" DIRECTORY)
  if(SPAR_OPENBLAS_FOLDER IN_LIST CMAKE_C_IMPLICIT_LINK_DIRECTORIES OR SPAR_OPENBLAS_FOLDER IN_LIST CMAKE_CXX_IMPLICIT_LINK_DIRECTORIES)
    set(SPAR_OPENBLAS_FOLDER)
  endif()
  set(SPAR_CBLAS_LIBRARY "${SPAR_OPENBLAS_LIBRARY}")
else()
  set(SPAR_OPENBLAS OFF)
  set(SPAR_CBLAS_LIBRARY "${GSL_CBLAS_LIBRARY}")
endif()

if(NOT TARGET spar::gsl)
  add_library(spar::gsl INTERFACE IMPORTED)
  target_include_directories(spar::gsl SYSTEM INTERFACE ${GSL_INCLUDE_DIRS})
  target_link_libraries(spar::gsl INTERFACE "${GSL_LIBRARY}" "${SPAR_CBLAS_LIBRARY}" m)
  if(SPAR_OPENBLAS_FOLDER) # also for the installed programs of a host that links the static library
    target_link_options(spar::gsl INTERFACE "LINKER:-rpath,${SPAR_OPENBLAS_FOLDER}")
  endif()
endif()
