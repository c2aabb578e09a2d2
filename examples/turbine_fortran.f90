! The whole NREL 5-MW turbine driven from Fortran: tower, nacelle, shaft, drivetrain, hub, pitch bearings and blades tied by
! joints, the published controller, the blade element theory of the library. The machine and the run are those of the C program
! turbine, so that the histories agree to rounding:
!
!   turbine --seconds 5 --vtk-every 0 --out out
!   turbine_fortran --seconds 5 --compare out/history.csv
!
! --help lists the options.

!-----------------------------------------------------------------------------------------------------------------------
! The controller of the report (Jonkman et al., NREL/TP-500-38060, 2009, section 7); at the fast shaft, rad/s and N m.
module controller
  use turbine, only: dp
  implicit none
  private
  public :: controller_begin, controller_step
  real(dp), parameter, public :: gear = 97, efficiency = 0.944_dp
  real(dp), parameter :: cut_in = 70.16224_dp, region_2 = 91.21091_dp, rated = 121.6805_dp, optimal = 2.332287_dp, &
      slip = 0.10_dp, power = 5296610, torque_most = 47402.91_dp, torque_rate = 15000, held_from = 0.01745329_dp
  real(dp), parameter :: reference = 122.9096_dp, corner = 1.570796_dp, gain_p = 0.01882681_dp, gain_i = 0.008068634_dp, &
      gain_half = 0.1099965_dp, pitch_most = 1.570796_dp, pitch_rate = 0.1396263_dp
  real(dp) :: filtered = 0, integral = 0
  real(dp), public :: pitch_now = 0, torque_now = 0, rate_now = 0

contains

  pure real(dp) function torque_law(w, pitch) result(torque)
    real(dp), intent(in) :: w, pitch
    real(dp) :: synchronous

    synchronous = rated / (1 + slip)
    if (w >= rated .or. pitch >= held_from) then
      torque = power / max(w, 1.0_dp)
    else if (w <= cut_in) then
      torque = 0
    else if (w < region_2) then
      torque = optimal * region_2 * region_2 / (region_2 - cut_in) * (w - cut_in)
    else
      torque = max(optimal * w * w, power / rated / (rated - synchronous) * (w - synchronous))
    end if
    torque = min(torque, torque_most)
  end function torque_law

  subroutine controller_begin(w, pitch)
    real(dp), intent(in) :: w, pitch

    filtered = w
    pitch_now = pitch
    integral = pitch * (1 + pitch / gain_half) / gain_i
    torque_now = torque_law(w, pitch)
  end subroutine controller_begin

  subroutine controller_step(w, dt)
    real(dp), intent(in) :: w, dt
    real(dp) :: keep, gain, next

    keep = exp(-corner * dt)
    filtered = keep * filtered + (1 - keep) * w
    torque_now = clipped(torque_law(filtered, pitch_now), torque_now - torque_rate * dt, torque_now + torque_rate * dt)
    gain = 1 / (1 + pitch_now / gain_half)
    integral = clipped(integral + (filtered - reference) * dt, 0.0_dp, pitch_most / (gain * gain_i))
    next = clipped(gain * (gain_p * (filtered - reference) + gain_i * integral), 0.0_dp, pitch_most)
    next = clipped(next, pitch_now - pitch_rate * dt, pitch_now + pitch_rate * dt)
    rate_now = (next - pitch_now) / dt
    pitch_now = next
  end subroutine controller_step

  pure real(dp) function clipped(x, least, most)
    real(dp), intent(in) :: x, least, most

    clipped = min(max(x, least), most)
  end function clipped
end module controller

