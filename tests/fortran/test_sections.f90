! Section matrices from Fortran: a bar of one material with its mass centre off the line, there and back, and a refusal.
program test_sections
  use, intrinsic :: iso_c_binding, only: c_double
  use, intrinsic :: iso_fortran_env, only: error_unit
  use spar
  implicit none

  real(c_double), parameter :: b = 0.2_c_double, h = 0.1_c_double, young = 210e9_c_double, rho = 7850
  real(c_double) :: p(0:SPAR_SECTION_COUNT - 1), again(0:SPAR_SECTION_COUNT - 1), K(6,6), M(6,6), moved(6,6)
  character(:), allocatable :: text
  character(200) :: message
  integer :: findings, stat, failures = 0

  call spar_section_from_shape(SPAR_SHAPE_RECTANGLE, [b, h], young, 0.3_c_double, rho, p)
  call check(abs(p(SPAR_SECTION_EI_Y) / (young * b * h**3 / 12) - 1) < 1e-12_c_double, 'EI about y')
  p(SPAR_SECTION_MASS_Y) = 0.01_c_double
  call spar_section_build(p, K, M)
  call check(abs(K(1,1) / (young * b * h) - 1) < 1e-12_c_double, 'EA')
  call check(abs(M(1,6) + rho * b * h * 0.01_c_double) < 1e-12_c_double, 'mass centre')
  findings = -1
  call spar_section_describe(K, M, again, findings)
  call check(findings == 0 .and. all(abs(again - p) <= 1e-10_c_double * (1 + abs(p))), 'describe')
  call spar_section_transform(M, 0.01_c_double, 0.0_c_double, 0.0_c_double, moved)
  call check(abs(moved(1,6)) < 1e-12_c_double, 'transform')
  K(4,5) = 0.1_c_double * sqrt(K(4,4) * K(5,5))
  K(5,4) = K(4,5)
  call spar_section_report(K, text=text)
  call check(index(text, 'bending and torsion are coupled, coefficient 0.100') == 1, 'report')
  p(SPAR_SECTION_GJ) = 0
  message = ''
  call spar_section_build(p, stiffness=K, stat=stat, errmsg=message)
  call check(stat == SPAR_ERR_ARGUMENT .and. index(message, 'SPAR_SECTION_GJ is 0') > 0, 'refusal')
  if (failures > 0) error stop 1

contains

  subroutine check(condition, what)
    logical, intent(in) :: condition
    character(*), intent(in) :: what

    if (condition) return
    write (error_unit, '(a)') 'failed: ' // what
    failures = failures + 1
  end subroutine check
end program test_sections
