! Random calls of the module spar with right, wrong and hostile arguments: shapes of other sizes, layouts, numbers that are not finite,
!   fuzz [calls [seed [threads]]]
! Each call answers SPAR_OK or a SPAR_ERR_* with a message. A refused call leaves its results as they were; no call writes beyond an
! array. With one thread the same seed makes the same calls.
module fuzz_world
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
  use, intrinsic :: iso_c_binding, only: c_double, c_float, c_int64_t
  use spar
  implicit none
  integer, parameter :: dp = c_double, SESSIONS = 2, MEMBERS = 6, JOINTS = 4, FLUIDS = 4, TRIALS = 2, LENGTH = 200
  real(dp), parameter :: SEAL = -7.25e300_dp

  type :: world
    integer(c_int64_t) :: state = 1, calls = 0, good = 0, refused = 0, worst = 0
    integer :: depth = 0, members_of(SESSIONS) = 0, member_session(MEMBERS) = 0, budget = 0, number = 0
    type(spar_session) :: session(SESSIONS)
    type(spar_member) :: member(MEMBERS)
    type(spar_joint) :: joint(JOINTS)
    type(spar_fluid) :: fluid(FLUIDS)
    type(spar_trial) :: trial(TRIALS)
    integer :: fluid_session(FLUIDS) = 0, trial_session(TRIALS) = 0, joint_session(JOINTS) = 0, fluid_member(FLUIDS) = 0
    integer :: stat = 0
    character(LENGTH) :: told = ''
  end type world

