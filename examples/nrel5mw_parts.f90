! The NREL 5-MW turbine for Fortran hosts: its data in a module, and a reader of the tables under examples/data/nrel5mw.
! A part of rotor_fortran and turbine_fortran.

!-----------------------------------------------------------------------------------------------------------------------
! What an older code keeps in COMMON.
module turbine
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  implicit none
  integer, parameter :: dp = c_double, max_rows = 512, max_sections = 64, max_polars = 16, max_blades = 9
  real(dp), parameter :: pi = acos(-1.0_dp), degree = pi / 180

  ! the turbine, from the tables
  integer :: blades = 0
  real(dp) :: length = 0, hub_radius = 0, tip_radius = 0, precone = 0, tilt = 0, density = 0, damping(6) = 0
  integer :: n_axis = 0, n_structure = 0, ns = 0, n_polars = 0
  real(dp) :: axis_eta(max_rows), axis_xyz(3,max_rows), axis_twist(max_rows)
  real(dp) :: structure_eta(max_rows), stiffness(6,6,max_rows), mass(6,6,max_rows)
  real(dp) :: span(max_sections), curve(max_sections), sweep(max_sections), aero_twist(max_sections), chord(max_sections)
  integer :: polar_of(max_sections), polar_rows(max_polars)
  character(32) :: polar_name(max_polars)
  real(dp) :: polar_alpha(max_rows,max_polars), polar_cl(max_rows,max_polars), polar_cd(max_rows,max_polars), &
      polar_cm(max_rows,max_polars)

  ! where the rotor stands and how it runs
  real(dp) :: hub(3) = 0, shaft(3) = 0, pitch = 0, speed = 0
  real(dp) :: wind = 8, gust = 0, gust_start = 10, gust_length = 10

