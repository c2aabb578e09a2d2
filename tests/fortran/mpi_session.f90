! Ranks from Fortran: a communicator of mpi_f08, a body whose fluid nodes are spread over all ranks but the last one of several,
! which has none; loads add over the ranks; what fails on one rank is told on all of them.
program mpi_session
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use mpi_f08
  use spar
  implicit none
  type(spar_session) :: session
  integer :: rank, ranks, failures = 0

  call MPI_Init()
  call MPI_Comm_rank(MPI_COMM_WORLD, rank)
  call MPI_Comm_size(MPI_COMM_WORLD, ranks)
  call shared_load()
  call no_communicator()
  call session%destroy()
  call MPI_Allreduce(MPI_IN_PLACE, failures, 1, MPI_INTEGER, MPI_SUM, MPI_COMM_WORLD)
  call MPI_Finalize()
  call session%destroy()
  if (failures > 0) error stop 'mpi_session failed'

contains

  subroutine check(right, what)
    logical, intent(in) :: right
    character(*), intent(in) :: what

    if (right) return
    failures = failures + 1
    write (*, '(a,i0,2a)') 'wrong on rank ', rank, ': ', what
  end subroutine check

  ! Every rank but the last of several pushes 1 N at x = 1 + rank on a body of 2 kg: the sum of the forces moves it, and the
  ! moment about its node is the sum of the places.
  subroutine shared_load()
    type(spar_member) :: body
    type(spar_fluid) :: fluid
    real(c_double) :: mass(6,6), load(6,1), v(6,1), sums(2)
    real(c_double), allocatable :: x(:,:), f(:,:)
    integer(c_int) :: stat
    character(300) :: errmsg
    integer :: i, n
    logical :: done

    n = merge(0, 1, ranks > 1 .and. rank == ranks - 1)
    sums = 0
    do i = 0, merge(0, ranks - 2, ranks == 1)
      sums = sums + [1, 1 + i]
    end do
    allocate (x(3,n), f(3,n))
    x = 0
    x(1,:) = 1 + rank
    f = 0
    f(2,:) = 1
    mass = 0
    do i = 1, 6
      mass(i,i) = merge(2.0_c_double, 1e9_c_double, i <= 3)
    end do
    call session%create(MPI_COMM_WORLD%MPI_VAL)
    call body%create_rigid(session, 'body', [0, 0, 0] * 1.0_c_double, [1, 0, 0, 0] * 1.0_c_double, mass)
    call body%commit()
    call fluid%create(body, 'fluid')
    call fluid%set_motion_nodes(x)
    call fluid%set_force_nodes(x)
    call fluid%map()
    call fluid%push_forces(f)
    call session%step_begin(0.5_c_double)
    call session%step_solve()
    call fluid%push_forces(f)
    call session%step_check(done)
    call body%get_loads(load)
    call check(abs(load(2,1) - sums(1)) < 1e-13_c_double .and. abs(load(6,1) - sums(2)) < 1e-6_c_double, 'loads add')
    call session%step_accept()
    call body%get_motion(v=v)
    call check(abs(v(2,1) - 0.25_c_double * sums(1)) < 1e-12_c_double, 'the body moves alike on all ranks')

    call session%step_begin(0.5_c_double)
    call session%step_solve()
    if (rank == 0) f = ieee_value(1.0_c_double, ieee_quiet_nan)
    call fluid%push_forces(f, stat=stat)
    call check(stat == merge(SPAR_ERR_ARGUMENT, SPAR_OK, rank == 0), 'a force not a number on rank 0')
    call session%step_check(done, stat, errmsg)
    call check(stat == merge(SPAR_ERR_ARGUMENT, SPAR_ERR_PEER, rank == 0), 'all ranks know: ' // trim(errmsg))
    call session%step_reject()
    call session%step_begin(0.5_c_double * (1 + rank), stat)
    call check(stat == merge(SPAR_OK, SPAR_ERR_COMM, ranks == 1), 'steps that differ between the ranks')
    if (ranks == 1) call session%step_reject()
    call session%step(0.5_c_double, stat=stat)
    call check(stat == SPAR_OK, 'after all that the session works')
  end subroutine shared_load

  subroutine no_communicator()
    type(spar_session) :: lost
    integer(c_int) :: stat
    character(300) :: errmsg

    call lost%create(MPI_COMM_NULL%MPI_VAL, stat, errmsg)
    call check(stat /= SPAR_OK .and. .not. lost%exists() .and. len_trim(errmsg) > 0, 'a session on no communicator')
  end subroutine no_communicator
end program mpi_session
