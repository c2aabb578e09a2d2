#!/bin/sh
# pkgconfig.sh <prefix> <work> <compiler> <source> <package> [--static]: builds and runs a program by pkg-config alone.
set -eu
prefix=$1 work=$2 compiler=$3 source=$4 package=$5 static=${6:-}
PKG_CONFIG_PATH=$(find "$prefix" -name pkgconfig -type d)
export PKG_CONFIG_PATH
libdir=$(pkg-config --variable=libdir "$package")
mkdir -p "$work"
if [ -n "$static" ]; then
    # shellcheck disable=SC2046
    "$compiler" $(pkg-config --cflags "$package") "$source" -o "$work/consumer" \
        $(pkg-config --static --libs "$package" | sed "s,-lspar ,$libdir/libspar.a ,") -lm
else
    # shellcheck disable=SC2046
    "$compiler" $(pkg-config --cflags "$package") "$source" -o "$work/consumer" $(pkg-config --libs "$package") -lm
fi
LD_LIBRARY_PATH=$libdir "$work/consumer"
