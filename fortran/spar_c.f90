! spar_c: the C interface of libspar as it is, one binding per public function, one parameter per constant. The headers under
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
    ! spar.h
    pure function spar_session_message(session) bind(c) result(text)
      import :: c_ptr
      type(c_ptr), value :: session
      type(c_ptr) :: text
    end function spar_session_message

    pure function spar_status_text(status) bind(c) result(text)
      import :: c_int, c_ptr
      integer(c_int), value :: status
      type(c_ptr) :: text
    end function spar_status_text

    pure function spar_version() bind(c) result(text)
      import :: c_ptr
      type(c_ptr) :: text
    end function spar_version

    function spar_has(feature) bind(c) result(status)
      import :: c_char, c_int
      character(kind=c_char), intent(in), optional :: feature(*)
      integer(c_int) :: status
    end function spar_has

    function spar_session_create(session) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), intent(inout), optional :: session
      integer(c_int) :: status
    end function spar_session_create

    function spar_session_create_fcomm(comm, session) bind(c) result(status)
      import :: c_int, c_ptr
      integer(c_int), value :: comm
      type(c_ptr), intent(inout), optional :: session
      integer(c_int) :: status
    end function spar_session_create_fcomm

    subroutine spar_session_destroy(session) bind(c)
      import :: c_ptr
      type(c_ptr), intent(inout), optional :: session
    end subroutine spar_session_destroy

    function spar_step_begin(session, dt) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), value :: dt
      integer(c_int) :: status
    end function spar_step_begin

    function spar_step_solve(session) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int) :: status
    end function spar_step_solve

    function spar_step_check(session, done) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int), intent(inout), optional :: done
      integer(c_int) :: status
    end function spar_step_check

    function spar_step_accept(session) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int) :: status
    end function spar_step_accept

    function spar_step_reject(session) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int) :: status
    end function spar_step_reject

    function spar_fluid_pull_motion(fluid, theta, x, v) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      real(c_double), value :: theta
      real(c_double), intent(inout), optional :: x(*), v(*)
      integer(c_int) :: status
    end function spar_fluid_pull_motion

    function spar_fluid_push_forces(fluid, force, moment) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      real(c_double), intent(in), optional :: force(*), moment(*)
      integer(c_int) :: status
    end function spar_fluid_push_forces

    function spar_fluid_fail(fluid, status, message) bind(c) result(answer)
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), value :: status
      character(kind=c_char), intent(in), optional :: message(*)
      integer(c_int) :: answer
    end function spar_fluid_fail

    function spar_step(session, dt, solve, context, iterations) bind(c) result(status)
      import :: c_double, c_funptr, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), value :: dt
      type(c_funptr), value :: solve
      type(c_ptr), value :: context
      integer(c_int), intent(inout), optional :: iterations
      integer(c_int) :: status
    end function spar_step

    function spar_session_set_gravity(session, g) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), intent(in), optional :: g(3)
      integer(c_int) :: status
    end function spar_session_set_gravity

    function spar_session_get_gravity(session, g) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), intent(inout), optional :: g(3)
      integer(c_int) :: status
    end function spar_session_get_gravity

    function spar_session_set_coupling(session, scheme, atol, rtol, max_iterations) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int), value :: scheme
      real(c_double), value :: atol, rtol
      integer(c_int), value :: max_iterations
      integer(c_int) :: status
    end function spar_session_set_coupling

    function spar_session_get_coupling(session, scheme, atol, rtol, max_iterations) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int), intent(inout), optional :: scheme
      real(c_double), intent(inout), optional :: atol, rtol
      integer(c_int), intent(inout), optional :: max_iterations
      integer(c_int) :: status
    end function spar_session_get_coupling

    function spar_session_get_time(session, t, step, iteration) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: session
      real(c_double), intent(inout), optional :: t
      integer(c_int64_t), intent(inout), optional :: step
      integer(c_int), intent(inout), optional :: iteration
      integer(c_int) :: status
    end function spar_session_get_time

    function spar_session_set_log(session, log, context) bind(c) result(status)
      import :: c_funptr, c_int, c_ptr
      type(c_ptr), value :: session
      type(c_funptr), value :: log
      type(c_ptr), value :: context
      integer(c_int) :: status
    end function spar_session_set_log

    subroutine spar_log_stderr(session, level, text, context) bind(c)
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int), value :: level
      character(kind=c_char), intent(in), optional :: text(*)
      type(c_ptr), value :: context
    end subroutine spar_log_stderr

    pure function spar_session_get_warning(session, i) bind(c) result(text)
      import :: c_int64_t, c_ptr
      type(c_ptr), value :: session
      integer(c_int64_t), value :: i
      type(c_ptr) :: text
    end function spar_session_get_warning

    function spar_point_create(session, name, x, q, member) bind(c) result(status)
      import :: c_char, c_double, c_int, c_ptr
      type(c_ptr), value :: session
      character(kind=c_char), intent(in), optional :: name(*)
      real(c_double), intent(in), optional :: x(3), q(4)
      type(c_ptr), intent(inout), optional :: member
      integer(c_int) :: status
    end function spar_point_create

    function spar_rigid_create(session, name, x, q, mass, member) bind(c) result(status)
      import :: c_char, c_double, c_int, c_ptr
      type(c_ptr), value :: session
      character(kind=c_char), intent(in), optional :: name(*)
      real(c_double), intent(in), optional :: x(3), q(4), mass(36)
      type(c_ptr), intent(inout), optional :: member
      integer(c_int) :: status
    end function spar_rigid_create

    function spar_beam_create(session, name, elements, nodes_per_element, member) bind(c) result(status)
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: session
      character(kind=c_char), intent(in), optional :: name(*)
      integer(c_int), value :: elements, nodes_per_element
      type(c_ptr), intent(inout), optional :: member
      integer(c_int) :: status
    end function spar_beam_create

    function spar_beam_set_axis(beam, n, eta, xyz, twist) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: beam
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: eta(*), xyz(*), twist(*)
      integer(c_int) :: status
    end function spar_beam_set_axis

    function spar_beam_set_sections(beam, n, eta, stiffness, mass) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: beam
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: eta(*), stiffness(*), mass(*)
      integer(c_int) :: status
    end function spar_beam_set_sections

    function spar_member_set_placement(member, x, q) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: member
      real(c_double), intent(in), optional :: x(3), q(4)
      integer(c_int) :: status
    end function spar_member_set_placement

    function spar_member_set_root(member, kind) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: member
      integer(c_int), value :: kind
      integer(c_int) :: status
    end function spar_member_set_root

    function spar_member_set_external(member, on) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: member
      integer(c_int), value :: on
      integer(c_int) :: status
    end function spar_member_set_external

    function spar_member_set_initial_velocity(member, x0, v0, omega) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: member
      real(c_double), intent(in), optional :: x0(3), v0(3), omega(3)
      integer(c_int) :: status
    end function spar_member_set_initial_velocity

    function spar_member_commit(member) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: member
      integer(c_int) :: status
    end function spar_member_commit

    function spar_member_get_count(member, nodes) bind(c) result(status)
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: member
      integer(c_int64_t), intent(inout), optional :: nodes
      integer(c_int) :: status
    end function spar_member_get_count

    function spar_member_get_reference(member, x, q) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: member
      real(c_double), intent(inout), optional :: x(*), q(*)
      integer(c_int) :: status
    end function spar_member_get_reference

    function spar_member_get_motion(member, q, v, a) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: member
      real(c_double), intent(inout), optional :: q(*), v(*), a(*)
      integer(c_int) :: status
    end function spar_member_get_motion

    function spar_member_set_motion(member, q, v, a) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: member
      real(c_double), intent(in), optional :: q(*), v(*), a(*)
      integer(c_int) :: status
    end function spar_member_set_motion

    function spar_member_drive(member, q, v, a) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: member
      real(c_double), intent(in), optional :: q(7), v(6), a(6)
      integer(c_int) :: status
    end function spar_member_drive

    function spar_member_set_load(member, node, kind, load) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: member
      integer(c_int64_t), value :: node
      integer(c_int), value :: kind
      real(c_double), intent(in), optional :: load(6)
      integer(c_int) :: status
    end function spar_member_set_load

    function spar_member_get_loads(member, load) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: member
      real(c_double), intent(inout), optional :: load(*)
      integer(c_int) :: status
    end function spar_member_get_loads

    function spar_fluid_create(member, name, fluid) bind(c) result(status)
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: member
      character(kind=c_char), intent(in), optional :: name(*)
      type(c_ptr), intent(inout), optional :: fluid
      integer(c_int) :: status
    end function spar_fluid_create

    subroutine spar_fluid_destroy(fluid) bind(c)
      import :: c_ptr
      type(c_ptr), intent(inout), optional :: fluid
    end subroutine spar_fluid_destroy

    function spar_fluid_set_motion_nodes(fluid, n, x) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: x(*)
      integer(c_int) :: status
    end function spar_fluid_set_motion_nodes

    function spar_fluid_set_force_nodes(fluid, n, x) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: x(*)
      integer(c_int) :: status
    end function spar_fluid_set_force_nodes

    function spar_fluid_set_stations(fluid, n, eta, offset) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: eta(*), offset(*)
      integer(c_int) :: status
    end function spar_fluid_set_stations

    function spar_fluid_map(fluid) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int) :: status
    end function spar_fluid_map

    function spar_fluid_pull_poses(fluid, which, theta, x, q, v, omega, accel, alpha) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), value :: which
      real(c_double), value :: theta
      real(c_double), intent(inout), optional :: x(*), q(*), v(*), omega(*), accel(*), alpha(*)
      integer(c_int) :: status
    end function spar_fluid_pull_poses

    function spar_session_save(session, path) bind(c) result(status)
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: session
      character(kind=c_char), intent(in), optional :: path(*)
      integer(c_int) :: status
    end function spar_session_save

    function spar_session_load(session, path) bind(c) result(status)
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: session
      character(kind=c_char), intent(in), optional :: path(*)
      integer(c_int) :: status
    end function spar_session_load

    ! spar_structure.h
    function spar_section_from_shape(shape, n, dimension, young, poisson, density, capacity, property) bind(c) &
        result(status)
      import :: c_double, c_int, c_int64_t
      integer(c_int), value :: shape
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: dimension(*)
      real(c_double), value :: young, poisson, density
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: property(*)
      integer(c_int) :: status
    end function spar_section_from_shape

    function spar_section_build(n, property, stiffness, mass) bind(c) result(status)
      import :: c_double, c_int, c_int64_t
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: property(*)
      real(c_double), intent(inout), optional :: stiffness(36), mass(36)
      integer(c_int) :: status
    end function spar_section_build

    function spar_section_describe(stiffness, mass, capacity, property, findings) bind(c) result(status)
      import :: c_double, c_int, c_int64_t
      real(c_double), intent(in), optional :: stiffness(36), mass(36)
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: property(*)
      integer(c_int), intent(inout), optional :: findings
      integer(c_int) :: status
    end function spar_section_describe

    function spar_section_report(stiffness, mass, capacity, text) bind(c) result(status)
      import :: c_char, c_double, c_int, c_int64_t
      real(c_double), intent(in), optional :: stiffness(36), mass(36)
      integer(c_int64_t), value :: capacity
      character(kind=c_char), intent(inout), optional :: text(*)
      integer(c_int) :: status
    end function spar_section_report

    function spar_section_transform(matrix, y, z, angle, out) bind(c) result(status)
      import :: c_double, c_int
      real(c_double), intent(in), optional :: matrix(36)
      real(c_double), value :: y, z, angle
      real(c_double), intent(inout), optional :: out(36)
      integer(c_int) :: status
    end function spar_section_transform

    function spar_beam_get_elements(beam, elements, nodes_per_element) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: beam
      integer(c_int), intent(inout), optional :: elements, nodes_per_element
      integer(c_int) :: status
    end function spar_beam_get_elements

    function spar_beam_get_axis(beam, n, capacity, eta, xyz, twist) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: beam
      integer(c_int64_t), intent(inout), optional :: n
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: eta(*), xyz(*), twist(*)
      integer(c_int) :: status
    end function spar_beam_get_axis

    function spar_beam_get_sections(beam, n, capacity, eta, stiffness, mass) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: beam
      integer(c_int64_t), intent(inout), optional :: n
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: eta(*), stiffness(*), mass(*)
      integer(c_int) :: status
    end function spar_beam_get_sections

    function spar_beam_set_nodes(beam, n, x, q) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: beam
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: x(*), q(*)
      integer(c_int) :: status
    end function spar_beam_set_nodes

    function spar_beam_set_quadrature(beam, rule, points) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: beam
      integer(c_int), value :: rule, points
      integer(c_int) :: status
    end function spar_beam_set_quadrature

    function spar_beam_get_quadrature(beam, rule, points) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: beam
      integer(c_int), intent(inout), optional :: rule, points
      integer(c_int) :: status
    end function spar_beam_get_quadrature

    function spar_beam_read_beamdyn(beam, primary_path, blade_path) bind(c) result(status)
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: beam
      character(kind=c_char), intent(in), optional :: primary_path(*), blade_path(*)
      integer(c_int) :: status
    end function spar_beam_read_beamdyn

    function spar_beam_set_masses(beam, n, eta, mass) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: beam
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: eta(*), mass(*)
      integer(c_int) :: status
    end function spar_beam_set_masses

    function spar_beam_get_masses(beam, n, capacity, eta, mass) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: beam
      integer(c_int64_t), intent(inout), optional :: n
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: eta(*), mass(*)
      integer(c_int) :: status
    end function spar_beam_get_masses

    function spar_beam_set_foundation(beam, n, eta, stiffness) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: beam
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: eta(*), stiffness(*)
      integer(c_int) :: status
    end function spar_beam_set_foundation

    function spar_beam_get_foundation(beam, n, capacity, eta, stiffness) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: beam
      integer(c_int64_t), intent(inout), optional :: n
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: eta(*), stiffness(*)
      integer(c_int) :: status
    end function spar_beam_get_foundation

    function spar_beam_set_pretension(beam, n, eta, force) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: beam
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: eta(*), force(*)
      integer(c_int) :: status
    end function spar_beam_set_pretension

    function spar_beam_get_pretension(beam, n, capacity, eta, force) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: beam
      integer(c_int64_t), intent(inout), optional :: n
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: eta(*), force(*)
      integer(c_int) :: status
    end function spar_beam_get_pretension

    function spar_beam_set_damping(beam, mu) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: beam
      real(c_double), intent(in), optional :: mu(6)
      integer(c_int) :: status
    end function spar_beam_set_damping

    function spar_beam_get_damping(beam, mu) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: beam
      real(c_double), intent(inout), optional :: mu(6)
      integer(c_int) :: status
    end function spar_beam_get_damping

    function spar_beam_set_mass_damping(beam, alpha) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: beam
      real(c_double), value :: alpha
      integer(c_int) :: status
    end function spar_beam_set_mass_damping

    function spar_beam_get_mass_damping(beam, alpha) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: beam
      real(c_double), intent(inout), optional :: alpha
      integer(c_int) :: status
    end function spar_beam_get_mass_damping

    function spar_beam_set_plane(beam, normal) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: beam
      real(c_double), intent(in), optional :: normal(3)
      integer(c_int) :: status
    end function spar_beam_set_plane

    function spar_beam_get_plane(beam, normal) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: beam
      real(c_double), intent(inout), optional :: normal(3)
      integer(c_int) :: status
    end function spar_beam_get_plane

    function spar_member_set_fidelity(member, kind, modes) bind(c) result(status)
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: member
      integer(c_int), value :: kind
      integer(c_int64_t), value :: modes
      integer(c_int) :: status
    end function spar_member_set_fidelity

    function spar_member_get_fidelity(member, kind, modes) bind(c) result(status)
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: member
      integer(c_int), intent(inout), optional :: kind
      integer(c_int64_t), intent(inout), optional :: modes
      integer(c_int) :: status
    end function spar_member_get_fidelity

    function spar_member_set_effects(member, switch_on, switch_off) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: member
      integer(c_int), value :: switch_on, switch_off
      integer(c_int) :: status
    end function spar_member_set_effects

    function spar_member_get_effects(member, effects) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: member
      integer(c_int), intent(inout), optional :: effects
      integer(c_int) :: status
    end function spar_member_get_effects

    function spar_member_get_placement(member, x, q) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: member
      real(c_double), intent(inout), optional :: x(3), q(4)
      integer(c_int) :: status
    end function spar_member_get_placement

    function spar_member_get_root(member, kind) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: member
      integer(c_int), intent(inout), optional :: kind
      integer(c_int) :: status
    end function spar_member_get_root

    function spar_member_get_external(member, on) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: member
      integer(c_int), intent(inout), optional :: on
      integer(c_int) :: status
    end function spar_member_get_external

    function spar_member_get_session(member, session) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: member
      type(c_ptr), intent(inout), optional :: session
      integer(c_int) :: status
    end function spar_member_get_session

    pure function spar_member_get_name(member) bind(c) result(text)
      import :: c_ptr
      type(c_ptr), value :: member
      type(c_ptr) :: text
    end function spar_member_get_name

    function spar_beam_set_line_load(beam, kind, n, eta, load) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: beam
      integer(c_int), value :: kind
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: eta(*), load(*)
      integer(c_int) :: status
    end function spar_beam_set_line_load

    function spar_member_get_reaction(member, load) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: member
      real(c_double), intent(inout), optional :: load(6)
      integer(c_int) :: status
    end function spar_member_get_reaction

    function spar_beam_evaluate(beam, n, eta, strain, force, x, q) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: beam
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: eta(*)
      real(c_double), intent(inout), optional :: strain(*), force(*), x(*), q(*)
      integer(c_int) :: status
    end function spar_beam_evaluate

    function spar_member_get_energy(member, capacity, energy) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: member
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: energy(*)
      integer(c_int) :: status
    end function spar_member_get_energy

    function spar_member_get_work(member, capacity, work) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: member
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: work(*)
      integer(c_int) :: status
    end function spar_member_get_work

    function spar_member_solve_static(member, load_steps) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: member
      integer(c_int), value :: load_steps
      integer(c_int) :: status
    end function spar_member_solve_static

    function spar_member_solve_modes(member, n, frequency_hz, shapes) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: member
      integer(c_int64_t), value :: n
      real(c_double), intent(inout), optional :: frequency_hz(*), shapes(*)
      integer(c_int) :: status
    end function spar_member_solve_modes

    function spar_member_solve_eigenvalues(member, n, shift, eigenvalue, shapes, frame) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: member
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: shift(2)
      real(c_double), intent(inout), optional :: eigenvalue(*), shapes(*), frame(3)
      integer(c_int) :: status
    end function spar_member_solve_eigenvalues

    function spar_beam_set_modal_damping(beam, mode, ratio, mu) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: beam
      integer(c_int64_t), intent(in), optional :: mode(2)
      real(c_double), intent(in), optional :: ratio(2)
      real(c_double), intent(inout), optional :: mu(6)
      integer(c_int) :: status
    end function spar_beam_set_modal_damping

    function spar_beam_fit_damping(beam, n, mode, ratio, achieved) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: beam
      integer(c_int64_t), value :: n
      integer(c_int64_t), intent(in), optional :: mode(*)
      real(c_double), intent(in), optional :: ratio(*)
      real(c_double), intent(inout), optional :: achieved(*)
      integer(c_int) :: status
    end function spar_beam_fit_damping

    function spar_joint_create(session, name, a, node_a, b, node_b, free_motions, joint) bind(c) result(status)
      import :: c_char, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: session
      character(kind=c_char), intent(in), optional :: name(*)
      type(c_ptr), value :: a
      integer(c_int64_t), value :: node_a
      type(c_ptr), value :: b
      integer(c_int64_t), value :: node_b
      integer(c_int), value :: free_motions
      type(c_ptr), intent(inout), optional :: joint
      integer(c_int) :: status
    end function spar_joint_create

    function spar_joint_set_frame(joint, x, q) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: joint
      real(c_double), intent(in), optional :: x(3), q(4)
      integer(c_int) :: status
    end function spar_joint_set_frame

    function spar_joint_set_spring(joint, stiffness, damping, preload) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: joint
      real(c_double), intent(in), optional :: stiffness(36), damping(36), preload(6)
      integer(c_int) :: status
    end function spar_joint_set_spring

    function spar_spring_create(session, name, member, node, free_motions, stiffness, damping, preload, joint) &
        bind(c) result(status)
      import :: c_char, c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: session
      character(kind=c_char), intent(in), optional :: name(*)
      type(c_ptr), value :: member
      integer(c_int64_t), value :: node
      integer(c_int), value :: free_motions
      real(c_double), intent(in), optional :: stiffness(36), damping(36), preload(6)
      type(c_ptr), intent(inout), optional :: joint
      integer(c_int) :: status
    end function spar_spring_create

    function spar_joint_set_driven(joint, mask) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: joint
      integer(c_int), value :: mask
      integer(c_int) :: status
    end function spar_joint_set_driven

    function spar_joint_drive(joint, motion, rate, acceleration) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: joint
      real(c_double), intent(in), optional :: motion(6), rate(6), acceleration(6)
      integer(c_int) :: status
    end function spar_joint_drive

    function spar_joint_set_load(joint, load) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: joint
      real(c_double), intent(in), optional :: load(6)
      integer(c_int) :: status
    end function spar_joint_set_load

    function spar_link_create(session, name, a, node_a, point_a, b, node_b, point_b, joint) bind(c) result(status)
      import :: c_char, c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: session
      character(kind=c_char), intent(in), optional :: name(*)
      type(c_ptr), value :: a
      integer(c_int64_t), value :: node_a
      real(c_double), intent(in), optional :: point_a(3)
      type(c_ptr), value :: b
      integer(c_int64_t), value :: node_b
      real(c_double), intent(in), optional :: point_b(3)
      type(c_ptr), intent(inout), optional :: joint
      integer(c_int) :: status
    end function spar_link_create

    function spar_link_set_spring(joint, stiffness, damping, length, tension_only) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: joint
      real(c_double), value :: stiffness, damping, length
      integer(c_int), value :: tension_only
      integer(c_int) :: status
    end function spar_link_set_spring

    function spar_joint_get_motion(joint, motion, rate, acceleration) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: joint
      real(c_double), intent(inout), optional :: motion(6), rate(6), acceleration(6)
      integer(c_int) :: status
    end function spar_joint_get_motion

    function spar_joint_get_load(joint, load) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: joint
      real(c_double), intent(inout), optional :: load(6)
      integer(c_int) :: status
    end function spar_joint_get_load

    function spar_joint_get_energy(joint, capacity, energy) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: joint
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: energy(*)
      integer(c_int) :: status
    end function spar_joint_get_energy

    ! spar_coupling.h
    function spar_session_set_integrator(session, rho_inf, substeps) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), value :: rho_inf
      integer(c_int), value :: substeps
      integer(c_int) :: status
    end function spar_session_set_integrator

    function spar_session_get_integrator(session, rho_inf, substeps) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), intent(inout), optional :: rho_inf
      integer(c_int), intent(inout), optional :: substeps
      integer(c_int) :: status
    end function spar_session_get_integrator

    function spar_session_set_newton(session, atol, rtol, max_iterations) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), value :: atol, rtol
      integer(c_int), value :: max_iterations
      integer(c_int) :: status
    end function spar_session_set_newton

    function spar_session_get_newton(session, atol, rtol, max_iterations) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), intent(inout), optional :: atol, rtol
      integer(c_int), intent(inout), optional :: max_iterations
      integer(c_int) :: status
    end function spar_session_get_newton

    function spar_member_get_iterations(member, iterations, left) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: member
      integer(c_int64_t), intent(inout), optional :: iterations
      real(c_double), intent(inout), optional :: left
      integer(c_int) :: status
    end function spar_member_get_iterations

    function spar_session_set_progress(session, progress, context) bind(c) result(status)
      import :: c_funptr, c_int, c_ptr
      type(c_ptr), value :: session
      type(c_funptr), value :: progress
      type(c_ptr), value :: context
      integer(c_int) :: status
    end function spar_session_set_progress

    function spar_session_set_predictor(session, order) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int), value :: order
      integer(c_int) :: status
    end function spar_session_set_predictor

    function spar_session_get_predictor(session, order) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int), intent(inout), optional :: order
      integer(c_int) :: status
    end function spar_session_get_predictor

    function spar_session_set_relaxation(session, omega) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), value :: omega
      integer(c_int) :: status
    end function spar_session_set_relaxation

    function spar_session_get_relaxation(session, omega) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), intent(inout), optional :: omega
      integer(c_int) :: status
    end function spar_session_get_relaxation

    function spar_session_set_option(session, key, value) bind(c) result(status)
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: session
      character(kind=c_char), intent(in), optional :: key(*), value(*)
      integer(c_int) :: status
    end function spar_session_set_option

    function spar_session_get_option(session, key, capacity, text) bind(c) result(status)
      import :: c_char, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: session
      character(kind=c_char), intent(in), optional :: key(*)
      integer(c_int64_t), value :: capacity
      character(kind=c_char), intent(inout), optional :: text(*)
      integer(c_int) :: status
    end function spar_session_get_option

    function spar_session_get_iterations(session, iterations, capacity, residual, size) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: session
      integer(c_int), intent(inout), optional :: iterations
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: residual(*), size(*)
      integer(c_int) :: status
    end function spar_session_get_iterations

    function spar_session_get_residual(session, residual, size) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), intent(inout), optional :: residual, size
      integer(c_int) :: status
    end function spar_session_get_residual

    function spar_session_get_report(session, capacity, report) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: session
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: report(*)
      integer(c_int) :: status
    end function spar_session_get_report

    function spar_session_get_phase(session, phase) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int), intent(inout), optional :: phase
      integer(c_int) :: status
    end function spar_session_get_phase

    function spar_member_set_added_mass(member, n, eta, mass) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: member
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: eta(*), mass(*)
      integer(c_int) :: status
    end function spar_member_set_added_mass

    function spar_member_get_added_mass(member, n, capacity, eta, mass) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: member
      integer(c_int64_t), intent(inout), optional :: n
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: eta(*), mass(*)
      integer(c_int) :: status
    end function spar_member_get_added_mass

    function spar_member_set_added_mass_response(member, response) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: member
      integer(c_int), value :: response
      integer(c_int) :: status
    end function spar_member_set_added_mass_response

    function spar_member_get_added_mass_response(member, response) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: member
      integer(c_int), intent(inout), optional :: response
      integer(c_int) :: status
    end function spar_member_get_added_mass_response

    function spar_session_solve_initial(session, dt, solve, context, iterations) bind(c) result(status)
      import :: c_double, c_funptr, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), value :: dt
      type(c_funptr), value :: solve
      type(c_ptr), value :: context
      integer(c_int), intent(inout), optional :: iterations
      integer(c_int) :: status
    end function spar_session_solve_initial

    function spar_step_begin_initial(session, dt) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), value :: dt
      integer(c_int) :: status
    end function spar_step_begin_initial

    function spar_session_solve_static(session, load_steps, solve, context, iterations) bind(c) result(status)
      import :: c_funptr, c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int), value :: load_steps
      type(c_funptr), value :: solve
      type(c_ptr), value :: context
      integer(c_int), intent(inout), optional :: iterations
      integer(c_int) :: status
    end function spar_session_solve_static

    function spar_session_set_tolerance(session, drift, rtol) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), value :: drift, rtol
      integer(c_int) :: status
    end function spar_session_set_tolerance

    function spar_session_get_tolerance(session, drift, rtol) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), intent(inout), optional :: drift, rtol
      integer(c_int) :: status
    end function spar_session_get_tolerance

    function spar_session_get_step_control(session, ratio, next_dt, reject, rejected) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: session
      real(c_double), intent(inout), optional :: ratio, next_dt
      integer(c_int), intent(inout), optional :: reject
      integer(c_int64_t), intent(inout), optional :: rejected
      integer(c_int) :: status
    end function spar_session_get_step_control

    function spar_step_adaptive(session, dt, before, solve, context, taken) bind(c) result(status)
      import :: c_double, c_funptr, c_int, c_ptr
      type(c_ptr), value :: session
      real(c_double), intent(inout), optional :: dt
      type(c_funptr), value :: before, solve
      type(c_ptr), value :: context
      real(c_double), intent(inout), optional :: taken
      integer(c_int) :: status
    end function spar_step_adaptive

    function spar_session_set_reproducible(session, on) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int), value :: on
      integer(c_int) :: status
    end function spar_session_set_reproducible

    function spar_session_get_reproducible(session, on) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int), intent(inout), optional :: on
      integer(c_int) :: status
    end function spar_session_get_reproducible

    function spar_session_set_threads(session, threads) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int), value :: threads
      integer(c_int) :: status
    end function spar_session_set_threads

    function spar_session_get_threads(session, threads) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int), intent(inout), optional :: threads
      integer(c_int) :: status
    end function spar_session_get_threads

    function spar_member_set_owner(member, rank) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: member
      integer(c_int), value :: rank
      integer(c_int) :: status
    end function spar_member_set_owner

    function spar_member_get_owner(member, rank) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: member
      integer(c_int), intent(inout), optional :: rank
      integer(c_int) :: status
    end function spar_member_get_owner

    function spar_session_sum_balance(session, capacity, members, expected, counted) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: session
      integer(c_int64_t), value :: capacity
      integer(c_int64_t), intent(inout), optional :: members(*)
      real(c_double), intent(inout), optional :: expected(*), counted(*)
      integer(c_int) :: status
    end function spar_session_sum_balance

    function spar_session_sum(session, status, n, x) bind(c) result(answer)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: session
      integer(c_int), value :: status
      integer(c_int64_t), value :: n
      real(c_double), intent(inout), optional :: x(*)
      integer(c_int) :: answer
    end function spar_session_sum

    function spar_session_fail(session, status, message) bind(c) result(answer)
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: session
      integer(c_int), value :: status
      character(kind=c_char), intent(in), optional :: message(*)
      integer(c_int) :: answer
    end function spar_session_fail

    function spar_fluid_get_member(fluid, member) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: fluid
      type(c_ptr), intent(inout), optional :: member
      integer(c_int) :: status
    end function spar_fluid_get_member

    pure function spar_fluid_get_name(fluid) bind(c) result(text)
      import :: c_ptr
      type(c_ptr), value :: fluid
      type(c_ptr) :: text
    end function spar_fluid_get_name

    function spar_fluid_set_motion_stations(fluid, n, eta, offset) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: eta(*), offset(*)
      integer(c_int) :: status
    end function spar_fluid_set_motion_stations

    function spar_fluid_set_motion_weights(fluid, n, w) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: w(*)
      integer(c_int) :: status
    end function spar_fluid_set_motion_weights

    function spar_fluid_get_motion_weights(fluid, w) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      real(c_double), intent(inout), optional :: w(*)
      integer(c_int) :: status
    end function spar_fluid_get_motion_weights

    function spar_fluid_fade_motion(fluid, within, beyond, n, distance, held) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      real(c_double), value :: within, beyond
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: distance(*)
      integer(c_int), intent(in), optional :: held(*)
      integer(c_int) :: status
    end function spar_fluid_fade_motion

    function spar_fluid_set_layout(fluid, which, node, component) bind(c) result(status)
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), value :: which
      integer(c_int64_t), value :: node, component
      integer(c_int) :: status
    end function spar_fluid_set_layout

    function spar_fluid_get_layout(fluid, which, node, component) bind(c) result(status)
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), value :: which
      integer(c_int64_t), intent(inout), optional :: node, component
      integer(c_int) :: status
    end function spar_fluid_get_layout

    function spar_fluid_set_projection(fluid, method, max_distance) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), value :: method
      real(c_double), value :: max_distance
      integer(c_int) :: status
    end function spar_fluid_set_projection

    function spar_fluid_get_projection(fluid, method, max_distance) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), intent(inout), optional :: method
      real(c_double), intent(inout), optional :: max_distance
      integer(c_int) :: status
    end function spar_fluid_get_projection

    function spar_fluid_set_interpolation(fluid, kind) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), value :: kind
      integer(c_int) :: status
    end function spar_fluid_set_interpolation

    function spar_fluid_get_interpolation(fluid, kind) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), intent(inout), optional :: kind
      integer(c_int) :: status
    end function spar_fluid_get_interpolation

    function spar_fluid_set_option(fluid, key, value) bind(c) result(status)
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: fluid
      character(kind=c_char), intent(in), optional :: key(*), value(*)
      integer(c_int) :: status
    end function spar_fluid_set_option

    function spar_fluid_get_option(fluid, key, capacity, text) bind(c) result(status)
      import :: c_char, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      character(kind=c_char), intent(in), optional :: key(*)
      integer(c_int64_t), value :: capacity
      character(kind=c_char), intent(inout), optional :: text(*)
      integer(c_int) :: status
    end function spar_fluid_get_option

    function spar_fluid_map_current(fluid) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int) :: status
    end function spar_fluid_map_current

    function spar_fluid_get_count(fluid, which, n) bind(c) result(status)
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), value :: which
      integer(c_int64_t), intent(inout), optional :: n
      integer(c_int) :: status
    end function spar_fluid_get_count

    function spar_fluid_get_kind(fluid, which, kind) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), value :: which
      integer(c_int), intent(inout), optional :: kind
      integer(c_int) :: status
    end function spar_fluid_get_kind

    function spar_fluid_get_flag_count(fluid, which, flag, n) bind(c) result(status)
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), value :: which, flag
      integer(c_int64_t), intent(inout), optional :: n
      integer(c_int) :: status
    end function spar_fluid_get_flag_count

    function spar_fluid_get_map(fluid, which, eta, distance, flags) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), value :: which
      real(c_double), intent(inout), optional :: eta(*), distance(*)
      integer(c_int), intent(inout), optional :: flags(*)
      integer(c_int) :: status
    end function spar_fluid_get_map

    function spar_fluid_get_nearest(fluid, which, x_map, q_map, con) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), value :: which
      real(c_double), intent(inout), optional :: x_map(*), q_map(*), con(*)
      integer(c_int) :: status
    end function spar_fluid_get_nearest

    function spar_fluid_get_basis(fluid, which, first_node, phi) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), value :: which
      integer(c_int64_t), intent(inout), optional :: first_node(*)
      real(c_double), intent(inout), optional :: phi(*)
      integer(c_int) :: status
    end function spar_fluid_get_basis

    function spar_fluid_get_travel(fluid, largest, node) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      real(c_double), intent(inout), optional :: largest
      integer(c_int64_t), intent(inout), optional :: node
      integer(c_int) :: status
    end function spar_fluid_get_travel

    function spar_fluid_get_positions(fluid, which, x, q, v, nearest) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), value :: which
      real(c_double), intent(inout), optional :: x(*), q(*), v(*), nearest(*)
      integer(c_int) :: status
    end function spar_fluid_get_positions

    function spar_fluid_pull_matrices(fluid, theta, convention, matrix) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      real(c_double), value :: theta
      integer(c_int), value :: convention
      real(c_double), intent(inout), optional :: matrix(*)
      integer(c_int) :: status
    end function spar_fluid_pull_matrices

    function spar_fluid_check_matrices(fluid, convention, matrix) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), value :: convention
      real(c_double), intent(in), optional :: matrix(*)
      integer(c_int) :: status
    end function spar_fluid_check_matrices

    function spar_fluid_pull_forces(fluid, theta, force) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      real(c_double), value :: theta
      real(c_double), intent(inout), optional :: force(*)
      integer(c_int) :: status
    end function spar_fluid_pull_forces

    function spar_fluid_get_forces(fluid, force) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      real(c_double), intent(inout), optional :: force(*)
      integer(c_int) :: status
    end function spar_fluid_get_forces

    function spar_fluid_push_forces_at(fluid, theta, force, moment) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      real(c_double), value :: theta
      real(c_double), intent(in), optional :: force(*), moment(*)
      integer(c_int) :: status
    end function spar_fluid_push_forces_at

    function spar_fluid_set_states(fluid, width) bind(c) result(status)
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int64_t), value :: width
      integer(c_int) :: status
    end function spar_fluid_set_states

    function spar_fluid_get_states(fluid, width, dt) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int64_t), intent(inout), optional :: width
      real(c_double), intent(inout), optional :: dt
      integer(c_int) :: status
    end function spar_fluid_get_states

    function spar_fluid_pull_states(fluid, width, states) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int64_t), value :: width
      real(c_double), intent(inout), optional :: states(*)
      integer(c_int) :: status
    end function spar_fluid_pull_states

    function spar_fluid_push_states(fluid, width, states) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int64_t), value :: width
      real(c_double), intent(in), optional :: states(*)
      integer(c_int) :: status
    end function spar_fluid_push_states

    function spar_fluid_pull_motion_f32(fluid, theta, x, v) bind(c) result(status)
      import :: c_double, c_float, c_int, c_ptr
      type(c_ptr), value :: fluid
      real(c_double), value :: theta
      real(c_float), intent(inout), optional :: x(*), v(*)
      integer(c_int) :: status
    end function spar_fluid_pull_motion_f32

    function spar_fluid_pull_poses_f32(fluid, which, theta, x, q, v, omega, accel, alpha) bind(c) result(status)
      import :: c_double, c_float, c_int, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int), value :: which
      real(c_double), value :: theta
      real(c_float), intent(inout), optional :: x(*), q(*), v(*), omega(*), accel(*), alpha(*)
      integer(c_int) :: status
    end function spar_fluid_pull_poses_f32

    function spar_fluid_pull_forces_f32(fluid, theta, force) bind(c) result(status)
      import :: c_double, c_float, c_int, c_ptr
      type(c_ptr), value :: fluid
      real(c_double), value :: theta
      real(c_float), intent(inout), optional :: force(*)
      integer(c_int) :: status
    end function spar_fluid_pull_forces_f32

    function spar_fluid_push_forces_f32(fluid, force, moment) bind(c) result(status)
      import :: c_float, c_int, c_ptr
      type(c_ptr), value :: fluid
      real(c_float), intent(in), optional :: force(*), moment(*)
      integer(c_int) :: status
    end function spar_fluid_push_forces_f32

    function spar_fluid_get_audit(fluid, capacity, audit) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: fluid
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: audit(*)
      integer(c_int) :: status
    end function spar_fluid_get_audit

    function spar_fluid_sum_loads(fluid, point, force, moment) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      real(c_double), intent(in), optional :: point(3)
      real(c_double), intent(inout), optional :: force(3), moment(3)
      integer(c_int) :: status
    end function spar_fluid_sum_loads

    function spar_fluid_check_loads(fluid, point, force, moment, rtol) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: fluid
      real(c_double), intent(in), optional :: point(3), force(3), moment(3)
      real(c_double), value :: rtol
      integer(c_int) :: status
    end function spar_fluid_check_loads

    ! spar_analysis.h
    function spar_member_estimate_error(member, step, nodes) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: member
      real(c_double), intent(inout), optional :: step, nodes
      integer(c_int) :: status
    end function spar_member_estimate_error

    function spar_member_learn_added_mass(member, n, eta) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: member
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: eta(*)
      integer(c_int) :: status
    end function spar_member_learn_added_mass

    function spar_member_get_learned_added_mass(member, used, spread, n, capacity, eta, mass) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: member
      integer(c_int), intent(inout), optional :: used
      real(c_double), intent(inout), optional :: spread
      integer(c_int64_t), intent(inout), optional :: n
      integer(c_int64_t), value :: capacity
      real(c_double), intent(inout), optional :: eta(*), mass(*)
      integer(c_int) :: status
    end function spar_member_get_learned_added_mass

    function spar_trial_create(session, trial) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: session
      type(c_ptr), intent(inout), optional :: trial
      integer(c_int) :: status
    end function spar_trial_create

    subroutine spar_trial_destroy(trial) bind(c)
      import :: c_ptr
      type(c_ptr), intent(inout), optional :: trial
    end subroutine spar_trial_destroy

    function spar_trial_get_session(trial, session) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: trial
      type(c_ptr), intent(inout), optional :: session
      integer(c_int) :: status
    end function spar_trial_get_session

    function spar_trial_set_steps(trial, dt, steps) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: trial
      real(c_double), value :: dt
      integer(c_int64_t), value :: steps
      integer(c_int) :: status
    end function spar_trial_set_steps

    function spar_trial_get_steps(trial, dt, steps) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: trial
      real(c_double), intent(inout), optional :: dt
      integer(c_int64_t), intent(inout), optional :: steps
      integer(c_int) :: status
    end function spar_trial_get_steps

    function spar_trial_set_callbacks(trial, before, before_context, solve, solve_context) bind(c) result(status)
      import :: c_funptr, c_int, c_ptr
      type(c_ptr), value :: trial
      type(c_funptr), value :: before
      type(c_ptr), value :: before_context
      type(c_funptr), value :: solve
      type(c_ptr), value :: solve_context
      integer(c_int) :: status
    end function spar_trial_set_callbacks

    function spar_trial_set_progress(trial, progress, context) bind(c) result(status)
      import :: c_funptr, c_int, c_ptr
      type(c_ptr), value :: trial
      type(c_funptr), value :: progress
      type(c_ptr), value :: context
      integer(c_int) :: status
    end function spar_trial_set_progress

    function spar_trial_run(trial, compare) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: trial
      integer(c_int), value :: compare
      integer(c_int) :: status
    end function spar_trial_run

    function spar_trial_get_errors(trial, motion, reaction, load) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: trial
      real(c_double), intent(inout), optional :: motion, reaction, load
      integer(c_int) :: status
    end function spar_trial_get_errors

    function spar_trial_get_cost(trial, seconds, evaluations) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: trial
      real(c_double), intent(inout), optional :: seconds
      integer(c_int64_t), intent(inout), optional :: evaluations
      integer(c_int) :: status
    end function spar_trial_get_cost

    pure function spar_effect_name(row) bind(c) result(text)
      import :: c_int, c_ptr
      integer(c_int), value :: row
      type(c_ptr) :: text
    end function spar_effect_name

    function spar_trial_report_effects(trial) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: trial
      integer(c_int) :: status
    end function spar_trial_report_effects

    function spar_trial_get_effect(trial, row, in_force, fails, size, motion, reaction, share) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: trial
      integer(c_int), value :: row
      integer(c_int), intent(inout), optional :: in_force, fails
      real(c_double), intent(inout), optional :: size, motion, reaction, share
      integer(c_int) :: status
    end function spar_trial_get_effect

    function spar_trial_set_goals(trial, goals) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: trial
      integer(c_int), value :: goals
      integer(c_int) :: status
    end function spar_trial_set_goals

    function spar_trial_get_goals(trial, goals) bind(c) result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: trial
      integer(c_int), intent(inout), optional :: goals
      integer(c_int) :: status
    end function spar_trial_get_goals

    function spar_trial_push_numbers(trial, n, numbers) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: trial
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: numbers(*)
      integer(c_int) :: status
    end function spar_trial_push_numbers

    function spar_trial_set_option(trial, key, value) bind(c) result(status)
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: trial
      character(kind=c_char), intent(in), optional :: key(*), value(*)
      integer(c_int) :: status
    end function spar_trial_set_option

    function spar_trial_get_option(trial, key, capacity, text) bind(c) result(status)
      import :: c_char, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: trial
      character(kind=c_char), intent(in), optional :: key(*)
      integer(c_int64_t), value :: capacity
      character(kind=c_char), intent(inout), optional :: text(*)
      integer(c_int) :: status
    end function spar_trial_get_option

    function spar_trial_advise(trial, tolerance, length) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: trial
      real(c_double), value :: tolerance, length
      integer(c_int) :: status
    end function spar_trial_advise

    function spar_trial_get_settings(trial, dt, substeps, scheme, coupling_rtol, predictor, newton_rtol) bind(c) &
        result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: trial
      real(c_double), intent(inout), optional :: dt
      integer(c_int), intent(inout), optional :: substeps, scheme
      real(c_double), intent(inout), optional :: coupling_rtol
      integer(c_int), intent(inout), optional :: predictor
      real(c_double), intent(inout), optional :: newton_rtol
      integer(c_int) :: status
    end function spar_trial_get_settings

    function spar_trial_get_beam(trial, member, fidelity, modes, elements, nodes_per_element, points) bind(c) &
        result(status)
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: trial, member
      integer(c_int), intent(inout), optional :: fidelity
      integer(c_int64_t), intent(inout), optional :: modes
      integer(c_int), intent(inout), optional :: elements, nodes_per_element, points
      integer(c_int) :: status
    end function spar_trial_get_beam

    function spar_trial_get_outcome(trial, error, cost, present_fails, present_error) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: trial
      real(c_double), intent(inout), optional :: error, cost
      integer(c_int), intent(inout), optional :: present_fails
      real(c_double), intent(inout), optional :: present_error
      integer(c_int) :: status
    end function spar_trial_get_outcome

    function spar_trial_get_search(trial, runs, work) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: trial
      integer(c_int64_t), intent(inout), optional :: runs
      real(c_double), intent(inout), optional :: work
      integer(c_int) :: status
    end function spar_trial_get_search

    function spar_trial_apply(trial, dt) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: trial
      real(c_double), intent(inout), optional :: dt
      integer(c_int) :: status
    end function spar_trial_apply

    function spar_trial_set_motion(trial, modes, amplitude, memory) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: trial
      integer(c_int64_t), value :: modes
      real(c_double), value :: amplitude
      integer(c_int64_t), value :: memory
      integer(c_int) :: status
    end function spar_trial_set_motion

    function spar_trial_get_motion(trial, modes, amplitude, memory) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: trial
      integer(c_int64_t), intent(inout), optional :: modes
      real(c_double), intent(inout), optional :: amplitude
      integer(c_int64_t), intent(inout), optional :: memory
      integer(c_int) :: status
    end function spar_trial_get_motion

    function spar_trial_solve_eigenvalues(trial, n, shift, eigenvalue, nodes, shapes, frame) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: trial
      integer(c_int64_t), value :: n
      real(c_double), intent(in), optional :: shift(2)
      real(c_double), intent(inout), optional :: eigenvalue(*)
      integer(c_int64_t), value :: nodes
      real(c_double), intent(inout), optional :: shapes(*), frame(3)
      integer(c_int) :: status
    end function spar_trial_solve_eigenvalues

    function spar_trial_solve_floquet(trial, n, eigenvalue) bind(c) result(status)
      import :: c_double, c_int, c_int64_t, c_ptr
      type(c_ptr), value :: trial
      integer(c_int64_t), value :: n
      real(c_double), intent(inout), optional :: eigenvalue(*)
      integer(c_int) :: status
    end function spar_trial_solve_floquet

    ! spar_output.h
    function spar_member_write_vtk(member, path) bind(c) result(status)
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: member
      character(kind=c_char), intent(in), optional :: path(*)
      integer(c_int) :: status
    end function spar_member_write_vtk

    function spar_fluid_write_vtk(fluid, path) bind(c) result(status)
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: fluid
      character(kind=c_char), intent(in), optional :: path(*)
      integer(c_int) :: status
    end function spar_fluid_write_vtk

    function spar_vtk_series_add(path, time, part, file) bind(c) result(status)
      import :: c_char, c_double, c_int
      character(kind=c_char), intent(in), optional :: path(*)
      real(c_double), value :: time
      integer(c_int), value :: part
      character(kind=c_char), intent(in), optional :: file(*)
      integer(c_int) :: status
    end function spar_vtk_series_add
  end interface
