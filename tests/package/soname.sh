#!/bin/sh
# soname.sh <library> <release>: the binary interface has a number of its own, and the file is named by the release.
set -eu
soname=$(readelf -d "$1" | sed -n 's/.*SONAME.*\[\(.*\)\].*/\1/p')
file=$(basename "$(readlink -f "$1")")
echo "soname $soname, file $file"
[ "$soname" = libspar.so.1 ] && [ "$file" = "libspar.so.$2" ]
