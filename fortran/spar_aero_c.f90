! spar_aero_c: the C interface of libspar_aero as it is, one binding per public function, one parameter per constant. The headers under
! include/spar say what every call does, and what it may be given; the module spar_aero puts the types and checks of Fortran over it.
! Written by cmake/make-bindings.sh from the headers.
!
! Handles are type(c_ptr), by value where C takes a pointer and by reference where C takes the address of one. An array or
! a number that C takes by address is optional here: left out, C gets NULL. Text ends in c_null_char; text that comes back is a
! pointer to text of the library. Results are intent(inout): a refused call leaves them as they were. Counting is C's, from 0.

! The calls alone: the module spar_aero has constants of its own, in the host's kind of integer.
module spar_aero_calls
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_float, c_funptr, c_int, c_int64_t, c_ptr
  implicit none
  private :: c_char, c_double, c_float, c_funptr, c_int, c_int64_t, c_ptr
  public

  interface
    ! spar_aero.h
    function spar_polar_create(n, alpha_rad, cl, cd, cm, polar) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: alpha_rad(*), cl(*), cd(*), cm(*)
      type(c_ptr), intent(inout), optional :: polar
      integer(c_int) :: status
    end function spar_polar_create

    function spar_polar_set_interpolation(polar, kind) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: polar
      integer(c_int), value :: kind
      integer(c_int) :: status
    end function spar_polar_set_interpolation

    function spar_polar_evaluate(polar, alpha_rad, cl, cd, cm) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: polar
      real(c_double), value :: alpha_rad
      real(c_double), intent(inout), optional :: cl, cd, cm
      integer(c_int) :: status
    end function spar_polar_evaluate

    subroutine spar_polar_destroy(polar) bind(c)
      import :: c_ptr
      type(c_ptr), intent(inout), optional :: polar
    end subroutine spar_polar_destroy

    function spar_aero_create(blades, sections, aero) bind(c) result(status)
      import :: c_int, c_ptr
      integer(c_int), value :: blades
      type(c_ptr), intent(in), optional :: sections(*)
      type(c_ptr), intent(inout), optional :: aero
      integer(c_int) :: status
    end function spar_aero_create

    subroutine spar_aero_destroy(aero) bind(c)
      import :: c_ptr
      type(c_ptr), intent(inout), optional :: aero
    end subroutine spar_aero_destroy

    function spar_aero_set_section(aero, i, chord, twist, polar) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: aero
      integer(c_int64_t), value :: i
      real(c_double), value :: chord, twist
      type(c_ptr), value :: polar
      integer(c_int) :: status
    end function spar_aero_set_section

    function spar_aero_get_chord(aero, chord, twist) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: aero
      real(c_double), intent(inout), optional :: chord(*), twist(*)
      integer(c_int) :: status
    end function spar_aero_get_chord

    function spar_aero_get_polar(aero, i, n, capacity, alpha_rad, cl, cd, cm, kind) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: aero
      integer(c_int64_t), value :: i
      integer(c_int64_t), intent(inout), optional :: n
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: alpha_rad(*), cl(*), cd(*), cm(*)
      integer(c_int), intent(inout), optional :: kind
      integer(c_int) :: status
    end function spar_aero_get_polar

    function spar_fluid_read_aerodyn(fluid, primary_path, blade_path, q, n, span) bind(c) result(status)
      import :: c_char, c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      character(kind=c_char), intent(in), optional :: primary_path(*), blade_path(*)
      real(c_double), intent(in), optional :: q(4)
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: span(*)
      integer(c_int) :: status
    end function spar_fluid_read_aerodyn

    function spar_aero_read_aerodyn(aero, primary_path, blade_path, q, span) bind(c) result(status)
      import :: c_char, c_double, c_int, c_ptr
      type(c_ptr), value :: aero
      character(kind=c_char), intent(in), optional :: primary_path(*), blade_path(*)
      real(c_double), intent(in), optional :: q(4), span(*)
      integer(c_int) :: status
    end function spar_aero_read_aerodyn

    function spar_aero_set_rotor(aero, hub, axis, hub_radius, tip_radius) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: aero
      real(c_double), intent(in), optional :: hub(3), axis(3)
      real(c_double), value :: hub_radius, tip_radius
      integer(c_int) :: status
    end function spar_aero_set_rotor

    function spar_aero_set_turn(aero, turn) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: aero
      integer(c_int), value :: turn
      integer(c_int) :: status
    end function spar_aero_set_turn

    function spar_aero_set_blades(aero, total) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: aero
      integer(c_int), value :: total
      integer(c_int) :: status
    end function spar_aero_set_blades

    function spar_aero_set_shear(aero, law, ground, up, height, parameter) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: aero
      integer(c_int), value :: law
      real(c_double), intent(in), optional :: ground(3), up(3)
      real(c_double), value :: height, parameter
      integer(c_int) :: status
    end function spar_aero_set_shear

    function spar_aero_set_tower(aero, base, top, base_radius, top_radius) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: aero
      real(c_double), intent(in), optional :: base(3), top(3)
      real(c_double), value :: base_radius, top_radius
      integer(c_int) :: status
    end function spar_aero_set_tower

    function spar_aero_set_effects(aero, effects) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: aero
      integer(c_int), value :: effects
      integer(c_int) :: status
    end function spar_aero_set_effects

    function spar_aero_solve(aero, density, inflow, theta) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: aero
      real(c_double), value :: density
      real(c_double), intent(in), optional :: inflow(*)
      real(c_double), value :: theta
      integer(c_int) :: status
    end function spar_aero_solve

    function spar_aero_get_rotor(aero, thrust, torque, power) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: aero
      real(c_double), intent(inout), optional :: thrust, torque, power
      integer(c_int) :: status
    end function spar_aero_get_rotor

    function spar_aero_get_sections(aero, alpha, cl, cd, a, a_tangential) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: aero
      real(c_double), intent(inout), optional :: alpha(*), cl(*), cd(*), a(*), a_tangential(*)
      integer(c_int) :: status
    end function spar_aero_get_sections

    function spar_aero_get_flags(aero, flags, no_root) bind(c) result(status)
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: aero
      integer(c_int), intent(inout), optional :: flags(*)
      integer(c_int64_t), intent(inout), optional :: no_root
      integer(c_int) :: status
    end function spar_aero_get_flags

    function spar_aero_get_loads(aero, per_length, force, moment) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: aero
      real(c_double), intent(inout), optional :: per_length(*), force(*), moment(*)
      integer(c_int) :: status
    end function spar_aero_get_loads

    pure function spar_aero_effect_name(row) bind(c) result(text)
      import :: c_int, c_ptr
      integer(c_int), value :: row
      type(c_ptr) :: text
    end function spar_aero_effect_name

    function spar_aero_report_effects(aero, trial) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: aero, trial
      integer(c_int) :: status
    end function spar_aero_report_effects

    function spar_aero_get_effect(aero, row, in_force, fails, size, motion, reaction, share) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: aero
      integer(c_int), value :: row
      integer(c_int), intent(inout), optional :: in_force, fails
      real(c_double), intent(inout), optional :: size, motion, reaction, share
      integer(c_int) :: status
    end function spar_aero_get_effect
  end interface
