# The scenes of benchmarks/scenes.h and worlds.h for every program that plays them.
add_library(benchmarks_scenes STATIC EXCLUDE_FROM_ALL
  "${PROJECT_SOURCE_DIR}/benchmarks/scenes.c" "${PROJECT_SOURCE_DIR}/benchmarks/worlds.c")
target_include_directories(benchmarks_scenes PUBLIC "${PROJECT_SOURCE_DIR}/benchmarks")
target_link_libraries(benchmarks_scenes PRIVATE spar_flags PUBLIC spar_example_parts spar_aero spar m)
foreach(program IN ITEMS benchmarks_accuracy benchmarks_advice benchmarks_kept)
  target_link_libraries(${program} PRIVATE benchmarks_scenes)
endforeach()

# The beam benchmarks count Newton iterations and quadrature points, which the shared library hides: the static one, and
# the internal headers.
foreach(program IN ITEMS benchmarks_beam benchmarks_beam_curves benchmarks_stability)
  set_target_properties(${program} PROPERTIES
    LINK_LIBRARIES "spar_flags;spar_example_parts;spar_aero_static;spar_static;m;$<$<BOOL:${SPAR_MPI}>:MPI::MPI_C>")
  target_include_directories(${program} PRIVATE "${PROJECT_SOURCE_DIR}/src")
endforeach()

# The transfer benchmark beside the plain loop, compiled with the library's flags and for this machine. It measures the
# nearest point alone, which the shared library hides.
set_target_properties(benchmarks_transfer PROPERTIES
  LINK_LIBRARIES "spar_flags;spar_aero_static;spar_static;spar::algebra;${GSL_LIBRARY};m;$<$<BOOL:${SPAR_MPI}>:MPI::MPI_C>")
target_include_directories(benchmarks_transfer PRIVATE "${PROJECT_SOURCE_DIR}/src")
foreach(kind IN ITEMS portable native)
  add_library(benchmarks_plain_${kind} OBJECT "${PROJECT_SOURCE_DIR}/benchmarks/plain.c")
  target_link_libraries(benchmarks_plain_${kind} PRIVATE spar_flags)
  target_compile_definitions(benchmarks_plain_${kind} PRIVATE PLAIN_KIND=${kind})
  target_sources(benchmarks_transfer PRIVATE $<TARGET_OBJECTS:benchmarks_plain_${kind}>)
endforeach()
target_compile_options(benchmarks_plain_native PRIVATE $<$<C_COMPILER_ID:GNU,Clang,AppleClang>:-O3;-march=native;-ffp-contract=fast>)

# The coupling benchmark plays the flows of the stability tests.
target_sources(benchmarks_coupling PRIVATE "${PROJECT_SOURCE_DIR}/tests/support/flows.c")
target_include_directories(benchmarks_coupling PRIVATE "${PROJECT_SOURCE_DIR}/tests")

# The peers: what of Kynema-FMB is installed where KynemaFMB_ROOT says (it ends the configuration where its own packages
# are not found, so it is not looked for unasked); nothing is fetched or built. It moves beams (peers) and a whole turbine
# (peers_turbine). BeamDyn's driver is looked for on the PATH as the
# program runs. Quadrature and tables of a member are the library's own, which the shared one hides.
target_sources(benchmarks_peers PRIVATE "${PROJECT_SOURCE_DIR}/benchmarks/peer_codes.c")
set_target_properties(benchmarks_peers PROPERTIES
  LINK_LIBRARIES "spar_flags;spar_example_parts;spar_aero_static;spar_static;m;$<$<BOOL:${SPAR_MPI}>:MPI::MPI_C>")
target_include_directories(benchmarks_peers PRIVATE "${PROJECT_SOURCE_DIR}/src")
get_property(spar_languages GLOBAL PROPERTY ENABLED_LANGUAGES)
if("CXX" IN_LIST spar_languages AND (KynemaFMB_ROOT OR KynemaFMB_DIR))
  find_package(KynemaFMB QUIET)
  if(TARGET KynemaFMB::kynema_fmb_library)
    foreach(peer IN ITEMS peers peers_turbine)
      string(REPLACE "peers" "peers_kynema" program ${peer})
      add_executable(benchmarks_${program} "${PROJECT_SOURCE_DIR}/benchmarks/${program}.cpp")
      set_target_properties(benchmarks_${program} PROPERTIES OUTPUT_NAME ${program}
        RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/benchmarks")
      target_link_libraries(benchmarks_${program} PRIVATE KynemaFMB::kynema_fmb_library)
      add_dependencies(benchmarks_${peer} benchmarks_${program})
    endforeach()
  endif()
endif()
if(SPAR_BUILD_TESTS)
  add_test(NAME benchmark_peers COMMAND benchmarks_peers --curves box3)
  set_tests_properties(benchmark_peers PROPERTIES LABELS unit
    PASS_REGULAR_EXPRESSION "Kynema-FMB: (not )?here.*BeamDyn: (not )?here.*box3: 1 blade.*spar +-0.*dt 0.005 s.*1e-05 +[0-9.]+ +[0-9.]+e-.*1e-01 m +spar")
  add_test(NAME benchmark_peers_turbine COMMAND benchmarks_peers_turbine --rounds 1 50)
  set_tests_properties(benchmark_peers_turbine PROPERTIES LABELS unit
    PASS_REGULAR_EXPRESSION "Kynema-FMB: (not )?here.*spar +the tip at 2 s, as dt goes to 0: 0.4634.*0.04 +spar +[89][.][0-9]+e-03 m")
endif()
