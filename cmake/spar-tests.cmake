# The tests: every file is a program, found by name. tests/<room>/ has the tests of the room src/<room>, tests/examples
# those of examples. Labels: unit, mpi, fortran, verification, stability, package, count,
# torture, house, hosts.
find_package(PkgConfig QUIET)
if(NOT SPAR_CMOCKA_INCLUDE OR NOT SPAR_CMOCKA_LIBRARY)
  message(FATAL_ERROR "SPAR_BUILD_TESTS needs CMocka (Debian: libcmocka-dev); or set SPAR_BUILD_TESTS=OFF")
endif()

find_package(GSL REQUIRED) # tests compare with it, also where the library is free of it

# Open MPI as root, in a container, on fewer cores than ranks, without ssh.
set(spar_test_environment
  OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
  OMPI_MCA_hwloc_base_binding_policy=none OMPI_MCA_mpi_yield_when_idle=1 OMPI_MCA_plm_rsh_agent=true
  OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_MCA_btl=self,vader
  OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
  ASAN_OPTIONS=allocator_may_return_null=1 UBSAN_OPTIONS=print_stacktrace=1)

# What tests share: tests/support/*.c, and any header under tests/ or src/.
add_library(spar_test_base INTERFACE)
target_include_directories(spar_test_base INTERFACE "${PROJECT_SOURCE_DIR}/src" "${PROJECT_SOURCE_DIR}/tests" "${PROJECT_SOURCE_DIR}/examples")
target_include_directories(spar_test_base SYSTEM INTERFACE "${SPAR_CMOCKA_INCLUDE}")
target_compile_definitions(spar_test_base INTERFACE
  SPAR_TEST_VERSION="${PROJECT_VERSION}" SPAR_SOURCE_DIR="${PROJECT_SOURCE_DIR}" SPAR_DATA_DIR="${PROJECT_SOURCE_DIR}/examples/data"
  $<$<BOOL:${SPAR_MPI}>:SPARI_HAVE_MPI=1>)
# cmocka.h wants these before it, and the formatter sorts includes
target_compile_options(spar_test_base INTERFACE
  "$<$<COMPILE_LANGUAGE:C>:SHELL:-include stdarg.h -include stddef.h -include stdint.h -include setjmp.h>")