contains

  pure function cross(a, b) result(c)
    real(dp), intent(in) :: a(3), b(3)
    real(dp) :: c(3)

    c = [a(2) * b(3) - a(3) * b(2), a(3) * b(1) - a(1) * b(3), a(1) * b(2) - a(2) * b(1)]
  end function cross

  ! The columns are the axes of the frame q.
  pure function frame_of(q) result(r)
    real(dp), intent(in) :: q(4)
    real(dp) :: r(3,3)

    r(:,1) = [1 - 2 * (q(3)**2 + q(4)**2), 2 * (q(2) * q(3) + q(1) * q(4)), 2 * (q(2) * q(4) - q(1) * q(3))]
    r(:,2) = [2 * (q(2) * q(3) - q(1) * q(4)), 1 - 2 * (q(2)**2 + q(4)**2), 2 * (q(3) * q(4) + q(1) * q(2))]
    r(:,3) = [2 * (q(2) * q(4) + q(1) * q(3)), 2 * (q(3) * q(4) - q(1) * q(2)), 1 - 2 * (q(2)**2 + q(3)**2)]
  end function frame_of

  ! The unit quaternion of a frame, from the largest of its four entries (Shepperd 1978).
  pure function quaternion_of(r) result(q)
    real(dp), intent(in) :: r(3,3)
    real(dp) :: q(4)
    integer :: a, b, c

    if (r(1,1) + r(2,2) + r(3,3) >= max(r(1,1), r(2,2), r(3,3))) then
      q = [1 + r(1,1) + r(2,2) + r(3,3), r(3,2) - r(2,3), r(1,3) - r(3,1), r(2,1) - r(1,2)]
    else
      a = maxloc([r(1,1), r(2,2), r(3,3)], dim=1)
      b = mod(a, 3) + 1
      c = mod(b, 3) + 1
      q(1) = r(c,b) - r(b,c)
      q(1+a) = 1 + r(a,a) - r(b,b) - r(c,c)
      q(1+b) = r(b,a) + r(a,b)
      q(1+c) = r(a,c) + r(c,a)
    end if
    q = q / norm2(q)
  end function quaternion_of

  ! Root of blade b (from 1) when the rotor stands at angle: x along the span, y towards the trailing edge, z upwind.
  subroutine root_at(b, angle, x, r)
    integer, intent(in) :: b
    real(dp), intent(in) :: angle
    real(dp), intent(out) :: x(3), r(3,3)
    real(dp) :: up(3), side(3), psi, radial(3), aft(3), face(3)

    psi = angle + 2 * pi * (b - 1) / blades
    up = [0, 0, 1] - shaft(3) * shaft
    up = up / norm2(up)
    side = cross(shaft, up)
    radial = cos(psi) * up + sin(psi) * side
    aft = sin(psi) * up - cos(psi) * side
    r(:,1) = cos(precone) * radial - sin(precone) * shaft
    face = cross(r(:,1), aft)
    r(:,2) = cos(pitch) * aft - sin(pitch) * face
    r(:,3) = sin(pitch) * aft + cos(pitch) * face
    x = hub + hub_radius * r(:,1)
  end subroutine root_at

  ! Motion of that root, relative to the reference at angle 0, at constant speed.
  subroutine root_motion(b, angle, q, v, a)
    integer, intent(in) :: b
    real(dp), intent(in) :: angle
    real(dp), intent(out) :: q(7), v(6), a(6)
    real(dp) :: x0(3), x(3), r(3,3), swirl(3)

    call root_at(b, 0.0_dp, x0, r)
    call root_at(b, angle, x, r)
    swirl = cross(shaft, x - hub)
    q = [x - x0, cos(angle / 2), sin(angle / 2) * shaft]
    v = [speed * swirl, speed * shaft]
    a = [speed**2 * cross(shaft, swirl), 0.0_dp, 0.0_dp, 0.0_dp]
  end subroutine root_motion

  ! A 1-cos gust on top of the steady wind, along global x.
  real(dp) function wind_at(t)
    real(dp), intent(in) :: t
    real(dp) :: part

    part = (t - gust_start) / gust_length
    wind_at = wind
    if (part > 0 .and. part < 1) wind_at = wind + gust / 2 * (1 - cos(2 * pi * part))
  end function wind_at

  ! Steady operation: rotor speed (rev/min) and pitch (degrees) over the wind; Jonkman et al., NREL/TP-500-38060, table 7-1.
  subroutine operating_point(u, rpm, degrees)
    real(dp), intent(in) :: u
    real(dp), intent(out) :: rpm, degrees
    real(dp), parameter :: row(3,24) = reshape([ &
        3.0_dp, 6.97_dp, 0.0_dp,    4.0_dp, 7.18_dp, 0.0_dp,    5.0_dp, 7.51_dp, 0.0_dp,    6.0_dp, 7.94_dp, 0.0_dp, &
        7.0_dp, 8.47_dp, 0.0_dp,    8.0_dp, 9.16_dp, 0.0_dp,    9.0_dp, 10.30_dp, 0.0_dp,   10.0_dp, 11.43_dp, 0.0_dp, &
        11.0_dp, 11.89_dp, 0.0_dp,  11.4_dp, 12.1_dp, 0.0_dp,   12.0_dp, 12.1_dp, 3.83_dp,  13.0_dp, 12.1_dp, 6.60_dp, &
        14.0_dp, 12.1_dp, 8.70_dp,  15.0_dp, 12.1_dp, 10.45_dp, 16.0_dp, 12.1_dp, 12.06_dp, 17.0_dp, 12.1_dp, 13.54_dp, &
        18.0_dp, 12.1_dp, 14.92_dp, 19.0_dp, 12.1_dp, 16.23_dp, 20.0_dp, 12.1_dp, 17.47_dp, 21.0_dp, 12.1_dp, 18.70_dp, &
        22.0_dp, 12.1_dp, 19.94_dp, 23.0_dp, 12.1_dp, 21.18_dp, 24.0_dp, 12.1_dp, 22.35_dp, 25.0_dp, 12.1_dp, 23.47_dp], &
        [3, 24])
    real(dp) :: t
    integer :: i

    i = 2
    do while (i < 24 .and. row(1,i) < u)
      i = i + 1
    end do
    t = min(1.0_dp, max(0.0_dp, (u - row(1,i-1)) / (row(1,i) - row(1,i-1))))
    rpm = row(2,i-1) + t * (row(2,i) - row(2,i-1))
    degrees = row(3,i-1) + t * (row(3,i) - row(3,i-1))
  end subroutine operating_point
end module turbine

!-----------------------------------------------------------------------------------------------------------------------
! The tables of examples/data/nrel5mw.
module tables
  use turbine
  implicit none
  private
  public :: read_turbine

