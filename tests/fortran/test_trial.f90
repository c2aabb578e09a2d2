! Trial runs from Fortran: a body on a spring, which is a Fortran fluid, under its weight.
module trial_fluid
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use spar
  implicit none

  type :: spring
    type(spar_fluid), pointer :: fluid => null()
    real(c_double) :: stiffness = 0
    integer :: steps = 0, fails_at = -1
  end type spring

  type :: hearing
    integer :: calls = 0, stops_at = -1
    real(c_double) :: done = -1
  end type hearing
  type(hearing), target :: heard ! here, as gfortran keeps what is local to a caller in registers

  type :: wing
    type(spar_aero), pointer :: aero => null()
  end type wing

contains

  subroutine solve(session, t, dt, iteration, context, stat)
    class(spar_session), intent(inout) :: session
    real(c_double), intent(in) :: t, dt
    integer(c_int), intent(in) :: iteration
    class(*), intent(inout), optional :: context
    integer(c_int), intent(inout) :: stat
    real(c_double) :: x(3,1)

    if (.not. session%exists() .or. t < 0 .or. dt < 0 .or. iteration < 0) stat = 4 ! 0 where a run of solve_floquet starts
    select type (context)
    type is (spring)
      call context%fluid%pull_motion(1.0_c_double, x)
      call context%fluid%push_forces(-context%stiffness * x)
    class default
      stat = 5
    end select
  end subroutine solve

  subroutine solve_wing(session, t, dt, iteration, context, stat)
    class(spar_session), intent(inout) :: session
    real(c_double), intent(in) :: t, dt
    integer(c_int), intent(in) :: iteration
    class(*), intent(inout), optional :: context
    integer(c_int), intent(inout) :: stat
    real(c_double) :: wind(3,2,1)

    wind = 0
    wind(2,:,1) = 10
    if (.not. session%exists() .or. t < 0 .or. dt <= 0 .or. iteration < 0) stat = 4
    select type (context)
    type is (wing)
      call context%aero%solve(1.2_c_double, wind, 1.0_c_double)
    end select
  end subroutine solve_wing

  ! Counts the steps of all runs.
  subroutine count_step(session, t, dt, context, stat)
    class(spar_session), intent(inout) :: session
    real(c_double), intent(in) :: t, dt
    class(*), intent(inout), optional :: context
    integer(c_int), intent(inout) :: stat
    real(c_double) :: now

    call session%get_time(now)
    select type (context)
    type is (spring)
      context%steps = context%steps + 1
      if (abs(now - t) > 0 .or. dt <= 0) stat = 6
      if (context%steps == context%fails_at) stat = 7
    class default
      stat = 5
    end select
  end subroutine count_step

  subroutine hear(done, expected, context, stat)
    real(c_double), intent(in) :: done, expected
    class(*), intent(inout), optional :: context
    integer, intent(inout) :: stat

    select type (context)
    type is (hearing)
      if (done < context%done .or. expected < done .or. (context%calls == 0 .and. done > 0)) stat = 6
      context%done = done
      context%calls = context%calls + 1
      if (context%calls == context%stops_at) stat = 9
    class default
      stat = 5
    end select
  end subroutine hear

  subroutine hear_nothing(done, expected, context, stat)
    real(c_double), intent(in) :: done, expected
    class(*), intent(inout), optional :: context
    integer, intent(inout) :: stat

    if (present(context) .or. expected < done) stat = 8
  end subroutine hear_nothing

  ! A host that keeps nothing: without a context.
  subroutine count_nothing(session, t, dt, context, stat)
    class(spar_session), intent(inout) :: session
    real(c_double), intent(in) :: t, dt
    class(*), intent(inout), optional :: context
    integer(c_int), intent(inout) :: stat

    if (present(context) .or. .not. session%exists() .or. t < 0 .or. dt <= 0) stat = 8
  end subroutine count_nothing
end module trial_fluid

