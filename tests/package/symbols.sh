#!/bin/sh
# symbols.sh <source> <folder of libraries>: the functions of the public headers, the version script and what the library exports are
# one list, in one version node, for libspar and for libspar_aero, which share none; and neither asks for what a library in a host must
# not: to read the environment, to print, to exit (an instrumented one does, by its instruments; messages and files go through
# snprintf and FILE). libspar_aero asks libspar for functions of the public headers alone.
set -eu
source=$1 folder=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export LC_ALL=C

# functions <header>...: those that the headers declare
functions() {
    cat "$@" | sed 's,/\*.*\*/,,' | tr '\n' ' ' | grep -oE 'SPAR_API [^;()]*spar_[a-z0-9_]+ *\(' |
        grep -oE 'spar_[a-z0-9_]+ *\($' | tr -d ' (' | sort -u
}

# check <library> <its version>
check() {
    version=$2_$(sed -n "s/^set($2_SOVERSION \([0-9.]*\)).*/\1/p" "$source/CMakeLists.txt")
    sed -n '/global:/,/local:/p' "$source/cmake/$1.map" | grep -oE 'spar_[a-z0-9_]+' | sort -u >"$work/map"
    diff "$work/$1" "$work/map" || { echo "the headers (<) and cmake/$1.map (>) differ: run cmake/generate"; exit 1; }
    nm -D --defined-only "$folder/lib$1.so" | awk '$2 != "A" {print $3}' | sort -u >"$work/exported"
    sed "s/\$/@@$version/" "$work/$1" | diff - "$work/exported" ||
        { echo "the headers (<) and what lib$1.so exports (>) differ"; exit 1; }
    nm -D --undefined-only "$folder/lib$1.so" | awk '{print $2}' | sed 's/@.*//' | sort -u >"$work/asked"
    # stderr belongs to spar_log_stderr, which the host gives to set_log, and to nothing else
    [ "$(grep -lE '\bstderr\b' "$source"/src/*/*.[ch])" = "$source/src/base/messages.c" ] &&
        [ "$(grep -c '\bstderr\b' "$source/src/base/messages.c")" = 1 ] || { echo "stderr is used beside spar_log_stderr"; exit 1; }
    grep -qE '^(__asan|__ubsan|__tsan|__gcov)' "$work/asked" || ! grep -E '^(getenv|setenv|stdout|printf|puts|putchar|perror|exit|_exit|abort|signal|srand)$' "$work/asked" ||
        { echo "lib$1.so asks for these, which belong to its host"; exit 1; }
    echo "lib$1.so: $(wc -l <"$work/$1") functions, the same in the headers, the version script and the library"
}

# shellcheck disable=SC2046 # no name of a header has a space
functions $(ls "$source"/include/spar/*.h | grep -v spar_aero) >"$work/spar"
functions "$source/include/spar/spar_aero.h" >"$work/spar_aero"
check spar SPAR
[ -e "$folder/libspar_aero.so" ] || exit 0 # where libspar alone was built
check spar_aero SPAR_AERO
grep '^spar' "$work/asked" | comm -23 - "$work/spar" >"$work/private"
[ ! -s "$work/private" ] || { echo "libspar_aero.so asks libspar for these, which are in no public header:"; cat "$work/private"; exit 1; }
