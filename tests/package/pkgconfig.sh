#!/bin/sh
# pkgconfig.sh <prefix> <work> <compiler> <source> <package> [--static]: builds and runs a program by pkg-config alone.
set -eu
prefix=$1 work=$2 compiler=$3 source=$4 package=$5 static=${6:-}
PKG_CONFIG_PATH=$(find "$prefix" -name pkgconfig -type d)
export PKG_CONFIG_PATH
# eval: pkg-config writes what a shell reads again, a folder's spaces with a backslash before them
eval "libdir=$(pkg-config --variable=libdir "$package")"
mkdir -p "$work"
if [ -n "$static" ]; then
    eval "set -- $(pkg-config --cflags "$package") \"\$source\" -o \"\$work/consumer\" $(pkg-config --static --libs "$package" | sed 's,-lspar_aero ,"$libdir/libspar_aero.a" ,; s,-lspar ,"$libdir/libspar.a" ,') -lm"
else
    eval "set -- $(pkg-config --cflags "$package") \"\$source\" -o \"\$work/consumer\" $(pkg-config --libs "$package") -lm"
fi
"$compiler" "$@"
LD_LIBRARY_PATH=$libdir "$work/consumer"
