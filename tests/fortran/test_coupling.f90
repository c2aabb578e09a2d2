! Scenes with known answers, driven from Fortran: that numbers arrive where C expects them, in the order of both languages.
module coupling_fluids
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use spar
  implicit none

  ! A host of its own: springs at the nodes of a fluid.
  type :: springs
    type(spar_fluid), pointer :: fluid => null()
    real(c_double) :: stiffness = 0
    integer :: calls = 0, last_iteration = -1
  end type springs

  type(spar_fluid) :: own_fluid
  integer :: own_calls = 0

  type :: diary
    integer :: lines = 0, worst = 99
    character(200) :: last = ''
  end type diary

contains

  subroutine pull_and_push(fluid, stiffness)
    type(spar_fluid), intent(inout) :: fluid
    real(c_double), intent(in) :: stiffness
    real(c_double) :: x(3,1)

    call fluid%pull_motion(1.0_c_double, x)
    call fluid%push_forces(-stiffness * x)
  end subroutine pull_and_push

  subroutine solve_springs(session, t, dt, iteration, context, stat)
    class(spar_session), intent(inout) :: session
    real(c_double), intent(in) :: t, dt
    integer(c_int), intent(in) :: iteration
    class(*), intent(inout), optional :: context
    integer(c_int), intent(inout) :: stat
    real(c_double) :: begun

    call session%get_time(begun)
    if (abs(begun - t) > 0 .or. dt <= 0) stat = 3
    select type (context)
    type is (springs)
      context%calls = context%calls + 1
      context%last_iteration = iteration
      call pull_and_push(context%fluid, context%stiffness)
    class default
      stat = 4
    end select
  end subroutine solve_springs

  ! A host that keeps its things in a module and needs no context.
  subroutine solve_own_springs(session, t, dt, iteration, context, stat)
    class(spar_session), intent(inout) :: session
    real(c_double), intent(in) :: t, dt
    integer(c_int), intent(in) :: iteration
    class(*), intent(inout), optional :: context
    integer(c_int), intent(inout) :: stat

    own_calls = own_calls + 1
    call pull_and_push(own_fluid, 4.0_c_double)
    if (present(context) .or. .not. session%exists() .or. t < 0 .or. dt < 0 .or. iteration < 0) stat = 5
  end subroutine solve_own_springs

  ! For a static solution: the clock stands.
  subroutine solve_standing_springs(session, t, dt, iteration, context, stat)
    class(spar_session), intent(inout) :: session
    real(c_double), intent(in) :: t, dt
    integer(c_int), intent(in) :: iteration
    class(*), intent(inout), optional :: context
    integer(c_int), intent(inout) :: stat

    if (abs(dt) > 0 .or. abs(t) > 0 .or. .not. session%exists()) stat = 3
    select type (context)
    type is (springs)
      if (iteration /= context%calls) stat = 5
      context%calls = context%calls + 1
      call pull_and_push_from(context%fluid, context%stiffness, [2, 0, 0] * 1.0_c_double)
    class default
      stat = 4
    end select
  end subroutine solve_standing_springs

  subroutine pull_and_push_from(fluid, stiffness, rest)
    type(spar_fluid), intent(inout) :: fluid
    real(c_double), intent(in) :: stiffness, rest(3)
    real(c_double) :: x(3,1)

    call fluid%pull_motion(1.0_c_double, x)
    call fluid%push_forces(-stiffness * (x - reshape(rest, [3, 1])))
  end subroutine pull_and_push_from

  subroutine refuse_to_solve(session, t, dt, iteration, context, stat)
    class(spar_session), intent(inout) :: session
    real(c_double), intent(in) :: t, dt
    integer(c_int), intent(in) :: iteration
    class(*), intent(inout), optional :: context
    integer(c_int), intent(inout) :: stat

    stat = 9
    if (present(context) .or. .not. session%exists() .or. t < 0 .or. dt < 0 .or. iteration < 0) stat = 5
  end subroutine refuse_to_solve

  subroutine write_diary(level, text, context)
    integer(c_int), intent(in) :: level
    character(*), intent(in) :: text
    class(*), intent(inout), optional :: context

    select type (context)
    type is (diary)
      context%lines = context%lines + 1
      context%worst = min(context%worst, level)
      context%last = text
    end select
  end subroutine write_diary
