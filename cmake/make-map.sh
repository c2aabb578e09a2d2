#!/bin/sh
# Writes cmake/spar.map from the public headers: run it after a function has been added there. The version of the symbols is
# SPAR_SOVERSION of CMakeLists.txt.
cd "$(dirname "$0")/.." || exit 1
version=$(sed -n 's/^set(SPAR_SOVERSION \(.*\))/\1/p' CMakeLists.txt)
{
    echo '# The functions of include/spar/*.h, all of them and nothing else (ctest checks it). Written by cmake/make-map.sh.'
    echo "SPAR_$version {"
    echo '  global:'
    cat include/spar/*.h | tr "\n" " " | grep -ohE "SPAR_API [^;()]*spar_[a-z0-9_]+ *\(" |
        grep -oE 'spar_[a-z0-9_]+ *\($' | tr -d ' (' | LC_ALL=C sort -u | sed 's/.*/    &;/'
    echo '  local:'
    echo '    *;'
    echo '};'
} >cmake/spar.map
