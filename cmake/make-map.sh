#!/bin/sh
# Writes cmake/spar.map from the public headers: run it after a function has been added there.
cd "$(dirname "$0")/.." || exit 1
{
    echo '# The functions of include/spar/*.h, all of them and nothing else (ctest checks it). Written by cmake/make-map.sh.'
    echo 'SPAR_1 {'
    echo '  global:'
    cat include/spar/*.h | tr "\n" " " | grep -ohE "SPAR_API [^;()]*spar_[a-z0-9_]+ *\(" |
        grep -oE 'spar_[a-z0-9_]+ *\($' | tr -d ' (' | LC_ALL=C sort -u | sed 's/.*/    &;/'
    echo '  local:'
    echo '    *;'
    echo '};'
} >cmake/spar.map