contains

  subroutine read_turbine(folder)
    character(*), intent(in) :: folder

    call read_rotor(folder // '/rotor.txt')
    call read_axis(folder // '/axis.txt')
    call read_structure(folder // '/sections.txt')
    call read_aero(folder // '/aero.txt', folder // '/polars/')
  end subroutine read_turbine

  ! The next line that says something; false at the end of the file.
  logical function next_line(unit, line)
    integer, intent(in) :: unit
    character(*), intent(out) :: line
    integer :: end, hash

    do
      read (unit, '(a)', iostat=end) line
      next_line = end == 0
      hash = index(line, '#')
      if (hash > 0) line(hash:) = ''
      if (.not. next_line .or. line /= '') return
    end do
  end function next_line

  integer function open_table(path) result(unit)
    character(*), intent(in) :: path
    integer :: status

    open (newunit=unit, file=path, action='read', status='old', iostat=status)
    if (status /= 0) error stop 'nrel5mw: ' // path // ' cannot be opened; say where the tables are with --data'
  end function open_table

  ! Rows of numbers, with a word after them where word is there.
  subroutine read_rows(path, columns, row, n, word)
    character(*), intent(in) :: path
    integer, intent(in) :: columns
    real(dp), intent(out) :: row(:,:)
    integer, intent(out) :: n
    character(*), intent(out), optional :: word(:)
    character(4096) :: line
    integer :: unit, status

    unit = open_table(path)
    n = 0
    do while (next_line(unit, line))
      n = n + 1
      if (n > size(row, 2)) error stop 'nrel5mw: ' // path // ' has too many rows'
      if (present(word)) then
        read (line, *, iostat=status) row(1:columns,n), word(n)
      else
        read (line, *, iostat=status) row(1:columns,n)
      end if
      if (status /= 0) error stop 'nrel5mw: ' // path // ': not the numbers expected: ' // trim(line)
    end do
    close (unit)
    if (n < 2) error stop 'nrel5mw: ' // path // ' has fewer than 2 rows'
  end subroutine read_rows

  subroutine read_rotor(path)
    character(*), intent(in) :: path
    character(4096) :: line
    character(32) :: name
    integer :: unit

    unit = open_table(path)
    do while (next_line(unit, line))
      read (line, *) name
      line = line(index(line, trim(name)) + len_trim(name):)
      select case (name)
      case ('blades')
        read (line, *) blades
      case ('length')
        read (line, *) length
      case ('hub_radius')
        read (line, *) hub_radius
      case ('tip_radius')
        read (line, *) tip_radius
      case ('precone')
        read (line, *) precone
        precone = precone * degree
      case ('tilt')
        read (line, *) tilt
        tilt = tilt * degree
      case ('density')
        read (line, *) density
      case ('damping')
        read (line, *) damping
      end select
    end do
    close (unit)
    if (blades < 1 .or. blades > max_blades) error stop 'nrel5mw: ' // path // ': a number of blades is wanted'
  end subroutine read_rotor

  subroutine read_axis(path)
    character(*), intent(in) :: path
    real(dp), save :: row(5,max_rows) ! not on the stack

    call read_rows(path, 5, row, n_axis)
    axis_eta(1:n_axis) = row(1,1:n_axis)
    axis_xyz(:,1:n_axis) = row(2:4,1:n_axis)
    axis_twist(1:n_axis) = -degree * row(5,1:n_axis) ! published: minus a right-handed turn
  end subroutine read_axis

  ! Upper triangles, row by row: 21 numbers of the stiffness, 21 of the mass.
  subroutine read_structure(path)
    character(*), intent(in) :: path
    real(dp), save :: row(43,max_rows) ! not on the stack
    integer :: i, j, k, at

    call read_rows(path, 43, row, n_structure)
    do k = 1, n_structure
      structure_eta(k) = row(1,k)
      at = 2
      do i = 1, 6
        do j = i, 6
          stiffness(i,j,k) = row(at,k)
          stiffness(j,i,k) = row(at,k)
          mass(i,j,k) = row(at+21,k)
          mass(j,i,k) = row(at+21,k)
          at = at + 1
        end do
      end do
    end do
  end subroutine read_structure

  subroutine read_aero(path, polars)
    character(*), intent(in) :: path, polars
    real(dp) :: row(5,max_sections)
    character(32) :: word(max_sections)
    integer :: i, p

    call read_rows(path, 5, row, ns, word)
    span(1:ns) = row(1,1:ns)
    curve(1:ns) = row(2,1:ns)
    sweep(1:ns) = row(3,1:ns)
    aero_twist(1:ns) = degree * row(4,1:ns)
    chord(1:ns) = row(5,1:ns)
    do i = 1, ns
      do p = 1, n_polars
        if (polar_name(p) == word(i)) exit
      end do
      polar_of(i) = p
      if (p > n_polars) call read_polar(polars // trim(word(i)) // '.txt', word(i))
    end do
  end subroutine read_aero

  subroutine read_polar(path, name)
    character(*), intent(in) :: path, name
    real(dp), save :: row(4,max_rows) ! not on the stack
    integer :: n

    if (n_polars == max_polars) error stop 'nrel5mw: too many polars'
    call read_rows(path, 4, row, n)
    n_polars = n_polars + 1
    polar_name(n_polars) = name
    polar_rows(n_polars) = n
    polar_alpha(1:n,n_polars) = degree * row(1,1:n)
    polar_cl(1:n,n_polars) = row(2,1:n)
    polar_cd(1:n,n_polars) = row(3,1:n)
    polar_cm(1:n,n_polars) = row(4,1:n)
  end subroutine read_polar
end module tables
