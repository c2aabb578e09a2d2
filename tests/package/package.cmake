# An installed copy, seen by strangers; and the binary interface.
set(prefix "${PROJECT_BINARY_DIR}/tests/package/prefix")
set(work "${PROJECT_BINARY_DIR}/tests/package")
set(here "${PROJECT_SOURCE_DIR}/tests/package")

# spar_package_test(<name> <command>...): run after the install
function(spar_package_test name)
  add_test(NAME package_${name} COMMAND ${ARGN})
  spar_set_test(package_${name} package 180)
  set_tests_properties(package_${name} PROPERTIES FIXTURES_REQUIRED spar_installed)
endfunction()

add_test(NAME package_install COMMAND "${CMAKE_COMMAND}" --install "${PROJECT_BINARY_DIR}" --prefix "${prefix}")
spar_set_test(package_install package 60)
set_tests_properties(package_install PROPERTIES FIXTURES_SETUP spar_installed)

spar_package_test(symbols sh "${here}/symbols.sh" "${PROJECT_SOURCE_DIR}" "${prefix}/${CMAKE_INSTALL_LIBDIR}")
spar_package_test(soname sh "${here}/soname.sh" "${prefix}/${CMAKE_INSTALL_LIBDIR}/libspar.so" "${PROJECT_VERSION}"
  "${SPAR_SOVERSION}")
add_test(NAME package_versions COMMAND "${CMAKE_COMMAND}" "-DSOURCE=${PROJECT_SOURCE_DIR}" "-DWORK=${work}/versions" -P "${here}/versions.cmake")
spar_set_test(package_versions package 30)

# what hosts were compiled with is still there, and the check would see it go
find_program(SPAR_AWK awk)
mark_as_advanced(SPAR_AWK)
if(SPAR_AWK)
  spar_package_test(interface sh "${here}/interface" "${CMAKE_C_COMPILER}")
  add_test(NAME package_generated COMMAND sh "${here}/generated" "${work}/generated")
  spar_set_test(package_generated package 30)
  spar_package_test(interface_fails sh "${here}/interface_fails" "${CMAKE_C_COMPILER}" "${work}/interface")
endif()