contains

  ! ---- random numbers: xorshift64* ----

  recursive real(dp) function real_of(w) result(x)
    type(world), intent(inout) :: w

    w%state = ieor(w%state, ishft(w%state, 13))
    w%state = ieor(w%state, ishft(w%state, -7))
    w%state = ieor(w%state, ishft(w%state, 17))
    x = real(ishft(w%state, -11), dp) / 9007199254740992.0_dp
  end function real_of

  ! From 1 to n.
  recursive integer function pick(w, n) result(k)
    type(world), intent(inout) :: w
    integer, intent(in) :: n

    k = 1 + int(n * real_of(w))
  end function pick

  recursive logical function chance(w, percent) result(yes)
    type(world), intent(inout) :: w
    integer, intent(in) :: percent

    yes = 100 * real_of(w) < percent
  end function chance

  recursive integer function whole(w, low, high) result(k)
    type(world), intent(inout) :: w
    integer, intent(in) :: low, high
    integer, parameter :: hostile(8) = [-1, 0, 65, 1000, huge(0), -huge(0), -huge(0) - 1, 4096]

    k = low - 1 + pick(w, high - low + 1)
    if (chance(w, 4)) k = hostile(pick(w, 8))
  end function whole

  ! A number of which much follows: the hostile ones are those that are refused.
  recursive integer function few(w, low, high) result(k)
    type(world), intent(inout) :: w
    integer, intent(in) :: low, high

    k = low - 1 + pick(w, high - low + 1)
    if (chance(w, 4)) k = merge(-1, -huge(0), chance(w, 50))
  end function few

  recursive real(dp) function number(w, low, high) result(x)
    type(world), intent(inout) :: w
    real(dp), intent(in) :: low, high

    x = low + (high - low) * real_of(w)
    if (chance(w, 1)) x = strange(w)
  end function number

  recursive real(dp) function strange(w) result(x)
    type(world), intent(inout) :: w

    select case (pick(w, 7))
    case (1)
      x = ieee_value(x, ieee_quiet_nan)
    case (2)
      x = ieee_value(x, ieee_positive_inf)
    case (3)
      x = -1e308_dp
    case (4)
      x = 5e-324_dp
    case (5)
      x = 0
    case (6)
      x = -1
    case default
      x = 1e-30_dp
    end select
  end function strange

  ! Mostly n, else another extent.
  recursive integer function extent(w, n) result(k)
    type(world), intent(inout) :: w
    integer, intent(in) :: n

    k = n
    if (chance(w, 3)) k = max(0, n - 2 + pick(w, 4))
  end function extent

  recursive function vector(w, n, low, high) result(x)
    type(world), intent(inout) :: w
    integer, intent(in) :: n
    real(dp), intent(in) :: low, high
    real(dp), allocatable :: x(:)
    integer :: i

    allocate (x(extent(w, n)))
    do i = 1, size(x)
      x(i) = low + (high - low) * real_of(w)
    end do
    if (size(x) > 0 .and. chance(w, 3)) x(pick(w, size(x))) = strange(w)
  end function vector

  ! Of a fixed length.
  recursive function triple(w, n, low, high) result(x)
    type(world), intent(inout) :: w
    integer, intent(in) :: n
    real(dp), intent(in) :: low, high
    real(dp) :: x(n)
    integer :: i

    do i = 1, n
      x(i) = number(w, low, high)
    end do
  end function triple

  recursive function grid(w, a, b, low, high) result(x)
    type(world), intent(inout) :: w
    integer, intent(in) :: a, b
    real(dp), intent(in) :: low, high
    real(dp), allocatable :: x(:,:)
    integer :: m, n, swap

    m = extent(w, a)
    n = extent(w, b)
    if (chance(w, 2)) then
      swap = m
      m = n
      n = swap
    end if
    allocate (x(m, n))
    do swap = 1, n
      x(:,swap) = triple(w, m, low, high)
    end do
  end function grid

  recursive function eta_of(w, n) result(eta)
    type(world), intent(inout) :: w
    integer, intent(in) :: n
    real(dp), allocatable :: eta(:)
    integer :: i

    eta = [(real(i - 1, dp) / max(1, n - 1), i = 1, n)]
    if (n > 0 .and. chance(w, 4)) eta(pick(w, n)) = merge(strange(w), 0.3_dp, chance(w, 50))
  end function eta_of

  ! Diagonal, mostly positive.
  recursive function matrix(w, high) result(x)
    type(world), intent(inout) :: w
    real(dp), intent(in) :: high
    real(dp) :: x(6,6)
    integer :: i

    x = 0
    do i = 1, 6
      x(i,i) = number(w, 0.2 * high, high)
    end do
    if (chance(w, 4)) x(pick(w, 6), pick(w, 6)) = number(w, -high, high)
  end function matrix

  recursive function matrices(w, n, high) result(x)
    type(world), intent(inout) :: w
    integer, intent(in) :: n
    real(dp), intent(in) :: high
    real(dp), allocatable :: x(:,:,:)
    integer :: i

    allocate (x(extent(w, 6), 6, extent(w, n)))
    do i = 1, size(x, 3)
      x(:,:,i) = 0
      if (size(x, 1) == 6) x(:,:,i) = matrix(w, high)
    end do
  end function matrices

  ! A mass per length, or of a body.
  recursive function mass_of(w) result(x)
    type(world), intent(inout) :: w
    real(dp) :: x(6,6)
    integer :: i

    x = 0
    do i = 1, 3
      x(i,i) = 2
      x(i+3,i+3) = merge(0.02_dp, 0.01_dp, i == 1)
    end do
    if (chance(w, 5)) x(pick(w, 6), pick(w, 6)) = number(w, -2.0_dp, 2.0_dp)
  end function mass_of

  recursive function text_of(w) result(text)
    type(world), intent(inout) :: w
    character(:), allocatable :: text

    select case (pick(w, 12))
    case (1)
      text = ''
    case (2)
      text = repeat('x', pick(w, 3000))
    case (3)
      text = '   '
    case (4)
      text = '%s%n' // achar(10) // achar(0) // 'b'
    case default
      w%number = w%number + 1
      allocate (character(12) :: text)
      write (text, '(a,i0)') 'n', w%number
    end select
  end function text_of

  recursive function path_of(w) result(text)
    type(world), intent(inout) :: w
    character(:), allocatable :: text

    text = 'f' // achar(iachar('0') + pick(w, 3))
    if (chance(w, 6)) text = text_of(w) // '/no/folder'
    if (chance(w, 3)) text = ''
  end function path_of

  ! ---- what a call has done ----

  recursive subroutine begin(w)
    type(world), intent(inout) :: w

    w%stat = -1
    w%told = '?'
  end subroutine begin

  recursive subroutine ended(w, name)
    type(world), intent(inout) :: w
    character(*), intent(in) :: name

    if (w%stat < SPAR_OK .or. w%stat > SPAR_ERR_LIMIT) call finding(w, name, 'no status')
    if (w%stat == SPAR_OK .and. w%told /= '?') call finding(w, name, 'a message without a failure')
    if (w%stat /= SPAR_OK .and. (w%told == '?' .or. w%told == '')) call finding(w, name, 'no message')
    w%calls = w%calls + 1
    if (w%stat == SPAR_OK) w%good = w%good + 1
    if (w%stat /= SPAR_OK) w%refused = w%refused + 1
  end subroutine ended

  recursive subroutine finding(w, name, what)
    type(world), intent(in) :: w
    character(*), intent(in) :: name, what

    print '(a,": ",a,", status ",i0,", call ",i0,", depth ",i0,": ",a)', name, what, w%stat, w%calls, w%depth, trim(w%told)
    error stop 1
  end subroutine finding

  ! Room for results of the shape (a, b), between two sealed columns.
  recursive function room(w, a, b) result(x)
    type(world), intent(inout) :: w
    integer, intent(in) :: a, b
    real(dp), allocatable :: x(:,:)
    integer :: m, n

    m = extent(w, a)
    n = extent(w, b)
    if (a == 1) m = 1
    allocate (x(m, n + 2))
    x = SEAL
  end function room

  ! all_of: no result may have been written, where the call was refused.
  recursive subroutine opened(w, name, x)
    type(world), intent(in) :: w
    character(*), intent(in) :: name
    real(dp), intent(in) :: x(:,:)
    integer :: n

    n = size(x, 2)
    if (size(x, 1) == 0) return
    if (any(x(:,1) /= SEAL) .or. any(x(:,n) /= SEAL)) call finding(w, name, 'wrote beyond an array')
    if (w%stat /= SPAR_OK) then
      if (any(x /= SEAL)) call finding(w, name, 'a refused call wrote results')
    end if
  end subroutine opened
end module fuzz_world

module fuzz_calls
  use fuzz_world
  implicit none
