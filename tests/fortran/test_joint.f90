! Joints from Fortran: springs to the ground in their short form, a driven hinge with a body on its arm, lines that hold and that
! pull, a motor; against closed forms. Nodes count from 1.
program test_joint
  use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t
  use, intrinsic :: iso_fortran_env, only: error_unit
  use spar
  implicit none

  real(c_double), parameter :: g = 9.81_c_double, origin(3) = 0, unit(4) = [1, 0, 0, 0]
  integer, parameter :: all_six = 63
  integer :: failures = 0

  call spring_to_the_ground()
  call driven_hinge()
  call lines()
  call motor()
  call refusals()
  if (failures > 0) error stop 1

contains

  subroutine check(condition, what)
    logical, intent(in) :: condition
    character(*), intent(in) :: what

    if (condition) return
    write (error_unit, '(a)') 'failed: ' // what
    failures = failures + 1
  end subroutine check

  function diagonal(d) result(matrix)
    real(c_double), intent(in) :: d(6)
    real(c_double) :: matrix(6,6)
    integer :: i

    matrix = 0
    do i = 1, 6
      matrix(i,i) = d(i)
    end do
  end function diagonal

  subroutine make_body(session, name, x, mass, body)
    type(spar_session), intent(in) :: session
    character(*), intent(in) :: name
    real(c_double), intent(in) :: x(3), mass
    type(spar_member), intent(inout) :: body

    call body%create_rigid(session, name, x, unit, diagonal([mass, mass, mass, 0.1_c_double, 0.1_c_double, 0.1_c_double]))
    call body%set_effects(SPAR_EFFECT_WORK, 0)
    call body%commit()
  end subroutine make_body

  ! 2 kg on springs with a preload: at rest z = (4 N - m g) / k; then along x with 0.5 m/s, exp(-d t) sin(w t) / w to order 2.
  subroutine spring_to_the_ground()
    type(spar_session) :: session
    type(spar_member) :: body
    type(spar_joint) :: spring
    real(c_double) :: z(6), rate(6), load(6), energy(0:SPAR_JOINT_ENERGY_COUNT - 1), d, w, t, rest
    integer :: i

    call session%create()
    call session%set_gravity([0.0_c_double, 0.0_c_double, -g])
    call session%set_integrator(1.0_c_double, 1)
    call make_body(session, 'body', origin, 2.0_c_double, body)
    call spring%create_spring(session, 'spring', body, 1, int(all_six, c_int), &
        stiffness=diagonal([80, 90, 100, 10, 11, 12] * 1.0_c_double), &
        damping=diagonal([1, 0, 0, 0, 0, 0] * 1.0_c_double), preload=[0, 0, 4, 0, 0, 0] * 1.0_c_double)
    call check(spring%exists(), 'a spring is a joint')
    call body%solve_static(1)
    call spring%get_motion(z)
    call spring%get_load(load)
    rest = (4 - 2 * g) / 100
    call check(abs(z(3) - rest) < 1e-12_c_double, 'at rest on the spring')
    call check(abs(load(3) - 2 * g) < 1e-11_c_double, 'it bears the weight')
    call body%set_initial_velocity(origin, [0.5_c_double, 0.0_c_double, 0.0_c_double], origin)
    do i = 1, 500
      call session%step(2e-3_c_double)
    end do
    d = 0.25_c_double
    w = sqrt(40 - d**2)
    t = 1
    call spring%get_motion(z, rate)
    call check(abs(z(1) - 0.5_c_double / w * exp(-d * t) * sin(w * t)) < 2e-5_c_double, 'a damped swing')
    call check(abs(z(3) - rest) < 1e-12_c_double .and. abs(rate(3)) < 1e-12_c_double, 'the weight hangs still')
    call spring%get_energy(energy)
    call check(abs(energy(SPAR_JOINT_ENERGY_SPRING) - (40 * z(1)**2 + 50 * z(3)**2 - 4 * z(3))) < 1e-12_c_double, 'energy')
  end subroutine spring_to_the_ground

  ! A body half a metre beside a shaft along z that is driven at 7 rad/s over three turns: it goes round, and the shaft bears
  ! m w^2 r towards the axis, to what acceleration and chord are off, dt^2.
  subroutine driven_hinge()
    type(spar_session) :: session
    type(spar_member) :: body
    type(spar_joint) :: shaft
    real(c_double), parameter :: w = 7, dt = 1e-3_c_double, arm(3) = [0.5_c_double, 0.0_c_double, 0.0_c_double]
    real(c_double) :: z(6), rate(6), second(6), load(6), q(7,1), angle
    integer :: i

    call session%create()
    call session%set_integrator(0.8_c_double, 1)
    call body%create_rigid(session, 'body', arm, unit, diagonal([2.0_c_double, 2.0_c_double, 2.0_c_double, 0.1_c_double, &
        0.1_c_double, 0.1_c_double]))
    call body%set_initial_velocity(origin, origin, [0.0_c_double, 0.0_c_double, w])
    call body%commit()
    call shaft%create(session, 'shaft', body, 1, SPAR_FREE_RZ)
    call shaft%set_frame(origin, unit)
    call shaft%set_driven(SPAR_FREE_RZ)
    do i = 1, 2700
      angle = w * dt * i
      call shaft%drive([0.0_c_double, 0.0_c_double, 0.0_c_double, 0.0_c_double, 0.0_c_double, angle], &
          rate=[0.0_c_double, 0.0_c_double, 0.0_c_double, 0.0_c_double, 0.0_c_double, w])
      call session%step(dt)
    end do
    call shaft%get_motion(z, rate, second)
    call shaft%get_load(load)
    call body%get_motion(q)
    call check(abs(z(6) - angle) < 1e-11_c_double .and. abs(rate(6) - w) < 1e-11_c_double, 'the hinge counts its turns')
    call check(abs(q(1,1) - 0.5_c_double * (cos(angle) - 1)) < 1e-11_c_double, 'the body goes round')
    call check(abs(norm2(load(1:2)) - 2 * w**2 * 0.5_c_double) < 1e-2_c_double, 'the shaft bears m w^2 r')
    call check(abs(load(3)) < 1e-9_c_double .and. abs(second(6)) < 1e-2_c_double, 'and nothing along it')
  end subroutine driven_hinge

  ! A weight of 3 kg on a rod of 2 m and a rope of 400 N/m to a point 1 m below, slack from 1.5 m on, so that the rod bears the
  ! weight alone; then the rope shortened by its unstretched length, 0.5 m: 200 N more in the rod.
  subroutine lines()
    type(spar_session) :: session
    type(spar_member) :: weight
    type(spar_joint) :: rod, rope, still
    real(c_double), parameter :: above(3) = [0, 0, 2], below(3) = [0, 0, -1]
    real(c_double) :: load(6), z(6)
    integer :: taut

    do taut = 0, 1
      call session%create()
      call session%set_gravity([0.0_c_double, 0.0_c_double, -g])
      call make_body(session, 'weight', origin, 3.0_c_double, weight)
      call rod%create_link(session, 'rod', weight, 1, origin, above)
      call rope%create_link(session, 'rope', weight, 1, origin, below)
      call rope%set_link_spring(400.0_c_double, 0.0_c_double, merge(0.5_c_double, 1.5_c_double, taut == 1), tension_only=.true.)
      call still%create(session, 'still', weight, 1_c_int64_t, int(all_six, c_int))
      call still%set_spring(stiffness=diagonal([1, 1, 0, 1, 1, 1] * 1.0_c_double))
      call weight%solve_static(1)
      call rod%get_motion(z)
      call check(abs(z(1) - 2) < 1e-12_c_double, 'the rod holds its length')
      call rod%get_load(load)
      call check(abs(abs(load(1)) - 3 * g - 200 * taut) < 1e-9_c_double, 'what the rod bears')
      call rope%get_load(load)
      call check(abs(abs(load(1)) - 200 * taut) < 1e-9_c_double, 'a rope only pulls')
      call session%destroy()
    end do
  end subroutine lines

  ! A motor of 0.5 N m between two discs on one axis, 0.1 kg m^2 each: they turn against each other.
  subroutine motor()
    type(spar_session) :: session
    type(spar_member) :: disc(2)
    type(spar_joint) :: bearing, shaft
    real(c_double) :: z(6), own(6)
    integer :: i

    call session%create()
    call make_body(session, 'first', origin, 1.0_c_double, disc(1))
    call make_body(session, 'second', origin, 1.0_c_double, disc(2))
    call bearing%create(session, 'bearing', disc(1), 1, SPAR_FREE_RZ)
    call shaft%create(session, 'shaft', disc(2), 1, SPAR_FREE_RZ, b=disc(1), node_b=1)
    call shaft%set_load([0.0_c_double, 0.0_c_double, 0.0_c_double, 0.0_c_double, 0.0_c_double, 0.5_c_double])
    do i = 1, 100
      call session%step(0.01_c_double)
    end do
    call shaft%get_motion(z)
    call bearing%get_motion(own)
    call check(abs(own(6) + 2.5_c_double) < 1e-10_c_double .and. abs(z(6) - 5) < 1e-10_c_double, 'the motor')
  end subroutine motor

  ! Each is refused with its status and a message, and nothing is made.
  subroutine refusals()
    type(spar_session) :: session
    type(spar_member) :: body
    type(spar_joint) :: joint, other
    integer(c_int) :: stat
    character(300) :: errmsg

    call session%create()
    call make_body(session, 'body', origin, 1.0_c_double, body)
    call joint%create(session, 'joint', body, 2, SPAR_FREE_X, stat=stat, errmsg=errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. .not. joint%exists() .and. index(errmsg, 'no node') > 0, trim(errmsg))
    call joint%create(session, 'joint', body, 1, SPAR_FREE_X)
    call joint%set_driven(SPAR_FREE_Y, stat=stat, errmsg=errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. index(errmsg, 'joint') > 0, trim(errmsg))
    call other%create(session, 'joint', body, 1, SPAR_FREE_X, stat=stat, errmsg=errmsg)
    call check(stat == SPAR_ERR_ARGUMENT .and. .not. other%exists(), 'a name twice: ' // trim(errmsg))
    call joint%drive([1, 0, 0, 0, 0, 0] * 1.0_c_double, stat=stat)
    call check(stat /= SPAR_OK, 'driving what is not driven')
  end subroutine refusals

end program test_joint