program test_trial
  use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t
  use spar
  use trial_fluid
  implicit none
  real(c_double), parameter :: unit(4) = [1, 0, 0, 0], origin(3) = 0, dt = 0.01_c_double
  integer :: failures = 0

  call trials()
  call eigenvalues()
  call a_beam()
  call a_wing()
  if (failures > 0) error stop 'test_trial failed'

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

  ! 1 kg on a spring of 4 N/m under its weight: without gravity it does not move, so the error of the motion is all of it,
  ! 1; without inertia it has no equilibrium to be found (a free body has no stiffness of its own).
  subroutine trials()
    type(spar_session) :: session
    type(spar_member) :: body
    type(spar_fluid), target :: fluid
    type(spring) :: context
    real(c_double) :: report(0:SPAR_TRY_COUNT - 1), table(0:SPAR_COLUMN_COUNT - 1,0:SPAR_ROW_COUNT - 1)
    real(c_double) :: advice(0:SPAR_ADVICE_COUNT - 1), q(7,1), t, size
    integer(c_int) :: stat, fidelity, nodes, points
    integer(c_int64_t) :: modes
    class(*), pointer :: listener
    character(300) :: errmsg
    integer :: row

    call session%create()
    call session%set_gravity([0.0_c_double, 0.0_c_double, -9.81_c_double])
    call session%set_coupling(SPAR_COUPLING_FIXED_POINT, 0.0_c_double, 1e-10_c_double, 50)
    call body%create_rigid(session, 'body', origin, unit, diagonal([1, 1, 1, 1, 1, 1] * 1.0_c_double))
    call body%commit()
    call fluid%create(body, 'spring')
    call fluid%set_motion_nodes(reshape(origin, [3, 1]))
    call fluid%set_force_nodes(reshape(origin, [3, 1]))
    call fluid%map()
    context%fluid => fluid
    context%stiffness = 4
    call session%try(dt, 16, report, count_step, solve, context)
    call check(context%steps == 16, 'before is called ahead of each step')
    call check(abs(report(SPAR_TRY_MOTION)) <= 0 .and. report(SPAR_TRY_SOLUTIONS) >= 16, 'a first trial')
    call session%try(dt, 16_c_int64_t, report, count_step, solve, context, compare=.true.)
    call check(all(abs(report(SPAR_TRY_MOTION:SPAR_TRY_LOAD)) <= 0), 'a trial is as the one before')
    call session%try(dt, 8, report, count_nothing, compare=.false.)
    call check(abs(report(SPAR_TRY_MOTION)) <= 0, 'a trial without context')
    context%fails_at = context%steps + 3
    call session%try(dt, 16, report, count_step, solve, context, stat=stat, errmsg=errmsg)
    call check(stat == SPAR_ERR_USER .and. index(errmsg, '7') > 0, 'a failing call before a step: ' // trim(errmsg))
    call session%try(dt, 12, report, stat=stat, errmsg=errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, 'multiple of 8') > 0, 'bad steps: ' // trim(errmsg))

    context%stiffness = 1e-6_c_double
    call session%report_effects(dt, 16, table, count_step, solve, context)
    call check(abs(table(SPAR_COLUMN_IN_FORCE,SPAR_ROW_GRAVITY) - 1) <= 0, 'gravity is in force')
    call check(abs(table(SPAR_COLUMN_MOTION,SPAR_ROW_GRAVITY) - 1) < 1e-5_c_double, 'gravity is all of the motion')
    call check(table(SPAR_COLUMN_MOTION,SPAR_ROW_INERTIA) < 0, 'no run without inertia')
    do row = 0, SPAR_ROW_COUNT - 1
      if (table(SPAR_COLUMN_IN_FORCE,row) > 0) cycle
      call check(all(abs(table(:,row)) <= 0), 'nothing of ' // spar_effect_name(int(row, c_int)))
    end do
    call check(spar_effect_name(SPAR_ROW_GRAVITY) == 'gravity' .and. spar_effect_name(-1_c_int) == '', 'names')

    context%stiffness = 4
    call body%get_advice(fidelity, modes, nodes, points, stat)
    call check(stat == SPAR_ERR_STATE, 'no advice yet')
    call session%apply_advice(stat=stat)
    call check(stat == SPAR_ERR_STATE, 'no advice to apply')
    call session%advise(1e-2_c_double, dt, 16, 16 * dt, advice, count_step, solve, context)
    call check(advice(SPAR_ADVICE_ERROR) <= 1e-2_c_double .and. advice(SPAR_ADVICE_DT) > 0, 'advice')
    call body%get_advice(nodes_per_element=nodes)
    call check(nodes == 1, 'the body stays as it is')
    call session%advise(2.0_c_double, dt, 16_c_int64_t, 16 * dt, advice, solve=solve, context=context, stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'a tolerance of 2')

    ! progress: once ahead of each trial; what it answers ends the call; without it nothing is called
    listener => heard
    call session%set_progress(hear, listener)
    call session%advise(1e-2_c_double, dt, 16, 16 * dt, advice, count_step, solve, context)
    call check(heard%calls == nint(advice(SPAR_ADVICE_TRIALS)), 'told ahead of each trial')
    heard = hearing(stops_at=2)
    call session%advise(1e-2_c_double, dt, 16, 16 * dt, advice, count_step, solve, context, stat)
    call check(stat == SPAR_ERR_USER .and. heard%calls == 2, 'stopped')
    call check(index(session%message(), 'cancelled by the progress callback (9)') > 0, 'what has stopped it')
    call session%set_progress(hear_nothing)
    call session%report_effects(dt, 16, table, count_step, solve, context)
    call session%set_progress()
    call session%report_effects(dt, 16, table, count_step, solve, context)
    call check(heard%calls == 2, 'nobody is told')

    ! back where it was: g t^2 / 2 to the order of the spring
    call session%get_time(t)
    call body%get_motion(q)
    size = maxval(abs(q(1:3,1)))
    call check(abs(t) <= 0 .and. size <= 0, 'all trials have gone back')
  end subroutine trials

  ! 1 kg on a spring of 4 N/m, which is a fluid: 2 rad/s, in three directions; the shape is one of unit mass.
  subroutine eigenvalues()
    type(spar_session) :: session
    type(spar_member) :: body
    type(spar_fluid), target :: fluid
    type(spring) :: context
    real(c_double) :: eigenvalue(2,3), shapes(2,6,1,3), frame(3), few(2,1)
    real(c_double), parameter :: at(2) = [0.0_c_double, 2.0_c_double]
    integer(c_int) :: stat
    character(300) :: errmsg

    call session%create()
    call body%create_rigid(session, 'body', origin, unit, diagonal([1, 1, 1, 1, 1, 1] * 1.0_c_double))
    call body%commit()
    call fluid%create(body, 'spring')
    call fluid%set_motion_nodes(reshape(origin, [3, 1]))
    call fluid%set_force_nodes(reshape(origin, [3, 1]))
    call fluid%map()
    context%fluid => fluid
    context%stiffness = 4
    call session%solve_eigenvalues(dt, 0, 6, at, eigenvalue, 0.0_c_double, count_step, solve, context, shapes, frame)
    call check(all(abs(eigenvalue(2,:) - 2) < 1e-7_c_double) .and. all(abs(eigenvalue(1,:)) < 1e-7_c_double), 'eigenvalues')
    call check(context%steps == 36, 'six calls a mode')
    call check(abs(sum(shapes**2) - 3) < 1e-6_c_double .and. all(abs(frame) <= 0), 'shapes of unit mass')
    call session%solve_eigenvalues(dt, 10_c_int64_t, 6_c_int64_t, at, few, 1e-4_c_double, solve=solve, context=context)
    call check(abs(few(2,1) - 2) < 1e-5_c_double, 'an eigenvalue by pulses')
    call session%solve_eigenvalues(dt, 0, 6, at, eigenvalue, shapes=shapes(:,:,:,:2), solve=solve, context=context, &
        stat=stat, errmsg=errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, 'shapes') > 0, 'shapes of too few: ' // trim(errmsg))
    call session%set_integrator(1.0_c_double, 1)
    call session%set_coupling(SPAR_COUPLING_EXPLICIT, 0.0_c_double, 1e-6_c_double, 50) ! its lag lets the spring's modes come first
    call session%solve_floquet(0.001_c_double, 1000, 6, few, before=count_step, solve=solve, context=context)
    call check(abs(few(2,1) - 2) < 1e-4_c_double .and. abs(few(1,1)) < 1e-4_c_double, 'a multiplier')
    call session%solve_floquet(0.001_c_double, 0_c_int64_t, 6_c_int64_t, few, solve=solve, context=context, stat=stat, &
        errmsg=errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, '0 steps') > 0, 'a period of no steps: ' // trim(errmsg))
  end subroutine eigenvalues

  ! Where trials vary the nodes, shapes follow: a beam whose solver asks for the basis of its fluid.
  subroutine a_beam()
    type(spar_session) :: session
    type(spar_member) :: beam
    type(spar_fluid), target :: fluid
    type(spring) :: context
    real(c_double) :: advice(0:SPAR_ADVICE_COUNT - 1)
    real(c_double) :: new_dt
    integer(c_int64_t) :: count
    integer(c_int) :: nodes

    call session%create()
    call beam%create_beam(session, 'beam', 1, 5)
    call beam%set_axis([0.0_c_double, 1.0_c_double], reshape([0, 0, 0, 2, 0, 0] * 1.0_c_double, [3, 2]))
    call beam%set_sections([0.0_c_double], reshape(diagonal([1d6, 1d6, 1d6, 1d2, 1d2, 1d2]), [6, 6, 1]), &
        reshape(diagonal([1d0, 1d0, 1d0, 2d-3, 1d-3, 1d-3]), [6, 6, 1]))
    call beam%commit()
    call fluid%create(beam, 'air')
    call fluid%set_motion_nodes(reshape([2, 0, 0] * 1.0_c_double, [3, 1]))
    call fluid%set_force_nodes(reshape([2, 0, 0] * 1.0_c_double, [3, 1]))
    call fluid%map()
    context%fluid => fluid
    call session%advise(0.05_c_double, 0.02_c_double, 16, 0.32_c_double, advice, solve=push_by_basis, context=context)
    call beam%get_advice(nodes_per_element=nodes)
    call check(nodes >= 3 .and. nodes <= 24, 'nodes are advised')
    call check(context%steps > 1, 'runs had other numbers of nodes')
    call session%apply_advice(new_dt)
    call check(abs(new_dt - advice(SPAR_ADVICE_DT)) <= 0, 'dt is the one advised')
    call beam%get_count(count)
    call check(count == nodes, 'the beam has the nodes advised')
    call session%step(new_dt, push_by_basis, context)
  end subroutine a_beam

  ! Coefficients that are the same at all angles: without drag, cd of hypot(cl, cd) is missing.
  subroutine a_wing()
    type(spar_session) :: session
    type(spar_member) :: beam
    type(spar_fluid) :: fluid(1)
    type(spar_polar) :: polar
    type(spar_aero), target :: aero
    type(wing) :: context
    real(c_double), parameter :: half_turn = 3.14159265358979_c_double
    real(c_double) :: table(0:SPAR_COLUMN_COUNT - 1,0:SPAR_AERO_ROW_COUNT - 1)
    integer(c_int) :: stat
    integer :: i

    call session%create()
    call beam%create_beam(session, 'beam', 1, 5)
    call beam%set_axis([0.0_c_double, 1.0_c_double], reshape([0, 0, 0, 2, 0, 0] * 1.0_c_double, [3, 2]))
    call beam%set_sections([0.0_c_double], reshape(diagonal([1d6, 1d6, 1d6, 1d3, 1d3, 1d3]), [6, 6, 1]), &
        reshape(diagonal([1d0, 1d0, 1d0, 2d-3, 1d-3, 1d-3]), [6, 6, 1]))
    call beam%commit()
    call fluid(1)%create(beam, 'air')
    call fluid(1)%set_stations([0.0_c_double, 1.0_c_double])
    call fluid(1)%map()
    call polar%create([-half_turn, half_turn], [0.3_c_double, 0.3_c_double], [0.4_c_double, 0.4_c_double])
    call aero%create(fluid)
    do i = 1, 2
      call aero%set_section(i, 0.1_c_double, 0.0_c_double, polar)
    end do
    context%aero => aero
    call aero%report_effects(session, 1e-3_c_double, 8, table, solve=solve_wing, context=context)
    call check(abs(table(SPAR_COLUMN_IN_FORCE,SPAR_AERO_ROW_DRAG) - 1) <= 0, 'drag is in force')
    call check(abs(table(SPAR_COLUMN_SIZE,SPAR_AERO_ROW_DRAG) - 0.8_c_double) < 1e-3_c_double, 'drag is 4 of 5 parts')
    call check(all(abs(table(:,SPAR_AERO_ROW_SWIRL)) <= 0), 'no swirl')
    call check(spar_aero_effect_name(SPAR_AERO_ROW_DRAG) == 'drag', 'names of the blade element')
    call aero%report_effects(session, 1e-3_c_double, 8_c_int64_t, table, stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'no solver')
  end subroutine a_wing

  ! The tip is the last node: its basis is 0, ..., 0, 1 with any number of nodes. context%steps: how many were seen.
  subroutine push_by_basis(session, t, dt, iteration, context, stat)
    class(spar_session), intent(inout) :: session
    real(c_double), intent(in) :: t, dt
    integer(c_int), intent(in) :: iteration
    class(*), intent(inout), optional :: context
    integer(c_int), intent(inout) :: stat
    real(c_double) :: phi(24,1)
    integer :: n, fits
    integer(c_int) :: answer

    if (.not. session%exists() .or. iteration < 0) stat = 4
    select type (context)
    type is (spring)
      fits = 0
      do n = 2, 24
        call context%fluid%get_basis(SPAR_NODES_FORCE, phi=phi(1:n,:), stat=answer)
        if (answer /= SPAR_OK) cycle
        fits = n
        if (abs(phi(n,1) - 1) > 1e-12_c_double) stat = 9
      end do
      if (fits == 0) stat = 10
      if (fits /= context%fails_at) context%steps = context%steps + 1
      context%fails_at = fits
      call context%fluid%push_forces(reshape([0.0_c_double, 0.0_c_double, sin(9 * (t + dt))], [3, 1]))
    end select
  end subroutine push_by_basis
end program test_trial
