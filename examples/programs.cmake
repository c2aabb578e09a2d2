# The rotor's sources once more: what effects are worth in its scene.
if(TARGET examples_rotor)
  add_executable(examples_spar-effects "${PROJECT_SOURCE_DIR}/examples/rotor.c")
  set_target_properties(examples_spar-effects PROPERTIES OUTPUT_NAME spar-effects
    RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/examples")
  target_compile_definitions(examples_spar-effects PRIVATE ROTOR_SHOWS_EFFECTS=1
    SPAR_DATA_DIR="${PROJECT_SOURCE_DIR}/examples/data" $<$<BOOL:${SPAR_MPI}>:SPAR_WITH_MPI=1>)
  target_link_libraries(examples_spar-effects PRIVATE spar_flags spar_example_parts spar_aero spar m $<$<BOOL:${SPAR_MPI}>:MPI::MPI_C>)
endif()

# The same host in single precision.
if(TARGET examples_aerodyn_style)
  add_executable(examples_aerodyn_style_single "${PROJECT_SOURCE_DIR}/examples/aerodyn_style.f90")
  get_target_property(spar_parts_of_host examples_aerodyn_style SOURCES)
  set_target_properties(examples_aerodyn_style_single PROPERTIES OUTPUT_NAME aerodyn_style_single SOURCES "${spar_parts_of_host}"
    RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/examples"
    Fortran_MODULE_DIRECTORY "${PROJECT_BINARY_DIR}/examples/modules_aerodyn_style_single")
  foreach(property IN ITEMS COMPILE_DEFINITIONS COMPILE_OPTIONS LINK_LIBRARIES)
    get_target_property(value examples_aerodyn_style ${property})
    set_target_properties(examples_aerodyn_style_single PROPERTIES ${property} "${value}")
  endforeach()
  target_compile_definitions(examples_aerodyn_style_single PRIVATE SPAR_EXAMPLE_SINGLE=1)
endif()

# Open MPI unloads its parts before it ends: the leak checker cannot tell any more what they left.
if(SPAR_MPI)
  set(spar_example_environment ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=0)
endif()

# spar-run, which is installed: what a case file describes, without a flow solver.
file(GLOB files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/examples/spar-run/*.c")
add_executable(spar-run ${files})
set_target_properties(spar-run PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/examples"
  INSTALL_RPATH "$<$<PLATFORM_ID:Linux>:$ORIGIN/../${CMAKE_INSTALL_LIBDIR}>")
target_link_libraries(spar-run PRIVATE spar_flags spar_host_parts spar_aero spar m)
if(SPAR_INSTALL)
  install(TARGETS spar-run RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT development)
endif()

# Adapters to hosts: each folder's programs and their tests.
file(GLOB files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/examples/hosts/*/host.cmake")
foreach(file IN LISTS files)
  get_filename_component(SPAR_HOST_DIR "${file}" DIRECTORY)
  include("${file}")
endforeach()

# The examples as tests: what they print must be what it should.
if(NOT SPAR_BUILD_TESTS)
  return()
endif()

# tests/examples/test_rotor.c runs the rotor as a user does, alone and on several ranks.
if(TARGET test_rotor AND TARGET examples_rotor)
  add_dependencies(test_rotor examples_rotor)
  add_dependencies(test_rotor examples_spar-effects)
  target_compile_definitions(test_rotor PRIVATE ROTOR_PROGRAM="$<TARGET_FILE:examples_rotor>"
    EFFECTS_PROGRAM="$<TARGET_FILE:examples_spar-effects>")
  if(SPAR_MPI)
    target_compile_definitions(test_rotor PRIVATE ROTOR_LAUNCHER="${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG}")
  endif()
endif()

if(TARGET test_rotor)
  spar_set_test(test_rotor unit 300 ${spar_example_environment})
endif()

if(TARGET test_turbine AND TARGET examples_turbine)
  add_dependencies(test_turbine examples_turbine)
  target_compile_definitions(test_turbine PRIVATE TURBINE_PROGRAM="$<TARGET_FILE:examples_turbine>")
  if(SPAR_MPI)
    target_compile_definitions(test_turbine PRIVATE TURBINE_LAUNCHER="${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG}")
  endif()
  spar_set_test(test_turbine unit 300 ${spar_example_environment})
endif()

add_test(NAME example_spar_run COMMAND sh "${PROJECT_SOURCE_DIR}/tests/examples/spar_run" $<TARGET_FILE:spar-run>
  "${PROJECT_SOURCE_DIR}/examples/spar-run/cases" "${PROJECT_BINARY_DIR}/tests/spar_run")
spar_set_test(example_spar_run unit 60 ${spar_example_environment})

# Libraries opened at run time: the published controller behind Bladed's interface, lines behind MoorDyn's, and one
# without either.
if(UNIX AND NOT CMAKE_C_FLAGS MATCHES "sanitize")
  add_library(spar_test_discon MODULE "${PROJECT_SOURCE_DIR}/tests/examples/discon.c" "${PROJECT_SOURCE_DIR}/examples/turbine_control.c")
  add_library(spar_test_other MODULE "${PROJECT_SOURCE_DIR}/examples/turbine_control.c")
  add_library(spar_test_moordyn MODULE "${PROJECT_SOURCE_DIR}/tests/examples/moordyn.c")
  foreach(library IN ITEMS spar_test_discon spar_test_moordyn spar_test_other)
    target_include_directories(${library} PRIVATE "${PROJECT_SOURCE_DIR}/examples")
    target_link_libraries(${library} PRIVATE spar_flags m)
    set_target_properties(${library} PROPERTIES LIBRARY_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  endforeach()
  add_test(NAME example_turbine_controller COMMAND sh "${PROJECT_SOURCE_DIR}/tests/examples/controller" $<TARGET_FILE:examples_turbine>
    $<TARGET_FILE:spar_test_discon> $<TARGET_FILE:spar_test_other> "${PROJECT_BINARY_DIR}/tests/controller")
  spar_set_test(example_turbine_controller unit 120 ${spar_example_environment})
  add_test(NAME example_floating_moordyn COMMAND sh "${PROJECT_SOURCE_DIR}/tests/examples/moorings" $<TARGET_FILE:examples_floating>
    $<TARGET_FILE:spar_test_moordyn> $<TARGET_FILE:spar_test_other> "${PROJECT_BINARY_DIR}/tests/moorings")
  spar_set_test(example_floating_moordyn stability 120 ${spar_example_environment})
endif()

# A host whose dt follows a CFL condition finds what even steps find.
add_test(NAME example_cfl COMMAND examples_cfl)
spar_set_test(example_cfl stability 120 ${spar_example_environment})
set_tests_properties(example_cfl PROPERTIES PASS_REGULAR_EXPRESSION
  "force of the hinge +CFL [0-9.]+e-0[23], even [0-9.]+e-0[23].*hinge: CFL 337\\.[0-9] N, even 337\\.[0-9] N, shorter 337")

# The sprung cylinder locks in at a reduced speed of 5 to 6; the floating body heaves on its water line, 8e6 kg on 5.05e5 N/m
# (25.0 s), a little stiffer by its moorings.
add_test(NAME example_sprung_cylinder COMMAND examples_sprung_cylinder)
spar_set_test(example_sprung_cylinder stability 120 ${spar_example_environment})
set_tests_properties(example_sprung_cylinder PROPERTIES PASS_REGULAR_EXPRESSION "5\\.5    0\\.217")
add_test(NAME example_floating COMMAND examples_floating)
spar_set_test(example_floating stability 120 ${spar_example_environment})
set_tests_properties(example_floating PROPERTIES PASS_REGULAR_EXPRESSION "heave .* 24\\.2. s")

# A gust of 50 m/s on the rotor when it stands still: the run ends, each step converged.
add_test(NAME example_rotor_gust
  COMMAND examples_rotor --rpm 0 --wind 15 --gust 35 --gust-start 1 --gust-length 10 --seconds 14 --coupling iqn --vtk-every 0
          --no-plots --quiet --out ${PROJECT_BINARY_DIR}/tests/rotor_gust)
spar_set_test(example_rotor_gust stability 120 ${spar_example_environment})

# The figures that docs/examples/rotor.md quotes (unoptimised and sanitized it takes minutes).
if(CMAKE_BUILD_TYPE STREQUAL "Release" AND SPAR_AWK)
  add_test(NAME docs_rotor COMMAND sh "${PROJECT_SOURCE_DIR}/tests/docs/rotor" $<TARGET_FILE:examples_rotor>
    "${PROJECT_BINARY_DIR}/tests/docs-rotor")
  spar_set_test(docs_rotor docs 300 ${spar_example_environment})
endif()

# At a hundred times the mass explicit coupling and fixed point must fail, the others must get the exact motion to 0.4 %
# (backward Euler in 200 steps).
add_test(NAME example_piston COMMAND examples_piston)
spar_set_test(example_piston unit 60 ${spar_example_environment})
set_tests_properties(example_piston PROPERTIES
  PASS_REGULAR_EXPRESSION "100 +diverges +no convergence +[0-9.]+ +0[.]3[0-9]% +[0-9.]+ +0[.]3[0-9]%")

# The disc that the host integrates moves as one body with both masses, to what the tolerance 1e-8 of the loads leaves in
# 400 steps: below 1e-6 of the amplitude at a hundred times its mass.
add_test(NAME example_external COMMAND examples_external)
spar_set_test(example_external unit 60 ${spar_example_environment})
set_tests_properties(example_external PROPERTIES PASS_REGULAR_EXPRESSION " 100 +[1-3][.][0-9]+ +[0-9.]+e-(0[789]|1[0-9])")

# The twist at rest is that of strip theory, 0.100996 deg, to 1e-3, at the end of the run and by the static solution; on ranks the
# same.
add_test(NAME example_wing COMMAND examples_wing)
set(spar_wing_tests example_wing)
if(SPAR_MPI)
  add_test(NAME example_wing_np3 COMMAND ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} 3 $<TARGET_FILE:examples_wing>)
  list(APPEND spar_wing_tests example_wing_np3)
endif()
foreach(name IN LISTS spar_wing_tests)
  spar_set_test(${name} unit 60 ${spar_example_environment})
  set_tests_properties(${name} PROPERTIES PASS_REGULAR_EXPRESSION
    " 4[.]00 +0[.]01139[0-9]* +0[.]10(09|10)[^=]*equilibrium[^=]* 4[.]00 +0[.]01139[0-9]* +0[.]10(09|10)")
endforeach()

# A host cut into pieces prints the same on any number of ranks, with sums that do not depend on who adds them.
if(SPAR_MPI)
  add_test(NAME example_mpi_host COMMAND "${PROJECT_SOURCE_DIR}/tests/alike" "${PROJECT_BINARY_DIR}/tests/mpi_host"
    $<TARGET_FILE:examples_mpi_host> 1 2 4 -- ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG})
  spar_set_test(example_mpi_host mpi 120 ${spar_example_environment})
endif()

# The Fortran hosts, with momentum theory of their own, give the numbers of the C program to 1e-10, on any number of ranks; the one
# in single precision, its coupling iterated to 1e-5 of the loads, to 1e-4: 7 digits in each section's load and in its motion.
if(TARGET examples_rotor_fortran)
  set(run --wind 11 --gust 4 --gust-start 0 --gust-length 0.4 --seconds 0.3 --dt 0.01 --elements 1 --nodes 10
    --coupling-tolerance 1e-6 --iterations 20)
  add_test(NAME example_rotor_reference
    COMMAND examples_rotor ${run} --coupling fixed-point --predictor 1 --rho-inf 0.8 --newton 1e-12 --vtk-every 0 --no-plots --quiet
            --out ${PROJECT_BINARY_DIR}/tests/rotor_reference)
  list(APPEND run --compare ${PROJECT_BINARY_DIR}/tests/rotor_reference/history.csv)
  add_test(NAME example_rotor_fortran COMMAND examples_rotor_fortran ${run})
  spar_set_test(example_rotor_reference fortran 120 ${spar_example_environment})
  spar_set_test(example_rotor_fortran fortran 120 ${spar_example_environment})
  set(spar_rotor_tests example_rotor_fortran)
  if(TARGET MPI::MPI_Fortran)
    spar_add_ranks(examples_rotor_fortran fortran 120 ${run})
    list(APPEND spar_rotor_tests examples_rotor_fortran_np1 examples_rotor_fortran_np2 examples_rotor_fortran_np4)
    spar_add_ranks(examples_aerodyn_style fortran 120 ${run})
    list(APPEND spar_rotor_tests examples_aerodyn_style_np1 examples_aerodyn_style_np2 examples_aerodyn_style_np4)
  endif()
  add_test(NAME example_aerodyn_style COMMAND examples_aerodyn_style ${run})
  add_test(NAME example_aerodyn_style_single COMMAND examples_aerodyn_style_single ${run} --coupling-tolerance 1e-5 --allowed 1e-4)
  # the recipe at the top of aerodyn_style.f90
  add_test(NAME example_aerodyn_style_recipe COMMAND sh -c "out='${PROJECT_BINARY_DIR}/tests/aerodyn_style_recipe' && \
    '$<TARGET_FILE:examples_rotor>' --seconds 2 --newton 1e-12 --out \"$out\" --no-plots --quiet >/dev/null && \
    '$<TARGET_FILE:examples_aerodyn_style>' --seconds 2 --compare \"$out/history.csv\"")
  spar_set_test(example_aerodyn_style_recipe fortran 120 ${spar_example_environment})
  spar_set_test(example_aerodyn_style fortran 120 ${spar_example_environment})
  spar_set_test(example_aerodyn_style_single fortran 120 ${spar_example_environment})
  list(APPEND spar_rotor_tests example_aerodyn_style example_aerodyn_style_single)
  set_tests_properties(example_rotor_reference PROPERTIES FIXTURES_SETUP rotor_reference)
  set_tests_properties(${spar_rotor_tests} PROPERTIES FIXTURES_REQUIRED rotor_reference)
endif()

# The Fortran host of the turbine gives the numbers of the C program to 1e-8, in a gust in which the blades pitch.
if(TARGET examples_turbine_fortran)
  set(run --wind 12 --gust 4 --gust-start 0 --gust-length 2 --seconds 1 --dt 0.02 --nodes 6)
  add_test(NAME example_turbine_reference
    COMMAND examples_turbine ${run} --vtk-every 0 --no-plots --quiet --out ${PROJECT_BINARY_DIR}/tests/turbine_reference)
  add_test(NAME example_turbine_fortran
    COMMAND examples_turbine_fortran ${run} --compare ${PROJECT_BINARY_DIR}/tests/turbine_reference/history.csv)
  spar_set_test(example_turbine_reference fortran 120 ${spar_example_environment})
  spar_set_test(example_turbine_fortran fortran 120 ${spar_example_environment})
  set_tests_properties(example_turbine_reference PROPERTIES FIXTURES_SETUP turbine_reference)
  set_tests_properties(example_turbine_fortran PROPERTIES FIXTURES_REQUIRED turbine_reference)
endif()
