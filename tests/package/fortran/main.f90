! A body of 2 kg falls for one second under 9.81 m/s^2: -4.905 m, exact for the integrator (constant acceleration).
program main
  use, intrinsic :: iso_c_binding, only: c_double
  use spar
  implicit none
  type(spar_session) :: session
  type(spar_member) :: body
  real(c_double) :: mass(6, 6), q(7, 1)
  integer :: i

  if (spar_version() /= '0.1.0') error stop 'version'
  mass = 0
  do i = 1, 6
    mass(i, i) = 2
  end do
  call session%create()
  call session%set_gravity([0.0_c_double, 0.0_c_double, -9.81_c_double])
  call body%create_rigid(session, 'body', [0.0_c_double, 0.0_c_double, 0.0_c_double], &
      [1.0_c_double, 0.0_c_double, 0.0_c_double, 0.0_c_double], mass)
  call body%commit()
  do i = 1, 10
    call session%step(0.1_c_double)
  end do
  call body%get_motion(q)
  print '(a, f0.12, a)', 'fell ', q(3, 1), ' m'
  call session%destroy()
  if (abs(q(3, 1) + 4.905_c_double) > 1e-9_c_double) error stop 1
end program main
