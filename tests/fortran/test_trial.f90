! Trial runs from Fortran: a body on a spring, which is a Fortran fluid, under its weight.
module trial_fluid
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use spar
  use spar_aero
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
  ! Contexts that a trial keeps: here, as gfortran keeps what is local to a caller in registers.
  type(hearing), target :: heard

  type :: wing
    type(spar_aero_object), pointer :: aero => null()
  end type wing

  type(spring), target :: held
  type(wing), target :: flown

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
  use spar_aero
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
    type(spar_session), target :: session
    type(spar_trial) :: trial, other
    type(spar_member) :: body
    type(spar_fluid), target :: fluid
    real(c_double) :: motion, reaction, load, size, error, t, q(7,1), step
    integer :: stat, in_force, fails, nodes, row, goals
    integer(c_int64_t) :: evaluations, runs, steps
    class(*), pointer :: context, listener
    character(:), allocatable :: text
    character(300) :: errmsg

    call session%create()
    call session%set_gravity([0.0_c_double, 0.0_c_double, -9.81_c_double])
    call session%set_coupling(SPAR_COUPLING_FIXED_POINT, 0.0_c_double, 1e-10_c_double, 50)
    call body%create_rigid(session, 'body', origin, unit, diagonal([1, 1, 1, 1, 1, 1] * 1.0_c_double))
    call body%commit()
    call fluid%create(body, 'spring')
    call fluid%set_motion_nodes(reshape(origin, [3, 1]))
    call fluid%set_force_nodes(reshape(origin, [3, 1]))
    call fluid%map()
    held = spring(fluid, 4.0_c_double)
    context => held
    call check(.not. trial%exists(), 'no trial yet')
    call trial%create(session)
    call trial%create(session, stat=stat)
    call check(trial%exists() .and. stat == SPAR_ERR_STATE, 'one trial in a variable')
    call trial%run(stat=stat, errmsg=errmsg)
    call check(stat == SPAR_ERR_STATE .and. index(errmsg, 'no steps') > 0, 'without steps: ' // trim(errmsg))
    call trial%set_steps(dt, 16)
    call trial%get_steps(step, steps)
    call check(abs(step - dt) <= 0 .and. steps == 16, 'its steps')
    call trial%set_callbacks(count_step, context, solve, context)
    call trial%run()
    call trial%get_errors(motion)
    call trial%get_cost(evaluations=evaluations)
    call check(held%steps == 16, 'before is called ahead of each step')
    call check(abs(motion) <= 0 .and. evaluations >= 16, 'a first run')
    call trial%run(compare=.true.)
    call trial%get_errors(motion, reaction, load)
    call check(max(abs(motion), abs(reaction), abs(load)) <= 0, 'a run is as the one before')
    call other%create(session)
    call other%set_steps(dt, 8_c_int64_t)
    call other%set_callbacks(count_nothing)
    call other%run(compare=.false.)
    call check(held%steps == 32, 'a trial without context')
    call other%destroy()
    call other%destroy()
    call check(.not. other%exists() .and. trial%exists(), 'one of two destroyed')
    held%fails_at = held%steps + 3
    call trial%run(stat=stat, errmsg=errmsg)
    call check(stat == SPAR_ERR_USER .and. index(errmsg, '7') > 0, 'a failing call before a step: ' // trim(errmsg))
    call trial%set_steps(dt, 12)
    call trial%run(stat=stat, errmsg=errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, 'multiple of 8') > 0, 'bad steps: ' // trim(errmsg))
    call trial%set_steps(dt, 16)

    held%stiffness = 1e-6_c_double
    call trial%report_effects()
    call trial%get_effect(SPAR_ROW_GRAVITY, in_force, fails, motion=motion)
    call check(in_force == 1 .and. fails == 0, 'gravity is in force')
    call check(abs(motion - 1) < 1e-5_c_double, 'gravity is all of the motion')
    call trial%get_effect(SPAR_ROW_INERTIA, fails=fails)
    call check(fails == 1, 'no run without inertia')
    do row = 0, SPAR_ROW_COUNT - 1
      call trial%get_effect(row, in_force, size=size, motion=motion, reaction=reaction)
      if (in_force > 0) cycle
      call check(max(abs(size), abs(motion), abs(reaction)) <= 0, 'nothing of ' // spar_effect_name(row))
    end do
    call check(spar_effect_name(SPAR_ROW_GRAVITY) == 'gravity' .and. spar_effect_name(-1) == '', 'names')

    held%stiffness = 4
    call trial%get_beam(body, nodes_per_element=nodes, stat=stat)
    call check(stat == SPAR_ERR_STATE, 'no advice yet')
    call trial%apply(stat=stat)
    call check(stat == SPAR_ERR_STATE, 'no advice to apply')
    call trial%set_goals(SPAR_GOAL_MOTION + SPAR_GOAL_REACTION)
    call trial%get_goals(goals)
    call check(goals == SPAR_GOAL_MOTION + SPAR_GOAL_REACTION, 'goals')
    call trial%set_goals(SPAR_GOAL_MOTION)
    call trial%push_numbers([1.0_c_double, 2.0_c_double])
    call trial%set_option('limit', '1000')
    call trial%get_option('limit', text)
    call check(text == '1000', 'an option')
    call trial%advise(1e-2_c_double, 16 * dt)
    call trial%get_settings(dt=step)
    call trial%get_outcome(error, present_fails=fails)
    call check(error <= 1e-2_c_double .and. step > 0 .and. fails == 0, 'advice')
    call trial%get_beam(body, nodes_per_element=nodes)
    call check(nodes == 1, 'the body stays as it is')
    call trial%advise(2.0_c_double, 16 * dt, stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT, 'a tolerance of 2')

    ! progress: once ahead of each run; what it answers ends the call; without it nothing is called
    listener => heard
    call trial%set_progress(hear, listener)
    call trial%advise(1e-2_c_double, 16 * dt)
    call trial%get_search(runs=runs)
    call check(heard%calls == runs, 'told ahead of each run')
    heard = hearing(stops_at=2)
    call trial%advise(1e-2_c_double, 16 * dt, stat)
    call check(stat == SPAR_ERR_USER .and. heard%calls == 2, 'stopped')
    call check(index(session%message(), 'cancelled by the progress callback (9)') > 0, 'what has stopped it')
    call trial%set_progress(hear_nothing)
    call trial%report_effects()
    ! of a session: at each iteration of Newton
    heard = hearing(stops_at=1)
    call session%set_progress(hear, listener)
    call session%step(dt, stat=stat)
    call check(stat == SPAR_ERR_USER .and. heard%calls == 1, 'a step is cancelled')
    call check(index(session%message(), 'cancelled by the progress callback (9) after 0 Newton') > 0, 'what has cancelled it')
    call session%set_progress(hear_nothing)
    call session%set_progress()
    call trial%set_progress()
    call trial%report_effects()
    call check(heard%calls == 1, 'nobody is told')

    ! back where it was: g t^2 / 2 to the order of the spring
    call session%get_time(t)
    call body%get_motion(q)
    size = maxval(abs(q(1:3,1)))
    call check(abs(t) <= 0 .and. size <= 0, 'all trials have gone back')
  end subroutine trials

  ! 1 kg on a spring of 4 N/m, which is a fluid: 2 rad/s, in three directions; the shape is one of unit mass.
  subroutine eigenvalues()
    type(spar_session), target :: session
    type(spar_trial) :: trial
    type(spar_member) :: body
    type(spar_fluid), target :: fluid
    class(*), pointer :: context
    real(c_double) :: eigenvalue(2,3), shapes(2,6,1,3), frame(3), few(2,1), amplitude
    real(c_double), parameter :: at(2) = [0.0_c_double, 2.0_c_double]
    integer :: stat
    integer(c_int64_t) :: modes, memory
    character(300) :: errmsg

    call session%create()
    call body%create_rigid(session, 'body', origin, unit, diagonal([1, 1, 1, 1, 1, 1] * 1.0_c_double))
    call body%commit()
    call fluid%create(body, 'spring')
    call fluid%set_motion_nodes(reshape(origin, [3, 1]))
    call fluid%set_force_nodes(reshape(origin, [3, 1]))
    call fluid%map()
    held = spring(fluid, 4.0_c_double)
    context => held
    call trial%create(session)
    call trial%set_steps(dt, 8)
    call trial%set_callbacks(count_step, context, solve, context)
    call trial%solve_eigenvalues(at, eigenvalue, stat=stat)
    call check(stat == SPAR_ERR_STATE, 'no modes')
    call trial%set_motion(6)
    call trial%solve_eigenvalues(at, eigenvalue, shapes, frame)
    call check(all(abs(eigenvalue(2,:) - 2) < 1e-7_c_double) .and. all(abs(eigenvalue(1,:)) < 1e-7_c_double), 'eigenvalues')
    call check(held%steps == 36, 'six calls a mode')
    call check(abs(sum(shapes**2) - 3) < 1e-6_c_double .and. all(abs(frame) <= 0), 'shapes of unit mass')
    call trial%set_motion(6_c_int64_t, 1e-4_c_double, 10_c_int64_t)
    call trial%get_motion(modes, amplitude, memory)
    call check(modes == 6 .and. abs(amplitude - 1e-4_c_double) <= 0 .and. memory == 10, 'the motion')
    call trial%solve_eigenvalues(at, few)
    call check(abs(few(2,1) - 2) < 1e-5_c_double, 'an eigenvalue by pulses')
    call trial%set_motion(6, memory=0)
    call trial%solve_eigenvalues(at, eigenvalue, shapes(:,:,:,:2), stat=stat, errmsg=errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, 'shapes') > 0, 'shapes of too few: ' // trim(errmsg))
    call session%set_integrator(1.0_c_double, 1)
    call session%set_coupling(SPAR_COUPLING_EXPLICIT, 0.0_c_double, 1e-6_c_double, 50) ! its lag lets the modes of the spring come first
    call trial%set_steps(0.001_c_double, 1000)
    call trial%solve_floquet(few)
    call check(abs(few(2,1) - 2) < 1e-4_c_double .and. abs(few(1,1)) < 1e-4_c_double, 'a multiplier')
    call trial%set_steps(0.001_c_double, 0, stat=stat, errmsg=errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, '0 steps') > 0, 'a period of no steps: ' // trim(errmsg))
  end subroutine eigenvalues

  ! Where trials vary the nodes, shapes follow: a beam whose solver asks for the basis of its fluid.
  subroutine a_beam()
    type(spar_session), target :: session
    type(spar_trial) :: trial
    type(spar_member) :: beam
    type(spar_fluid), target :: fluid
    class(*), pointer :: context
    real(c_double) :: new_dt, advised
    integer(c_int64_t) :: count
    integer :: nodes, elements

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
    held = spring(fluid)
    context => held
    call trial%create(session)
    call trial%set_steps(0.02_c_double, 16)
    call trial%set_callbacks(solve=push_by_basis, solve_context=context)
    call trial%advise(0.05_c_double, 0.32_c_double)
    call trial%get_beam(beam, elements=elements, nodes_per_element=nodes)
    call trial%get_settings(dt=advised)
    call check(elements == 1 .and. nodes >= 3 .and. nodes <= 24, 'nodes are advised')
    call check(held%steps > 1, 'runs had other numbers of nodes')
    call trial%apply(new_dt)
    call check(abs(new_dt - advised) <= 0, 'dt is the one advised')
    call beam%get_count(count)
    call check(count == nodes, 'the beam has the nodes advised')
    call session%step(new_dt, push_by_basis, held)
  end subroutine a_beam

  ! Coefficients that are the same at all angles: without drag, cd of hypot(cl, cd) is missing.
  subroutine a_wing()
    type(spar_session), target :: session
    type(spar_trial) :: trial
    type(spar_member) :: beam
    type(spar_fluid) :: fluid(1)
    type(spar_polar) :: polar
    type(spar_aero_object), target, save :: aero ! the context of the trial points to it
    class(*), pointer :: context
    real(c_double), parameter :: half_turn = 3.14159265358979_c_double
    real(c_double) :: size, motion
    integer :: stat, i, in_force

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
    flown%aero => aero
    context => flown
    call trial%create(session)
    call trial%set_steps(1e-3_c_double, 8)
    call aero%report_effects(trial, stat=stat)
    call check(stat == SPAR_ERR_STATE, 'no solver')
    call trial%set_callbacks(solve=solve_wing, solve_context=context)
    call aero%report_effects(trial)
    call aero%get_effect(SPAR_AERO_ROW_DRAG, in_force, size=size)
    call check(in_force == 1, 'drag is in force')
    call check(abs(size - 0.8_c_double) < 1e-3_c_double, 'drag is 4 of 5 parts')
    call aero%get_effect(SPAR_AERO_ROW_SWIRL, in_force, size=size, motion=motion)
    call check(in_force == 0 .and. abs(size) <= 0 .and. abs(motion) <= 0, 'no swirl')
    call check(spar_aero_effect_name(SPAR_AERO_ROW_DRAG) == 'drag', 'names of the blade element')
    call aero%destroy()
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
