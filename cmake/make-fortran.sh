#!/bin/sh
# Writes fortran/spar_c.f90 from the public headers, and into fortran/spar.f90 the list of their constants: run it after they
# have changed. What a pointer is, the headers' own comments say: `x[n][3]: out` is an array, `t: out` a single number; what
# is said of a name holds until something else is.
#   make-fortran.sh [<folder to write to>]
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
out=${1:-$root/fortran}
made=$(mktemp)
trap 'rm -f "$made"' EXIT
# of a header: calls, constants, or names, which are constants in the default kind of integer
of() { awk -v pass="$2" -v title="$1.h" -f "$root/cmake/make-fortran.awk" "$root/include/spar/$1.h"; }
{
    cat <<'HEAD'
! spar_c: the C interface of spar as it is, one binding per public function, one parameter per constant. The headers under
! include/spar say what every call does, and what it may be given; the module spar puts the types and checks of Fortran over it.
! Written by cmake/make-fortran.sh from the headers.
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
    of spar calls
    echo
    of spar_aero calls
    echo
    of spar_output calls
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
    of spar constants
    of spar_aero constants
    echo 'end module spar_c'
} >"$made"
cat "$made" >"$out/spar_c.f90"

{ of spar names && of spar_aero names; } >"$made"
awk -v list="$made" '
    !skip
    /constants of the headers \{/ { skip = 1; while ((getline line < list) > 0) print line }
    skip && /\} written by/ { skip = 0; print }' "$root/fortran/spar.f90" >"$made.f90"
cat "$made.f90" >"$out/spar.f90"
rm "$made.f90"
