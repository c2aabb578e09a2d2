# What is installed: libraries, headers, the CMake package, the pkg-config files, the Fortran modules (by compiler) and their
# source (for any other compiler), Python's module, the documents. Three components, which are Debian's three packages: `cpack` writes them.
include(CMakePackageConfigHelpers)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME development)
set(spar_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/spar")

install(TARGETS spar EXPORT spar-targets LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}"
  COMPONENT runtime NAMELINK_COMPONENT development)
install(TARGETS spar_static EXPORT spar-static-targets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
install(FILES ${spar_headers} DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/spar")
install(EXPORT spar-targets NAMESPACE spar:: DESTINATION "${spar_package_dir}")
install(EXPORT spar-static-targets NAMESPACE spar:: DESTINATION "${spar_package_dir}")
install(FILES cmake/spar-dependencies.cmake DESTINATION "${spar_package_dir}")

if(TARGET spar_fortran)
  install(TARGETS spar_fortran EXPORT spar-fortran-targets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
  install(EXPORT spar-fortran-targets NAMESPACE spar:: DESTINATION "${spar_package_dir}")
  install(DIRECTORY "${PROJECT_BINARY_DIR}/fortran/${spar_fortran_tag}/" DESTINATION "${SPAR_FORTRAN_MODULE_DIR}"
    FILES_MATCHING PATTERN "*.mod")
  set(spar_fortran_files)
  foreach(file IN LISTS spar_fortran_sources)
    get_filename_component(name "${file}" NAME)
    list(APPEND spar_fortran_files "${name}")
  endforeach()
endif()
install(FILES ${spar_fortran_sources} DESTINATION "${CMAKE_INSTALL_DATADIR}/spar/fortran")
install(FILES "${PROJECT_SOURCE_DIR}/examples/python/spar.py" DESTINATION "${CMAKE_INSTALL_DATADIR}/spar/python")

configure_package_config_file(cmake/spar-config.cmake.in "${PROJECT_BINARY_DIR}/spar-config.cmake"
  INSTALL_DESTINATION "${spar_package_dir}" PATH_VARS CMAKE_INSTALL_DATADIR CMAKE_INSTALL_LIBDIR)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/spar-config-version.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/spar-config.cmake" "${PROJECT_BINARY_DIR}/spar-config-version.cmake"
  DESTINATION "${spar_package_dir}")

# pkg-config; the files find the prefix from where they lie
file(RELATIVE_PATH spar_up "/p/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/p")
string(REGEX REPLACE "/$" "" spar_up "${spar_up}")
set(spar_private_libs "-lm -pthread")
if(SPAR_OPENBLAS)
  string(PREPEND spar_private_libs "-lopenblas ")
  if(SPAR_OPENBLAS_FOLDER)
    string(PREPEND spar_private_libs "-L${SPAR_OPENBLAS_FOLDER} -Wl,-rpath,${SPAR_OPENBLAS_FOLDER} ")
  endif()
endif()
set(spar_private_packages "gsl")
if(SPAR_MPI) # the libraries themselves: each MPI has another name for its package
  list(JOIN MPI_C_LIBRARIES " " spar_mpi_libs)
  string(PREPEND spar_private_libs "${spar_mpi_libs} ")
endif()
configure_file(cmake/spar.pc.in "${PROJECT_BINARY_DIR}/spar.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/spar.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
if(TARGET spar_fortran)
  configure_file(cmake/spar_fortran.pc.in "${PROJECT_BINARY_DIR}/spar_fortran.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/spar_fortran.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
endif()

install(FILES README.md CHANGELOG.md CONTRIBUTING.md CITATION.cff LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT documentation)
install(DIRECTORY docs DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT documentation)
# the book, if the target of that name was built
install(DIRECTORY "${PROJECT_BINARY_DIR}/book/html" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT documentation OPTIONAL)

# ---------------------------------------------------------------- Debian packages
set(spar_deb_runtime libspar${SPAR_SOVERSION})
set(spar_deb_development libspar-dev)
set(spar_deb_documentation spar-doc)
foreach(component IN ITEMS runtime development documentation)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${spar_deb_${component}})
  # where Debian wants the licence; not in an installation as a whole
  install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${spar_deb_${component}}" RENAME copyright
    COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL runtime development documentation)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_NAME spar)
set(CPACK_PACKAGE_CONTACT "The spar authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "The shared library.")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Headers, the static library, the Fortran modules and their source, CMake package and pkg-config files.")
set(CPACK_COMPONENT_DOCUMENTATION_DESCRIPTION "The documents.")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON) # needs dpkg-dev and file
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${spar_deb_runtime} (= ${PROJECT_VERSION}), libgsl-dev")
if(SPAR_OPENBLAS_FOLDER MATCHES "openblas-serial")
  set(CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS libopenblas0-serial)
  string(APPEND CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ", libopenblas-serial-dev")
endif()
if(PROJECT_IS_TOP_LEVEL)
  include(CPack)
endif()
