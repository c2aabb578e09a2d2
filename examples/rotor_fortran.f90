! The NREL 5-MW rotor from the side of an older Fortran code: a blade-element host with its data in modules, its own reader of
! the tables, its own momentum theory and its own loop over time (rotor_parts.f90). Each rank takes its share of the blades
! (none is normal), pulls the motion of its sections out of spar, finds the loads and pushes them back. The equations are
! those of spar_aero.h, programmed a second time, so that the history agrees with that of the C program rotor to rounding:
!
!   rotor --seconds 2 --newton 1e-12 --out out
!   rotor_fortran --seconds 2 --compare out/history.csv        (or: mpirun -np 2 rotor_fortran ...)
!
! --help lists the options.

!-----------------------------------------------------------------------------------------------------------------------
! The fluid: a uniform wind.
module blade_elements
  use turbine
  use bemt
  use rotor_run
  implicit none

contains

  ! Motion out, loads per length, loads in.
  subroutine fluid_loads(t)
    real(dp), intent(in) :: t
    real(dp), dimension(3,ns) :: x, v, force, moment
    real(dp) :: q(4,ns), load(6,ns), u(3), r(3,3), c(3), normal(3)
    integer :: i, k

    thrust = 0
    torque = 0
    u = [wind_at(t), 0.0_dp, 0.0_dp]
    do k = 1, nb
      call fluid(k)%pull_motion(1.0_dp, x, v)
      call fluid(k)%pull_poses(SPAR_NODES_MOTION, 1.0_dp, q=q)
      do i = 1, ns
        r = frame_of(q(:,i))
        c = cos(extra_twist(i)) * r(:,2) - sin(extra_twist(i)) * r(:,3)
        normal = -cos(extra_twist(i)) * r(:,3) - sin(extra_twist(i)) * r(:,2)
        call element_loads(i, x(:,i), r(:,1), c, normal, v(:,i), u, loss_radius(i,k), load(:,i))
      end do
      call spread(k, load, force, moment)
      call fluid(k)%push_forces(force, moment)
      call add_to_rotor(x, force, moment)
    end do
  end subroutine fluid_loads
end module blade_elements

!-----------------------------------------------------------------------------------------------------------------------
program rotor_fortran
  use bemt, only: bemt_begin
  use blade_elements, only: fluid_loads
  use rotor_run, only: rotor_begin, rotor_end, run
  implicit none

  if (.not. rotor_begin('rotor_fortran')) stop
  call bemt_begin()
  call run('rotor_fortran', fluid_loads)
  call rotor_end()
end program rotor_fortran
