#!/bin/sh
# Writes cmake/spar.map and cmake/spar_aero.map from the public headers: run it after a function has been added there. The versions of
# the symbols are SPAR_SOVERSION and SPAR_AERO_SOVERSION of CMakeLists.txt.
cd "$(dirname "$0")/.." || exit 1

# map <variable of the version> <name of the version> <header>...
map() {
    variable=$1 name=$2
    shift 2
    echo "# The functions of the library's headers, all of them and nothing else (ctest checks it). Written by cmake/make-map.sh."
    echo "${name}_$(sed -n "s/^set($variable \([0-9.]*\)).*/\1/p" CMakeLists.txt) {"
    echo '  global:'
    cat "$@" | tr "\n" " " | grep -ohE "SPAR_API [^;()]*spar_[a-z0-9_]+ *\(" |
        grep -oE 'spar_[a-z0-9_]+ *\($' | tr -d ' (' | LC_ALL=C sort -u | sed 's/.*/    &;/'
    echo '  local:'
    echo '    *;'
    echo '};'
}

# shellcheck disable=SC2046 # no name of a header has a space
map SPAR_SOVERSION SPAR $(ls include/spar/*.h | grep -v spar_aero) >cmake/spar.map
map SPAR_AERO_SOVERSION SPAR_AERO include/spar/spar_aero.h >cmake/spar_aero.map
