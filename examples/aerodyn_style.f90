! A blade-element code of the kind of AeroDyn on the structure of spar: its state lies SAVEd in a module, its blades are
! meshes of nodes (place, orientation matrix, velocities, acceleration in; force and moment out), and it is driven by two
! calls, UpdateStates from one time to the next and CalcOutput at a time. Such a code need not be changed to be coupled: the
! module coupling below fills its meshes from spar, calls it, and hands its loads back, on each MPI rank for the blades that
! are there (none is normal).
!
!   rotor --seconds 2 --newton 1e-12 --out out
!   aerodyn_style --seconds 2 --compare out/history.csv        (or: mpirun -np 2 aerodyn_style ...)
!
! In double precision the history agrees with that of the C program to rounding, if that one iterates as closely as this one does
! (--newton 1e-12): the differences are 1e-12 of the largest entry of a column, where 1e-10 is allowed. aerodyn_style_single is the same
! source with a host in single precision, as such codes often are: spar keeps double, and the loads arrive with 7 digits; it needs
! --coupling-tolerance 1e-5 --allowed 1e-4.
!
! Compiled alone, with spar installed (SPAR: its sources; with mpif90, add -DSPAR_WITH_MPI to run on several ranks; single precision:
! -DSPAR_EXAMPLE_SINGLE):
!
!   gfortran -cpp -ffree-line-length-none -DSPAR_DATA_DIR="\"$SPAR/examples/data\"" $(pkg-config --cflags spar_aero_fortran) \
!       $SPAR/examples/nrel5mw_parts.f90 $SPAR/examples/rotor_parts.f90 $SPAR/examples/aerodyn_style.f90 \
!       $(pkg-config --libs spar_aero_fortran) -o aerodyn_style

!-----------------------------------------------------------------------------------------------------------------------
! The host as one finds it: it knows nothing of spar. Orientation matrices have the local axes as rows (global to local), in
! the order of AeroDyn: normal to the chord towards the suction side, along the chord towards the trailing edge, along the span.
module aerodyn_like
  use bemt, only: ReKi, bemt_begin, element_loads
  use turbine, only: the_shaft => shaft, the_hub => hub
  implicit none
  private
  public :: MeshType, BladeMotion, BladeLoad, WindSpeed, AD_Init, AD_UpdateStates, AD_CalcOutput, AD_GetWork

  type :: MeshType
    real(ReKi), allocatable :: Position(:,:)        ! of the reference
    real(ReKi), allocatable :: TranslationDisp(:,:) ! since then
    real(ReKi), allocatable :: Orientation(:,:,:)   ! (local axis, component, node)
    real(ReKi), allocatable :: TranslationVel(:,:), RotationVel(:,:), TranslationAcc(:,:)
    real(ReKi), allocatable :: Force(:,:), Moment(:,:) ! per length
  end type MeshType

  type(MeshType), allocatable, save, target :: BladeMotion(:), BladeLoad(:)
  real(ReKi), allocatable, save :: LossRadius(:,:), Interval(:,:)
  real(ReKi), save :: Shaft(3) = 0, Hub(3) = 0, WindSpeed = 0, TimeBefore = -1
  ! The state: what the air has done to the blades so far, J, and the power that it is integrated from, W.
  real(ReKi), allocatable, save :: Work(:), WorkBefore(:), Power(:), PowerBefore(:)

