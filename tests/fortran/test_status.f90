! Status, messages, shapes and life of the types of the module: what the wrapper adds to C. The expected values are the rules
! at the top of fortran/spar.f90.
program test_status
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int, c_int64_t
  use spar
  use spar_aero
  implicit none
  character(*), parameter :: untouched = 'untouched'
  real(c_double), parameter :: unit(4) = [1, 0, 0, 0], origin(3) = 0
  integer :: failures = 0

  call texts()
  call life()
  call life() ! again, after the variables of the first call were finalised
  call messages()
  call bad_values()
  call shapes()
  call empty_arrays()
  call array_sections()
  call counting()
  call blade_objects()
  if (failures > 0) error stop 'test_status failed'

contains

  subroutine check(right, what)
    logical, intent(in) :: right
    character(*), intent(in) :: what

    if (right) return
    failures = failures + 1
    write (*, '(2a)') 'wrong: ', what
  end subroutine check

  ! Equality that is meant: numbers that are handed through, or small whole ones.
  elemental logical function alike(a, b)
    real(c_double), intent(in) :: a, b

    alike = abs(a - b) <= 0
  end function alike

  elemental logical function same(a, b)
    real(c_double), intent(in) :: a
    integer, intent(in) :: b

    same = alike(a, real(b, c_double))
  end function same

  ! A session with a body of 2 kg, committed.
  subroutine make_body(session, body)
    type(spar_session), intent(inout) :: session
    type(spar_member), intent(inout) :: body

    call session%create()
    call body%create_rigid(session, 'body', origin, unit, whole_mass())
    call body%set_effects(SPAR_EFFECT_FLUID_HISTORY, 0)
    call body%commit()
  end subroutine make_body

  pure function whole_mass() result(mass)
    real(c_double) :: mass(6,6)
    integer :: i

    mass = 0
    do i = 1, 6
      mass(i,i) = merge(2.0_c_double, 1.0_c_double, i <= 3)
    end do
  end function whole_mass

  subroutine texts()
    call check(len(spar_version()) > 0, 'there is a version')
    call check(len(spar_status_text(SPAR_ERR_NUMERIC)) > 0, 'a status has a text')
    call check(spar_status_text(SPAR_OK) /= spar_status_text(SPAR_ERR_NUMERIC), 'statuses have texts of their own')
    call check(.not. spar_has('no such feature') .and. .not. spar_has(''), 'an unknown feature is not there')
  end subroutine texts

  ! Session, several(2) and polar are left to their finalisation: a leak checker sees it if that is not done.
  subroutine life()
    type(spar_session) :: session, several(3), none(3)
    type(spar_polar) :: polar
    type(spar_aero_object) :: aero
    type(spar_fluid) :: fluid
    type(spar_member) :: member, copy
    integer(c_int) :: stat
    character(200) :: errmsg

    call session%destroy()
    call polar%destroy()
    call aero%destroy()
    call fluid%destroy()
    call check(.not. session%exists() .and. .not. member%exists() .and. .not. fluid%exists(), 'nothing exists at first')
    call session%create()
    call check(session%exists() .and. c_associated(session%c_handle()), 'created')
    call session%create(stat=stat, errmsg=errmsg)
    call check(stat == SPAR_ERR_STATE .and. index(errmsg, 'session%create') > 0, 'a session created twice is refused')
    call session%destroy()
    call session%destroy()
    call check(.not. session%exists(), 'destroyed twice')
    call make_body(session, member)
    copy = member
    call copy%get_count(stat)
    call check(copy%exists() .and. stat == 1, 'a member is a view and can be copied')
    several = none
    call check(.not. several(1)%exists() .and. .not. several(3)%exists(), 'nothing can be assigned to nothing')
    call several(2)%create()
    call polar%create([-1.0_c_double, 1.0_c_double], [0.0_c_double, 0.0_c_double], [0.0_c_double, 0.0_c_double])
    call polar%create([-1.0_c_double, 1.0_c_double], [0.0_c_double, 0.0_c_double], [0.0_c_double, 0.0_c_double], stat=stat)
    call check(stat == SPAR_ERR_STATE .and. polar%exists(), 'a polar created twice is refused')
    call fluid%create(copy, 'fluid')
    call fluid%destroy()
    call fluid%destroy()
    call check(.not. fluid%exists(), 'a fluid destroyed twice')
  end subroutine life

  subroutine messages()
    type(spar_session) :: session
    type(spar_member) :: body, twin, beam
    type(spar_fluid) :: fluid
    integer(c_int) :: stat
    character(300) :: errmsg
    character(10) :: short

    stat = 17
    errmsg = untouched
    call session%create(stat=stat, errmsg=errmsg)
    call check(stat == SPAR_OK .and. errmsg == untouched, 'success sets stat and leaves errmsg')
    call session%destroy()
    call make_body(session, body)
    call session%set_predictor(7, stat, errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. errmsg == session%message(), 'errmsg is the message of the session')
    call check(index(errmsg, 'spar_session_set_predictor') > 0 .and. index(errmsg, '7') > 0, 'the message says what')
    call session%set_predictor(7, stat, short)
    call check(short == errmsg(1:10), 'a short errmsg takes what it can')
    call session%set_predictor(7, stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'stat goes without errmsg')
    call twin%create_point(session, 'body   ', origin, unit, stat, errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. .not. twin%exists(), 'blanks at the end of a name do not count')
    call check(index(errmsg, '''body''') > 0, 'the message names the twin')
    call beam%create_beam(session, 'beam', 1, 1, stat, errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. .not. beam%exists(), 'a beam of one node is refused')
    call beam%commit(stat, errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. len_trim(errmsg) > 0, 'what was never created is refused')
    call fluid%create(beam, 'fluid', stat, errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. .not. fluid%exists(), 'a fluid on no member is refused')
    call session%step_solve(stat, errmsg)
    call check(stat == SPAR_ERR_STATE, 'a step must begin')
    call session%step_begin(0.1_c_double, stat, errmsg)
    call check(stat == SPAR_OK, 'after refusals the session works')
    call session%step_reject()
    call session%set_option('no such', 'option', stat, errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, 'no such') > 0, 'texts arrive as they are')
  end subroutine messages

  subroutine bad_values()
    type(spar_session) :: session
    type(spar_member) :: body
    type(spar_fluid) :: fluid
    type(spar_member) :: own, solved
    real(c_double) :: x(3,2), before(3,2), rest(7,1), nan
    integer(c_int) :: stat
    logical :: done

    nan = ieee_value(nan, ieee_quiet_nan)
    call make_body(session, body)
    call session%set_gravity([0.0_c_double, nan, 0.0_c_double], stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'gravity not a number')
    call own%create_rigid(session, 'own', origin, unit, whole_mass())
    call own%set_external(.true.)
    call own%commit()
    call solved%create_rigid(session, 'solved', origin, unit, whole_mass())
    call solved%set_external(.true.)
    call solved%set_external(.false.)
    call solved%commit()
    rest = 0
    rest(4,1) = 1
    call own%set_motion(rest, stat=stat)
    call check(stat == SPAR_OK, 'the host moves what it solves itself')
    call solved%set_motion(rest, stat=stat)
    call check(stat == SPAR_ERR_STATE, 'and nothing else')
    call fluid%create(body, 'fluid')
    x = 1
    call fluid%set_force_nodes(x)
    call fluid%set_motion_nodes(x)
    before = x
    call fluid%pull_motion(1.0_c_double, x, stat=stat)
    call check(stat == SPAR_ERR_STATE .and. all(alike(x, before)), 'a refused pull leaves the array')
    call fluid%map()
    call fluid%pull_motion(nan, x, stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT .and. all(alike(x, before)), 'theta not a number')
    call session%step_begin(-1.0_c_double, stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'a step back in time')
    call session%set_coupling(SPAR_COUPLING_EXPLICIT, 1e-9_c_double, 1e-6_c_double, 50)
    call session%step_begin(0.1_c_double)
    call session%step_solve()
    x(2,2) = nan
    call fluid%push_forces(x, stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'a force not a number')
    done = .false.
    call session%step_check(done, stat)
    call check(stat == SPAR_ERR_ARGUMENT .and. done, 'the step does not go on without the loads, and its loop ends')
    call fluid%push_forces(before)
    call session%step_check(done, stat)
    call check(stat == SPAR_OK .and. done, 'good loads mend the step')
    call session%step_solve()
    call fluid%push_forces(before(:,1:1), stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'forces for one of two nodes')
    call session%step_check(done, stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'nor does it go on with loads of the wrong shape')
    call session%step_reject()
  end subroutine bad_values

  subroutine shapes()
    type(spar_session) :: session
    type(spar_member) :: body, beam
    type(spar_fluid) :: fluid
    type(spar_polar) :: polar
    real(c_double) :: q(7,4), v(6,4), x(3,4), eta(4), matrices(6,6,4)
    integer(c_int) :: flags(4), stat
    integer(c_int64_t) :: first(4)
    character(300) :: errmsg

    q = -1
    v = -1
    x = 0
    eta = [0.0_c_double, 0.25_c_double, 0.5_c_double, 1.0_c_double]
    matrices = 0
    call make_body(session, body)
    call body%get_motion(q, stat=stat, errmsg=errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. all(same(q, -1)), 'motion of four nodes of one')
    call check(errmsg == 'member%get_motion: ''body'': q has the shape (7,4); it must be (7,1)', 'message of a shape')
    call body%get_motion(v=q(:,1:1), stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'velocities of 7 entries')
    call body%get_motion(q(:,1:1), v(:,1:1), v(:,2:2), stat=stat)
    call check(stat == SPAR_OK .and. same(q(4,1), 1) .and. same(q(4,2), -1), 'the right shapes')
    call body%get_loads(v, stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'loads of four nodes of one')
    call body%get_reference(x(:,1:2), stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'reference of two nodes of one')
    call body%solve_modes(eta(1:1), matrices(1:5,1:1,1:1), stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'modes of 5 entries')

    call beam%create_beam(session, 'beam', 1, 4)
    call beam%set_axis(eta, x(1:2,:), stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'an axis of pairs')
    call beam%set_axis(eta, x(:,1:3), stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'an axis with a point too few')
    call beam%set_axis(eta, x, eta(1:2), stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'a twist for half of the axis')
    call beam%set_sections(eta, matrices(:,1:5,:), stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'sections of 6 by 5')
    call beam%set_sections(eta, matrices, matrices(:,:,1:1), stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'a mass for the first section only')
    call beam%set_nodes(x, q(1:3,:), stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'orientations of 3 entries')

    call fluid%create(body, 'fluid')
    call fluid%set_motion_nodes(q, stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'places of 7 entries')
    call fluid%set_stations(eta, x(:,1:3), stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'an offset too few')
    call fluid%set_motion_nodes(x)
    call fluid%map()
    call fluid%pull_motion(1.0_c_double, v=x(:,1:3), stat=stat, errmsg=errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, 'fluid%pull_motion: ''fluid'': v has the shape (3,3)') > 0, &
        'velocity of three')
    call fluid%pull_poses(SPAR_NODES_MOTION, 1.0_c_double, omega=q(1:4,:), stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'omega of 4 entries')
    call fluid%get_map(SPAR_NODES_MOTION, flags=flags(1:3), stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'flags of three')
    call fluid%get_nearest(SPAR_NODES_MOTION, q_map=x, stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'orientations of 3 entries')
    call fluid%get_basis(SPAR_NODES_MOTION, first, x, stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'basis of 3 nodes where an element has 1')
    call fluid%get_basis(SPAR_NODES_MOTION, first, x(1:1,:), stat)
    call check(stat == SPAR_OK .and. all(first == 1) .and. all(same(x(1,:), 1)), &
        'basis of a body: its node, with all the weight')

    call polar%create(eta, eta(1:3), eta, stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT .and. .not. polar%exists(), 'a polar with a lift too few')
    call polar%create(eta, eta, eta, eta(2:3), stat)
    call check(stat == SPAR_ERR_ARGUMENT .and. .not. polar%exists(), 'a polar with two moments')
    call polar%create(eta(1:1), eta(1:1), eta(1:1), stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT .and. .not. polar%exists(), 'a polar with one row')
  end subroutine shapes

  ! A fluid without nodes on this rank is a normal case.
  subroutine empty_arrays()
    type(spar_session) :: session
    type(spar_member) :: body
    type(spar_fluid) :: fluid
    type(spar_aero_object) :: aero
    type(spar_fluid) :: no_fluids(0)
    real(c_double) :: x(3,0), q(4,0), nowhere(0), inflow(3,5,0), loads(6,1), thrust
    integer(c_int) :: n
    logical :: done

    call make_body(session, body)
    call fluid%create(body, 'fluid')
    call fluid%set_motion_nodes(x)
    call fluid%set_force_nodes(x)
    call fluid%map()
    call fluid%get_count(SPAR_NODES_FORCE, n)
    call check(n == 0, 'no nodes')
    call session%step_begin(0.1_c_double)
    call session%step_solve()
    call fluid%pull_motion(1.0_c_double, x, x)
    call fluid%pull_poses(SPAR_NODES_MOTION, 1.0_c_double, q=q, omega=x, accel=x)
    call fluid%pull_forces(1.0_c_double, x)
    call fluid%push_forces(x, x)
    call session%step_check(done)
    call session%step_accept()
    call body%get_loads(loads)
    call check(all(same(loads, 0)), 'no nodes, no loads')
    call fluid%set_stations(nowhere, x)
    call fluid%map()
    call aero%create(no_fluids)
    call aero%solve(1.0_c_double, inflow, 1.0_c_double)
    call aero%set_rotor(origin, [1.0_c_double, 0.0_c_double, 0.0_c_double], 1.0_c_double, 2.0_c_double)
    call aero%solve(1.0_c_double, inflow, 1.0_c_double)
    thrust = 1
    call aero%get_rotor(thrust)
    call check(same(thrust, 0), 'no blades, no thrust')
  end subroutine empty_arrays

  ! Every other column of a larger array goes in, and every other column comes back; the columns between stay.
  subroutine array_sections()
    type(spar_session) :: session
    type(spar_member) :: body
    type(spar_fluid) :: fluid
    real(c_double) :: x(3,4), out(6,4), f(3,5), loads(6,1)
    logical :: done
    integer :: i

    call make_body(session, body)
    x = 0
    x(1,:) = [(real(i, c_double), i = 1, 4)]
    call fluid%create(body, 'fluid')
    call fluid%set_motion_nodes(x(:,1:4:2))
    call fluid%set_force_nodes(x(:,4:1:-3))
    call fluid%map()
    out = -1
    call fluid%pull_motion(1.0_c_double, out(1:5:2,1:4:2), out(2:6:2,1:4:2))
    call check(all(alike(out(1:5:2,1), x(:,1))) .and. all(alike(out(1:5:2,3), x(:,3))), 'places of every other node')
    call check(all(same(out(2:6:2,1:4:2), 0)) .and. all(same(out(:,2:4:2), -1)), 'the columns between are left alone')
    f = 0
    f(2,:) = [(1e-4_c_double * 10.0_c_double**i, i = 0, 4)]
    call session%step_begin(0.1_c_double)
    call session%step_solve()
    call fluid%push_forces(f(:,2:5:3))
    call session%step_check(done)
    call body%get_loads(loads)
    ! 0.001 at x = 4 and 1 at x = 1, on a body that has not moved
    call check(abs(loads(2,1) - 1.001_c_double) < 1e-12_c_double .and. abs(loads(6,1) - 1.004_c_double) < 1e-12_c_double, &
        'forces of every other node')
    call session%step_accept()
  end subroutine array_sections

  ! Nodes from 1, counts in both kinds.
  subroutine counting()
    type(spar_session) :: session
    type(spar_member) :: beam
    type(spar_fluid) :: fluid
    integer(c_int64_t) :: long, first(2)
    integer(c_int) :: n, stat
    real(c_double) :: stiffness(6,6,1), loads(6,8), phi(4,2)
    character(300) :: errmsg
    integer :: i

    call session%create()
    call beam%create_beam(session, 'beam', 2, 4)
    stiffness = 0
    do i = 1, 6
      stiffness(i,i,1) = 1
    end do
    call beam%set_axis([0.0_c_double, 1.0_c_double], reshape([0, 0, 0, 1, 0, 0] * 1.0_c_double, [3, 2]))
    call beam%set_sections([0.0_c_double], stiffness)
    call beam%commit()
    call beam%get_count(n)
    call beam%get_count(long)
    call check(n == 8 .and. long == 8, 'nodes of two elements of four')
    call beam%set_load(0, SPAR_LOAD_DEAD, stiffness(:,1,1), stat, errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, 'nodes are 1 to 8') > 0, 'there is no node 0')
    call beam%set_load(9_c_int64_t, SPAR_LOAD_DEAD, stiffness(:,1,1), stat, errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, 'no node 9') > 0, 'there is no node 9')
    call beam%set_load(9, SPAR_LOAD_FOLLOWER, stiffness(:,1,1), stat, errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, 'member%set_load') > 0, 'nor for a load that turns')
    call beam%set_line_load(SPAR_LOAD_DEAD, [0.0_c_double, 1.0_c_double], stiffness(:,1:3,1), stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'a line load of three stations at two places')
    call beam%set_load(8, SPAR_LOAD_DEAD, stiffness(:,2,1), stat)
    call beam%get_loads(loads)
    call check(stat == SPAR_OK .and. same(loads(2,8), 1) .and. same(sum(abs(loads)), 1), &
        'a load on the last node is in the last column')
    call fluid%create(beam, 'fluid')
    call fluid%set_stations([0.25_c_double, 0.75_c_double])
    call fluid%map()
    call fluid%get_basis(SPAR_NODES_FORCE, first, phi)
    call check(all(first == [1, 5]), 'the elements begin at nodes 1 and 5')
    call check(all(abs(sum(phi, 1) - 1) < 1e-14_c_double), 'a basis sums to one')
  end subroutine counting

  subroutine blade_objects()
    type(spar_session) :: session
    type(spar_member) :: beam
    type(spar_fluid) :: fluids(1)
    type(spar_polar) :: polar
    type(spar_aero_object) :: aero
    real(c_double) :: stiffness(6,6,1), inflow(3,2,1), loads(6,2,1)
    integer(c_int) :: stat
    character(300) :: errmsg
    integer :: i

    inflow = 0
    call session%create()
    call beam%create_beam(session, 'beam', 1, 3)
    stiffness = 0
    do i = 1, 6
      stiffness(i,i,1) = 1
    end do
    call beam%set_axis([0.0_c_double, 1.0_c_double], reshape([0, 0, 0, 2, 0, 0] * 1.0_c_double, [3, 2]))
    call beam%set_sections([0.0_c_double], stiffness)
    call beam%commit()
    call fluids(1)%create(beam, 'sections')
    call fluids(1)%set_stations([0.0_c_double, 1.0_c_double])
    call fluids(1)%map()
    call polar%create([-3.0_c_double, 3.0_c_double], [0.0_c_double, 0.0_c_double], [2.0_c_double, 2.0_c_double])
    call aero%create(fluids)
    call aero%set_section(0, 1.0_c_double, 0.0_c_double, polar, stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'there is no section 0')
    call aero%set_section(3_c_int64_t, 1.0_c_double, 0.0_c_double, polar, stat, errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, 'no section 3') > 0, 'there is no section 3')
    call aero%set_section(1, 0.5_c_double, 0.0_c_double, polar)
    call aero%set_section(2_c_int64_t, 1.0_c_double, 0.0_c_double, polar)
    call polar%destroy()
    call aero%solve(1.0_c_double, inflow(:,1:1,:), 1.0_c_double, stat, errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, '(3,1,1); it must be (3,2,1)') > 0, 'wind for one section of two')
    inflow = spread(reshape([0, 3, 0] * 1.0_c_double, [3, 1]), 2, 2)
    call aero%solve(2.0_c_double, inflow, 1.0_c_double)
    call aero%get_loads(loads)
    ! drag of the wind along the chord: rho/2 c cd v^2 = 1 * c * 2 * 9
    call check(all(same(loads(:,1,1), [0, 9, 0, 0, 0, 0])) .and. all(same(loads(:,2,1), [0, 18, 0, 0, 0, 0])), &
        'loads in the order of C')
    call aero%get_loads(loads(:,:,1:0), stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'loads of no blade of one')
    call aero%destroy()
    call aero%solve(2.0_c_double, inflow(:,:,1:0), 1.0_c_double, stat, errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. len_trim(errmsg) > 0, 'an aero object that is gone')
  end subroutine blade_objects
end program test_status
