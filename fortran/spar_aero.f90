! spar_aero: blade elements with momentum theory in Fortran, the interface of libspar_aero. include/spar/spar_aero.h says what each call
! does; names, statuses, arrays, kinds and life are as in the module spar. The interface is experimental: it may change in any
! release.
!
!   use spar
!   use spar_aero
!   type(spar_polar) :: polar
!   type(spar_aero_object) :: rotor
!   call polar%create(alpha_rad, cl, cd)
!   call rotor%create(fluids) ! one of each blade
!   call rotor%set_section(1, chord, twist, polar)
!
! spar_fluid_read_aerodyn and spar_aero_effect_name keep their names. Arrays of sections are (n,blades) and (3,n,blades). Polars and aero
! objects are owned by their variables, as sessions are.
module spar_aero
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int, c_int64_t, c_null_ptr, c_ptr
  use spar
  use spar_aero_calls, c_aero_effect_name => spar_aero_effect_name, c_fluid_read_aerodyn => spar_fluid_read_aerodyn
  use spar_calls, only: spar_fluid_get_count, spar_fluid_get_member, spar_member_get_session, spar_trial_get_session
  use spar_support
  implicit none
  private

  public :: spar_polar, spar_aero_object, spar_aero_effect_name, spar_fluid_read_aerodyn

  ! constants of the headers {
  integer, parameter, public :: SPAR_AERO_INDUCTION = 1, SPAR_AERO_TIP_LOSS = 2, SPAR_AERO_HUB_LOSS = 4, &
      SPAR_AERO_SWIRL = 8, SPAR_AERO_DRAG = 16, SPAR_AERO_MOMENT = 32, SPAR_AERO_SHEAR = 64, SPAR_AERO_TOWER = 128, &
      SPAR_AERO_INFLOW = 256, SPAR_AERO_STALL = 512, SPAR_AERO_UNSTEADY = 1024
  integer, parameter, public :: SPAR_SHEAR_POWER = 0, SPAR_SHEAR_LOG = 1, SPAR_SHEAR_LINEAR = 2
  integer, parameter, public :: SPAR_POLAR_LINEAR = 0, SPAR_POLAR_AKIMA = 1, SPAR_POLAR_CUBIC = 2
  integer, parameter, public :: SPAR_AERO_FLAG_END = 1, SPAR_AERO_FLAG_NO_ROOT = 2, SPAR_AERO_FLAG_BEYOND_POLAR = 4, &
      SPAR_AERO_FLAG_TOWER = 8
  integer, parameter, public :: SPAR_AERO_ROW_INDUCTION = 0, SPAR_AERO_ROW_TIP_LOSS = 1, SPAR_AERO_ROW_HUB_LOSS = 2, &
      SPAR_AERO_ROW_SWIRL = 3, SPAR_AERO_ROW_DRAG = 4, SPAR_AERO_ROW_MOMENT = 5, SPAR_AERO_ROW_SHEAR = 6, &
      SPAR_AERO_ROW_TOWER = 7, SPAR_AERO_ROW_INFLOW = 8, SPAR_AERO_ROW_STALL = 9, SPAR_AERO_ROW_UNSTEADY = 10, &
      SPAR_AERO_ROW_COUNT = 11
  ! } written by cmake/make-bindings.sh

  type :: spar_polar
    private
    type(c_ptr) :: handle = c_null_ptr
  contains
    procedure :: set_interpolation => polar_set_interpolation
    procedure :: create => polar_create
    procedure :: destroy => polar_destroy
    procedure :: exists => polar_exists
    procedure :: c_handle => polar_handle
    procedure :: evaluate => polar_evaluate
    procedure, private :: polar_assign
    generic :: assignment(=) => polar_assign
    final :: polar_final
  end type spar_polar

  type :: spar_aero_object
    private
    type(c_ptr) :: handle = c_null_ptr, session = c_null_ptr
    integer(c_int64_t) :: blades = 0, sections = 0
  contains
    procedure :: get_chord => aero_get_chord
    procedure :: set_rotor => aero_set_rotor
    procedure :: set_turn => aero_set_turn
    procedure :: set_blades => aero_set_blades
    procedure :: set_shear => aero_set_shear
    procedure :: set_tower => aero_set_tower
    procedure :: set_effects => aero_set_effects
    procedure :: solve => aero_solve
    procedure :: get_rotor => aero_get_rotor
    procedure :: get_sections => aero_get_sections
    procedure :: get_loads => aero_get_loads
    procedure :: get_effect => aero_get_effect
    procedure :: create => aero_create
    procedure :: destroy => aero_destroy
    procedure :: exists => aero_exists
    procedure :: c_handle => aero_handle
    procedure, private :: aero_set_section_64, aero_set_section_32
    generic :: set_section => aero_set_section_64, aero_set_section_32
    procedure, private :: aero_get_polar_64, aero_get_polar_32
    generic :: get_polar => aero_get_polar_64, aero_get_polar_32
    procedure :: read_aerodyn => aero_read_aerodyn
    procedure :: get_flags => aero_get_flags
    procedure :: report_effects => aero_report_effects
    procedure, private :: aero_assign
    generic :: assignment(=) => aero_assign
    final :: aero_final
  end type spar_aero_object

  interface spar_aero_effect_name
    procedure :: aero_effect_name
  end interface spar_aero_effect_name

  interface spar_fluid_read_aerodyn
    procedure :: fluid_read_aerodyn
  end interface spar_fluid_read_aerodyn