end module coupling_fluids

program test_coupling
  use, intrinsic :: iso_c_binding, only: c_double, c_float, c_int, c_int64_t
  use spar
  use coupling_fluids
  implicit none
  real(c_double), parameter :: unit(4) = [1, 0, 0, 0], origin(3) = 0
  integer :: failures = 0

  call free_body()
  call turned_point()
  call moved_mesh()
  call layouts()
  call oscillator()
  call failing_fluid()
  call logging()
  call cantilever()
  call equilibrium()
  call driven_root()
  if (failures > 0) error stop 'test_coupling failed'

contains

  subroutine check(right, what)
    logical, intent(in) :: right
    character(*), intent(in) :: what

    if (right) return
    failures = failures + 1
    write (*, '(2a)') 'wrong: ', what
  end subroutine check

  pure function diagonal(d) result(matrix)
    real(c_double), intent(in) :: d(6)
    real(c_double) :: matrix(6,6)
    integer :: i

    matrix = 0
    do i = 1, 6
      matrix(i,i) = d(i)
    end do
  end function diagonal

  ! 2 kg under a constant force through the centre: u = F t^2 / (2 m), v = F t / m, which the integrator has exactly (its
  ! interpolation is quadratic), to rounding.
  subroutine free_body()
    type(spar_session) :: session
    type(spar_member) :: body
    type(spar_fluid) :: fluid
    real(c_double) :: q(7,1), v(6,1), a(6,1), f(3,1), audit(8), energy(4), t, force(3), moment(3), way, change, loads
    integer(c_int64_t) :: steps, node
    integer(c_int) :: stat
    integer :: i
    logical :: done

    call session%create()
    call body%create_rigid(session, 'body', origin, unit, diagonal([2, 2, 2, 1, 1, 1] * 1.0_c_double))
    call body%commit()
    call fluid%create(body, 'fluid')
    call fluid%set_motion_nodes(reshape(origin, [3, 1]))
    call fluid%set_force_nodes(reshape(origin, [3, 1]))
    call fluid%map()
    call fluid%set_option('velocity', 'own') ! a spring needs none
    f(:,1) = [1, -2, 3]
    call fluid%push_forces(f)
    do i = 1, 10
      call session%step_begin(0.05_c_double)
      call session%step_solve()
      call fluid%push_forces(f)
      call session%step_check(done)
      if (i == 1) then ! u = F t^2 / (2 m): |F| = sqrt(14), t = 0.05
        call fluid%get_travel(way, node)
        call check(abs(way - sqrt(14.0_c_double) * 0.000625_c_double) < 1e-12_c_double .and. node == 0, 'the way of the first step')
      end if
      call session%step_accept()
    end do
    call session%get_time(t, steps)
    call body%get_motion(q, v, a)
    call body%get_energy(energy)
    call fluid%get_audit(audit)
    call fluid%sum_loads(force=force, moment=moment)
    call check(all(abs(force - f(:,1)) < 1e-14_c_double) .and. all(abs(moment) < 1e-12_c_double), &
        'the force of all nodes, through the origin')
    call fluid%sum_loads(q(1:3,1) - [0.0_c_double, 0.0_c_double, 1.0_c_double], moment=moment)
    call check(all(abs(moment - [2.0_c_double, 1.0_c_double, 0.0_c_double]) < 1e-12_c_double), 'its moment, an arm of 1 along z')
    call fluid%check_loads(q(1:3,1) - [0.0_c_double, 0.0_c_double, 1.0_c_double], f(:,1), &
        [2.0_c_double, 1.0_c_double, 0.0_c_double], 1e-12_c_double)
    call fluid%check_loads(force=f(:,1), moment=[0.0_c_double, 0.0_c_double, 1.0_c_double], rtol=1e-12_c_double, stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'a total that is not that of the loads')
    call session%get_residual(change, loads)
    call check(abs(change) < 1e-14_c_double .and. abs(loads - sqrt(14.0_c_double)) < 1e-12_c_double, 'the last residual')
    call check(abs(t - 0.5_c_double) < 1e-14_c_double .and. steps == 10, 'ten steps make half a second')
    call check(all(abs(q(1:3,1) - f(:,1) / 16) < 1e-12_c_double), 'places under a constant force')
    call check(all(abs(v(1:3,1) - f(:,1) / 4) < 1e-12_c_double), 'velocities under a constant force')
    call check(all(abs(a(1:3,1) - f(:,1) / 2) < 1e-11_c_double), 'accelerations under a constant force')
    call check(abs(energy(1) - 0.875_c_double) < 1e-12_c_double, 'kinetic energy m/2 v^2 = 14/16')
    call check(abs(audit(1) - sqrt(14.0_c_double)) < 1e-14_c_double .and. maxval(audit(4:6)) < 1e-13_c_double, &
        'audit of the map')
  end subroutine free_body

  ! A point turned by 90 degrees about z and moved: the nodes of its fluid go with it, and their forces come back as force and
  ! moment about it.
  subroutine turned_point()
    type(spar_session) :: session
    type(spar_member) :: point
    type(spar_fluid) :: fluid
    real(c_double) :: q(7,1), v(6,1), x(3,2), xdot(3,2), f(3,2), load(6,1), con(3,2), orientation(4,2), matrix(3,3,2)
    real(c_float) :: single(3,2), single_v(3,2)
    integer(c_int) :: stat
    character(300) :: errmsg
    real(c_double), parameter :: h = sqrt(0.5_c_double)

    call session%create()
    call point%create_point(session, 'point', [1, 0, 0] * 1.0_c_double, unit)
    call point%commit()
    call fluid%create(point, 'fluid')
    x = reshape([3, 0, 0, 1, 1, 5] * 1.0_c_double, [3, 2])
    call fluid%set_motion_nodes(x)
    call fluid%set_force_nodes(x)
    call fluid%map()
    call fluid%set_option('velocity', 'own') ! a spring needs none
    call fluid%get_nearest(SPAR_NODES_FORCE, con=con)
    call check(all(abs(con - reshape([2, 0, 0, 0, 1, 5] * 1.0_c_double, [3, 2])) < 1e-15_c_double), 'from the foot to the node')
    q(:,1) = [0.0_c_double, 0.0_c_double, 10.0_c_double, h, 0.0_c_double, 0.0_c_double, h]
    v(:,1) = [0, 0, 1, 0, 0, 2]
    call session%step_begin(0.1_c_double)
    call point%set_motion(q, v)
    call session%step_solve()
    call fluid%pull_motion(1.0_c_double, x, xdot)
    call check(all(abs(x - reshape([1, 2, 10, 0, 0, 15] * 1.0_c_double, [3, 2])) < 1e-14_c_double), &
        'places in a turned state')
    call check(all(abs(xdot - reshape([-4, 0, 1, 0, -2, 1] * 1.0_c_double, [3, 2])) < 1e-14_c_double), &
        'velocities')
    call fluid%pull_poses(SPAR_NODES_MOTION, 1.0_c_double, x, orientation, v=xdot, omega=con)
    call check(all(abs([x(2,1) - 2, xdot(1,1) + 4, con(3,2) - 2, orientation(:,1) - q(4:7,1)]) < 1e-14_c_double), &
        'all of the motion at once')
    call fluid%pull_motion_f32(1.0_c_double, single, v=single_v)
    call check(all(abs(single - x) < 1e-6) .and. all(abs(single_v - xdot) < 1e-6), 'motion in single precision')
    call fluid%pull_matrices(1.0_c_double, SPAR_MATRIX_LOCAL_TO_GLOBAL, matrix)
    call check(all(abs(matmul(matrix(:,:,2), [1, 2, 3] * 1.0_c_double) - [-2, 1, 3]) < 1e-14_c_double), 'matrix(row,column)')
    call fluid%check_matrices(SPAR_MATRIX_LOCAL_TO_GLOBAL, matrix)
    call fluid%check_matrices(SPAR_MATRIX_GLOBAL_TO_LOCAL, matrix, stat, errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, 'transpose') > 0, 'a transposed matrix is found: ' // trim(errmsg))
    f = reshape([1, 0, 0, 0, 0, 1] * 1.0_c_double, [3, 2])
    call fluid%push_forces(f, 7 * f)
    call session%step_accept()
    call session%step_begin(0.1_c_double)
    call session%step_reject()
    call session%step_begin(0.1_c_double)
    call session%step_solve()
    call fluid%push_forces_f32(real(f, c_float), 7 * real(f, c_float))
    call check_and_accept(session)
    call point%get_loads(load)
    ! arms (0,2,0) and (-1,0,5): (0,2,0) x (1,0,0) = (0,0,-2); (-1,0,5) x (0,0,1) = (0,1,0); and the moments 7 f
    call check(all(abs(load(:,1) - [1, 0, 1, 7, 1, 5]) < 1e-13_c_double), 'loads in a turned state')
  end subroutine turned_point

  ! A point that moves by 2 along y at 4 m/s, and the nodes of a mesh around it that take all, half and none of it: faded
  ! from 1 to 3 m (half way 1/2), or given. Arrays x(n,3) by component.
  subroutine moved_mesh()
    type(spar_session) :: session
    type(spar_member) :: point
    type(spar_fluid) :: fluid
    real(c_double) :: q(7,1), v(6,1), x(3,3), xdot(3,3), w(3), f(3,3), total(3)
    integer(c_int64_t) :: node, component
    integer(c_int) :: stat, kind

    call session%create()
    call point%create_point(session, 'point', origin, unit)
    call point%set_effects(SPAR_EFFECT_FLUID_HISTORY, 0)
    call point%commit()
    call fluid%create(point, 'mesh')
    x = reshape([1, 0, 0, 0, 0, 2, 0, 3, 0] * 1.0_c_double, [3, 3])
    call fluid%set_motion_nodes(x)
    call fluid%set_force_nodes(x)
    call fluid%fade_motion(1.0_c_double, 3.0_c_double)
    call fluid%map()
    call fluid%set_option('velocity', 'own') ! a spring needs none
    call fluid%get_motion_weights(w)
    call check(all(abs(w - [1.0_c_double, 0.5_c_double, 0.0_c_double]) < 1e-15_c_double), 'weights by distance')
    call fluid%fade_motion(1.0_c_double, 3.0_c_double, distance=[2, 0, 2] * 1.0_c_double, held=[0, 1, 0])
    call fluid%get_motion_weights(w)
    call check(all(abs(w - [0.5_c_double, 0.0_c_double, 0.5_c_double]) < 1e-15_c_double), 'held nodes stay')
    call fluid%set_motion_weights(w(1:2), stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'two weights for three nodes')
    call fluid%set_motion_weights([1.0_c_double, 0.5_c_double, 0.0_c_double])
    call fluid%get_kind(SPAR_NODES_MOTION, kind)
    call check(kind == SPAR_KIND_WEIGHTS, 'nodes with weights')
    call fluid%set_layout(SPAR_NODES_MOTION, 1_c_int64_t, 3_c_int64_t)
    call fluid%set_layout(SPAR_NODES_FORCE, 1_c_int64_t, 3_c_int64_t)
    call fluid%get_layout(SPAR_NODES_MOTION, node, component)
    call check(node == 1 .and. component == 3, 'arrays by component')
    q(:,1) = [0, 2, 0, 1, 0, 0, 0]
    v(:,1) = [0, 4, 0, 0, 0, 0]
    call session%step_begin(0.1_c_double)
    call point%set_motion(q, v)
    call session%step_solve()
    call fluid%pull_motion(1.0_c_double, x, xdot)
    call check(all(abs(x(:,2) - [2, 1, 3]) < 1e-15_c_double) .and. all(abs(x(:,1) - [1, 0, 0]) < 1e-15_c_double), &
        'places of a mesh, by component')
    call check(all(abs(xdot(:,2) - [4, 2, 0]) < 1e-15_c_double), 'its velocities')
    call fluid%pull_motion(1.0_c_double, x(:,1:2), stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'an array that is shorter than its layout')
    f = 0
    f(:,3) = [1, 2, 4]
    call fluid%push_forces(f)
    call fluid%sum_loads(force=total)
    call check(all(abs(total - [0, 0, 7]) < 1e-14_c_double), 'forces by component')
    call fluid%pull_poses(SPAR_NODES_FORCE, 1.0_c_double, x)
    call check(all(abs(x(:,2) - [2, 2, 5]) < 1e-15_c_double), 'force nodes have no weights')
    call fluid%get_positions(SPAR_NODES_FORCE, x, nearest=xdot)
    call check(all(abs(x(2,:) - [2, 2, 5]) < 1e-15_c_double) .and. all(abs(xdot(2,:) - 2) < 1e-15_c_double), &
        'getters are packed')
    call fluid%get_forces(x)
    call check(all(abs(x(3,:) - [1, 2, 4]) < 1e-15_c_double), 'forces as kept')
    call session%step_reject()
    call fluid%set_motion_weights()
    call fluid%set_motion_stations([0, 1] * 1.0_c_double)
    call fluid%get_kind(SPAR_NODES_MOTION, kind)
    call check(kind == SPAR_KIND_STATIONS, 'motion nodes as sections')
  end subroutine moved_mesh

  ! Each layout has arrays of its shape; others are refused, also with as many numbers (their sums were wrong). The sum of forces
  ! 1 to 4 along y is 10, in each layout.
  subroutine layouts()
    type(spar_session) :: session
    type(spar_member) :: point
    type(spar_fluid) :: fluid
    real(c_double) :: x(3,4), columns(4,3), padded(6,3), records(8,4), flat(12,1)
    integer :: i

    x = 0
    columns = 0
    padded = 0
    records = 0
    flat = 0
    do i = 1, 4
      x(2,i) = i
      columns(i,2) = i
      padded(i,2) = i
      records(2,i) = i
    end do
    call session%create()
    call point%create_point(session, 'point', origin, unit)
    call point%commit()
    call fluid%create(point, 'layouts')
    call fluid%set_force_nodes(0 * x)
    call fluid%map()
    call pushes(fluid, 3, 1, x, [.true., .false., .false., .false., .false.], columns, padded, records, flat)
    call pushes(fluid, 1, 4, x, [.false., .true., .false., .false., .false.], columns, padded, records, flat)
    call pushes(fluid, 1, 6, x, [.false., .false., .true., .false., .false.], columns, padded, records, flat)
    call pushes(fluid, 8, 1, x, [.false., .false., .false., .true., .false.], columns, padded, records, flat)
  end subroutine layouts

  subroutine pushes(fluid, node, component, x, taken, columns, padded, records, flat)
    type(spar_fluid), intent(inout) :: fluid
    integer, intent(in) :: node, component
    logical, intent(in) :: taken(5)
    real(c_double), intent(in) :: x(:,:), columns(:,:), padded(:,:), records(:,:), flat(:,:)
    real(c_double) :: total(3)
    integer :: stat(5)

    call fluid%set_layout(SPAR_NODES_FORCE, int(node, c_int64_t), int(component, c_int64_t))
    call fluid%push_forces(x, stat=stat(1))
    call fluid%push_forces(columns, stat=stat(2))
    call fluid%push_forces(padded, stat=stat(3))
    call fluid%push_forces(records, stat=stat(4))
    call fluid%push_forces(flat, stat=stat(5))
    call check(all((stat == SPAR_OK) .eqv. taken), 'a layout takes arrays of its shape alone')
    if (taken(1)) call fluid%push_forces(x)
    if (taken(2)) call fluid%push_forces(columns)
    if (taken(3)) call fluid%push_forces(padded)
    if (taken(4)) call fluid%push_forces(records)
    call fluid%sum_loads(force=total)
    call check(all(abs(total - [0, 10, 0]) < 1e-14_c_double), 'the sum of forces in each layout')
  end subroutine pushes

  subroutine check_and_accept(session)
    type(spar_session), intent(inout) :: session
    logical :: done

    call session%step_check(done)
    call session%step_accept()
  end subroutine check_and_accept

  subroutine make_oscillator(session, body, fluid)
    type(spar_session), intent(inout) :: session
    type(spar_member), intent(inout) :: body
    type(spar_fluid), intent(inout) :: fluid

    call session%create()
    call session%set_integrator(1.0_c_double, 1)
    call session%set_coupling(SPAR_COUPLING_FIXED_POINT, 0.0_c_double, 1e-13_c_double, 100)
    call body%create_rigid(session, 'body', origin, unit, diagonal([1, 1, 1, 1, 1, 1] * 1.0_c_double))
    call body%set_initial_velocity(v0=[1, 0, 0] * 1.0_c_double)
    call body%commit()
    call fluid%create(body, 'fluid')
    call fluid%set_motion_nodes(reshape(origin, [3, 1]))
    call fluid%set_force_nodes(reshape(origin, [3, 1]))
    call fluid%map()
    call fluid%set_option('velocity', 'own') ! a spring needs none
  end subroutine make_oscillator

  ! 1 kg on a spring of 4 N/m, with 1 m/s at x = 0: x = sin(2 t) / 2. The trapezoidal rule (rho_inf = 1) lags by w^3 dt^2 t / 12
  ! in phase, 6.7e-5 here, and keeps the amplitude. The same steps through callbacks with and without a context, and through a
  ! loop of the host: the same bits.
  subroutine oscillator()
    type(spar_session) :: session(3)
    type(spar_member) :: body(3)
    type(spar_fluid), target :: fluid
    type(spar_fluid) :: loop_fluid
    type(springs) :: context
    real(c_double), parameter :: dt = 0.01_c_double
    real(c_double) :: q(7,3), residual(100), report(SPAR_REPORT_COUNT+1)
    integer(c_int) :: iterations
    integer :: i, k, mine
    logical :: done

    call make_oscillator(session(1), body(1), fluid)
    call make_oscillator(session(2), body(2), own_fluid)
    call make_oscillator(session(3), body(3), loop_fluid)
    context%fluid => fluid
    context%stiffness = 4
    mine = 0
    residual = -1
    do i = 1, 100
      call session(1)%step(dt, solve_springs, context, iterations)
      mine = mine + iterations
      call session(2)%step(dt, solve_own_springs)
      call session(3)%step_begin(dt)
      do
        call session(3)%step_solve()
        call pull_and_push(loop_fluid, 4.0_c_double)
        call session(3)%step_check(done)
        if (done) exit
      end do
      call session(3)%step_accept()
    end do
    do k = 1, 3
      call body(k)%get_motion(q(:,k:k))
    end do
    call check(abs(q(1,1) - 0.5_c_double * sin(2.0_c_double)) < 7e-5_c_double, 'the oscillator after a second')
    call check(all(abs(q(:,2) - q(:,1)) <= 0) .and. all(abs(q(:,3) - q(:,1)) <= 0), 'callbacks and loop give the same bits')
    call check(context%calls == mine .and. own_calls == mine .and. mine > 100, 'each iteration is one call')
    call check(context%last_iteration == iterations - 1, 'iterations are counted from 0')
    call session(1)%get_iterations(i, residual(1:iterations+1))
    call check(i == iterations .and. all(residual(1:i) > 0) .and. abs(residual(i+1)) <= 0 .and. all(residual(i+2:) < 0), &
        'a residual per iteration')
    call session(1)%get_iterations(i, size=residual(10:9+iterations-1))
    call check(i == iterations .and. all(residual(10:8+iterations) > 0) .and. residual(9+iterations) < 0, &
        'as many sizes as there is room for')
    call session(1)%get_report(report)
    call check(report(SPAR_REPORT_CONTRACTION + 1) > 0 .and. abs(report(SPAR_REPORT_COUNT + 1)) <= 0, &
        'what the library does not know is zero')
    ! f = -k x and x = ... + f dt^2 / (4 m), trapezoidal: each iteration shrinks the change of the load by k dt^2 / (4 m)
    call check(abs(residual(2) / residual(1) - 1e-4_c_double) < 1e-10_c_double, 'each iteration brings the same factor')
  end subroutine oscillator

  ! After a refusal of the fluid the session is at t^n, and the next step is as if nothing had been.
  subroutine failing_fluid()
    type(spar_session) :: session, other
    type(spar_member) :: body, twin
    type(spar_fluid), target :: fluid, its
    type(springs) :: context
    real(c_double) :: q(7,2), t
    integer(c_int) :: stat
    character(200) :: errmsg
    integer :: k

    call make_oscillator(session, body, fluid)
    call make_oscillator(other, twin, its)
    context%stiffness = 4
    do k = 1, 2
      context%fluid => fluid
      call session%step(0.01_c_double, solve_springs, context)
      context%fluid => its
      call other%step(0.01_c_double, solve_springs, context)
      call session%step(0.02_c_double, refuse_to_solve, stat=stat, errmsg=errmsg)
      call check(stat == SPAR_ERR_USER .and. index(errmsg, 'returned 9') > 0, 'a fluid that fails: ' // trim(errmsg))
    end do
    call session%get_time(t)
    call body%get_motion(q(:,1:1))
    call twin%get_motion(q(:,2:2))
    call check(abs(t - 0.02_c_double) < 1e-15_c_double .and. all(abs(q(:,1) - q(:,2)) <= 0), 'a failed step leaves no trace')
    call session%step(0.01_c_double, stat=stat)
    call check(stat == SPAR_OK, 'a step without a fluid')
  end subroutine failing_fluid

  subroutine logging()
    type(spar_session) :: session
    type(diary), target :: log
    class(*), pointer :: context
    integer(c_int) :: stat
    integer :: before

    context => log
    call session%create()
    call session%set_log(write_diary, context)
    call session%set_predictor(-1, stat)
    call check(log%lines == 1 .and. log%worst == SPAR_LOG_ERROR .and. log%last == session%message(), &
        'an error is logged')
    before = log%lines
    call session%set_log()
    call session%set_predictor(-1, stat)
    call check(log%lines == before .and. stat == SPAR_ERR_ARGUMENT, 'the log is silent again')
    call session%set_log(write_diary, context)
    call session%destroy()
    call session%set_log(write_diary, context, stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'no log without a session')
  end subroutine logging

  ! A cantilever of length 2 in the linear theory, which one element of 4 nodes has exactly (deflections are cubic):
  ! w = P L / GA + P L^3 / (3 EI); its root gives minus P and minus P L.
  subroutine cantilever()
    type(spar_session) :: session
    type(spar_member) :: beam
    real(c_double) :: stiffness(6,6,1), q(7,4), reaction(6), mass(6,6,1), f(3), shapes(6,4,3), p(6)

    call session%create()
    stiffness(:,:,1) = diagonal([100, 50, 60, 10, 20, 30] * 1.0_c_double)
    mass(:,:,1) = diagonal([1.0_c_double, 1.0_c_double, 1.0_c_double, 2e-3_c_double, 1e-3_c_double, 1e-3_c_double])
    call beam%create_beam(session, 'beam', 1, 4)
    call beam%set_axis([0, 1] * 1.0_c_double, reshape([0, 0, 0, 2, 0, 0] * 1.0_c_double, [3, 2]))
    call beam%set_sections([0.0_c_double], stiffness, mass)
    call beam%set_fidelity(SPAR_FIDELITY_LINEAR)
    call beam%commit()
    p = [0.0_c_double, 0.01_c_double, 0.02_c_double, 0.0_c_double, 0.0_c_double, 0.0_c_double]
    call beam%set_load(4, SPAR_LOAD_DEAD, p)
    call beam%solve_static(1)
    call beam%get_motion(q)
    call beam%get_reaction(reaction)
    call check(abs(q(2,4) - p(2) * (2 / 50.0_c_double + 8 / 90.0_c_double)) < 1e-12_c_double, 'deflection along y')
    call check(abs(q(3,4) - p(3) * (2 / 60.0_c_double + 8 / 60.0_c_double)) < 1e-12_c_double, 'deflection along z')
    call check(all(abs(reaction(1:3) + p(1:3)) < 1e-12_c_double), 'force at the root')
    call check(abs(reaction(5) - 2 * p(3)) < 1e-12_c_double .and. abs(reaction(6) + 2 * p(2)) < 1e-12_c_double, &
        'moment at the root')
    call beam%evaluate([0.0_c_double, 0.5_c_double], force=q(1:6,1:2))
    q(2:3,1) = q(2:3,1) - p(2:3)
    q(5:6,1:2) = q(5:6,1:2) - reshape([-2 * p(3), 2 * p(2), -p(3), p(2)], [2, 2])
    call check(maxval(abs(q([2, 3, 5, 6],1))) < 1e-12_c_double .and. maxval(abs(q(5:6,2))) < 1e-12_c_double, &
        'shear and bending along the beam')
    call beam%solve_modes(f, shapes)
    call check(all(f(2:3) >= f(1:2)) .and. f(1) > 0 .and. all(abs(shapes(:,1,:)) <= 0), 'modes of a clamped beam')
    call check(maxval(abs(shapes(:,4,1))) > 0, 'the tip moves in the first mode')
  end subroutine cantilever

  ! A cantilever under a tip force p, on a spring k of the fluid: u = p / (1 / (L / GA + L^3 / 3 EI) + k), here along y.
  subroutine equilibrium()
    type(spar_session) :: session
    type(spar_member) :: beam
    type(spar_fluid), target :: fluid
    type(springs) :: host
    real(c_double) :: stiffness(6,6,1), q(7,4), p(6)
    integer(c_int) :: iterations, stat
    character(400) :: errmsg

    call session%create()
    call session%set_coupling(SPAR_COUPLING_IQN_ILS, 0.0_c_double, 1e-12_c_double, 20)
    stiffness(:,:,1) = diagonal([100, 50, 60, 10, 20, 30] * 1.0_c_double)
    call beam%create_beam(session, 'beam', 1, 4)
    call beam%set_axis([0, 1] * 1.0_c_double, reshape([0, 0, 0, 2, 0, 0] * 1.0_c_double, [3, 2]))
    call beam%set_sections([0.0_c_double], stiffness)
    call beam%set_fidelity(SPAR_FIDELITY_LINEAR)
    call beam%commit()
    call fluid%create(beam, 'springs')
    call fluid%set_motion_nodes(reshape([2, 0, 0] * 1.0_c_double, [3, 1]))
    call fluid%set_force_nodes(reshape([2, 0, 0] * 1.0_c_double, [3, 1]))
    call fluid%map()
    call fluid%set_option('velocity', 'own') ! a spring needs none
    p = 0
    p(2) = 0.01_c_double
    call beam%set_load(4, SPAR_LOAD_DEAD, p)
    host%fluid => fluid
    host%stiffness = 7
    call session%solve_static(solve=solve_standing_springs, context=host, iterations=iterations)
    call beam%get_motion(q)
    call check(abs(q(2,4) - p(2) / (1 / (2 / 50.0_c_double + 8 / 90.0_c_double) + 7)) < 1e-13_c_double, 'the beam on its spring')
    call check(iterations == host%calls .and. iterations > 1, 'as many calls of the fluid')
    call session%solve_static(0, stat=stat, errmsg=errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, 'spar_session_solve_static') > 0, 'no load steps')
  end subroutine equilibrium

  ! A rigid body whose node is driven about z through two turns: its tip goes round, |q| = 1.
  subroutine driven_root()
    type(spar_session) :: session
    type(spar_member) :: body
    type(spar_fluid) :: fluid
    real(c_double), parameter :: pi = acos(-1.0_c_double), dt = 0.1_c_double
    real(c_double) :: x(3,1), v(3,1), angle, q(7), w(6), a(6)
    integer :: i

    call session%create()
    call body%create_rigid(session, 'body', origin, unit, diagonal([1, 1, 1, 1, 1, 1] * 1.0_c_double))
    call body%set_root(SPAR_ROOT_DRIVEN)
    call body%commit()
    call fluid%create(body, 'tip')
    call fluid%set_motion_nodes(reshape([2, 0, 0] * 1.0_c_double, [3, 1]))
    call fluid%map()
    call fluid%set_option('velocity', 'own') ! a spring needs none
    w = [0.0_c_double, 0.0_c_double, 0.0_c_double, 0.0_c_double, 0.0_c_double, 2 * pi]
    a = 0
    do i = 1, 20
      angle = 2 * pi * dt * i
      q = [0.0_c_double, 0.0_c_double, 0.0_c_double, cos(angle / 2), 0.0_c_double, 0.0_c_double, sin(angle / 2)]
      call body%drive(q, w, a)
      call session%step(dt)
      call fluid%pull_motion(1.0_c_double, x, v)
      call check(all(abs(x(:,1) - 2 * [cos(angle), sin(angle), 0.0_c_double]) < 1e-13_c_double), 'the tip of a driven body')
      call check(all(abs(v(:,1) - 4 * pi * [-sin(angle), cos(angle), 0.0_c_double]) < 1e-12_c_double), 'its velocity')
    end do
  end subroutine driven_root
end program test_coupling
