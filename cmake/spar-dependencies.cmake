# Target spar::algebra: what src/algebra calls, a fast CBLAS with GSL over it (SPAR_GSL) or with LAPACK. Sets SPAR_CBLAS_LIBRARY,
# SPAR_OPENBLAS and SPAR_OPENBLAS_FOLDER (empty where the loader looks anyway). Used by the build and, for the static library, by
# the installed package.
if(SPAR_GSL)
  find_package(GSL REQUIRED)
endif()

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
  if(SPAR_GSL)
    set(SPAR_CBLAS_LIBRARY "${GSL_CBLAS_LIBRARY}")
  else()
    find_library(SPAR_LAPACK_LIBRARY lapack)
    find_library(SPAR_BLAS_LIBRARY NAMES cblas blas)
    mark_as_advanced(SPAR_LAPACK_LIBRARY SPAR_BLAS_LIBRARY)
    if(NOT SPAR_LAPACK_LIBRARY OR NOT SPAR_BLAS_LIBRARY)
      message(FATAL_ERROR "spar without GSL (SPAR_GSL=OFF) needs LAPACK and a BLAS with CBLAS, and found none. Install OpenBLAS "
        "(Debian: libopenblas-serial-dev), or set SPAR_GSL=ON.")
    endif()
    set(SPAR_CBLAS_LIBRARY "${SPAR_LAPACK_LIBRARY}" "${SPAR_BLAS_LIBRARY}")
  endif()
endif()

if(NOT TARGET spar::algebra)
  add_library(spar::algebra INTERFACE IMPORTED)
  if(SPAR_GSL)
    target_include_directories(spar::algebra SYSTEM INTERFACE ${GSL_INCLUDE_DIRS})
    target_link_libraries(spar::algebra INTERFACE "${GSL_LIBRARY}")
  endif()
  target_link_libraries(spar::algebra INTERFACE ${SPAR_CBLAS_LIBRARY} m)
  if(SPAR_OPENBLAS_FOLDER) # also for the installed programs of a host that links the static library
    target_link_options(spar::algebra INTERFACE "LINKER:-rpath,${SPAR_OPENBLAS_FOLDER}")
  endif()
endif()