contains

  ! ---- callbacks ----

  recursive subroutine solve(session, t, dt, iteration, context, stat)
    class(spar_session), intent(inout) :: session
    real(dp), intent(in) :: t, dt
    integer, intent(in) :: iteration
    class(*), intent(inout), optional :: context
    integer, intent(inout) :: stat

    if (.not. present(context)) return
    select type (context)
    type is (world)
      if (t /= t .or. dt < 0 .or. iteration < 0 .or. .not. session%exists()) call finding(context, 'solver', 'wrong arguments')
      call call_back(context, stat)
    end select
  end subroutine solve

  recursive subroutine before(session, t, dt, context, stat)
    class(spar_session), intent(inout) :: session
    real(dp), intent(in) :: t, dt
    class(*), intent(inout), optional :: context
    integer, intent(inout) :: stat

    if (.not. present(context)) return
    select type (context)
    type is (world)
      if (t /= t .or. dt < 0 .or. .not. session%exists()) call finding(context, 'before', 'wrong arguments')
      call call_back(context, stat)
    end select
  end subroutine before

  recursive subroutine progress(done, expected, context, stat)
    real(dp), intent(in) :: done, expected
    class(*), intent(inout), optional :: context
    integer, intent(inout) :: stat

    if (.not. present(context)) return
    select type (context)
    type is (world)
      if (done < 0 .or. expected < done) call finding(context, 'progress', 'wrong arguments')
      if (chance(context, 2)) stat = pick(context, 5)
    end select
  end subroutine progress

  recursive subroutine log(level, text, context)
    integer, intent(in) :: level
    character(*), intent(in) :: text
    class(*), intent(inout), optional :: context

    if (level < SPAR_LOG_ERROR .or. level > SPAR_LOG_INFO .or. len(text) == 0) error stop 'log: wrong arguments'
    if (present(context)) continue
  end subroutine log

  recursive subroutine call_back(w, stat)
    type(world), intent(inout), target :: w
    integer, intent(inout) :: stat
    character(LENGTH) :: told
    integer :: outer, k

    if (w%depth >= 3 .or. w%budget <= 0) return
    outer = w%stat
    told = w%told
    w%depth = w%depth + 1
    do k = 1, pick(w, 4)
      call random_call(w)
    end do
    w%depth = w%depth - 1
    w%stat = outer
    w%told = told
    if (chance(w, 3)) stat = pick(w, 20)
  end subroutine call_back

  ! ---- sessions ----

  recursive subroutine forget(w, s)
    type(world), intent(inout) :: w
    integer, intent(in) :: s
    type(spar_member) :: nobody
    type(spar_joint) :: nothing
    integer :: i

    do i = 1, TRIALS
      if (w%trial_session(i) == s) call w%trial(i)%destroy()
    end do
    do i = 1, FLUIDS
      if (w%fluid_session(i) == s) call w%fluid(i)%destroy()
      if (w%fluid_session(i) == s) w%fluid_session(i) = 0
    end do
    do i = 1, MEMBERS
      if (w%member_session(i) == s) w%member(i) = nobody
      if (w%member_session(i) == s) w%member_session(i) = 0
    end do
    do i = 1, JOINTS
      if (w%joint_session(i) == s) w%joint(i) = nothing
    end do
    call w%session(s)%destroy()
  end subroutine forget

  recursive subroutine session_calls(w)
    type(world), intent(inout), target :: w
    integer :: s, n, k
    real(dp) :: x, y
    real(dp), allocatable :: values(:,:)
    integer(c_int64_t) :: many
    logical :: on
    character(:), allocatable :: text
    class(*), pointer :: me

    me => w
    s = pick(w, SESSIONS)
    call begin(w)
    select case (pick(w, 30))
    case (1)
      if (w%depth == 0 .and. chance(w, 30)) call forget(w, s)
      call w%session(s)%create(stat=w%stat, errmsg=w%told)
      if (w%stat == SPAR_OK .and. chance(w, 50)) call w%session(s)%set_gravity([0.0_dp, 0.0_dp, -9.81_dp])
      call ended(w, 'create')
    case (2)
      call w%session(s)%set_gravity(triple(w, 3, -10.0_dp, 10.0_dp), stat=w%stat, errmsg=w%told)
      call ended(w, 'set_gravity')
    case (3)
      call w%session(s)%set_coupling(whole(w, 0, 3), number(w, 0.0_dp, 1e-6_dp), number(w, 0.0_dp, 1e-3_dp), &
          few(w, 1, 20), stat=w%stat, errmsg=w%told)
      call ended(w, 'set_coupling')
    case (4)
      call w%session(s)%get_coupling(n, x, y, k, stat=w%stat, errmsg=w%told)
      call ended(w, 'get_coupling')
    case (5)
      call w%session(s)%set_integrator(number(w, 0.0_dp, 1.0_dp), few(w, 1, 3), stat=w%stat, errmsg=w%told)
      call ended(w, 'set_integrator')
    case (6)
      call w%session(s)%set_newton(number(w, 0.0_dp, 1e-9_dp), number(w, 0.0_dp, 1e-6_dp), few(w, 1, 60), &
          stat=w%stat, errmsg=w%told)
      call ended(w, 'set_newton')
    case (7)
      text = 'newton.budget'
      select case (pick(w, 5))
      case (1)
        text = 'coupling.norm'
      case (2)
        text = text_of(w)
      case (3)
        text = 'coupling.unconverged'
      end select
      if (chance(w, 50)) then
        call w%session(s)%set_option(text, merge('accept', '5000  ', chance(w, 50)), stat=w%stat, errmsg=w%told)
      else
        call w%session(s)%get_option(text, text, stat=w%stat, errmsg=w%told)
      end if
      call ended(w, 'option')
    case (8)
      values = room(w, 1, SPAR_REPORT_COUNT)
      n = size(values, 2) - 1
      call w%session(s)%get_report(values(1,2:n), stat=w%stat, errmsg=w%told)
      call ended(w, 'get_report')
      call opened(w, 'get_report', values)
    case (9)
      call w%session(s)%get_phase(n, stat=w%stat, errmsg=w%told)
      call ended(w, 'get_phase')
    case (10)
      call w%session(s)%set_tolerance(number(w, 1e-3_dp, 1.0_dp), number(w, 0.0_dp, 0.3_dp), stat=w%stat, &
          errmsg=w%told)
      call ended(w, 'set_tolerance')
    case (11)
      call w%session(s)%get_step_control(x, y, n, many, stat=w%stat, errmsg=w%told)
      call ended(w, 'get_step_control')
    case (12)
      call w%session(s)%set_reproducible(chance(w, 50), stat=w%stat, errmsg=w%told)
      call w%session(s)%get_reproducible(on)
      call ended(w, 'set_reproducible')
    case (13)
      call w%session(s)%set_threads(few(w, 1, 2), stat=w%stat, errmsg=w%told)
      call ended(w, 'set_threads')
    case (14)
      call w%session(s)%fail(whole(w, 0, 11), text_of(w), stat=w%stat, errmsg=w%told)
      call ended(w, 'fail')
    case (15)
      call w%session(s)%save(path_of(w), stat=w%stat, errmsg=w%told)
      call ended(w, 'save')
    case (16)
      call w%session(s)%load(path_of(w), stat=w%stat, errmsg=w%told)
      call ended(w, 'load')
    case (17)
      if (chance(w, 60)) then
        call w%session(s)%set_progress(progress, me, stat=w%stat, errmsg=w%told)
      else
        call w%session(s)%set_progress(stat=w%stat, errmsg=w%told)
      end if
      call ended(w, 'set_progress')
    case (18)
      if (chance(w, 60)) then
        call w%session(s)%set_log(log, me, stat=w%stat, errmsg=w%told)
      else
        call w%session(s)%set_log(stat=w%stat, errmsg=w%told)
      end if
      call ended(w, 'set_log')
    case (19)
      values = room(w, 2, 40)
      n = size(values, 2) - 1
      k = -5
      if (size(values, 1) == 2) then
        values = reshape(values, [size(values, 2), 2])
        call w%session(s)%get_iterations(k, values(2:n,1), values(2:n,2), stat=w%stat, errmsg=w%told)
        call ended(w, 'get_iterations')
        call opened(w, 'get_iterations', transpose(values))
        if (w%stat == SPAR_OK .and. k < 0) call finding(w, 'get_iterations', 'none')
      end if
    case (20)
      values = reshape([number(w, -1.0_dp, 1.0_dp), 2.0_dp], [2, 1])
      call w%session(s)%sum(values(:,1), stat=w%stat, errmsg=w%told)
      call ended(w, 'sum')
    case (21)
      if (len(w%session(s)%message()) > 1023) call finding(w, 'message', 'too long')
      if (len(w%session(s)%get_warning(whole(w, 1, 3))) > 2000) call finding(w, 'warning', 'too long')
      if (len(spar_status_text(whole(w, 0, 12))) == 0 .or. len(spar_effect_name(whole(w, 0, 3))) > 40) &
          call finding(w, 'texts', 'none')
    case (22)
      call w%session(s)%set_predictor(whole(w, 0, 2), stat=w%stat, errmsg=w%told)
      call ended(w, 'set_predictor')
    case (23)
      call w%session(s)%get_time(x, many, n, stat=w%stat, errmsg=w%told)
      call ended(w, 'get_time')
    case default
      call step_calls(w, s)
    end select
  end subroutine session_calls

  recursive subroutine step_calls(w, s)
    type(world), intent(inout), target :: w
    integer, intent(in) :: s
    integer :: n
    real(dp) :: dt, taken
    logical :: done

    dt = number(w, 1e-3_dp, 2e-2_dp)
    taken = SEAL
    w%budget = w%budget - 1
    select case (pick(w, 10))
    case (1)
      call w%session(s)%step_begin(dt, stat=w%stat, errmsg=w%told)
    case (2)
      call w%session(s)%step_solve(stat=w%stat, errmsg=w%told)
    case (3)
      call w%session(s)%step_check(done, stat=w%stat, errmsg=w%told)
    case (4)
      call w%session(s)%step_accept(stat=w%stat, errmsg=w%told)
    case (5)
      call w%session(s)%step_reject(stat=w%stat, errmsg=w%told)
    case (6)
      call w%session(s)%step_adaptive(dt, before, solve, w, taken, stat=w%stat, errmsg=w%told)
      if (w%stat /= SPAR_OK .and. taken /= SEAL) call finding(w, 'step_adaptive', 'a refused call wrote a result')
    case (7)
      call w%session(s)%solve_initial(dt, solve, w, n, stat=w%stat, errmsg=w%told)
    case (8)
      call w%session(s)%solve_static(few(w, 1, 2), solve, w, n, stat=w%stat, errmsg=w%told)
    case (9)
      call w%session(s)%step(dt, stat=w%stat, errmsg=w%told)
    case default
      call w%session(s)%step(dt, solve, w, n, stat=w%stat, errmsg=w%told)
    end select
    call ended(w, 'step')
  end subroutine step_calls

  ! ---- members ----

  recursive subroutine make_member(w)
    type(world), intent(inout) :: w
    integer :: s, m, n

    s = pick(w, SESSIONS)
    m = findloc(w%member_session, 0, 1)
    if (m == 0) m = pick(w, MEMBERS)
    if (w%member_session(m) /= 0 .and. chance(w, 90)) return
    call begin(w)
    select case (pick(w, 4))
    case (1)
      call w%member(m)%create_point(w%session(s), text_of(w), triple(w, 3, -1.0_dp, 1.0_dp), &
          [1, 0, 0, 0] * 1.0_dp, stat=w%stat, errmsg=w%told)
    case (2)
      call w%member(m)%create_rigid(w%session(s), text_of(w), triple(w, 3, -1.0_dp, 1.0_dp), &
          [1, 0, 0, 0] * 1.0_dp, mass_of(w), stat=w%stat, errmsg=w%told)
    case default
      call w%member(m)%create_beam(w%session(s), text_of(w), few(w, 1, 2), whole(w, 2, 5), stat=w%stat, errmsg=w%told)
    end select
    call ended(w, 'create member')
    if (w%stat /= SPAR_OK) return
    w%member_session(m) = s
    if (chance(w, 80)) then
      n = 2
      call w%member(m)%set_axis([0, 1] * 1.0_dp, reshape([0, 0, 0, 2, 0, 0] * 1.0_dp, [3, 2]), stat=w%stat)
      call w%member(m)%set_sections(eta_of(w, 1), matrices(w, 1, 1e4_dp), reshape(mass_of(w), [6, 6, 1]), stat=w%stat)
    end if
    if (chance(w, 70)) call w%member(m)%commit(stat=w%stat)
  end subroutine make_member

  recursive integer function nodes_of(w, m) result(n)
    type(world), intent(inout) :: w
    integer, intent(in) :: m
    integer :: stat

    n = 3
    call w%member(m)%get_count(n, stat=stat)
    if (n > 50) n = 3
  end function nodes_of

  recursive subroutine description_calls(w)
    type(world), intent(inout) :: w
    integer :: m, n

    m = pick(w, MEMBERS)
    n = pick(w, 3)
    call begin(w)
    select case (pick(w, 16))
    case (1)
      call w%member(m)%set_axis(eta_of(w, n + 1), grid(w, 3, n + 1, -1.0_dp, 1.0_dp), vector(w, n + 1, 0.0_dp, &
          0.2_dp), stat=w%stat, errmsg=w%told)
    case (2)
      call w%member(m)%set_sections(eta_of(w, n), matrices(w, n, 1e4_dp), matrices(w, n, 1.0_dp), stat=w%stat, &
          errmsg=w%told)
    case (3)
      call w%member(m)%set_placement(triple(w, 3, -1.0_dp, 1.0_dp), triple(w, 4, -1.0_dp, 1.0_dp), &
          stat=w%stat, errmsg=w%told)
    case (4)
      call w%member(m)%set_root(whole(w, 0, 3), stat=w%stat, errmsg=w%told)
    case (5)
      call w%member(m)%set_external(chance(w, 30), stat=w%stat, errmsg=w%told)
    case (6)
      call w%member(m)%set_initial_velocity(omega=triple(w, 3, -1.0_dp, 1.0_dp), stat=w%stat, errmsg=w%told)
    case (7)
      call w%member(m)%set_quadrature(whole(w, 0, 2), whole(w, 1, 6), stat=w%stat, errmsg=w%told)
    case (8)
      call w%member(m)%set_masses(eta_of(w, n), matrices(w, n, 1.0_dp), stat=w%stat, errmsg=w%told)
    case (9)
      call w%member(m)%set_foundation(eta_of(w, n), grid(w, 6, n, 0.0_dp, 10.0_dp), stat=w%stat, errmsg=w%told)
    case (10)
      call w%member(m)%set_pretension(eta_of(w, n), grid(w, 6, n, -1.0_dp, 1.0_dp), stat=w%stat, errmsg=w%told)
    case (11)
      call w%member(m)%set_damping(triple(w, 6, 0.0_dp, 1e-2_dp), stat=w%stat, errmsg=w%told)
    case (12)
      call w%member(m)%set_effects(whole(w, 0, 4095), whole(w, 0, 4095), stat=w%stat, errmsg=w%told)
    case (13)
      call w%member(m)%set_fidelity(whole(w, 0, 4), whole(w, 1, 4), stat=w%stat, errmsg=w%told)
    case (14)
      call w%member(m)%set_nodes(grid(w, 3, 5, 0.0_dp, 1.0_dp), stat=w%stat, errmsg=w%told)
    case (15)
      call w%member(m)%set_added_mass(eta_of(w, n), matrices(w, n, 1.0_dp), stat=w%stat, errmsg=w%told)
    case default
      call w%member(m)%commit(stat=w%stat, errmsg=w%told)
    end select
    call ended(w, 'description')
  end subroutine description_calls

  recursive subroutine member_calls(w)
    type(world), intent(inout) :: w
    integer :: m, n, k, u
    real(dp), allocatable :: x(:,:), y(:,:), shape(:,:,:)
    real(dp) :: six(6)
    integer(c_int64_t) :: many

    m = pick(w, MEMBERS)
    n = nodes_of(w, m)
    call begin(w)
    select case (pick(w, 14))
    case (1)
      x = room(w, 7, n)
      y = room(w, 6, n)
      k = size(x, 2) - 1
      u = size(y, 2) - 1
      call w%member(m)%get_motion(q=x(:,2:k), a=y(:,2:u), stat=w%stat, errmsg=w%told)
      call ended(w, 'get_motion')
      call opened(w, 'get_motion', x)
      call opened(w, 'get_motion', y)
    case (2)
      x = grid(w, 7, n, -0.1_dp, 0.1_dp)
      if (size(x, 1) == 7) x(4,:) = 1
      call w%member(m)%set_motion(x, grid(w, 6, n, -1.0_dp, 1.0_dp), stat=w%stat, errmsg=w%told)
      call ended(w, 'set_motion')
    case (3)
      call w%member(m)%drive([0.01_dp * real_of(w), 0.0_dp, 0.0_dp, 1.0_dp, number(w, -0.9_dp, &
          0.9_dp), 0.0_dp, 0.0_dp], triple(w, 6, -1.0_dp, 1.0_dp), stat=w%stat, errmsg=w%told)
      call ended(w, 'drive')
    case (4)
      call w%member(m)%set_load(whole(w, 1, n), whole(w, 0, 1), triple(w, 6, -50.0_dp, 50.0_dp), stat=w%stat, &
          errmsg=w%told)
      call ended(w, 'set_load')
    case (5)
      x = room(w, 6, n)
      k = size(x, 2) - 1
      call w%member(m)%get_loads(x(:,2:k), stat=w%stat, errmsg=w%told)
      call ended(w, 'get_loads')
      call opened(w, 'get_loads', x)
    case (6)
      call w%member(m)%set_line_load(whole(w, 0, 1), eta_of(w, 2), grid(w, 6, 2, -5.0_dp, 5.0_dp), stat=w%stat, &
          errmsg=w%told)
      call ended(w, 'set_line_load')
    case (7)
      six = SEAL
      call w%member(m)%get_reaction(six, stat=w%stat, errmsg=w%told)
      call ended(w, 'get_reaction')
      if (w%stat /= SPAR_OK .and. any(six /= SEAL)) call finding(w, 'get_reaction', 'a refused call wrote results')
    case (8)
      u = pick(w, 4)
      x = room(w, 6, u)
      y = room(w, 4, u)
      call w%member(m)%evaluate(vector(w, u, 0.0_dp, 1.0_dp), force=x(:,2:size(x, 2)-1), q=y(:,2:size(y, 2)-1), &
          stat=w%stat, errmsg=w%told)
      call ended(w, 'evaluate')
      call opened(w, 'evaluate', x)
      call opened(w, 'evaluate', y)
    case (9)
      call w%member(m)%solve_static(few(w, 1, 3), stat=w%stat, errmsg=w%told)
      call ended(w, 'solve_static')
    case (10)
      u = pick(w, 3)
      x = room(w, 1, u)
      u = size(x, 2) - 1
      allocate (shape(extent(w, 6), extent(w, n), u - 1))
      if (size(x, 1) == 1) then
        call w%member(m)%solve_modes(x(1,2:u), shape, stat=w%stat, errmsg=w%told)
        call ended(w, 'solve_modes')
        call opened(w, 'solve_modes', x)
      end if
    case (11)
      u = pick(w, 2)
      x = room(w, 2, u)
      call w%member(m)%solve_eigenvalues([0, 0] * 1.0_dp, x(:,2:size(x, 2)-1), stat=w%stat, errmsg=w%told)
      call ended(w, 'solve_eigenvalues')
      call opened(w, 'solve_eigenvalues', x)
    case (12)
      many = -1
      call w%member(m)%get_iterations(many, stat=w%stat, errmsg=w%told)
      call ended(w, 'get_iterations')
      if (w%stat == SPAR_OK .and. many < 0) call finding(w, 'get_iterations', 'none')
    case (13)
      if (len(w%member(m)%get_name()) > 4000) call finding(w, 'get_name', 'too long')
      call w%member(m)%write_vtk(path_of(w), stat=w%stat, errmsg=w%told)
      call ended(w, 'write_vtk')
    case default
      x = room(w, 3, n)
      k = size(x, 2) - 1
      call w%member(m)%get_reference(x=x(:,2:k), stat=w%stat, errmsg=w%told)
      call ended(w, 'get_reference')
      call opened(w, 'get_reference', x)
    end select
  end subroutine member_calls

  ! ---- joints ----

  recursive subroutine joint_calls(w)
    type(world), intent(inout) :: w
    integer :: j, a, b, s
    real(dp) :: six(6)

    j = pick(w, JOINTS)
    a = pick(w, MEMBERS)
    b = pick(w, MEMBERS)
    s = pick(w, SESSIONS)
    call begin(w)
    select case (pick(w, 9))
    case (1)
      call w%joint(j)%create(w%session(s), text_of(w), w%member(a), whole(w, 1, 3), whole(w, 0, 63), w%member(b), whole(w, 1, 3), &
          stat=w%stat, errmsg=w%told)
      if (w%stat == SPAR_OK) w%joint_session(j) = s
    case (2)
      call w%joint(j)%create_link(w%session(s), text_of(w), w%member(a), whole(w, 1, 3), triple(w, 3, -1.0_dp, 1.0_dp), &
          triple(w, 3, -1.0_dp, 1.0_dp), stat=w%stat, errmsg=w%told)
      if (w%stat == SPAR_OK) w%joint_session(j) = s
    case (3)
      call w%joint(j)%create_spring(w%session(s), text_of(w), w%member(a), whole(w, 1, 3), whole(w, 1, 63), stiffness=matrix(w, &
          100.0_dp), stat=w%stat, errmsg=w%told)
      if (w%stat == SPAR_OK) w%joint_session(j) = s
    case (4)
      call w%joint(j)%set_frame(triple(w, 3, -1.0_dp, 1.0_dp), stat=w%stat, errmsg=w%told)
    case (5)
      call w%joint(j)%set_spring(matrix(w, 100.0_dp), stat=w%stat, errmsg=w%told)
    case (6)
      call w%joint(j)%set_driven(whole(w, 0, 63), stat=w%stat, errmsg=w%told)
    case (7)
      call w%joint(j)%drive(triple(w, 6, -0.1_dp, 0.1_dp), stat=w%stat, errmsg=w%told)
    case (8)
      six = SEAL
      call w%joint(j)%get_load(six, stat=w%stat, errmsg=w%told)
      if (w%stat /= SPAR_OK .and. any(six /= SEAL)) call finding(w, 'get_load', 'a refused call wrote results')
    case default
      call w%joint(j)%set_load(triple(w, 6, -1.0_dp, 1.0_dp), stat=w%stat, errmsg=w%told)
    end select
    call ended(w, 'joint')
  end subroutine joint_calls

  ! ---- fluids ----

  recursive subroutine make_fluid(w)
    type(world), intent(inout) :: w
    integer :: f, m, n

    f = pick(w, FLUIDS)
    m = pick(w, MEMBERS)
    n = pick(w, 6)
    call begin(w)
    if (chance(w, 10)) call w%fluid(f)%destroy()
    call w%fluid(f)%create(w%member(m), text_of(w), stat=w%stat, errmsg=w%told)
    call ended(w, 'create fluid')
    if (w%stat /= SPAR_OK) return
    w%fluid_session(f) = w%member_session(m)
    select case (pick(w, 3))
    case (1)
      call w%fluid(f)%set_stations(vector(w, n, 0.0_dp, 1.0_dp), stat=w%stat)
    case (2)
      call w%fluid(f)%set_motion_nodes(grid(w, 3, n, 0.0_dp, 2.0_dp), stat=w%stat)
    case default
      call w%fluid(f)%set_motion_nodes(grid(w, 3, n, 0.0_dp, 2.0_dp), stat=w%stat)
      call w%fluid(f)%set_force_nodes(grid(w, 3, n, 0.0_dp, 2.0_dp), stat=w%stat)
    end select
    if (chance(w, 85)) call w%fluid(f)%map(stat=w%stat)
  end subroutine make_fluid

  recursive integer function fluid_nodes(w, f, which) result(n)
    type(world), intent(inout) :: w
    integer, intent(in) :: f, which
    integer :: stat

    n = 2
    call w%fluid(f)%get_count(which, n, stat=stat)
  end function fluid_nodes

  recursive subroutine fluid_calls(w)
    type(world), intent(inout) :: w
    integer :: f, n, k, which, u
    real(dp), allocatable :: x(:,:), y(:,:), turn(:,:,:)
    integer(c_int64_t) :: component, node
    integer :: stat
    logical :: plain

    f = pick(w, FLUIDS)
    which = merge(SPAR_NODES_MOTION, SPAR_NODES_FORCE, chance(w, 50))
    n = fluid_nodes(w, f, which)
    node = 3
    component = 1
    call w%fluid(f)%get_layout(which, node, component, stat=stat)
    plain = node == 3 .and. component == 1
    call begin(w)
    select case (pick(w, 20))
    case (1, 2)
      n = fluid_nodes(w, f, SPAR_NODES_MOTION)
      x = room(w, 3, n)
      y = room(w, 3, n)
      k = size(x, 2) - 1
      u = size(y, 2) - 1
      call w%fluid(f)%pull_motion(number(w, 0.0_dp, 1.0_dp), x(:,2:k), y(:,2:u), stat=w%stat, errmsg=w%told)
      call ended(w, 'pull_motion')
      call opened(w, 'pull_motion', x)
      call opened(w, 'pull_motion', y)
    case (3, 4, 5)
      n = fluid_nodes(w, f, SPAR_NODES_FORCE)
      call w%fluid(f)%push_forces(grid(w, 3, n, -1.0_dp, 1.0_dp), stat=w%stat, errmsg=w%told)
      call ended(w, 'push_forces')
    case (6)
      n = fluid_nodes(w, f, SPAR_NODES_FORCE)
      call w%fluid(f)%push_forces_f32(real(grid(w, 3, n, -1.0_dp, 1.0_dp), c_float), real(grid(w, 3, n, -1.0_dp, &
          1.0_dp), c_float), stat=w%stat, errmsg=w%told)
      call ended(w, 'push_forces_f32')
    case (7)
      x = room(w, 3, n)
      y = room(w, 4, n)
      k = size(x, 2) - 1
      u = size(y, 2) - 1
      call w%fluid(f)%pull_poses(which, number(w, 0.0_dp, 1.0_dp), x=x(:,2:k), q=y(:,2:u), stat=w%stat, errmsg=w%told)
      call ended(w, 'pull_poses')
      call opened(w, 'pull_poses', x)
      call opened(w, 'pull_poses', y)
    case (8)
      call w%fluid(f)%set_layout(which, int(whole(w, 1, 8), c_int64_t), int(whole(w, 1, 8), c_int64_t), stat=w%stat, errmsg=w%told)
      call ended(w, 'set_layout')
    case (9) ! by component
      if (.not. plain) then
        x = room(w, n, 3)
        k = size(x, 2) - 1
        call w%fluid(f)%get_positions(which, x=x(:,2:k), stat=w%stat, errmsg=w%told)
        call ended(w, 'get_positions')
        call opened(w, 'get_positions', x)
      else
        call w%fluid(f)%set_layout(which, 1_c_int64_t, int(max(n, 1), c_int64_t), stat=w%stat, errmsg=w%told)
        call ended(w, 'set_layout')
      end if
    case (10)
      call w%fluid(f)%map(stat=w%stat, errmsg=w%told)
      call ended(w, 'map')
    case (11)
      call w%fluid(f)%map_current(stat=w%stat, errmsg=w%told)
      call ended(w, 'map_current')
    case (12)
      n = fluid_nodes(w, f, SPAR_NODES_FORCE)
      x = room(w, 3, n)
      k = size(x, 2) - 1
      call w%fluid(f)%pull_forces(number(w, 0.0_dp, 1.0_dp), x(:,2:k), stat=w%stat, errmsg=w%told)
      call ended(w, 'pull_forces')
      call opened(w, 'pull_forces', x)
    case (13)
      n = fluid_nodes(w, f, SPAR_NODES_MOTION)
      if (chance(w, 50)) then
        call w%fluid(f)%set_motion_weights(vector(w, n, 0.0_dp, 1.0_dp), stat=w%stat, errmsg=w%told)
      else
        call w%fluid(f)%fade_motion(number(w, 0.1_dp, 0.5_dp), number(w, 0.5_dp, 3.0_dp), stat=w%stat, &
            errmsg=w%told)
      end if
      call ended(w, 'weights')
    case (14)
      u = pick(w, 3)
      call w%fluid(f)%set_states(int(whole(w, 0, 3), c_int64_t), stat=w%stat, errmsg=w%told)
      call ended(w, 'set_states')
      n = fluid_nodes(w, f, SPAR_NODES_FORCE)
      x = room(w, u, n)
      k = size(x, 2) - 1
      call begin(w)
      call w%fluid(f)%pull_states(int(u, c_int64_t), x(:,2:k), stat=w%stat, errmsg=w%told)
      call ended(w, 'pull_states')
      call opened(w, 'pull_states', x)
    case (15)
      allocate (turn(extent(w, 3), 3, extent(w, n)), source=0.0_dp)
      call w%fluid(f)%pull_matrices(number(w, 0.0_dp, 1.0_dp), whole(w, 0, 1), turn, stat=w%stat, errmsg=w%told)
      call ended(w, 'pull_matrices')
    case (16)
      call w%fluid(f)%fail(whole(w, 1, 11), text_of(w), stat=w%stat, errmsg=w%told)
      call ended(w, 'fail')
    case (17)
      if (len(w%fluid(f)%get_name()) > 4000) call finding(w, 'get_name', 'too long')
      call w%fluid(f)%write_vtk(path_of(w), stat=w%stat, errmsg=w%told)
      call ended(w, 'write_vtk')
    case (18)
      x = room(w, 3, n)
      y = room(w, 3, n)
      call w%fluid(f)%get_nearest(which, x_map=x(:,2:size(x, 2)-1), con=y(:,2:size(y, 2)-1), stat=w%stat, errmsg=w%told)
      call ended(w, 'get_nearest')
      call opened(w, 'get_nearest', x)
      call opened(w, 'get_nearest', y)
    case (19)
      call w%fluid(f)%set_force_nodes(grid(w, 3, pick(w, 5), 0.0_dp, 2.0_dp), stat=w%stat, errmsg=w%told)
      call ended(w, 'set_force_nodes')
    case default
      if (chance(w, 20)) call w%fluid(f)%destroy()
    end select
  end subroutine fluid_calls

  ! ---- trials ----

  recursive subroutine trial_calls(w)
    type(world), intent(inout), target :: w
    integer :: t, s
    class(*), pointer :: me
    real(dp) :: x, y, z
    character(:), allocatable :: text

    me => w
    t = pick(w, TRIALS)
    s = pick(w, SESSIONS)
    call begin(w)
    select case (pick(w, 10))
    case (1)
      if (chance(w, 30)) call w%trial(t)%destroy()
      call w%trial(t)%create(w%session(s), stat=w%stat, errmsg=w%told)
      if (w%stat == SPAR_OK) w%trial_session(t) = s
      call ended(w, 'create trial')
    case (2)
      call w%trial(t)%set_steps(number(w, 1e-3_dp, 1e-2_dp), 8 * few(w, 1, 2), stat=w%stat, errmsg=w%told)
      call ended(w, 'set_steps')
    case (3)
      call w%trial(t)%set_callbacks(before, me, solve, me, stat=w%stat, errmsg=w%told)
      call ended(w, 'set_callbacks')
    case (4)
      call w%trial(t)%set_progress(progress, me, stat=w%stat, errmsg=w%told)
      call ended(w, 'set_progress')
    case (5, 6)
      w%budget = w%budget - 8
      if (w%budget > 0) call w%trial(t)%run(chance(w, 50), stat=w%stat, errmsg=w%told)
      if (w%stat >= 0) call ended(w, 'run')
    case (7)
      x = SEAL
      call w%trial(t)%get_errors(x, y, z, stat=w%stat, errmsg=w%told)
      call ended(w, 'get_errors')
      if (w%stat /= SPAR_OK .and. x /= SEAL) call finding(w, 'get_errors', 'a refused call wrote results')
    case (8)
      text = 'nodes'
      call w%trial(t)%get_option(text, text, stat=w%stat, errmsg=w%told)
      call ended(w, 'get_option')
    case (9)
      call w%trial(t)%push_numbers(vector(w, pick(w, 5), -1.0_dp, 1.0_dp), stat=w%stat, errmsg=w%told)
      call ended(w, 'push_numbers')
    case default
      w%budget = w%budget - 60
      if (w%budget > 0 .and. w%depth == 0 .and. chance(w, 10)) then
        if (chance(w, 50)) then
          call w%trial(t)%advise(number(w, 0.05_dp, 0.5_dp), number(w, 0.1_dp, 1.0_dp), stat=w%stat, &
              errmsg=w%told)
        else
          call w%trial(t)%apply(stat=w%stat, errmsg=w%told)
        end if
        call ended(w, 'advise or apply')
      end if
    end select
  end subroutine trial_calls

  ! ---- any ----

  recursive subroutine random_call(w)
    type(world), intent(inout), target :: w

    select case (pick(w, 16))
    case (1, 2)
      call make_member(w)
    case (3)
      call description_calls(w)
    case (4, 5)
      call member_calls(w)
    case (6)
      call joint_calls(w)
    case (7)
      call make_fluid(w)
    case (8, 9, 10)
      call fluid_calls(w)
    case (11)
      call trial_calls(w)
    case default
      call session_calls(w)
    end select
  end subroutine random_call

  ! A world of a few hundred calls, from nothing to its end.
  recursive subroutine play(seed, calls, good, refused)
    integer(c_int64_t), intent(in) :: seed
    integer(c_int64_t), intent(inout) :: calls, good, refused
    type(world), pointer :: w
    integer :: k, s

    allocate (w) ! for good: gfortran 12 finalises sessions in an array of a type at wrong addresses
    w%state = ieor(seed * 7046029254386353131_c_int64_t, 88172645463325252_c_int64_t)
    if (w%state == 0) w%state = 1
    do k = 1, 10
      s = pick(w, 2)
    end do
    do s = 1, SESSIONS
      call w%session(s)%create()
      do k = 1, 2
        call make_member(w)
      end do
      call make_fluid(w)
    end do
    do k = 1, 300
      w%budget = 100
      call random_call(w)
    end do
    do s = 1, SESSIONS
      call forget(w, s)
    end do
    calls = calls + w%calls
    good = good + w%good
    refused = refused + w%refused
  end subroutine play
end module fuzz_calls

program fuzz
  use, intrinsic :: iso_c_binding, only: c_int64_t
  use fuzz_calls
  implicit none
  integer(c_int64_t) :: most, seed, calls, good, refused, k
  integer :: threads, i
  character(40) :: word

  most = 20000
  seed = 1
  threads = 1
  call get_command_argument(1, word)
  if (word /= '') read (word, *) most
  call get_command_argument(2, word)
  if (word /= '') read (word, *) seed
  call get_command_argument(3, word)
  if (word /= '') read (word, *) threads
  calls = 0
  good = 0
  refused = 0
  k = 0
  do while (calls < most)
    !$omp parallel do reduction(+:calls, good, refused) num_threads(threads) schedule(dynamic)
    do i = 1, 4 * threads
      call play(seed + k + i, calls, good, refused)
    end do
    k = k + 4 * threads
  end do
  print '(i0," calls from seed ",i0,": ",i0," succeed, ",i0," are refused")', calls, seed, good, refused
end program fuzz
