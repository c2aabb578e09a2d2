! What the modules must bear that are compiled with -fcheck=all: calls of another session within callbacks, and sessions in threads,
! each with messages and names of its own length. Both ended the program, or cut a text, where a procedure of the modules was not
! recursive, or a function's result had a length that gfortran keeps in one place for all threads.
module nested
  use, intrinsic :: iso_c_binding, only: c_associated, c_double
  use spar
  implicit none
  type(spar_session), target :: outer, inner
  integer :: solved = 0, told = 0
contains
  recursive subroutine solve(session, t, dt, iteration, context, stat)
    class(spar_session), intent(inout) :: session
    real(c_double), intent(in) :: t, dt
    integer, intent(in) :: iteration
    class(*), intent(inout), optional :: context
    integer, intent(inout) :: stat

    if (t < 0 .or. iteration < 0 .or. present(context) .or. .not. session%exists()) error stop 'not the arguments of a solver'
    solved = solved + 1
    if (c_associated(session%c_handle(), outer%c_handle())) call inner%step(dt, solve, stat=stat)
    call inner%set_newton(-1.0_c_double, 0.0_c_double, 1, stat=told) ! refused, while the outer step goes on
  end subroutine solve

  recursive subroutine before(session, t, dt, context, stat)
    class(spar_session), intent(inout) :: session
    real(c_double), intent(in) :: t, dt
    class(*), intent(inout), optional :: context
    integer, intent(inout) :: stat

    if (.not. session%exists() .or. t < 0 .or. present(context)) error stop 'not the arguments of what comes before a step'
    call inner%step(dt, stat=stat)
  end subroutine before

  recursive subroutine log(level, text, context)
    integer, intent(in) :: level
    character(*), intent(in) :: text
    class(*), intent(inout), optional :: context

    if (level < 0 .or. len(text) == 0 .or. present(context)) error stop 'not the arguments of a log'
    told = told + 1
    call inner%set_newton(-1.0_c_double, 0.0_c_double, 1, stat=solved)
  end subroutine log
end module nested

program reentrant
  use nested
  implicit none
  integer :: i, bad

  call one_in_another()
  bad = 0
  !$omp parallel do schedule(dynamic) reduction(+:bad) num_threads(4)
  do i = 1, 40
    call run(i, bad)
  end do
  if (bad > 0) error stop 'texts of one thread in another'
  print '(a)', 'sessions in sessions and in threads'
contains
  subroutine one_in_another()
    type(spar_member) :: a, b
    integer :: stat

    call make(outer, a, 'a')
    call make(inner, b, 'b')
    call outer%step(0.1_c_double, solve)
    if (solved < 2) error stop 'a step in a step'
    call outer%set_tolerance(1.0_c_double, 0.0_c_double)
    call adaptive()
    call outer%set_log(log)
    told = 0
    call outer%set_newton(-1.0_c_double, 0.0_c_double, 1, stat=stat)
    if (told /= 1 .or. stat /= SPAR_ERR_ARGUMENT .or. solved /= SPAR_ERR_ARGUMENT) error stop 'a refusal in a log'
    call outer%destroy()
    call inner%destroy()
  end subroutine one_in_another

  subroutine adaptive()
    real(c_double) :: dt, t

    dt = 0.01_c_double
    call inner%get_time(t)
    call outer%step_adaptive(dt, before)
    call inner%get_time(dt)
    if (dt <= t) error stop 'a step before a step'
  end subroutine adaptive

  subroutine make(session, member, name)
    type(spar_session), intent(inout) :: session
    type(spar_member), intent(inout) :: member
    character(*), intent(in) :: name
    real(c_double) :: mass(6,6)
    integer :: k

    mass = 0
    do k = 1, 6
      mass(k,k) = 1
    end do
    call session%create()
    call member%create_rigid(session, name, [0, 0, 0] * 1.0_c_double, [1, 0, 0, 0] * 1.0_c_double, mass)
    call member%commit()
  end subroutine make

  recursive subroutine run(i, bad)
    integer, intent(in) :: i
    integer, intent(inout) :: bad
    type(spar_session) :: session
    type(spar_member) :: member
    type(spar_fluid) :: fluid
    character(100) :: name
    integer :: k, stat

    name = 'body' // repeat('x', mod(7 * i, 90))
    call make(session, member, trim(name))
    call fluid%create(member, trim(name))
    do k = 1, 60
      call member%set_load(99, SPAR_LOAD_DEAD, [0, 0, 0, 0, 0, 0] * 1.0_c_double, stat=stat)
      call member%set_root(k + 3, stat=stat)
      if (index(session%message(), trim(name)) == 0) bad = bad + 1
      if (member%get_name() /= trim(name) .or. len(member%get_name()) /= len_trim(name)) bad = bad + 1
      if (len(fluid%get_name()) /= len_trim(name)) bad = bad + 1
      if (len(session%get_warning(99)) /= 0) bad = bad + 1
      if (len(spar_status_text(mod(k, 12))) < 3 .or. len(spar_version()) < 5) bad = bad + 1
      if (len(spar_effect_name(SPAR_ROW_GRAVITY)) /= 7) bad = bad + 1
    end do
    call session%step(1e-3_c_double)
  end subroutine run
end program reentrant
