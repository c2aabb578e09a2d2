! spar_support: what the modules spar and spar_aero share, and no host needs: statuses and messages, shapes of arrays, numbers and
! text between Fortran and C. All procedures are recursive: a callback may call another session, and threads each their own.
module spar_support
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_int, c_int64_t, c_null_char, c_ptr
  use spar_c, only: SPAR_OK, SPAR_ERR_ARGUMENT, SPAR_ERR_STATE, spar_session_message, c_status_text => spar_status_text
  implicit none
  private
  public :: append_extents, c_text, copy_text, fill_text, finish, flag, forbid_copy, hand, narrow, need, occupied, refuse, tell, &
      text_length, text_of, to_c

  interface
    pure function strlen(text) bind(c) result(n)
      import :: c_ptr, c_int64_t
      type(c_ptr), value :: text
      integer(c_int64_t) :: n
    end function strlen
  end interface

contains

  ! ---- status and messages ----

  ! How every call ends: the status goes to the caller that takes it; where none does, a failure stops the program with the
  ! message.
  recursive subroutine finish(status, session, stat, errmsg)
    integer(c_int), intent(in) :: status
    type(c_ptr), intent(in) :: session ! whose message tells; none: this thread's
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: text

    if (present(stat)) stat = status
    if (status == SPAR_OK) return
    call copy_text(spar_session_message(session), text)
    if (len(text) == 0) call copy_text(c_status_text(status), text)
    call tell(text, present(stat), errmsg)
  end subroutine finish

  ! How a call ends whose arguments the library has not seen.
  recursive subroutine refuse(place, fault, stat, errmsg, name)
    character(*), intent(in) :: place, fault
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(*), intent(in), optional :: name

    if (present(stat)) stat = SPAR_ERR_ARGUMENT
    if (present(name)) then
      call tell(place // ': ''' // name // ''': ' // trim(fault), present(stat), errmsg)
    else
      call tell(place // ': ' // trim(fault), present(stat), errmsg)
    end if
  end subroutine refuse

  recursive subroutine occupied(place, stat, errmsg)
    character(*), intent(in) :: place
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    if (present(stat)) stat = SPAR_ERR_STATE
    call tell(place // ': the variable holds one already; destroy it first, or use another variable', present(stat), errmsg)
  end subroutine occupied

  recursive subroutine tell(text, taken, errmsg)
    character(*), intent(in) :: text
    logical, intent(in) :: taken
    character(*), intent(inout), optional :: errmsg

    if (present(errmsg)) errmsg = text
    if (.not. taken) error stop text
  end subroutine tell

  ! Two uncreated variables are alike, and a variable is like itself; anything else would make a second owner.
  recursive subroutine forbid_copy(what, left, right)
    character(*), intent(in) :: what
    type(c_ptr), intent(in) :: left, right

    if (c_associated(right)) then
      if (c_associated(left, right)) return
    else
      if (.not. c_associated(left)) return
    end if
    error stop 'spar: ' // what // ' cannot be copied: pass it as an argument or keep a pointer to it'
  end subroutine forbid_copy

  ! ---- shapes and numbers ----

  ! Puts into fault what is wrong with the shape of an array, unless something is there already. Where there is nothing to be
  ! read or written, any array without elements will do.
  recursive subroutine need(fault, array, has, needs)
    character(:), allocatable, intent(inout) :: fault
    character(*), intent(in) :: array
    integer(c_int64_t), intent(in) :: has(:), needs(:)

    if (allocated(fault) .or. all(has == needs) .or. (product(has) == 0 .and. product(needs) == 0)) return
    fault = array // ' has the shape '
    call append_extents(fault, has)
    fault = fault // '; it must be '
    call append_extents(fault, needs)
  end subroutine need

  recursive subroutine append_extents(text, extents)
    character(:), allocatable, intent(inout) :: text
    integer(c_int64_t), intent(in) :: extents(:)
    integer :: i

    do i = 1, size(extents)
      text = text // merge('(', ',', i == 1) // trim(text_of(extents(i)))
    end do
    text = text // ')'
  end subroutine append_extents

  pure recursive function text_of(number) result(text)
    integer(c_int64_t), intent(in) :: number
    character(20) :: text

    write (text, '(i0)') number
  end function text_of

  ! A count for a caller with 32-bit integers.
  recursive subroutine narrow(status, from, to, place, session, stat, errmsg)
    integer(c_int), intent(in) :: status
    integer(c_int64_t), intent(in) :: from
    integer(c_int), intent(inout) :: to
    character(*), intent(in) :: place
    type(c_ptr), intent(in) :: session
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    if (status == SPAR_OK) then
      if (from > huge(to)) then
        call refuse(place, trim(text_of(from)) // ' does not fit; take a 64-bit integer', stat, errmsg)
        return
      end if
      to = int(from, c_int)
    end if
    call finish(status, session, stat, errmsg)
  end subroutine narrow

  ! A result of C in the host's kind of integer, which may be absent.
  pure recursive subroutine hand(status, from, to)
    integer(c_int), intent(in) :: status, from
    integer, intent(inout), optional :: to

    if (status == SPAR_OK .and. present(to)) to = from
  end subroutine hand

  ! An integer of the host for C; what C cannot hold becomes the largest that it can, which no call takes.
  elemental recursive integer(c_int) function to_c(number)
    integer, intent(in) :: number
    integer, parameter :: largest = huge(0_c_int)

    to_c = int(max(-largest, min(number, largest)), c_int)
  end function to_c

  recursive integer(c_int) function flag(on)
    logical, intent(in) :: on

    flag = merge(1_c_int, 0_c_int, on)
  end function flag

  ! ---- text across the border ----

  pure recursive function c_text(text) result(c)
    character(*), intent(in) :: text
    character(kind=c_char, len=len_trim(text) + 1) :: c

    c = trim(text) // c_null_char
  end function c_text

  ! Texts of C as results of functions: text_length says how long the result is, fill_text fills it. No function allocates its result,
  ! because gfortran keeps the length of such a result in one place for all threads, in the caller.
  pure recursive integer(c_int64_t) function text_length(c) result(n)
    type(c_ptr), intent(in) :: c

    n = 0
    if (c_associated(c)) n = strlen(c)
  end function text_length

  recursive subroutine fill_text(c, text)
    type(c_ptr), intent(in) :: c
    character(kind=c_char, len=*), intent(out) :: text
    character(kind=c_char), pointer :: letters(:)
    integer(c_int64_t) :: i, n

    text = ' '
    n = min(text_length(c), len(text, kind=c_int64_t))
    if (n == 0) return
    call c_f_pointer(c, letters, [n])
    do i = 1, n
      text(i:i) = letters(i)
    end do
  end subroutine fill_text

  recursive subroutine copy_text(c, text)
    type(c_ptr), intent(in) :: c
    character(kind=c_char, len=:), allocatable, intent(out) :: text

    allocate (character(kind=c_char, len=text_length(c)) :: text)
    call fill_text(c, text)
  end subroutine copy_text
end module spar_support
