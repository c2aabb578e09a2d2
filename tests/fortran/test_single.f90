! The four calls of nodes in single precision beside those in double. Set-up: a clamped beam along x with a fluid of 5 motion
! and 3 force nodes off its line, and one of 3 stations; three steps of 0.01 s under loads of few binary digits.
! Expected: what is pulled in single precision is the double, rounded, to the last bit. What is pushed in single precision gives
! the motion of the same numbers in double, to the last bit. Arrays may have strides; a refused call changes no result.
program test_single
  use, intrinsic :: iso_c_binding, only: c_double, c_float
  use spar
  implicit none
  integer, parameter :: steps = 3
  type(spar_session), target :: session
  type(spar_member) :: beam
  type(spar_fluid) :: cloth, strip
  real(c_double) :: in_double(7,5), in_single(7,5)
  integer :: failures = 0

  call run(.false., in_double)
  call run(.true., in_single)
  call check(.not. any(abs(in_double - in_single) > 0), 'the motion after loads in single precision')
  call check(abs(in_double(2,5)) > 1e-6_c_double, 'the beam moves')
  if (failures > 0) error stop 'test_single failed'

contains

  subroutine check(right, what)
    logical, intent(in) :: right
    character(*), intent(in) :: what

    if (right) return
    failures = failures + 1
    write (*, '(2a)') 'wrong: ', what
  end subroutine check

  logical function same(single, double)
    real(c_float), intent(in) :: single(:,:)
    real(c_double), intent(in) :: double(:,:)

    same = .not. any(abs(single - real(double, c_float)) > 0)
  end function same

  logical function untouched(array)
    real(c_float), intent(in) :: array(:,:)

    untouched = .not. any(abs(array - 7) > 0)
  end function untouched

  subroutine run(single, motion)
    logical, intent(in) :: single
    real(c_double), intent(out) :: motion(:,:)
    logical :: done
    integer :: step

    call describe()
    do step = 1, steps
      call session%step_begin(0.01_c_double)
      done = .false.
      do while (.not. done)
        call session%step_solve()
        call push(single, step)
        call session%step_check(done)
      end do
      call session%step_accept()
    end do
    call compare()
    call compare_refused()
    call beam%get_motion(motion)
    call session%destroy()
  end subroutine run

  subroutine describe()
    real(c_double) :: eta(2), xyz(3,2), stiffness(6,6,2), mass(6,6,2), nodes(3,5)
    integer :: i

    eta = [0.0_c_double, 1.0_c_double]
    xyz = reshape(real([0, 0, 0, 2, 0, 0], c_double), [3, 2])
    stiffness = 0
    mass = 0
    do i = 1, 6
      stiffness(i,i,:) = 1e3_c_double * i
      mass(i,i,:) = merge(2.0_c_double, 0.5_c_double, i <= 3)
    end do
    do i = 1, 5
      nodes(:,i) = [0.375_c_double * i, 0.25_c_double, 0.125_c_double * i]
    end do
    call session%create()
    call beam%create_beam(session, 'beam', 1, 5)
    call beam%set_axis(eta, xyz, [0.0_c_double, 0.0_c_double])
    call beam%set_sections(eta, stiffness, mass)
    call beam%set_effects(SPAR_EFFECT_FLUID_HISTORY, 0)
    call beam%commit()
    call cloth%create(beam, 'cloth')
    call cloth%set_motion_nodes(nodes)
    call cloth%set_force_nodes(nodes(:,1:5:2))
    call cloth%map()
    call strip%create(beam, 'strip')
    call strip%set_stations([0.25_c_double, 0.5_c_double, 0.75_c_double])
    call strip%map()
  end subroutine describe

  ! Single precision takes them from every other column.
  subroutine push(single, step)
    logical, intent(in) :: single
    integer, intent(in) :: step
    real(c_double) :: force(3,3), moment(3,3), none(3,3)
    real(c_float) :: wide(3,6), wide_moment(3,6)

    force = reshape(real([0, 1, 2, 3, 4, 5, 6, 7, 8], c_double), [3, 3]) / 16 * step
    moment = force(:,3:1:-1) / 8
    wide = 99
    wide_moment = 99
    wide(:,::2) = real(force, c_float)
    wide_moment(:,::2) = real(moment, c_float)
    if (single) then
      call cloth%push_forces_f32(wide(:,::2), wide_moment(:,::2))
    else
      call cloth%push_forces(force, moment)
    end if
    none = 0
    call strip%push_forces(none)
  end subroutine push

  subroutine compare()
    real(c_double) :: x(3,5), v(3,5), q(4,3), omega(3,3), accel(3,3), force(3,3)
    real(c_float) :: sx(3,5), sv(3,5), sq(4,3), somega(3,3), saccel(3,3), sforce(3,3), wide(3,10)

    call cloth%pull_motion(0.5_c_double, x, v)
    call cloth%pull_motion_f32(0.5_c_double, sx, sv)
    call check(same(sx, x) .and. same(sv, v), 'motion')
    wide = 7
    call cloth%pull_motion_f32(0.5_c_double, v=wide(:,::2))
    call check(same(wide(:,::2), v) .and. untouched(wide(:,2::2)), 'velocities alone, in an array with strides')
    call strip%pull_poses(SPAR_NODES_MOTION, 1.0_c_double, q=q, omega=omega, accel=accel)
    call strip%pull_poses_f32(SPAR_NODES_MOTION, 1.0_c_double, q=sq, omega=somega, accel=saccel)
    call check(same(sq, q) .and. same(somega, omega) .and. same(saccel, accel) .and. any(abs(saccel) > 0), 'stations')
    call cloth%pull_forces(1.0_c_double, force)
    call cloth%pull_forces_f32(1.0_c_double, sforce)
    call check(same(sforce, force) .and. any(abs(sforce) > 0), 'forces')
  end subroutine compare

  subroutine compare_refused()
    real(c_float) :: x(3,5), few(3,4)
    integer :: stat
    character(200) :: text

    x = 7
    few = 7
    text = ''
    call cloth%pull_motion_f32(2.0_c_double, x, stat=stat)
    call check(stat == SPAR_ERR_ARGUMENT .and. untouched(x), 'a theta out of range')
    call cloth%pull_motion_f32(1.0_c_double, few, stat=stat, errmsg=text)
    call check(stat == SPAR_ERR_ARGUMENT .and. untouched(few) .and. index(text, 'x has the shape (3,4)') > 0, 'a shape')
  end subroutine compare_refused
end program test_single