target_link_libraries(spar_test_base INTERFACE spar_flags "${SPAR_CMOCKA_LIBRARY}" spar::algebra "${GSL_LIBRARY}")
target_include_directories(spar_test_base SYSTEM INTERFACE ${GSL_INCLUDE_DIRS})
file(GLOB spar_support CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/support/*.c")
if(spar_support)
  add_library(spar_test_support STATIC ${spar_support})
  target_link_libraries(spar_test_support PUBLIC spar_test_base spar_aero_static spar_static)
  set(spar_test_libraries spar_test_support)
endif()
# The static library: tests may call what the shared one hides. The examples' parts call it too, so stand before it.
list(APPEND spar_test_libraries $<TARGET_NAME_IF_EXISTS:spar_example_parts> $<TARGET_NAME_IF_EXISTS:spar_host_parts>
  spar_aero_static spar_static spar_test_base)

set(SPAR_TEST_LAUNCHER "" CACHE STRING "Program (a list) that runs the serial tests, such as valgrind")
mark_as_advanced(SPAR_TEST_LAUNCHER)

set(SPAR_TEST_TIME_FACTOR 1 CACHE STRING "What the tests' time limits are multiplied with")
mark_as_advanced(SPAR_TEST_TIME_FACTOR)

# What a test may take is processor time (tests/limit): at least four times what it takes alone. By the clock it may take
# eight times as long, so that a busy machine fails no test and one that waits for nothing still ends.
function(spar_limit_of variable seconds)
  math(EXPR seconds "${seconds} * ${SPAR_TEST_TIME_FACTOR}")
  set(${variable} sh "${PROJECT_SOURCE_DIR}/tests/limit" ${seconds} PARENT_SCOPE)
endfunction()

function(spar_set_test name label timeout)
  math(EXPR timeout "8 * ${timeout} * ${SPAR_TEST_TIME_FACTOR}")
  set_tests_properties(${name} PROPERTIES LABELS "${label}" TIMEOUT ${timeout} ENVIRONMENT "${spar_test_environment};${ARGN}")
endfunction()

# spar_add_test(<file> <label> <timeout>): one program, run as it is
function(spar_add_test file label timeout)
  get_filename_component(name "${file}" NAME_WE)
  add_executable(${name} "${file}")
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  target_link_libraries(${name} PRIVATE ${spar_test_libraries})
  spar_limit_of(limit ${timeout})
  add_test(NAME ${name} COMMAND ${limit} ${SPAR_TEST_LAUNCHER} $<TARGET_FILE:${name}> WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  spar_set_test(${name} ${label} ${timeout})
endfunction()

# spar_add_ranks(<target> <label> <timeout> [arguments]): the program of a target under 1, 2 and 4 ranks; where sums
# have to have the same bits, and for files, under 3 and 7 too
function(spar_add_ranks target label timeout)
  set(counts 1 2 4)
  if(target MATCHES "_(sums|save)$")
    set(counts 1 2 3 4 7)
  endif()
  spar_limit_of(limit ${timeout})
  foreach(ranks IN LISTS counts)
    add_test(NAME ${target}_np${ranks}
      COMMAND ${limit} ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} ${ranks}
              $<TARGET_FILE:${target}> ${ARGN}
      WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
    # Open MPI unloads its parts before it ends: the leak checker cannot tell any more what they left.
    spar_set_test(${target}_np${ranks} ${label} ${timeout} ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=0)
    if(ranks GREATER 1) # ranks wait for each other's turns on a busy machine, and spin, so that the limit ends a deadlock
      math(EXPR patience "30 * ${timeout} * ${SPAR_TEST_TIME_FACTOR}")
      set_tests_properties(${target}_np${ranks} PROPERTIES PROCESSORS 2 TIMEOUT ${patience})
    endif()
  endforeach()
endfunction()

file(GLOB files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/*/test_*.c")
foreach(file IN LISTS files)
  spar_add_test("${file}" unit 120)
endforeach()
# These tests bring kernels of their own. -O3 takes gcc minutes for them; contractions are off, so -O1 gives the same bits.
foreach(test IN ITEMS transfer body nodes linear)
  foreach(lanes IN ITEMS scalar wide)
    target_compile_options(test_${test}_${lanes} PRIVATE ${spar_kernel_flags} $<$<AND:$<C_COMPILER_ID:GNU,Clang,AppleClang>,$<CONFIG:Release>>:-O1>)
  endforeach()
endforeach()
foreach(test IN ITEMS test_advice test_newton_scenes test_pace)
  target_sources(${test} PRIVATE "${PROJECT_SOURCE_DIR}/benchmarks/scenes.c")
  target_include_directories(${test} PRIVATE "${PROJECT_SOURCE_DIR}/benchmarks")
endforeach()
foreach(test IN ITEMS test_advice_findings test_error_scenes)
  target_sources(${test} PRIVATE "${PROJECT_SOURCE_DIR}/benchmarks/worlds.c")
  target_include_directories(${test} PRIVATE "${PROJECT_SOURCE_DIR}/benchmarks")
endforeach()
foreach(kind IN ITEMS verification stability)
  file(GLOB files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/${kind}/*.c")
  list(FILTER files EXCLUDE REGEX "/(test|mpi)_[^/]*$") # the tests of the room of that name
  foreach(file IN LISTS files)
    spar_add_test("${file}" ${kind} 300)
  endforeach()
endforeach()

if(SPAR_MPI)
  file(GLOB files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/*/mpi_*.c")
  foreach(file IN LISTS files)
    get_filename_component(name "${file}" NAME_WE)
    add_executable(${name} "${file}")
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
    target_link_libraries(${name} PRIVATE ${spar_test_libraries} MPI::MPI_C)
    spar_add_ranks(${name} mpi 60)
  endforeach()
  include("${PROJECT_SOURCE_DIR}/tests/spread/spread.cmake")
endif()

if(TARGET spar_fortran)
  file(GLOB files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/fortran/test_*.f90"
       "${PROJECT_SOURCE_DIR}/tests/fortran/mpi_*.f90")
  foreach(file IN LISTS files)
    get_filename_component(name "${file}" NAME_WE)
    set(target fortran_${name})
    if(name MATCHES "^mpi_" AND NOT TARGET MPI::MPI_Fortran)
      continue()
    endif()
    add_executable(${target} "${file}")
    set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests"
      Fortran_MODULE_DIRECTORY "${PROJECT_BINARY_DIR}/tests/modules_${name}")
    target_compile_options(${target} PRIVATE -cpp)
    target_compile_definitions(${target} PRIVATE $<$<BOOL:${SPAR_MPI}>:SPARI_HAVE_MPI=1>)
    target_link_libraries(${target} PRIVATE spar_flags spar_aero_fortran spar_fortran)
    if(name MATCHES "^mpi_")
      target_link_libraries(${target} PRIVATE MPI::MPI_Fortran)
      spar_add_ranks(${target} fortran 60)
    else()
      spar_limit_of(limit 120)
      add_test(NAME ${target} COMMAND ${limit} $<TARGET_FILE:${target}> WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
      spar_set_test(${target} fortran 120)
    endif()
  endforeach()
  include("${PROJECT_SOURCE_DIR}/tests/fortran/fortran.cmake" OPTIONAL)
endif()

if(SPAR_INSTALL)
  include("${PROJECT_SOURCE_DIR}/tests/package/package.cmake")
endif()
include("${PROJECT_SOURCE_DIR}/tests/python/python.cmake")
include("${PROJECT_SOURCE_DIR}/tests/docs/docs.cmake")
include("${PROJECT_SOURCE_DIR}/tests/verification/verification.cmake" OPTIONAL)
include("${PROJECT_SOURCE_DIR}/tests/count/count.cmake" OPTIONAL)
include("${PROJECT_SOURCE_DIR}/tests/torture/torture.cmake")
include("${PROJECT_SOURCE_DIR}/tests/rooms.cmake")

# The short form of tests/sanitize: the tests with the label short, and the target that builds their programs. It has the unit tests
# and the torture without those below, which take longest and use memory as others do: test_transfer, test_body and test_nodes run
# the kernels of every width that the processor has; torture_fuzz_fresh plays what torture_fuzz does, in a tenth of the calls;
# torture_threads has sessions of several threads, torture_memory_shortest the scenes of torture_memory.
set(spar_not_short test_rotor test_turbine test_trial test_learned_mass test_learned_mass_life test_floquet test_error_scenes
  test_advice_kept test_advice_findings test_transfer_scalar test_transfer_wide test_body_scalar test_body_wide test_nodes_scalar
  test_nodes_wide test_assembly test_coupling test_added_mass test_explicit_stability test_idle_loads test_light_structures test_linear_beams test_pace test_threads
  test_modes test_static test_dynamic test_newton torture_traps torture_upward torture_ftz torture_comma torture_twins torture_memory torture_memory_np2 torture_fuzz
  torture_twins_fresh torture_ranks_np3 torture_ranks_binned_np2 test_advice test_step_invariance test_limit test_newton_scenes
  test_angular_momentum test_turning test_eigenvalues test_added_mass_life)
get_property(tests DIRECTORY PROPERTY TESTS)
foreach(test IN LISTS tests)
  get_test_property(${test} LABELS labels)
  if(test MATCHES "^(test|torture)_" AND labels MATCHES "^(unit|torture)$" AND NOT test IN_LIST spar_not_short)
    set_tests_properties(${test} PROPERTIES LABELS "${labels};short")
  endif()
endforeach()
get_property(spar_short_targets DIRECTORY PROPERTY BUILDSYSTEM_TARGETS)
list(FILTER spar_short_targets INCLUDE REGEX "^(test_.*|torture_.*|twins|fuzz)$")
list(FILTER spar_not_short INCLUDE REGEX "^test_") # programs of torture have other tests too
list(REMOVE_ITEM spar_short_targets ${spar_not_short})
add_custom_target(spar_short DEPENDS ${spar_short_targets})
