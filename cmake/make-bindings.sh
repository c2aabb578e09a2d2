#!/bin/sh
# Writes from the public headers the Fortran modules and the table of examples/python/spar.py: run it after they have changed. Of
# each library: its raw bindings (spar_c.f90, spar_aero_c.f90), and its module (spar.f90, spar_aero.f90), where what takes thought is by
# hand in a file .f90.in; this adds the constants and the plain procedures.
#   make-bindings.sh [<folder to write to, instead of fortran and examples/python>]
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
out=${1:-$root/fortran} out_python=${1:-$root/examples/python}
headers='spar spar_structure spar_coupling spar_analysis spar_output' aero_headers='spar_aero'
made=$(mktemp)
trap 'rm -f "$made" "$made.file"' EXIT
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
    done | awk -v file="fortran/$1.f90.in" -f "$root/cmake/plain.awk" "$made.file" - >"$out/$1.f90"
}

raw libspar spar_calls spar_c "$headers" >"$out/spar_c.f90"
raw libspar_aero spar_aero_calls spar_aero_c "$aero_headers" >"$out/spar_aero_c.f90"
module spar "$headers"
module spar_aero "$aero_headers"
{
    echo 'TABLE = """'
    for name in $headers $aero_headers; do
        awk -f "$root/cmake/interface.awk" "$root/include/spar/$name.h" | tr '\t' ' '
    done
    echo '"""'
} >"$made"
put_between "$root/examples/python/spar.py" 'as cmake/interface.awk reads it {'
cat "$made.file" >"$out_python/spar.py"
rm "$made.file"