contains

  ! Places of the nodes of the blades here, (3, nodes, blades).
  subroutine AD_Init(Position)
    real(ReKi), intent(in) :: Position(:,:,:)
    real(ReKi) :: arm(3)
    integer :: nodes, blades, i, k

    call bemt_begin()
    nodes = size(Position, 2)
    blades = size(Position, 3)
    Shaft = real(the_shaft, ReKi)
    Hub = real(the_hub, ReKi)
    allocate (BladeMotion(blades), BladeLoad(blades), LossRadius(nodes,blades), Interval(nodes-1,blades))
    allocate (Work(blades), WorkBefore(blades), Power(blades), PowerBefore(blades), source=0.0_ReKi)
    do k = 1, blades
      allocate (BladeMotion(k)%Position, source=Position(:,:,k))
      allocate (BladeMotion(k)%TranslationDisp(3,nodes), BladeMotion(k)%Orientation(3,3,nodes), &
          BladeMotion(k)%TranslationVel(3,nodes), BladeMotion(k)%RotationVel(3,nodes), &
          BladeMotion(k)%TranslationAcc(3,nodes), BladeLoad(k)%Force(3,nodes), BladeLoad(k)%Moment(3,nodes))
      do i = 1, nodes
        arm = Position(:,i,k) - Hub
        LossRadius(i,k) = norm2(arm - dot_product(arm, Shaft) * Shaft)
        if (i < nodes) Interval(i,k) = norm2(Position(:,i+1,k) - Position(:,i,k))
      end do
    end do
  end subroutine AD_Init

  ! The states from t to t_next, with motion and wind at t_next in the meshes. A t given before is a correction: the step
  ! begins again with the states it began with (as in the library of AeroDyn).
  subroutine AD_UpdateStates(t, t_next)
    real(ReKi), intent(in) :: t, t_next

    if (abs(t - TimeBefore) > 0) then
      WorkBefore = Work
      PowerBefore = Power
      TimeBefore = t
    end if
    call FindLoads()
    call FindPower()
    Work = WorkBefore + (t_next - t) / 2 * (PowerBefore + Power)
  end subroutine AD_UpdateStates

  ! Loads of the motion and wind in the meshes.
  subroutine AD_CalcOutput()
    call FindLoads()
    call FindPower()
  end subroutine AD_CalcOutput

  ! Per length, in a uniform wind along x.
  subroutine FindLoads()
    real(ReKi) :: load(6), x(3), axes(3,3)
    integer :: i, k

    do k = 1, size(BladeMotion)
      associate (m => BladeMotion(k), y => BladeLoad(k))
        do i = 1, size(m%Position, 2)
          x = m%Position(:,i) + m%TranslationDisp(:,i)
          axes = transpose(m%Orientation(:,:,i))
          call element_loads(i, x, axes(:,3), axes(:,2), axes(:,1), m%TranslationVel(:,i), &
              [WindSpeed, 0.0_ReKi, 0.0_ReKi], LossRadius(i,k), load)
          y%Force(:,i) = load(1:3)
          y%Moment(:,i) = load(4:6)
        end do
      end associate
    end do
  end subroutine FindLoads

  ! Power of the loads on each blade: loads and velocities are linear between the nodes.
  subroutine FindPower()
    real(ReKi) :: same, next
    integer :: i, k

    Power = 0
    do k = 1, size(Power)
      do i = 1, size(Interval, 1)
        same = NodePower(i, i) + NodePower(i + 1, i + 1)
        next = NodePower(i, i + 1) + NodePower(i + 1, i)
        Power(k) = Power(k) + Interval(i,k) / 6 * (2 * same + next)
      end do
    end do

  contains

    real(ReKi) function NodePower(a, b)
      integer, intent(in) :: a, b

      NodePower = dot_product(BladeLoad(k)%Force(:,a), BladeMotion(k)%TranslationVel(:,b)) &
          + dot_product(BladeLoad(k)%Moment(:,a), BladeMotion(k)%RotationVel(:,b))
    end function NodePower
  end subroutine FindPower

  ! Work on the blades here since the first step, J.
  real(ReKi) function AD_GetWork() result(W)
    W = sum(Work)
  end function AD_GetWork
end module aerodyn_like

!-----------------------------------------------------------------------------------------------------------------------
! All that is between the two: motion into the meshes, loads out of them.
module coupling
  use spar
  use turbine
  use bemt, only: ReKi
  use rotor_run
  use aerodyn_like
  implicit none