# The builds of the whole library have the portable kernels alone (SPARI_PLAIN_LANES), whose vectors are not what is looked at.
# the same symbols with nothing but GSL: no MPI, no OpenBLAS (the short form of tests/configurations). It has debug information, so
# the binary interface is compared here, where there are abidiff and gcc's view of the types.
if(SPAR_GSL)
  spar_package_test(without_mpi "${CMAKE_CTEST_COMMAND}" --build-and-test "${PROJECT_SOURCE_DIR}" "${work}/without_mpi"
    --build-generator "${CMAKE_GENERATOR}" --build-target spar --build-options -DSPAR_MPI=OFF -DSPAR_FORTRAN=OFF -DSPAR_OPENBLAS=OFF
    -DSPAR_BUILD_TESTS=OFF -DSPAR_BUILD_EXAMPLES=OFF -DSPAR_BUILD_BENCHMARKS=OFF -DCMAKE_BUILD_TYPE=Debug
    "-DCMAKE_C_FLAGS=-O0 -g -DSPARI_PLAIN_LANES=2"
    --test-command sh "${here}/symbols.sh" "${PROJECT_SOURCE_DIR}" "${work}/without_mpi")
  set_tests_properties(package_without_mpi PROPERTIES PROCESSORS 2 TIMEOUT 600)
  if(CMAKE_C_COMPILER_ID STREQUAL "GNU" AND CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64" AND NOT CMAKE_C_FLAGS_DEBUG MATCHES "sanitize")
    spar_package_test(abi sh "${here}/abi" "${work}/without_mpi/libspar.so")
    spar_package_test(abi_fails sh "${here}/abi_fails" "${CMAKE_C_COMPILER}" "${work}/without_mpi" "${work}/abi")
    set_tests_properties(package_abi package_abi_fails PROPERTIES SKIP_RETURN_CODE 77 DEPENDS package_without_mpi)
  endif()
endif()

# the same symbols with LAPACK in place of GSL, of which nothing is left; a program solves eigenvalue problems with it
if(SPAR_GSL AND SPAR_LAPACK AND NOT CMAKE_C_FLAGS_DEBUG MATCHES "sanitize")
  spar_package_test(without_gsl "${CMAKE_CTEST_COMMAND}" --build-and-test "${PROJECT_SOURCE_DIR}" "${work}/without_gsl"
    --build-generator "${CMAKE_GENERATOR}" --build-target spar --build-options -DSPAR_GSL=OFF -DSPAR_MPI=OFF -DSPAR_FORTRAN=OFF
    -DSPAR_BUILD_TESTS=OFF -DSPAR_BUILD_EXAMPLES=OFF -DSPAR_BUILD_BENCHMARKS=OFF -DCMAKE_BUILD_TYPE=Debug
    "-DCMAKE_C_FLAGS=-O0 -g0 -DSPARI_PLAIN_LANES=2"
    --test-command sh "${here}/without_gsl.sh" "${work}/without_gsl" "${work}/without_gsl_program" "${CMAKE_C_COMPILER}")
  set_tests_properties(package_without_gsl PROPERTIES PROCESSORS 2 TIMEOUT 600)
endif()

# spar as a part of another project (FetchContent), whose installed program runs without the build folder
add_test(NAME package_subproject COMMAND sh "${here}/subproject" "${PROJECT_SOURCE_DIR}" "${work}/subproject" -G "${CMAKE_GENERATOR}"
  "-DCMAKE_C_COMPILER=${CMAKE_C_COMPILER}" "-DCMAKE_C_COMPILER_LAUNCHER=${CMAKE_C_COMPILER_LAUNCHER}" -DSPAR_MPI=OFF -DSPAR_FORTRAN=OFF)
spar_set_test(package_subproject package 600)
set_tests_properties(package_subproject PROPERTIES PROCESSORS 2)

# a 32-bit target is refused (this configures without the C library for 32 bits)
if(CMAKE_C_COMPILER_ID STREQUAL "GNU" AND CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  add_test(NAME package_32_bits COMMAND "${CMAKE_COMMAND}" -S "${PROJECT_SOURCE_DIR}" -B "${work}/32_bits" -G "${CMAKE_GENERATOR}"
    "-DCMAKE_C_COMPILER=${CMAKE_C_COMPILER}" -DCMAKE_C_FLAGS=-m32 -DCMAKE_TRY_COMPILE_TARGET_TYPE=STATIC_LIBRARY)
  spar_set_test(package_32_bits package 60)
  set_tests_properties(package_32_bits PROPERTIES PASS_REGULAR_EXPRESSION "spar needs a 64-bit target,")
endif()

add_test(NAME package_recipes COMMAND sh "${here}/recipes" "${PROJECT_SOURCE_DIR}" "${PROJECT_VERSION}")
spar_set_test(package_recipes package 30)

function(spar_consumer name folder)
  spar_package_test(${name} "${CMAKE_CTEST_COMMAND}" --build-and-test "${here}/${folder}" "${work}/${name}"
    --build-generator "${CMAKE_GENERATOR}" --build-options "-DCMAKE_PREFIX_PATH=${prefix}" ${ARGN}
    --test-command "${CMAKE_CTEST_COMMAND}" --output-on-failure --no-tests=error)
endfunction()

spar_consumer(c_cmake c)
spar_consumer(aero_cmake aero)
find_program(SPAR_PKG_CONFIG NAMES pkg-config)
mark_as_advanced(SPAR_PKG_CONFIG)
if(SPAR_PKG_CONFIG)
  spar_package_test(c_pkgconfig sh "${here}/pkgconfig.sh" "${prefix}" "${work}/c_pkgconfig" "${CMAKE_C_COMPILER}"
    "${here}/c/main.c" spar)
  spar_package_test(aero_pkgconfig sh "${here}/pkgconfig.sh" "${prefix}" "${work}/aero_pkgconfig" "${CMAKE_C_COMPILER}"
    "${here}/aero/main.c" spar_aero)
  spar_package_test(aero_pkgconfig_static sh "${here}/pkgconfig.sh" "${prefix}" "${work}/aero_pkgconfig_static" "${CMAKE_C_COMPILER}"
    "${here}/aero/main.c" spar_aero --static)
  spar_package_test(c_pkgconfig_static sh "${here}/pkgconfig.sh" "${prefix}" "${work}/c_pkgconfig_static"
    "${CMAKE_C_COMPILER}" "${here}/c/main.c" spar --static)
endif()

if(SPAR_OPENBLAS_FOLDER AND EXISTS "${SPAR_OPENBLAS_FOLDER}/libopenblas.so.0" AND NOT CMAKE_C_FLAGS_DEBUG MATCHES "sanitize")
  spar_package_test(openblas sh "${here}/openblas.sh" "${prefix}" "${work}/openblas" "${CMAKE_C_COMPILER}" "${SPAR_OPENBLAS_FOLDER}")
endif()

if(TARGET spar_fortran AND EXISTS "${here}/fortran/main.f90")
  spar_consumer(fortran_cmake fortran)
  if(CMAKE_Fortran_COMPILER_ID MATCHES "GNU|LLVMFlang") # a host whose integers and logicals have 8 bytes
    spar_consumer(fortran_integer8 fortran -DCMAKE_Fortran_FLAGS=-fdefault-integer-8)
  endif()
  if(SPAR_PKG_CONFIG)
    spar_package_test(fortran_pkgconfig sh "${here}/pkgconfig.sh" "${prefix}" "${work}/fortran_pkgconfig"
      "${CMAKE_Fortran_COMPILER}" "${here}/fortran/main.f90" spar_fortran)
  endif()
endif()

check_language(CXX)
set(spar_cxx)
if(NOT CMAKE_C_FLAGS_DEBUG MATCHES "sanitize")
  set(spar_cxx ${CMAKE_CXX_COMPILER})
endif()
spar_package_test(components sh "${here}/components" "${prefix}" "${work}/components" "${SPAR_MPI}" "${SPAR_FORTRAN}" ${spar_cxx})

find_program(SPAR_DPKG_SHLIBDEPS dpkg-shlibdeps)
find_program(SPAR_FILE file) # CPack asks it what is a library
mark_as_advanced(SPAR_DPKG_SHLIBDEPS SPAR_FILE)
if(SPAR_DPKG_SHLIBDEPS AND SPAR_FILE AND SPAR_PKG_CONFIG)
  spar_package_test(deb sh "${here}/deb.sh" "${PROJECT_SOURCE_DIR}" "${PROJECT_BINARY_DIR}" "${work}/deb" "${CMAKE_CPACK_COMMAND}"
    "${CMAKE_C_COMPILER}" "${PROJECT_VERSION}" "${SPAR_SOVERSION}" "${SPAR_AERO_SOVERSION}")
endif()

set(mpi_flags)
if(SPAR_MPI)
  list(TRANSFORM MPI_C_INCLUDE_DIRS PREPEND -isystem OUTPUT_VARIABLE mpi_flags)
  list(APPEND mpi_flags -DSPAR_TEST_MPI -DOMPI_SKIP_MPICXX -DMPICH_SKIP_MPICXX ${MPI_C_LIBRARIES})
endif()
if(NOT CMAKE_C_FLAGS_DEBUG MATCHES "sanitize")
  set(spar_alone "-;-")
  if(TARGET spar_fortran)
    set(spar_alone "${CMAKE_Fortran_COMPILER};${prefix}/${SPAR_FORTRAN_MODULE_DIR}")
  endif()
  spar_package_test(headers sh "${here}/headers" "${prefix}" "${prefix}/${CMAKE_INSTALL_LIBDIR}" "${work}/headers" "${CMAKE_C_COMPILER}"
    "$<IF:$<BOOL:${CMAKE_CXX_COMPILER}>,${CMAKE_CXX_COMPILER},->" ${spar_alone} ${mpi_flags})
endif()
if(CMAKE_CXX_COMPILER)
  spar_package_test(cxx "${CMAKE_CXX_COMPILER}" -std=c++11 -Wall -Wextra -Wpedantic -Wconversion -Werror
    "-I${prefix}/${CMAKE_INSTALL_INCLUDEDIR}" "${here}/headers.cpp" -o "${work}/headers_cxx"
    "-L${prefix}/${CMAKE_INSTALL_LIBDIR}" "-Wl,-rpath,${prefix}/${CMAKE_INSTALL_LIBDIR}" -lspar_aero -lspar ${mpi_flags})
  if(TARGET spar_example_parts AND TARGET spar_host_parts AND NOT CMAKE_C_FLAGS_DEBUG MATCHES "sanitize")
    add_dependencies(test_case spar_example_parts spar_host_parts)
    spar_package_test(cxx_examples sh "${here}/cxx_examples" "${PROJECT_SOURCE_DIR}" "${work}/cxx_examples" "${CMAKE_CXX_COMPILER}"
      "$<TARGET_FILE:spar_example_parts>" "$<TARGET_FILE:spar_host_parts>" "-L${prefix}/${CMAKE_INSTALL_LIBDIR}"
      "-Wl,-rpath,${prefix}/${CMAKE_INSTALL_LIBDIR}" -lspar_aero -lspar -lm)
  endif()
endif()