end module spar_aero_calls

module spar_aero_c
  use, intrinsic :: iso_c_binding, only: c_int
  use spar_aero_calls
  implicit none
  private :: c_int
  public

  ! spar_aero.h
  integer(c_int), parameter :: SPAR_AERO_INDUCTION = 1, SPAR_AERO_TIP_LOSS = 2, SPAR_AERO_HUB_LOSS = 4, &
      SPAR_AERO_SWIRL = 8, SPAR_AERO_DRAG = 16, SPAR_AERO_MOMENT = 32, SPAR_AERO_SHEAR = 64, SPAR_AERO_TOWER = 128, &
      SPAR_AERO_INFLOW = 256, SPAR_AERO_STALL = 512, SPAR_AERO_UNSTEADY = 1024
  integer(c_int), parameter :: SPAR_SHEAR_POWER = 0, SPAR_SHEAR_LOG = 1, SPAR_SHEAR_LINEAR = 2
  integer(c_int), parameter :: SPAR_POLAR_LINEAR = 0, SPAR_POLAR_AKIMA = 1, SPAR_POLAR_CUBIC = 2
  integer(c_int), parameter :: SPAR_AERO_FLAG_END = 1, SPAR_AERO_FLAG_NO_ROOT = 2, SPAR_AERO_FLAG_BEYOND_POLAR = 4, &
      SPAR_AERO_FLAG_TOWER = 8
  integer(c_int), parameter :: SPAR_AERO_ROW_INDUCTION = 0, SPAR_AERO_ROW_TIP_LOSS = 1, SPAR_AERO_ROW_HUB_LOSS = 2, &
      SPAR_AERO_ROW_SWIRL = 3, SPAR_AERO_ROW_DRAG = 4, SPAR_AERO_ROW_MOMENT = 5, SPAR_AERO_ROW_SHEAR = 6, &
      SPAR_AERO_ROW_TOWER = 7, SPAR_AERO_ROW_INFLOW = 8, SPAR_AERO_ROW_STALL = 9, SPAR_AERO_ROW_UNSTEADY = 10, &
      SPAR_AERO_ROW_COUNT = 11
end module spar_aero_c
