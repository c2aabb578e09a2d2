! Hosts in single precision: the same host, compiled once with each kind of real, in one program. It takes and gives what the
! other does, rounded; arrays with strides, results of refused calls and what lies behind the last entry included.
module host_double
  use, intrinsic :: iso_c_binding, only: c_double, c_float, c_int64_t
  use spar
  implicit none
  private
  public :: run, kept
  integer, parameter :: k = c_double
  real(c_float), allocatable :: kept(:)
  type(spar_fluid) :: cloth

contains

#include "single_host.inc"
end module host_double

module host_single
  use, intrinsic :: iso_c_binding, only: c_double, c_float, c_int64_t
  use spar
  implicit none
  private
  public :: run, kept
  integer, parameter :: k = c_float
  real(c_float), allocatable :: kept(:)
  type(spar_fluid) :: cloth

contains

#include "single_host.inc"
end module host_single

program test_single
  use, intrinsic :: iso_c_binding, only: c_int32_t
  use host_double, only: run_double => run, double => kept
  use host_single, only: run_single => run, single => kept
  implicit none
  integer :: i, wrong

  call run_double()
  call run_single()
  if (size(double) /= size(single) .or. size(double) < 800) error stop 'test_single: the hosts keep different things'
  wrong = 0
  do i = 1, size(double)
    if (transfer(double(i), 0_c_int32_t) == transfer(single(i), 0_c_int32_t)) cycle
    wrong = wrong + 1
    if (wrong <= 10) write (*, '(a,i0,2es24.16)') 'wrong: number ', i, double(i), single(i)
  end do
  if (count(abs(double) > 0) < size(double) / 3) error stop 'test_single: too little moves'
  write (*, '(2(i0,a))') size(double), ' numbers, ', wrong, ' differ'
  if (wrong > 0) error stop 'test_single failed'
end program test_single