!-----------------------------------------------------------------------------------------------------------------------
! The machine. Figures: NREL/TP-500-38060, tables 4-1, 5-1, 6-1.
module machine
  use, intrinsic :: iso_c_binding, only: c_int
  use spar
  use spar_aero
  use turbine
  implicit none
  private
  public :: build, let_go, blow, shaft_speed, set_pitch, set_torque, session, tower, tower_nodes, air
  real(dp), parameter :: tower_height = 87.6_dp, overhang = 5.01910_dp, shaft_height = 1.96256_dp
  type(spar_session) :: session
  type(spar_member) :: tower, nacelle, generator, hub_body, blade(3)
  type(spar_joint) :: yaw, shaft_joint, drivetrain, bearing(3)
  type(spar_fluid) :: sections(3)
  type(spar_aero_object) :: air
  integer, parameter :: tower_nodes = 8
  real(dp) :: shaft_axes(4), extra_twist(max_sections)

contains

  subroutine build(elements, nodes, tolerance)
    integer(c_int), intent(in) :: elements, nodes
    real(dp), intent(in) :: tolerance

    call session%create()
    call session%set_gravity([0.0_dp, 0.0_dp, -9.80665_dp])
    call session%set_integrator(0.8_dp, 1)
    call session%set_coupling(SPAR_COUPLING_FIXED_POINT, 0.0_dp, tolerance, 30)
    shaft = [cos(tilt), 0.0_dp, -sin(tilt)]
    shaft_axes = [cos(tilt / 2), 0.0_dp, sin(tilt / 2), 0.0_dp] ! about y: x goes down
    hub = [0.0_dp, 0.0_dp, tower_height + shaft_height] - overhang * shaft
    call make_tower()
    call make_bodies()
    call make_blades(elements, nodes)
    call make_joints()
  end subroutine build

  ! A steel tube at 11 stations; 1 % of critical at 0.32 Hz.
  subroutine make_tower()
    integer, parameter :: stations = 11
    real(dp) :: eta(stations), stiff(6,6,stations), dense(6,6,stations), line(3,2), outer, wall, inner, area, inertia
    integer :: i

    stiff = 0
    dense = 0
    do i = 1, stations
      eta(i) = (i - 1) / (stations - 1.0_dp)
      outer = 6.0_dp + eta(i) * (3.87_dp - 6.0_dp)
      wall = 0.0351_dp + eta(i) * (0.0247_dp - 0.0351_dp)
      inner = outer - 2 * wall
      area = pi / 4 * (outer**2 - inner**2)
      inertia = pi / 64 * (outer**4 - inner**4)
      call put_diagonal(stiff(:,:,i), [210e9_dp * area, 0.53_dp * 80.8e9_dp * area, 0.53_dp * 80.8e9_dp * area, &
          2 * 80.8e9_dp * inertia, 210e9_dp * inertia, 210e9_dp * inertia])
      call put_diagonal(dense(:,:,i), 8500 * [area, area, area, 2 * inertia, inertia, inertia])
    end do
    line(:,1) = 0
    line(:,2) = [tower_height, 0.0_dp, 0.0_dp]
    call tower%create_beam(session, 'tower', 1, tower_nodes)
    call tower%set_axis([0.0_dp, 1.0_dp], line)
    call tower%set_placement([0.0_dp, 0.0_dp, 0.0_dp], [sqrt(0.5_dp), 0.0_dp, -sqrt(0.5_dp), 0.0_dp])
    call tower%set_sections(eta, stiff, dense)
    call tower%set_damping(spread(2 * 0.01_dp / (2 * pi * 0.32_dp), 1, 6))
    call tower%commit()
  end subroutine make_tower

  ! The generator has the inertia of the fast shaft times the gear squared; its gyroscopic moments are left out.
  subroutine make_bodies()
    real(dp), parameter :: none(3) = 0, centre(3) = [1.9_dp, 0.0_dp, 1.75_dp], m = 240000
    real(dp) :: level

    level = 2607890 - m * centre(1)**2
    call nacelle%create_rigid(session, 'nacelle', [0.0_dp, 0.0_dp, tower_height], [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], &
        body_mass(m, centre, [level, level, level]))
    call nacelle%commit()
    call generator%create_rigid(session, 'generator', [0.0_dp, 0.0_dp, tower_height + shaft_height], shaft_axes, &
        body_mass(0.0_dp, none, [534.116_dp * 97 * 97, 0.0_dp, 0.0_dp]))
    call generator%set_effects(0, SPAR_EFFECT_GRAVITY + SPAR_EFFECT_GYROSCOPIC)
    call generator%commit()
    call hub_body%create_rigid(session, 'hub', hub, shaft_axes, &
        body_mass(56780.0_dp, none, [115926.0_dp, 115926.0_dp, 115926.0_dp]))
    call hub_body%commit()
  end subroutine make_bodies

  pure function body_mass(m, c, inertia) result(mass)
    real(dp), intent(in) :: m, c(3), inertia(3)
    real(dp) :: mass(6,6), s(3,3)
    integer :: i, j

    s = reshape([0.0_dp, c(3), -c(2), -c(3), 0.0_dp, c(1), c(2), -c(1), 0.0_dp], [3, 3])
    mass = 0
    mass(4:6,1:3) = m * s
    mass(1:3,4:6) = transpose(m * s)
    do i = 1, 3
      mass(i,i) = m
      do j = 1, 3
        mass(3+i,3+j) = -m * c(i) * c(j)
      end do
      mass(3+i,3+i) = inertia(i) + m * dot_product(c, c) - m * c(i)**2
    end do
  end function body_mass

  pure subroutine put_diagonal(a, x)
    real(dp), intent(out) :: a(6,6)
    real(dp), intent(in) :: x(6)
    integer :: i

    a = 0
    do i = 1, 6
      a(i,i) = x(i)
    end do
  end subroutine put_diagonal

  subroutine make_blades(elements, nodes)
    integer(c_int), intent(in) :: elements, nodes
    real(dp) :: x(3), r(3,3)
    character(8) :: name
    integer :: b

    do b = 1, 3
      write (name, '(a,i0)') 'blade', b
      call root_at(b, 0.0_dp, x, r)
      call blade(b)%create_beam(session, name, elements, nodes)
      call blade(b)%set_axis(axis_eta(1:n_axis), axis_xyz(:,1:n_axis), axis_twist(1:n_axis))
      call blade(b)%set_sections(structure_eta(1:n_structure), stiffness(:,:,1:n_structure), mass(:,:,1:n_structure))
      call blade(b)%set_damping(damping)
      call blade(b)%set_placement(x, quaternion_of(r))
      call blade(b)%set_root(SPAR_ROOT_FREE)
      call blade(b)%commit()
      call make_sections(b, x, r)
    end do
    call make_air()
  end subroutine make_blades

  ! Sections on the line first, to learn the frames there; then with the aerodynamic centres in these frames.
  subroutine make_sections(b, root, r)
    integer, intent(in) :: b
    real(dp), intent(in) :: root(3), r(3,3)
    real(dp) :: eta(ns), foot(3,ns), q(4,ns), offset(3,ns), own(3,3), arm(3)
    character(12) :: name
    integer :: i

    write (name, '(a,i0)') 'sections', b
    eta = span(1:ns) / length
    call sections(b)%create(blade(b), name)
    call sections(b)%set_stations(eta)
    call sections(b)%map()
    call sections(b)%get_nearest(SPAR_NODES_MOTION, foot, q)
    do i = 1, ns
      own = frame_of(q(:,i))
      arm = root + span(i) * r(:,1) + sweep(i) * r(:,2) - curve(i) * r(:,3) - foot(:,i)
      offset(:,i) = matmul(arm, own)
      extra_twist(i) = aero_twist(i) + atan2(dot_product(own(:,2), r(:,3)), dot_product(own(:,2), r(:,2)))
    end do
    call sections(b)%set_stations(eta, offset)
    call sections(b)%map()
  end subroutine make_sections

  subroutine make_air()
    type(spar_polar) :: polar
    integer :: i, p, n

    call air%create(sections)
    do i = 1, ns
      p = polar_of(i)
      n = polar_rows(p)
      call polar%create(polar_alpha(1:n,p), polar_cl(1:n,p), polar_cd(1:n,p), polar_cm(1:n,p))
      call air%set_section(i, chord(i), extra_twist(i), polar)
      call polar%destroy()
    end do
    call air%set_blades(3)
    call air%set_rotor(hub, shaft, cos(precone) * hub_radius, cos(precone) * tip_radius)
  end subroutine make_air

  subroutine make_joints()
    real(dp) :: spring(6,6), damper(6,6), x(3), r(3,3)
    character(8) :: name
    integer :: b

    call put_diagonal(spring, [0.0_dp, 0.0_dp, 0.0_dp, 867.637e6_dp, 0.0_dp, 0.0_dp])
    call put_diagonal(damper, [0.0_dp, 0.0_dp, 0.0_dp, 6.215e6_dp, 0.0_dp, 0.0_dp])
    call yaw%create(session, 'yaw', nacelle, 1, 0, tower, tower_nodes) ! welded
    call shaft_joint%create(session, 'shaft', generator, 1, SPAR_FREE_RX, nacelle, 1)
    call shaft_joint%set_frame([0.0_dp, 0.0_dp, tower_height + shaft_height], shaft_axes)
    call drivetrain%create(session, 'drivetrain', hub_body, 1, SPAR_FREE_RX, generator, 1)
    call drivetrain%set_frame(hub, shaft_axes)
    call drivetrain%set_spring(spring, damper)
    do b = 1, 3
      write (name, '(a,i0)') 'bearing', b
      call root_at(b, 0.0_dp, x, r)
      call bearing(b)%create(session, name, blade(b), 1, SPAR_FREE_RX, hub_body, 1)
      call bearing(b)%set_frame(x, quaternion_of(r))
      call bearing(b)%set_driven(SPAR_FREE_RX)
    end do
  end subroutine make_joints

  ! Place of the centre of the hub and direction of the shaft now.
  subroutine where_hub(x, axis)
    real(dp), intent(out) :: x(3), axis(3)
    real(dp) :: q(7,1)

    call hub_body%get_motion(q)
    x = hub + q(1:3,1)
    axis = matmul(frame_of(q(4:7,1)), shaft)
  end subroutine where_hub

  ! The loads of the air on the blades in their latest motion.
  subroutine blow(t)
    real(dp), intent(in) :: t
    real(dp) :: x(3), axis(3), inflow(3,ns,3)

    call where_hub(x, axis)
    call air%set_rotor(x, axis, cos(precone) * hub_radius, cos(precone) * tip_radius)
    inflow = 0
    inflow(1,:,:) = wind_at(t)
    call air%solve(density, inflow, 1.0_dp)
  end subroutine blow

  ! All that turns with the rotor does so about the shaft where it is now.
  subroutine spin()
    real(dp) :: x(3), axis(3)
    integer :: b

    call where_hub(x, axis)
    call generator%set_initial_velocity(x0=x, omega=speed * axis)
    call hub_body%set_initial_velocity(x0=x, omega=speed * axis)
    do b = 1, 3
      call blade(b)%set_initial_velocity(x0=x, omega=speed * axis)
    end do
  end subroutine spin

  ! Bent to where wind and weight hold it with the brake on, then let go at its speed.
  subroutine let_go()
    real(dp) :: brake(6,6)
    integer :: round

    call put_diagonal(brake, [0.0_dp, 0.0_dp, 0.0_dp, 1e12_dp, 0.0_dp, 0.0_dp])
    call shaft_joint%set_spring(brake)
    call spin()
    do round = 1, 4
      call blow(0.0_dp)
      call tower%solve_static(4)
      call spin()
    end do
    call shaft_joint%set_spring()
    call blow(0.0_dp)
  end subroutine let_go

  ! Of the generator against the nacelle, at the side of the rotor.
  real(dp) function shaft_speed()
    real(dp) :: x(3), axis(3), own(6,1), frame(6,1)

    call where_hub(x, axis)
    call generator%get_motion(v=own)
    call nacelle%get_motion(v=frame)
    shaft_speed = dot_product(axis, own(4:6,1) - frame(4:6,1))
  end function shaft_speed

  subroutine set_pitch(angle, rate)
    real(dp), intent(in) :: angle, rate
    real(dp) :: motion(6), by(6)
    integer :: b

    motion = 0
    by = 0
    motion(4) = pitch - angle ! feather: minus about the span; pitch is the of the reference
    by(4) = -rate
    do b = 1, 3
      call bearing(b)%drive(motion, by)
    end do
  end subroutine set_pitch

  subroutine set_torque(torque)
    real(dp), intent(in) :: torque

    call shaft_joint%set_load([0.0_dp, 0.0_dp, 0.0_dp, -torque, 0.0_dp, 0.0_dp])
  end subroutine set_torque
