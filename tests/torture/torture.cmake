# What tries to break the library. Each folder here is one instrument: its part.cmake adds the short form to ctest (label
# torture), its `long` script is the long form (tests/torture/run).
# A seed of the sources: new with each of their changes, and the same wherever a commit is tested.
file(GLOB_RECURSE spar_sources LIST_DIRECTORIES false "${PROJECT_SOURCE_DIR}/src/*.c" "${PROJECT_SOURCE_DIR}/src/*.h")
list(SORT spar_sources)
set(spar_torture_seed "")
foreach(file IN LISTS spar_sources)
  file(SHA256 "${file}" hash)
  string(APPEND spar_torture_seed "${hash}")
endforeach()
string(SHA256 spar_torture_seed "${spar_torture_seed}")
string(SUBSTRING "${spar_torture_seed}" 0 16 spar_torture_seed)
set(spar_torture_seed "0x${spar_torture_seed}")
file(GLOB parts CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/torture/*/part.cmake")
foreach(part IN LISTS parts)
  get_filename_component(spar_torture_dir "${part}" DIRECTORY)
  include("${part}")
endforeach()