contains

  ! The reference of the host is where the sections are before anything moves.
  subroutine coupling_begin()
    real(dp) :: foot(3,ns), arm(3,ns)
    real(ReKi) :: position(3,ns,nb)
    integer :: k

    do k = 1, nb
      call fluid(k)%get_nearest(SPAR_NODES_MOTION, foot, con=arm)
      position(:,:,k) = real(foot + arm, ReKi)
    end do
    call AD_Init(position)
  end subroutine coupling_begin

  ! A section of spar has x along the span, y to the trailing edge, z to the pressure side; the axes of the host also turn with what
  ! the aerodynamic twist has beyond that of the structure.
  subroutine fill_mesh(k, x)
    integer, intent(in) :: k
    real(dp), intent(out) :: x(3,ns)
    real(dp) :: v(3,ns), omega(3,ns), accel(3,ns), rows(3,3,ns), own(3,3), c, s
    integer :: i

    call fluid(k)%pull_motion(1.0_dp, x, v)
    call fluid(k)%pull_poses(SPAR_NODES_MOTION, 1.0_dp, omega=omega, accel=accel)
    call fluid(k)%pull_matrices(1.0_dp, SPAR_MATRIX_GLOBAL_TO_LOCAL, rows)
    do i = 1, ns
      c = cos(extra_twist(i))
      s = sin(extra_twist(i))
      own(1,:) = -c * rows(3,:,i) - s * rows(2,:,i)
      own(2,:) = c * rows(2,:,i) - s * rows(3,:,i)
      own(3,:) = rows(1,:,i)
      BladeMotion(k)%Orientation(:,:,i) = real(own, ReKi)
    end do
    BladeMotion(k)%TranslationDisp = real(x - real(BladeMotion(k)%Position, dp), ReKi)
    BladeMotion(k)%TranslationVel = real(v, ReKi)
    BladeMotion(k)%RotationVel = real(omega, ReKi)
    BladeMotion(k)%TranslationAcc = real(accel, ReKi)
  end subroutine fill_mesh

  ! The fluid of the run: motion at t in, loads at t out, as often as the coupling iterates. The states of the host go from the
  ! last accepted time to t each time.
  subroutine couple(t)
    real(dp), intent(in) :: t
    real(dp) :: x(3,ns,nb), load(6,ns), force(3,ns), moment(3,ns), t_n
    integer :: k

    call session%get_time(t_n)
    do k = 1, nb
      call fill_mesh(k, x(:,:,k))
    end do
    WindSpeed = real(wind_at(t), ReKi)
    if (steps > 0) call AD_UpdateStates(real(t_n, ReKi), real(t, ReKi))
    call AD_CalcOutput()
    thrust = 0
    torque = 0
    do k = 1, nb
      load(1:3,:) = real(BladeLoad(k)%Force, dp)
      load(4:6,:) = real(BladeLoad(k)%Moment, dp)
      call spread(k, load, force, moment)
      call fluid(k)%push_forces(force, moment)
      call add_to_rotor(x(:,:,k), force, moment)
    end do
  end subroutine couple

  ! The host has kept the account of its work through all iterations; so has spar, as the work of the loads on the nodes. The
  ! two differ by how each sums over a step, to second order in dt: by far less than a step of an iteration counted twice.
  subroutine check_work()
    real(dp) :: host(2), structure, work(SPAR_WORK_COUNT)
    integer :: b

    host = [real(AD_GetWork(), dp), 0.0_dp]
#ifdef SPAR_WITH_MPI
    call sum_over_ranks(host)
#endif
    structure = 0
    do b = 1, blades
      call blade(b)%get_work(work)
      structure = structure + work(SPAR_WORK_FLUID + 1)
    end do
    if (rank == 0) write (output_unit, '(2(a,f12.3),a)') 'work: the host gave ', host(1) * 1e-3_dp, ' kJ, the blades took ', &
        structure * 1e-3_dp, ' kJ'
    if (abs(host(1) - structure) > 1e-3_dp * abs(structure)) error stop 'aerodyn_style: the works differ'
  end subroutine check_work
end module coupling

!-----------------------------------------------------------------------------------------------------------------------
program aerodyn_style
  use coupling, only: check_work, couple, coupling_begin
  use rotor_run, only: keep_work, rotor_begin, rotor_end, run
  implicit none

  keep_work = .true.
  if (.not. rotor_begin('aerodyn_style')) stop
  call coupling_begin()
  call run('aerodyn_style', couple)
  call check_work()
  call rotor_end()
end program aerodyn_style
