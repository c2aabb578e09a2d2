! code_saturne's user routines that have to be there: its limits of the sub-iterations of a step are out of spar's way (40),
! and nothing comes from an XML file.
subroutine usppmo(ixmlpu)
  implicit none
  integer :: ixmlpu
end subroutine usppmo

subroutine usipph(ixmlpu, iturb, itherm, iale)
  implicit none
  integer :: ixmlpu, iturb, itherm, iale
end subroutine usipph

subroutine usipsu(nmodpp)
  use optcal
  use albase
  implicit none
  integer :: nmodpp
  nalinf = 0
  nalimx = 60
  epalim = 1.d-6
end subroutine usipsu

subroutine usipes(nmodpp)
  implicit none
  integer :: nmodpp
end subroutine usipes

subroutine usati1
end subroutine usati1
