# What tries to break the library. Each folder here is one instrument: its part.cmake adds the short form to ctest (label
# torture), its `long` script is the long form (tests/torture/run).
file(GLOB parts CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/torture/*/part.cmake")
foreach(part IN LISTS parts)
  get_filename_component(spar_torture_dir "${part}" DIRECTORY)
  include("${part}")
endforeach()