end module spar_calls

module spar_c
  use, intrinsic :: iso_c_binding, only: c_int
  use spar_calls
  implicit none
  private :: c_int
  public

  ! spar.h
  integer(c_int), parameter :: SPAR_OK = 0, SPAR_ERR_ARGUMENT = 1, SPAR_ERR_STATE = 2, SPAR_ERR_MEMORY = 3, &
      SPAR_ERR_NUMERIC = 4, SPAR_ERR_MAPPING = 5, SPAR_ERR_COMM = 6, SPAR_ERR_PEER = 7, SPAR_ERR_IO = 8, &
      SPAR_ERR_UNSUPPORTED = 9, SPAR_ERR_USER = 10, SPAR_ERR_LIMIT = 11
  integer(c_int), parameter :: SPAR_COUPLING_EXPLICIT = 0, SPAR_COUPLING_FIXED_POINT = 1, SPAR_COUPLING_AITKEN = 2, &
      SPAR_COUPLING_IQN_ILS = 3
  integer(c_int), parameter :: SPAR_LOG_ERROR = 0, SPAR_LOG_WARNING = 1, SPAR_LOG_INFO = 2
  integer(c_int), parameter :: SPAR_ROOT_FREE = 0, SPAR_ROOT_FIXED = 1, SPAR_ROOT_PINNED = 2, SPAR_ROOT_DRIVEN = 3
  integer(c_int), parameter :: SPAR_LOAD_DEAD = 0, SPAR_LOAD_FOLLOWER = 1
  integer(c_int), parameter :: SPAR_NODES_MOTION = 0, SPAR_NODES_FORCE = 1
  ! spar_structure.h
  integer(c_int), parameter :: SPAR_SECTION_EA = 0, SPAR_SECTION_GA_Y = 1, SPAR_SECTION_GA_Z = 2, &
      SPAR_SECTION_GJ = 3, SPAR_SECTION_EI_Y = 4, SPAR_SECTION_EI_Z = 5, SPAR_SECTION_ANGLE = 6, &
      SPAR_SECTION_SHEAR_ANGLE = 7, SPAR_SECTION_TENSION_Y = 8, SPAR_SECTION_TENSION_Z = 9, &
      SPAR_SECTION_SHEAR_Y = 10, SPAR_SECTION_SHEAR_Z = 11, SPAR_SECTION_MASS = 12, SPAR_SECTION_MASS_Y = 13, &
      SPAR_SECTION_MASS_Z = 14, SPAR_SECTION_INERTIA_Y = 15, SPAR_SECTION_INERTIA_Z = 16, &
      SPAR_SECTION_INERTIA_ANGLE = 17, SPAR_SECTION_COUNT = 18
  integer(c_int), parameter :: SPAR_SHAPE_CIRCLE = 0, SPAR_SHAPE_TUBE = 1, SPAR_SHAPE_RECTANGLE = 2, SPAR_SHAPE_BOX = 3
  integer(c_int), parameter :: SPAR_FINDING_ASYMMETRIC = 1, SPAR_FINDING_INDEFINITE = 2, SPAR_FINDING_MASS = 4, &
      SPAR_FINDING_BEND_TWIST = 8, SPAR_FINDING_STRETCH_TWIST = 16, SPAR_FINDING_STRETCH_SHEAR = 32, &
      SPAR_FINDING_BEND_SHEAR = 64, SPAR_FINDING_POLAR = 128, SPAR_FINDING_ORDER = 256, SPAR_FINDING_UNITS = 512
  integer(c_int), parameter :: SPAR_QUADRATURE_GAUSS = 0, SPAR_QUADRATURE_LOBATTO = 1, SPAR_QUADRATURE_SECTIONS = 2
  integer(c_int), parameter :: SPAR_FIDELITY_PRESCRIBED = 0, SPAR_FIDELITY_RIGID = 1, SPAR_FIDELITY_LINEAR = 2, &
      SPAR_FIDELITY_MODAL = 3, SPAR_FIDELITY_EXACT = 4
  integer(c_int), parameter :: SPAR_EFFECT_INERTIA = 1, SPAR_EFFECT_GYROSCOPIC = 2, SPAR_EFFECT_GRAVITY = 4, &
      SPAR_EFFECT_DAMPING = 8, SPAR_EFFECT_FLUID_MOMENT = 32, SPAR_EFFECT_FLUID_HISTORY = 64, SPAR_EFFECT_WORK = 128, &
      SPAR_EFFECT_MASSES = 512, SPAR_EFFECT_FOUNDATION = 1024, SPAR_EFFECT_PRETENSION = 2048
  integer(c_int), parameter :: SPAR_ENERGY_KINETIC = 0, SPAR_ENERGY_STRAIN = 1, SPAR_ENERGY_GRAVITY = 2, &
      SPAR_ENERGY_DISSIPATED = 3, SPAR_ENERGY_FOUNDATION = 4, SPAR_ENERGY_COUNT = 5
  integer(c_int), parameter :: SPAR_WORK_LOADS = 0, SPAR_WORK_FLUID = 1, SPAR_WORK_ROOT = 2, SPAR_WORK_JOINTS = 3, &
      SPAR_WORK_COUNT = 4
  integer(c_int), parameter :: SPAR_FREE_X = 1, SPAR_FREE_Y = 2, SPAR_FREE_Z = 4, SPAR_FREE_RX = 8, &
      SPAR_FREE_RY = 16, SPAR_FREE_RZ = 32
  integer(c_int), parameter :: SPAR_JOINT_ENERGY_SPRING = 0, SPAR_JOINT_ENERGY_DAMPER = 1, &
      SPAR_JOINT_ENERGY_DRIVE = 2, SPAR_JOINT_ENERGY_LOAD = 3, SPAR_JOINT_ENERGY_COUNT = 4
  ! spar_coupling.h
  integer(c_int), parameter :: SPAR_REPORT_CONTRACTION = 0, SPAR_REPORT_ADDED_MASS = 1, SPAR_REPORT_COLUMNS = 2, &
      SPAR_REPORT_DROPPED = 3, SPAR_REPORT_ERROR = 4, SPAR_REPORT_WORK_DEFECT = 5, SPAR_REPORT_UNCONVERGED = 6, &
      SPAR_REPORT_ADDED_MASS_SPREAD = 7, SPAR_REPORT_MOTION_ERROR = 8, SPAR_REPORT_COUNT = 9
  integer(c_int), parameter :: SPAR_PHASE_START = 0, SPAR_PHASE_BETWEEN = 1, SPAR_PHASE_BEGUN = 2, &
      SPAR_PHASE_SOLVED = 3, SPAR_PHASE_CHECKED = 4
  integer(c_int), parameter :: SPAR_RESPONSE_ACCELERATION = 0, SPAR_RESPONSE_VELOCITY = 1
  integer(c_int), parameter :: SPAR_PROJECT_BOUNDED = 0, SPAR_PROJECT_RPOLY = 1
  integer(c_int), parameter :: SPAR_INTERPOLATE_NODAL = 0, SPAR_INTERPOLATE_CONSISTENT = 1
  integer(c_int), parameter :: SPAR_KIND_STATIONS = 1, SPAR_KIND_SHARED = 2, SPAR_KIND_WEIGHTS = 4, SPAR_KIND_FORCES = 8
  integer(c_int), parameter :: SPAR_MAP_END = 1, SPAR_MAP_AMBIGUOUS = 2, SPAR_MAP_FAR = 4
  integer(c_int), parameter :: SPAR_MATRIX_LOCAL_TO_GLOBAL = 0, SPAR_MATRIX_GLOBAL_TO_LOCAL = 1
  integer(c_int), parameter :: SPAR_AUDIT_FORCE = 0, SPAR_AUDIT_MOMENT = 1, SPAR_AUDIT_POWER = 2, &
      SPAR_AUDIT_FORCE_ERROR = 3, SPAR_AUDIT_MOMENT_ERROR = 4, SPAR_AUDIT_POWER_ERROR = 5, SPAR_AUDIT_FARTHEST = 6, &
      SPAR_AUDIT_NODES = 7, SPAR_AUDIT_COUNT = 8
  ! spar_analysis.h
  integer(c_int), parameter :: SPAR_ROW_INERTIA = 0, SPAR_ROW_GYROSCOPIC = 1, SPAR_ROW_GRAVITY = 2, &
      SPAR_ROW_DAMPING = 3, SPAR_ROW_FLUID_MOMENT = 4, SPAR_ROW_FLUID_VELOCITY = 5, SPAR_ROW_FLUID_POSES = 6, &
      SPAR_ROW_FLUID_HISTORY = 7, SPAR_ROW_PREDICTOR = 8, SPAR_ROW_ITERATION = 9, SPAR_ROW_HALF_STEP = 10, &
      SPAR_ROW_MASSES = 11, SPAR_ROW_FOUNDATION = 12, SPAR_ROW_PRETENSION = 13, SPAR_ROW_COUNT = 14
  integer(c_int), parameter :: SPAR_GOAL_MOTION = 1, SPAR_GOAL_REACTION = 2, SPAR_GOAL_SECTION = 4, &
      SPAR_GOAL_LOAD = 8, SPAR_GOAL_NUMBERS = 16
end module spar_c
