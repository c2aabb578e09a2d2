#!/bin/sh
# Writes from the public headers fortran/spar_c.f90, fortran/spar.f90 (what takes thought is by hand in fortran/spar.f90.in; this
# adds the constants and the plain procedures), and the table of examples/python/spar.py: run it after they have changed.
#   make-bindings.sh [<folder to write to, instead of fortran and examples/python>]
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
out=${1:-$root/fortran} out_python=${1:-$root/examples/python}
headers='spar spar_structure spar_coupling spar_analysis spar_aero spar_output'
made=$(mktemp)
trap 'rm -f "$made" "$made.file"' EXIT
# of <header> calls|constants|names
of() { awk -f "$root/cmake/interface.awk" "$root/include/spar/$1.h" | awk -v pass="$2" -v title="$1.h" -f "$root/cmake/fortran.awk"; }

{
    cat <<'HEAD'
! spar_c: the C interface of spar as it is, one binding per public function, one parameter per constant. The headers under
! include/spar say what every call does, and what it may be given; the module spar puts the types and checks of Fortran over it.
! Written by cmake/make-bindings.sh from the headers.
!
! Handles are type(c_ptr), by value where C takes a pointer and by reference where C takes the address of one. An array or
! a number that C takes by address is optional here: left out, C gets NULL. Text ends in c_null_char; text that comes back is a
! pointer to text of the library. Results are intent(inout): a refused call leaves them as they were. Counting is C's, from 0.

! The calls alone: the module spar has constants of its own, in the host's kind of integer.
module spar_calls
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_float, c_funptr, c_int, c_int64_t, c_ptr
  implicit none
  private :: c_char, c_double, c_float, c_funptr, c_int, c_int64_t, c_ptr
  public

  interface
HEAD
    for name in $headers; do
        of "$name" calls
        echo
    done | sed '$d'
    cat <<'MIDDLE'
  end interface
end module spar_calls

module spar_c
  use, intrinsic :: iso_c_binding, only: c_int
  use spar_calls
  implicit none
  private :: c_int
  public

MIDDLE
    for name in $headers; do of "$name" constants; done
    echo 'end module spar_c'
} >"$made"
cat "$made" >"$out/spar_c.f90"

# <file> <mark>: the file with what was made between the line that has the mark and the one that says who wrote it
put_between() {
    awk -v list="$made" -v mark="$2" '
        index($0, mark) { print; skip = 1; while ((getline line < list) > 0) print line }
        index($0, "} written by cmake/make-bindings.sh") { skip = 0 }
        !skip && !index($0, mark)' "$1" >"$made.file"
}

for name in $headers; do of "$name" names; done >"$made"
put_between "$root/fortran/spar.f90.in" 'constants of the headers {'
for name in $headers; do
    awk -v null=1 -f "$root/cmake/interface.awk" "$root/include/spar/$name.h"
done | awk -f "$root/cmake/plain.awk" "$made.file" - >"$out/spar.f90"

{
    echo 'TABLE = """'
    for name in $headers; do
        awk -f "$root/cmake/interface.awk" "$root/include/spar/$name.h" | tr '\t' ' '
    done
    echo '"""'
} >"$made"
put_between "$root/examples/python/spar.py" 'as cmake/interface.awk reads it {'
cat "$made.file" >"$out_python/spar.py"
rm "$made.file"
