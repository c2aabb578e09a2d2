#!/bin/sh
# soname.sh <library> <release> <number of the ABI>: the soname has the number of the ABI, and the Python package loads that one; the
# file is named by the release, which is that of CITATION.cff. The ABI is 0.9 before release 1.0, and 1 from then on.
set -eu
soname=$(readelf -d "$1" | sed -n 's/.*SONAME.*\[\(.*\)\].*/\1/p')
file=$(basename "$(readlink -f "$1")")
echo "soname $soname, file $file"
case $2 in 0.*) expected=0.9 ;; *) expected=1 ;; esac
[ "$3" = "$expected" ] || { echo "SPAR_SOVERSION is $3; in release $2 it must be $expected"; exit 1; }
[ "$soname" = "libspar.so.$3" ] && [ "$file" = "libspar.so.$2" ] || exit 1
grep -q "_load('$3')" "$(dirname "$0")/../../python/spar/__init__.py" || { echo "python/spar loads another library than libspar.so.$3"; exit 1; }
grep -qx "version: $2" "$(dirname "$0")/../../CITATION.cff" || { echo "CITATION.cff is of another release than $2"; exit 1; }
