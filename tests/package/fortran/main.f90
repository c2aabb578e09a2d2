! A body of 2 kg falls for one second under 9.81 m/s^2: -4.905 m, exact for the integrator (constant acceleration); and again
! while a fluid bears it with 4 N: -3.905 m. Integers and logicals have the default kind, whatever the compiler's options say.
module own
  use, intrinsic :: iso_c_binding, only: c_double
  use spar
  implicit none
  integer :: calls = 0, steps_begun = 0
  type(spar_fluid) :: fluid

contains

  subroutine bear(session, t, dt, iteration, context, stat)
    class(spar_session), intent(inout) :: session
    real(c_double), intent(in) :: t, dt
    integer, intent(in) :: iteration
    class(*), intent(inout), optional :: context
    integer, intent(inout) :: stat
    real(c_double) :: x(3, 1), force(3, 1)

    calls = calls + 1
    if (iteration == 0) steps_begun = steps_begun + 1
    if (.not. session%exists() .or. t < 0 .or. dt < 0 .or. present(context)) stat = 1
    call fluid%pull_motion(1.0_c_double, x)
    force(:, 1) = [0.0_c_double, 0.0_c_double, 4.0_c_double]
    call fluid%push_forces(force)
  end subroutine bear

  subroutine listen(level, text, context)
    integer, intent(in) :: level
    character(*), intent(in) :: text
    class(*), intent(inout), optional :: context

    if (level < SPAR_LOG_ERROR .or. level > SPAR_LOG_INFO .or. len(text) == 0 .or. present(context)) error stop 'log'
  end subroutine listen
end module own

program main
  use own
  implicit none
  type(spar_session) :: session
  type(spar_member) :: body
  real(c_double) :: q(7, 1), force(3, 1), atol, rtol
  integer :: i, scheme, most, iterations, nodes, stat, kind
  integer :: flags(1), held(1)
  logical :: done, on

  if (spar_version() /= '0.9.0') error stop 'version'
  call describe()
  do i = 1, 10
    call session%step(0.1_c_double)
  end do
  call fallen(-4.905_c_double)

  ! the loop of the README
  call describe()
  call bear_start()
  do i = 1, 5
    call session%step_begin(0.1_c_double)
    done = .false.
    do while (.not. done)
      call session%step_solve()
      call fluid%push_forces(force)
      call session%step_check(done)
    end do
    call session%step_accept()
  end do
  do i = 1, 5
    iterations = -1
    call session%step(0.1_c_double, bear, iterations=iterations)
    if (iterations < 1 .or. iterations > 30) error stop 'iterations'
  end do
  if (steps_begun /= 5 .or. calls < 5) error stop 'calls of the fluid'

  ! integers and logicals there and back
  call session%get_coupling(scheme, atol, rtol, most)
  if (scheme /= SPAR_COUPLING_IQN_ILS .or. most /= 30) error stop 'coupling'
  call session%set_reproducible(.false.)
  call session%get_reproducible(on)
  if (on) error stop 'reproducible'
  call body%get_count(nodes)
  call body%get_fidelity(kind)
  if (nodes /= 1 .or. kind /= SPAR_FIDELITY_EXACT) error stop 'body'
  flags = 99
  call fluid%get_map(SPAR_NODES_MOTION, flags=flags)
  if (flags(1) == 99) error stop 'flags'
  held = 1
  call fluid%fade_motion(0.1_c_double, 0.2_c_double, held=held)
  call session%set_newton(1e-15_c_double, 1e-12_c_double, -huge(most), stat=stat)
  if (stat /= SPAR_ERR_ARGUMENT) error stop 'a count out of range'
  if (spar_status_text(stat) == spar_status_text(SPAR_OK)) error stop 'text'
  call fallen(-3.905_c_double)

contains

  subroutine describe()
    real(c_double) :: mass(6, 6)
    integer :: k

    mass = 0
    do k = 1, 6
      mass(k, k) = 2
    end do
    call session%create()
    call session%set_log(listen)
    call session%set_gravity([0.0_c_double, 0.0_c_double, -9.81_c_double])
    call session%set_coupling(SPAR_COUPLING_IQN_ILS, 1e-9_c_double, 1e-6_c_double, 30)
    call body%create_rigid(session, 'body', [0.0_c_double, 0.0_c_double, 0.0_c_double], &
        [1.0_c_double, 0.0_c_double, 0.0_c_double, 0.0_c_double], mass)
    call body%commit()
  end subroutine describe

  subroutine bear_start()
    call fluid%create(body, 'fluid')
    call fluid%set_motion_nodes(reshape([0.0_c_double, 0.0_c_double, 0.0_c_double], [3, 1]))
    call fluid%set_force_nodes(reshape([0.0_c_double, 0.0_c_double, 0.0_c_double], [3, 1]))
    call fluid%map()
    call fluid%set_option('velocity', 'own') ! the load does not depend on the motion
    force(:, 1) = [0.0_c_double, 0.0_c_double, 4.0_c_double]
    call fluid%push_forces(force)
  end subroutine bear_start

  subroutine fallen(z)
    real(c_double), intent(in) :: z

    call body%get_motion(q)
    print '(a, f0.12, a)', 'fell ', q(3, 1), ' m'
    call session%destroy()
    if (abs(q(3, 1) - z) > 1e-9_c_double) error stop 'fallen'
  end subroutine fallen
end program main
