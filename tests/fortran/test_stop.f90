! What stops a program: a failure where stat is left out, and a copy of a handle. The program runs itself once per case, which
! must end with a status other than 0 and with the message on standard error.
program test_stop
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use spar
  use spar_aero
  implicit none
  character(16) :: what
  integer :: failures = 0

  call get_command_argument(1, what)
  select case (what)
  case ('')
    call expect('status', 'spar_session_set_predictor')
    call expect('errmsg', 'spar_session_set_predictor')
    call expect('shape', 'q has the shape (7,2); it must be (7,1)')
    call expect('create', 'session%create: the variable holds one already')
    call expect('session', 'a session cannot be copied')
    call expect('array', 'a session cannot be copied')
    call expect('part', 'a session cannot be copied')
    call expect('over', 'a session cannot be copied')
    call expect('fluid', 'a fluid cannot be copied')
    call expect('polar', 'a polar cannot be copied')
    call expect('aero', 'an aero object cannot be copied')
    if (failures > 0) error stop 'test_stop failed'
  case default
    call offend(what)
    stop ! a status of 0: the caller complains
  end select

contains

  subroutine expect(offence, message)
    character(*), intent(in) :: offence, message
    character(1000) :: me, line
    integer :: unit, status, length
    logical :: told

    call get_command_argument(0, me, length)
    call execute_command_line('"' // me(1:length) // '" ' // offence // ' 2> test_stop_' // offence // '.txt', exitstat=status)
    told = .false.
    open (newunit=unit, file='test_stop_' // offence // '.txt', action='read')
    do
      read (unit, '(a)', iostat=length) line
      if (length /= 0) exit
      told = told .or. index(line, message) > 0
    end do
    close (unit, status='delete')
    if (status /= 0 .and. told) return
    failures = failures + 1
    write (*, '(3a,i0,a,l1)') 'wrong: ', offence, ': status ', status, ', message told ', told
  end subroutine expect

  subroutine offend(offence)
    character(*), intent(in) :: offence
    type :: holder
      type(spar_session) :: session
    end type holder
    type(spar_session) :: session, other, several(2)
    type(holder) :: holders(2)
    type(spar_member) :: point
    type(spar_fluid) :: fluid, second
    type(spar_polar) :: polar, third
    type(spar_aero_object) :: aero, fourth
    real(c_double) :: q(7,2)
    character(80) :: errmsg

    call session%create()
    call point%create_point(session, 'point', [0, 0, 0] * 1.0_c_double, [1, 0, 0, 0] * 1.0_c_double)
    call point%commit()
    select case (offence)
    case ('status')
      call session%set_predictor(9)
    case ('errmsg')
      call session%set_predictor(9, errmsg=errmsg)
    case ('shape')
      call point%get_motion(q)
    case ('create')
      call session%create()
    case ('session')
      other = session
    case ('array')
      call several(2)%create()
      several(1:1) = several(2:2)
    case ('part')
      call holders(1)%session%create()
      holders(2) = holders(1)
    case ('over') ! the one that is lost would leak
      session = other
    case ('fluid')
      call fluid%create(point, 'fluid')
      second = fluid
    case ('polar')
      call polar%create([0, 1] * 1.0_c_double, [0, 1] * 1.0_c_double, [0, 1] * 1.0_c_double)
      third = polar
    case ('aero')
      call aero%create([spar_fluid ::])
      fourth = aero
    end select
  end subroutine offend
end program test_stop
