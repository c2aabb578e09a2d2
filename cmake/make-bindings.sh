#!/bin/sh
# Writes what follows from the public headers alone: run it after they have changed (cmake/generate does).
#   fortran/spar_c.f90, spar_aero_c.f90       raw bindings of each library
#   fortran/spar.f90, spar_aero.f90           its module: what takes thought is by hand in the file .f90.in; this adds the constants and the
#                                             plain procedures
#   python/spar/_interface.py, __init__.pyi   table, docstrings and type stubs of the Python package
#   tests/fortran/test_bindings.f90           each raw binding once
#   tests/torture/calls.h, fuzz/calls_plain.* names of all calls, and callers of those that the fuzzer has none for by hand
#   make-bindings.sh [<folder to write to, instead of the sources>]
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
out=${1:-$root}
mkdir -p "$out/fortran" "$out/python/spar" "$out/tests/fortran" "$out/tests/torture/fuzz"
headers='spar spar_structure spar_coupling spar_analysis spar_output' aero_headers='spar_aero'
made=$(mktemp)
trap 'rm -f "$made" "$made.file" "$made.table"' EXIT
# of <header> calls|constants|names
of() { awk -f "$root/cmake/interface.awk" "$root/include/spar/$1.h" | awk -v pass="$2" -v title="$1.h" -f "$root/cmake/fortran.awk"; }

# raw <library> <module of the calls> <module of calls and constants> <headers>: the C interface of a library as it is
raw() {
    cat <<HEAD
! $3: the C interface of $1 as it is, one binding per public function, one parameter per constant. The headers under
! include/spar say what every call does, and what it may be given; the module ${3%_c} puts the types and checks of Fortran over it.
! Written by cmake/make-bindings.sh from the headers.
!
! Handles are type(c_ptr), by value where C takes a pointer and by reference where C takes the address of one. An array or
! a number that C takes by address is optional here: left out, C gets NULL. Text ends in c_null_char; text that comes back is a
! pointer to text of the library. Results are intent(inout): a refused call leaves them as they were. Counting is C's, from 0.

! The calls alone: the module ${3%_c} has constants of its own, in the host's kind of integer.
module $2
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_float, c_funptr, c_int, c_int64_t, c_ptr
  implicit none
  private :: c_char, c_double, c_float, c_funptr, c_int, c_int64_t, c_ptr
  public

  interface
HEAD
    for name in $4; do
        of "$name" calls
        echo
    done | sed '$d'
    cat <<MIDDLE
  end interface
end module $2

module $3
  use, intrinsic :: iso_c_binding, only: c_int
  use $2
  implicit none
  private :: c_int
  public

MIDDLE
    for name in $4; do of "$name" constants; done
    echo "end module $3"
}

# put_between <file> <mark>: the file with what was made between the line that has the mark and the one that says who wrote it
put_between() {
    awk -v list="$made" -v mark="$2" '
        index($0, mark) { print; skip = 1; while ((getline line < list) > 0) print line }
        index($0, "} written by cmake/make-bindings.sh") { skip = 0 }
        !skip && !index($0, mark)' "$1" >"$made.file"
}

# module <name> <headers>
module() {
    for name in $2; do of "$name" names; done >"$made"
    put_between "$root/fortran/$1.f90.in" 'constants of the headers {'
    for name in $2; do
        awk -v null=1 -f "$root/cmake/interface.awk" "$root/include/spar/$name.h"
    done | awk -v file="fortran/$1.f90.in" -f "$root/cmake/plain.awk" "$made.file" - >"$out/fortran/$1.f90"
}

raw libspar spar_calls spar_c "$headers" >"$out/fortran/spar_c.f90"
raw libspar_aero spar_aero_calls spar_aero_c "$aero_headers" >"$out/fortran/spar_aero_c.f90"
module spar "$headers"
module spar_aero "$aero_headers"
{
    echo '"""The interface, as cmake/interface.awk reads it. Written by cmake/make-bindings.sh from the headers."""'
    for name in $headers $aero_headers; do awk -v null=1 -v docs=1 -f "$root/cmake/interface.awk" "$root/include/spar/$name.h"; done >"$made.table"
    echo "VERSION = '$(sed -n 's/^project(spar VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt")'"
    echo 'CONSTANTS = {'
    sed -n 's/^constants//p' "$made.table" | tr '\t' '\n' | sed -n "s/\(.*\)=\(.*\)/    '\1': \2,/p"
    printf '}\nTABLE = """\n'
    grep '^call' "$made.table" | tr '\t' ' '
    printf '"""\nDOCS = {\n'
    sed -n 's/"/\\"/g; s/^doc\t\([a-z0-9_]*\)\t\(.*\)/    "\1": "\2",/p' "$made.table"
    echo '}'
} >"$out/python/spar/_interface.py"
if command -v python3 >/dev/null 2>&1; then # the only part that needs it
    python3 -B "$root/cmake/python-stubs.py" "$root/python/spar" "$out/python/spar"
fi

# what the instruments of tests/ know of every call
for name in $headers $aero_headers; do awk -v null=1 -f "$root/cmake/interface.awk" "$root/include/spar/$name.h"; done >"$made.table"
awk -v pass=bindings -f "$root/cmake/calls.awk" "$made.table" >"$made"
put_between "$root/tests/fortran/test_bindings.f90" 'calls of the headers {'
cat "$made.file" >"$out/tests/fortran/test_bindings.f90"
{
    echo '/* All public calls by name. Written by cmake/make-bindings.sh from the headers. */'
    echo '/* clang-format off */'
    awk -v pass=names -f "$root/cmake/calls.awk" "$made.table"
} >"$out/tests/torture/calls.h"
cat "$root"/tests/torture/fuzz/calls_[!p]*.c | sed -n 's/^void do_\([a-z0-9_]*\)(call .*/\1/p' >"$made"
{
    echo '/* The calls of calls_plain.c, as FUZZ_CALLS has those by hand. Written by cmake/make-bindings.sh from the headers. */'
    echo '/* clang-format off */'
    printf '#define FUZZ_PLAIN_CALLS(CALL)'
    awk -v pass=table -f "$root/cmake/calls.awk" "$made" "$made.table"
} >"$out/tests/torture/fuzz/calls_plain.h"
{
    echo '/* Callers whose arguments follow from their types. Written by cmake/make-bindings.sh from the headers. */'
    echo '#include "fuzz.h"'
    awk -v pass=fuzz -f "$root/cmake/calls.awk" "$made" "$made.table"
} >"$out/tests/torture/fuzz/calls_plain.c"