contains

  ! ---- polars ----

  ! cm left out: 0.
  recursive subroutine polar_create(self, alpha_rad, cl, cd, cm, stat, errmsg)
    class(spar_polar), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: alpha_rad(:), cl(:), cd(:)
    real(c_double), contiguous, intent(in), optional :: cm(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault
    integer(c_int64_t) :: n

    n = size(alpha_rad, kind=c_int64_t)
    if (c_associated(self%handle)) then
      call occupied('polar%create', stat, errmsg)
      return
    end if
    call need(fault, 'cl', shape(cl, kind=c_int64_t), [n])
    call need(fault, 'cd', shape(cd, kind=c_int64_t), [n])
    if (present(cm)) call need(fault, 'cm', shape(cm, kind=c_int64_t), [n])
    if (allocated(fault)) then
      call refuse('polar%create', fault, stat, errmsg)
      return
    end if
    call finish(spar_polar_create(n, alpha_rad, cl, cd, cm, self%handle), c_null_ptr, stat, errmsg)
  end subroutine polar_create

  ! Sections that use the polar keep its table.
  recursive subroutine polar_destroy(self)
    class(spar_polar), intent(inout) :: self

    call spar_polar_destroy(self%handle)
  end subroutine polar_destroy

  impure elemental recursive subroutine polar_final(self)
    type(spar_polar), intent(inout) :: self

    call self%destroy()
  end subroutine polar_final

  impure elemental recursive subroutine polar_assign(left, right)
    class(spar_polar), intent(inout) :: left
    type(spar_polar), intent(in) :: right

    call forbid_copy('a polar', left%handle, right%handle)
  end subroutine polar_assign

  recursive logical function polar_exists(self) result(there)
    class(spar_polar), intent(in) :: self

    there = c_associated(self%handle)
  end function polar_exists

  recursive type(c_ptr) function polar_handle(self) result(handle)
    class(spar_polar), intent(in) :: self

    handle = self%handle
  end function polar_handle

  recursive subroutine polar_evaluate(self, alpha, cl, cd, cm, stat, errmsg)
    class(spar_polar), intent(in) :: self
    real(c_double), intent(in) :: alpha
    real(c_double), intent(inout), optional :: cl, cd, cm
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_polar_evaluate(self%handle, alpha, cl, cd, cm), c_null_ptr, stat, errmsg)
  end subroutine polar_evaluate

  ! ---- blade element with momentum theory ----

  ! One fluid per blade of this rank; a rank without blades gives an array of none.
  recursive subroutine aero_create(self, fluids, stat, errmsg)
    class(spar_aero_object), intent(inout) :: self
    type(spar_fluid), intent(in) :: fluids(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(c_ptr), allocatable :: handles(:)
    type(c_ptr) :: session
    integer(c_int64_t) :: n
    integer :: b
    integer(c_int) :: status

    if (c_associated(self%handle)) then
      call occupied('aero%create', stat, errmsg)
      return
    end if
    allocate (handles(size(fluids)))
    session = c_null_ptr
    n = 0
    do b = 1, size(fluids)
      handles(b) = fluids(b)%c_handle()
    end do
    if (size(fluids) > 0) session = session_of(handles(1))
    status = spar_aero_create(int(size(fluids), c_int), handles, self%handle)
    if (status == SPAR_OK .and. size(fluids) > 0) status = spar_fluid_get_count(handles(1), to_c(SPAR_NODES_MOTION), n)
    if (status == SPAR_OK) then
      self%session = session
      self%blades = size(fluids)
      self%sections = n
    end if
    call finish(status, session, stat, errmsg)
  end subroutine aero_create

  recursive subroutine aero_destroy(self)
    class(spar_aero_object), intent(inout) :: self

    call spar_aero_destroy(self%handle)
    self%session = c_null_ptr
    self%blades = 0
    self%sections = 0
  end subroutine aero_destroy

  impure elemental recursive subroutine aero_final(self)
    type(spar_aero_object), intent(inout) :: self

    call self%destroy()
  end subroutine aero_final

  impure elemental recursive subroutine aero_assign(left, right)
    class(spar_aero_object), intent(inout) :: left
    type(spar_aero_object), intent(in) :: right

    call forbid_copy('an aero object', left%handle, right%handle)
  end subroutine aero_assign

  recursive logical function aero_exists(self) result(there)
    class(spar_aero_object), intent(in) :: self

    there = c_associated(self%handle)
  end function aero_exists

  recursive type(c_ptr) function aero_handle(self) result(handle)
    class(spar_aero_object), intent(in) :: self

    handle = self%handle
  end function aero_handle

  ! Section i, from 1, of every blade.
  recursive subroutine aero_set_section_64(self, i, chord, twist, polar, stat, errmsg)
    class(spar_aero_object), intent(inout) :: self
    integer(c_int64_t), intent(in) :: i
    real(c_double), intent(in) :: chord, twist
    class(spar_polar), intent(in) :: polar
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    if (c_associated(self%handle) .and. (i < 1 .or. (self%blades > 0 .and. i > self%sections))) then
      call refuse('aero%set_section', 'sections are 1 to ' // trim(text_of(self%sections)) // '; there is no section ' // &
          text_of(i), stat, errmsg)
      return
    end if
    call finish(spar_aero_set_section(self%handle, i - 1, chord, twist, polar%handle), self%session, stat, errmsg)
  end subroutine aero_set_section_64

  recursive subroutine aero_set_section_32(self, i, chord, twist, polar, stat, errmsg)
    class(spar_aero_object), intent(inout) :: self
    integer(c_int), intent(in) :: i
    real(c_double), intent(in) :: chord, twist
    class(spar_polar), intent(in) :: polar
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call self%set_section(int(i, c_int64_t), chord, twist, polar, stat, errmsg)
  end subroutine aero_set_section_32

  ! n: rows; the arrays are filled as far as they reach
  recursive subroutine aero_get_polar_64(self, i, n, alpha_rad, cl, cd, cm, kind, stat, errmsg)
    class(spar_aero_object), intent(in) :: self
    integer(c_int64_t), intent(in) :: i
    integer(c_int64_t), intent(inout), optional :: n
    real(c_double), contiguous, intent(inout), optional :: alpha_rad(:), cl(:), cd(:), cm(:)
    integer, intent(inout), optional :: kind
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_kind

    c_kind = 0
    status = spar_aero_get_polar(self%handle, i - 1, n, 0_c_int64_t, kind=c_kind)
    if (status == SPAR_OK .and. present(alpha_rad)) &
        status = spar_aero_get_polar(self%handle, i - 1, n, size(alpha_rad, kind=c_int64_t), alpha_rad)
    if (status == SPAR_OK .and. present(cl)) &
        status = spar_aero_get_polar(self%handle, i - 1, n, size(cl, kind=c_int64_t), cl=cl)
    if (status == SPAR_OK .and. present(cd)) &
        status = spar_aero_get_polar(self%handle, i - 1, n, size(cd, kind=c_int64_t), cd=cd)
    if (status == SPAR_OK .and. present(cm)) &
        status = spar_aero_get_polar(self%handle, i - 1, n, size(cm, kind=c_int64_t), cm=cm)
    if (status == SPAR_OK .and. present(kind)) kind = c_kind
    call finish(status, self%session, stat, errmsg)
  end subroutine aero_get_polar_64

  recursive subroutine aero_get_polar_32(self, i, n, alpha_rad, cl, cd, cm, kind, stat, errmsg)
    class(spar_aero_object), intent(in) :: self
    integer(c_int), intent(in) :: i
    integer(c_int64_t), intent(inout), optional :: n
    real(c_double), contiguous, intent(inout), optional :: alpha_rad(:), cl(:), cd(:), cm(:)
    integer, intent(inout), optional :: kind
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call self%get_polar(int(i, c_int64_t), n, alpha_rad, cl, cd, cm, kind, stat, errmsg)
  end subroutine aero_get_polar_32

  recursive subroutine aero_read_aerodyn(self, primary_path, blade_path, q, span, stat, errmsg)
    class(spar_aero_object), intent(inout) :: self
    character(*), intent(in) :: primary_path
    character(*), intent(in), optional :: blade_path
    real(c_double), intent(in), optional :: q(4)
    real(c_double), contiguous, intent(in), optional :: span(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault
    integer(c_int) :: status

    if (present(span)) call need(fault, 'span', shape(span, kind=c_int64_t), [self%sections])
    if (allocated(fault)) then
      call refuse('aero%read_aerodyn', fault, stat, errmsg)
      return
    end if
    if (present(blade_path)) then
      status = spar_aero_read_aerodyn(self%handle, c_text(primary_path), c_text(blade_path), q, span)
    else
      status = spar_aero_read_aerodyn(self%handle, c_text(primary_path), q=q, span=span)
    end if
    call finish(status, self%session, stat, errmsg)
  end subroutine aero_read_aerodyn

  recursive subroutine aero_get_flags(self, flags, no_root, stat, errmsg)
    class(spar_aero_object), intent(in) :: self
    integer, intent(inout), optional :: flags(:,:)
    integer(c_int64_t), intent(inout), optional :: no_root
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault
    integer(c_int) :: status
    integer(c_int), allocatable :: c_flags(:,:)

    if (present(flags)) call need(fault, 'flags', shape(flags, kind=c_int64_t), [self%sections, self%blades])
    if (allocated(fault)) then
      call refuse('aero%get_flags', fault, stat, errmsg)
      return
    end if
    if (present(flags)) allocate (c_flags(self%sections, self%blades), source=0_c_int)
    status = spar_aero_get_flags(self%handle, c_flags, no_root)
    if (status == SPAR_OK .and. present(flags)) flags(:self%sections, :self%blades) = c_flags
    call finish(status, self%session, stat, errmsg)
  end subroutine aero_get_flags

  recursive subroutine aero_report_effects(self, trial, stat, errmsg)
    class(spar_aero_object), intent(inout) :: self
    class(spar_trial), intent(inout) :: trial
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_aero_report_effects(self%handle, trial%c_handle()), session_of_trial(trial%c_handle()), stat, errmsg)
  end subroutine aero_report_effects

  recursive subroutine fluid_read_aerodyn(fluid, primary_path, blade_path, q, span, stat, errmsg)
    class(spar_fluid), intent(inout) :: fluid
    character(*), intent(in) :: primary_path
    character(*), intent(in), optional :: blade_path
    real(c_double), intent(in), optional :: q(4)
    real(c_double), contiguous, intent(in), optional :: span(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    integer(c_int) :: status

    n = 0
    if (present(span)) n = size(span, kind=c_int64_t)
    if (present(blade_path)) then
      status = c_fluid_read_aerodyn(fluid%c_handle(), c_text(primary_path), c_text(blade_path), q, n, span)
    else
      status = c_fluid_read_aerodyn(fluid%c_handle(), c_text(primary_path), q=q, n=n, span=span)
    end if
    call finish(status, session_of(fluid%c_handle()), stat, errmsg)
  end subroutine fluid_read_aerodyn

  ! The session that a fluid belongs to; none of no fluid.
  recursive type(c_ptr) function session_of(fluid) result(session)
    type(c_ptr), intent(in) :: fluid
    type(c_ptr) :: member

    session = c_null_ptr
    member = c_null_ptr
    if (spar_fluid_get_member(fluid, member) /= SPAR_OK) return
    if (spar_member_get_session(member, session) /= SPAR_OK) session = c_null_ptr
  end function session_of

  ! The session of a trial; none of no trial.
  recursive type(c_ptr) function session_of_trial(trial) result(session)
    type(c_ptr), intent(in) :: trial

    session = c_null_ptr
    if (spar_trial_get_session(trial, session) /= SPAR_OK) session = c_null_ptr
  end function session_of_trial

  ! ---- what needs no thought ----

  ! Written by cmake/make-bindings.sh.

  recursive subroutine polar_set_interpolation(self, kind, stat, errmsg)
    class(spar_polar), intent(inout) :: self
    integer, intent(in) :: kind
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_polar_set_interpolation(self%handle, to_c(kind)), c_null_ptr, stat, errmsg)
  end subroutine polar_set_interpolation

  ! Written by cmake/make-bindings.sh.

  recursive subroutine aero_get_chord(self, chord, twist, stat, errmsg)
    class(spar_aero_object), intent(in) :: self
    real(c_double), contiguous, intent(inout), optional :: chord(:), twist(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    if (present(chord)) call need(fault, 'chord', shape(chord, kind=c_int64_t), [self%sections])
    if (present(twist)) call need(fault, 'twist', shape(twist, kind=c_int64_t), [self%sections])
    if (allocated(fault)) then
      call refuse('aero%get_chord', fault, stat, errmsg)
      return
    end if
    call finish(spar_aero_get_chord(self%handle, chord, twist), self%session, stat, errmsg)
  end subroutine aero_get_chord

  recursive subroutine aero_set_rotor(self, hub, axis, hub_radius, tip_radius, stat, errmsg)
    class(spar_aero_object), intent(inout) :: self
    real(c_double), intent(in) :: hub(3), axis(3), hub_radius, tip_radius
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_aero_set_rotor(self%handle, hub, axis, hub_radius, tip_radius), self%session, stat, errmsg)
  end subroutine aero_set_rotor

  recursive subroutine aero_set_turn(self, turn, stat, errmsg)
    class(spar_aero_object), intent(inout) :: self
    integer, intent(in) :: turn
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_aero_set_turn(self%handle, to_c(turn)), self%session, stat, errmsg)
  end subroutine aero_set_turn

  recursive subroutine aero_set_blades(self, total, stat, errmsg)
    class(spar_aero_object), intent(inout) :: self
    integer, intent(in) :: total
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_aero_set_blades(self%handle, to_c(total)), self%session, stat, errmsg)
  end subroutine aero_set_blades

  recursive subroutine aero_set_shear(self, law, ground, up, height, parameter, stat, errmsg)
    class(spar_aero_object), intent(inout) :: self
    integer, intent(in) :: law
    real(c_double), intent(in) :: ground(3), up(3), height, parameter
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_aero_set_shear(self%handle, to_c(law), ground, up, height, parameter), self%session, stat, errmsg)
  end subroutine aero_set_shear

  recursive subroutine aero_set_tower(self, base, top, base_radius, top_radius, stat, errmsg)
    class(spar_aero_object), intent(inout) :: self
    real(c_double), intent(in) :: base(3), top(3), base_radius, top_radius
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_aero_set_tower(self%handle, base, top, base_radius, top_radius), self%session, stat, errmsg)
  end subroutine aero_set_tower

  recursive subroutine aero_set_effects(self, effects, stat, errmsg)
    class(spar_aero_object), intent(inout) :: self
    integer, intent(in) :: effects
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_aero_set_effects(self%handle, to_c(effects)), self%session, stat, errmsg)
  end subroutine aero_set_effects

  recursive subroutine aero_solve(self, density, inflow, theta, stat, errmsg)
    class(spar_aero_object), intent(inout) :: self
    real(c_double), intent(in) :: density
    real(c_double), contiguous, intent(in) :: inflow(:,:,:)
    real(c_double), intent(in) :: theta
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    call need(fault, 'inflow', shape(inflow, kind=c_int64_t), [3_c_int64_t, self%sections, self%blades])
    if (allocated(fault)) then
      call refuse('aero%solve', fault, stat, errmsg)
      return
    end if
    call finish(spar_aero_solve(self%handle, density, inflow, theta), self%session, stat, errmsg)
  end subroutine aero_solve

  recursive subroutine aero_get_rotor(self, thrust, torque, power, stat, errmsg)
    class(spar_aero_object), intent(in) :: self
    real(c_double), intent(inout), optional :: thrust, torque, power
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_aero_get_rotor(self%handle, thrust, torque, power), self%session, stat, errmsg)
  end subroutine aero_get_rotor

  recursive subroutine aero_get_sections(self, alpha, cl, cd, a, a_tangential, stat, errmsg)
    class(spar_aero_object), intent(in) :: self
    real(c_double), contiguous, intent(inout), optional :: alpha(:,:), cl(:,:), cd(:,:), a(:,:), a_tangential(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    if (present(alpha)) call need(fault, 'alpha', shape(alpha, kind=c_int64_t), [self%sections, self%blades])
    if (present(cl)) call need(fault, 'cl', shape(cl, kind=c_int64_t), [self%sections, self%blades])
    if (present(cd)) call need(fault, 'cd', shape(cd, kind=c_int64_t), [self%sections, self%blades])
    if (present(a)) call need(fault, 'a', shape(a, kind=c_int64_t), [self%sections, self%blades])
    if (present(a_tangential)) call need(fault, 'a_tangential', shape(a_tangential, kind=c_int64_t), [self%sections, &
        self%blades])
    if (allocated(fault)) then
      call refuse('aero%get_sections', fault, stat, errmsg)
      return
    end if
    call finish(spar_aero_get_sections(self%handle, alpha, cl, cd, a, a_tangential), self%session, stat, errmsg)
  end subroutine aero_get_sections

  recursive subroutine aero_get_loads(self, per_length, force, moment, stat, errmsg)
    class(spar_aero_object), intent(in) :: self
    real(c_double), contiguous, intent(inout), optional :: per_length(:,:,:), force(:,:,:), moment(:,:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    if (present(per_length)) call need(fault, 'per_length', shape(per_length, kind=c_int64_t), [6_c_int64_t, &
        self%sections, self%blades])
    if (present(force)) call need(fault, 'force', shape(force, kind=c_int64_t), [3_c_int64_t, self%sections, &
        self%blades])
    if (present(moment)) call need(fault, 'moment', shape(moment, kind=c_int64_t), [3_c_int64_t, self%sections, &
        self%blades])
    if (allocated(fault)) then
      call refuse('aero%get_loads', fault, stat, errmsg)
      return
    end if
    call finish(spar_aero_get_loads(self%handle, per_length, force, moment), self%session, stat, errmsg)
  end subroutine aero_get_loads

  recursive subroutine aero_get_effect(self, row, in_force, fails, size, motion, reaction, share, stat, errmsg)
    class(spar_aero_object), intent(in) :: self
    integer, intent(in) :: row
    integer, intent(inout), optional :: in_force, fails
    real(c_double), intent(inout), optional :: size, motion, reaction, share
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_in_force, c_fails

    status = spar_aero_get_effect(self%handle, to_c(row), c_in_force, c_fails, size, motion, reaction, share)
    call hand(status, c_in_force, in_force)
    call hand(status, c_fails, fails)
    call finish(status, self%session, stat, errmsg)
  end subroutine aero_get_effect

  ! Of a row of aero%report_effects, from 0 as SPAR_AERO_ROW_*; '' for what is no row.
  recursive function aero_effect_name(row) result(name)
    integer, intent(in) :: row
    character(length_of_aero_effect_name(row)) :: name

    call fill_text(c_aero_effect_name(to_c(row)), name)
  end function aero_effect_name

  pure recursive integer(c_int64_t) function length_of_aero_effect_name(row) result(n)
    integer, intent(in) :: row

    n = text_length(c_aero_effect_name(to_c(row)))
  end function length_of_aero_effect_name

end module spar_aero
