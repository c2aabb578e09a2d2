#!/bin/sh
# symbols.sh <source> <library>...: the functions of the public headers, the version script and what each library exports are
# one list, in one version node; and none asks for what a library in a host must not: to read the environment, to print, to
# exit (an instrumented one does, by its instruments; messages and files go through snprintf and FILE).
set -eu
source=$1
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export LC_ALL=C
version=SPAR_$(sed -n 's/^set(SPAR_SOVERSION \(.*\))/\1/p' "$source/CMakeLists.txt")
cat "$source"/include/spar/*.h | sed 's,/\*.*\*/,,' | tr '\n' ' ' | grep -oE 'SPAR_API [^;()]*spar_[a-z0-9_]+ *\(' |
    grep -oE 'spar_[a-z0-9_]+ *\($' | tr -d ' (' | sort -u >"$work/headers"
sed -n '/global:/,/local:/p' "$source/cmake/spar.map" | grep -oE 'spar_[a-z0-9_]+' | sort -u >"$work/map"
diff "$work/headers" "$work/map" || { echo "the headers (<) and cmake/spar.map (>) differ: run cmake/make-map.sh"; exit 1; }
for library in "$@"; do
    nm -D --defined-only "$library" | awk '$2 != "A" {print $3}' | sort -u >"$work/exported"
    sed "s/\$/@@$version/" "$work/headers" | diff - "$work/exported" ||
        { echo "the headers (<) and what $library exports (>) differ"; exit 1; }
    nm -D --undefined-only "$library" | awk '{print $2}' >"$work/asked"
    grep -qE '^(__asan|__ubsan|__tsan|__gcov)' "$work/asked" || ! grep -E '^(getenv|setenv|stderr|stdout|printf|puts|putchar|perror|exit|_exit|abort|signal|srand)(@|$)' "$work/asked" ||
        { echo "$library asks for these, which belong to its host"; exit 1; }
done
echo "$(wc -l <"$work/headers") functions, the same in the headers, the version script and $# libraries"