end module machine

!-----------------------------------------------------------------------------------------------------------------------
program turbine_fortran
  use, intrinsic :: iso_fortran_env, only: output_unit
  use, intrinsic :: iso_c_binding, only: c_int
  use controller
  use machine
  use tables
  use turbine
  implicit none
  integer, parameter :: columns = 11
  real(dp) :: seconds = 60, dt = 0.02_dp, tolerance = 1e-6_dp, rpm, degrees
  integer(c_int) :: elements = 1, nodes = 10
  character(1024) :: data_folder, compare_file = ''
  real(dp), allocatable :: history(:,:)

  data_folder = &
    SPAR_DATA_DIR
  data_folder = trim(data_folder) // '/nrel5mw'
  gust = 6
  gust_start = 20
  gust_length = 20
  if (.not. options_read()) stop
  call read_turbine(trim(data_folder))
  call operating_point(wind, rpm, degrees)
  speed = rpm * pi / 30
  pitch = degrees * degree
  call build(elements, nodes, tolerance)
  call let_go()
  call controller_begin(gear * speed, pitch)
  call run()
  if (compare_file /= '') call compare_history(trim(compare_file))
  call air%destroy()
  call session%destroy()

contains

  subroutine run()
    integer :: i, steps, iterations, shown
    real(dp) :: t

    steps = ceiling(seconds / dt - 1e-9_dp)
    allocate (history(columns, 0:steps))
    shown = max(1, steps / 20)
    write (output_unit, '(a8,a8,a12,a10,a12,a12,a12)') 'time', 'wind', 'speed', 'pitch', 'shaft', 'thrust', 'tower top', &
        's', 'm/s', 'rev/min', 'deg', 'kW', 'kN', 'm'
    do i = 0, steps
      t = i * dt
      if (i > 0) then
        call controller_step(gear * shaft_speed(), dt)
        call set_torque(gear * torque_now)
        call set_pitch(pitch_now, rate_now)
        call step(t, iterations)
      end if
      call record(history(:,i), t)
      if (mod(i, shown) /= 0 .and. i < steps) cycle
      write (output_unit, '(f8.2,f8.3,f12.5,f10.4,2f12.3,f12.5)') t, history(2,i), history(3,i) * 30 / pi, &
          history(4,i) / degree, history(6,i) * 1e-3_dp, history(8,i) * 1e-3_dp, history(10,i)
      flush (output_unit)
    end do
  end subroutine run

  subroutine step(t, iterations)
    real(dp), intent(in) :: t
    integer, intent(out) :: iterations
    logical :: done

    call session%step_begin(dt)
    done = .false.
    iterations = 0
    do while (.not. done)
      call session%step_solve()
      call blow(t)
      call session%step_check(done)
      iterations = iterations + 1
    end do
    call session%step_accept()
  end subroutine step

  ! The first columns of the history of the C program.
  subroutine record(row, t)
    real(dp), intent(out) :: row(:)
    real(dp), intent(in) :: t
    real(dp) :: q(7,tower_nodes), w, thrust, torque

    w = shaft_speed()
    call tower%get_motion(q)
    call air%get_rotor(thrust, torque)
    row = [t, wind_at(t), w, pitch_now, gear * torque_now, gear * torque_now * w, efficiency * gear * torque_now * w, &
        thrust, torque, q(1,tower_nodes), q(2,tower_nodes)]
  end subroutine record

  ! The largest difference from such a history, relative to the largest entry of its column; more than 1e-8 is an error.
  subroutine compare_history(path)
    character(*), intent(in) :: path
    real(dp) :: reference(columns, 0:ubound(history, 2)), difference(columns), largest(columns)
    character(4096) :: line
    integer :: unit, status, i

    open (newunit=unit, file=path, action='read', status='old', iostat=status)
    if (status /= 0) error stop 'turbine_fortran: ' // path // ' cannot be opened'
    read (unit, '(a)') line
    do i = 0, ubound(history, 2)
      read (unit, *, iostat=status) reference(:,i)
      if (status /= 0) error stop 'turbine_fortran: ' // path // ' is not the history of the same run'
    end do
    close (unit)
    largest = maxval(abs(reference), dim=2)
    difference = maxval(abs(history - reference), dim=2) / merge(largest, 1.0_dp, largest > 0)
    write (output_unit, '(a,es8.1,a,i0)') 'against ' // path // ': differences up to ', maxval(difference), &
        ' of the largest entry of the column, in column ', maxloc(difference, dim=1)
    flush (output_unit)
    if (maxval(difference) > 1e-8_dp) error stop 'turbine_fortran: the runs differ'
  end subroutine compare_history

  logical function options_read() result(go_on)
    character(1024) :: name, value
    real(dp) :: x
    integer :: i, status

    go_on = .true.
    do i = 1, command_argument_count(), 2
      call get_command_argument(i, name)
      call get_command_argument(i + 1, value)
      if (name == '--help') then
        call help()
        go_on = .false.
        return
      end if
      if (value == '') error stop 'turbine_fortran: ' // trim(name) // ' needs a value'
      x = 0
      status = 0
      if (all(name /= ['--data   ', '--compare'])) read (value, *, iostat=status) x
      if (status /= 0) error stop 'turbine_fortran: ' // trim(name) // ' ' // trim(value) // ': a number is wanted'
      select case (name)
      case ('--wind')
        wind = x
      case ('--gust')
        gust = x
      case ('--gust-start')
        gust_start = x
      case ('--gust-length')
        gust_length = x
      case ('--seconds')
        seconds = x
      case ('--dt')
        dt = x
      case ('--nodes')
        nodes = int(x)
      case ('--tolerance')
        tolerance = x
      case ('--data')
        data_folder = value
      case ('--compare')
        compare_file = value
      case default
        error stop 'turbine_fortran: ' // trim(name) // ' is no option; --help lists them'
      end select
    end do
    if (.not. (seconds > 0 .and. dt > 0 .and. gust_length > 0)) error stop 'turbine_fortran: times are positive'
  end function options_read

  subroutine help()
    write (output_unit, '(a)') 'usage: turbine_fortran [options]', '', &
        'The NREL 5-MW turbine from a Fortran host.', '', &
        '  --wind M/S         wind speed [8]', &
        '  --gust M/S         height of a 1-cos gust [6]', &
        '  --gust-start S     when it begins [20]', &
        '  --gust-length S    how long it lasts [20]', &
        '  --seconds S        time to simulate [60]', &
        '  --dt S             time step [0.02]', &
        '  --nodes N          nodes of a blade [10]', &
        '  --tolerance R      change of the loads that ends the iteration [1e-6]', &
        '  --data FOLDER      the tables of the turbine', &
        '  --compare FILE     compares with the history of such a run of the C program; fails beyond 1e-8'
  end subroutine help
end program turbine_fortran
