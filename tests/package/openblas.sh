#!/bin/sh
# openblas.sh <prefix> <work> <compiler> <folder of OpenBLAS>: the installed library loads the OpenBLAS that it was built with
# (of one thread), although another bears the same soname and comes first by the program's own path.
set -eu
prefix=$1 work=$2 compiler=$3 folder=$4
library=$(find "$prefix" -name libspar.so)
libdir=$(dirname "$library")
mkdir -p "$work/decoy"
cp -L "$folder/libopenblas.so.0" "$work/decoy/"
"$compiler" "-I$prefix/include" "$(dirname "$0")/c/main.c" -o "$work/consumer" "-L$libdir" -lspar -lm \
    -Wl,--disable-new-dtags "-Wl,-rpath,$work/decoy:$libdir"
loaded=$(LD_TRACE_LOADED_OBJECTS=1 "$work/consumer" | sed -n 's/.*libopenblas.so.0 => \(.*\) (.*/\1/p')
echo "loaded: $loaded"
[ "$loaded" = "$folder/libopenblas.so.0" ]
