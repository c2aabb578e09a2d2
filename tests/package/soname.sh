#!/bin/sh
# soname.sh <library> <release>: the binary interface has a number of its own; the file is named by the release, which is that
# of CITATION.cff.
set -eu
soname=$(readelf -d "$1" | sed -n 's/.*SONAME.*\[\(.*\)\].*/\1/p')
file=$(basename "$(readlink -f "$1")")
echo "soname $soname, file $file"
[ "$soname" = libspar.so.1 ] && [ "$file" = "libspar.so.$2" ] || exit 1
grep -qx "version: $2" "$(dirname "$0")/../../CITATION.cff" || { echo "CITATION.cff is of another release than $2"; exit 1; }
