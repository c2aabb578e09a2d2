#!/bin/sh
# without_gsl.sh <build> <work> <compiler>: the library built there with -DSPAR_GSL=OFF has the same symbols, neither loads nor asks
# for anything of GSL, says so, and solves what GSL would have solved.
set -eu
build=$1 work=$2 compiler=$3
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$work"
sh "$here/symbols.sh" "$here/../.." "$build"
if ldd "$build/libspar.so" | grep -i gsl || nm -D "$build/libspar.so" | grep -i ' gsl'; then
    echo "the library needs GSL"
    exit 1
fi
if grep -i gsl "$build/spar.pc"; then
    echo "spar.pc asks for GSL"
    exit 1
fi
"$compiler" -std=c11 "-I$here/../../include" "$here/without_gsl.c" -o "$work/without_gsl_host" "-L$build" -lspar -lm "-Wl,-rpath,$build"
"$work/without_gsl_host"
