! What the Fortran rotors share: blade element momentum theory, and the coupled run of the NREL 5-MW rotor with whatever
! fluid model it is given. A part of rotor_fortran and aerodyn_style.

!-----------------------------------------------------------------------------------------------------------------------
! Blade element momentum theory: one bracketed equation for the inflow angle of each section (Ning 2014, doi
! 10.1002/we.1636), in the form without poles of src/aero/momentum.h, with the losses of Prandtl and the thrust of Buhl.
! In the precision that the host works in: double, or single where it is compiled with SPAR_EXAMPLE_SINGLE.
module bemt
  use, intrinsic :: iso_c_binding, only: c_double, c_float
  use turbine, only: dp, blades, precone, tip_radius, hub_radius, max_rows, max_polars, max_sections
  use turbine, only: ns, n_polars, polar_of, polar_rows, the_shaft => shaft, the_hub => hub, the_chord => chord, &
      the_density => density, the_alpha => polar_alpha, the_cl => polar_cl, the_cd => polar_cd, the_cm => polar_cm
  implicit none
  private
  public :: ReKi, bemt_begin, element_loads
#ifdef SPAR_EXAMPLE_SINGLE
  integer, parameter :: ReKi = c_float
#else
  integer, parameter :: ReKi = c_double
#endif
  real(ReKi), parameter :: pi = acos(-1.0_ReKi)

  ! how near to 0 an angle is looked for; where the swirl fades out; how near to tip and hub there is no loss factor
  real(ReKi), parameter :: phi_min = 1e-8_ReKi, swirl_sine = 0.01_ReKi, end_share = 1e-4_ReKi
  ! the turbine in this precision
  real(ReKi), save :: shaft(3), hub(3), tip, root, density, chord(max_sections)
  real(ReKi), save :: polar_alpha(max_rows,max_polars), polar_cl(max_rows,max_polars), polar_cd(max_rows,max_polars), &
      polar_cm(max_rows,max_polars)
  ! the annulus that is being solved
  integer, save :: polar
  real(ReKi), save :: vx, vy, twist, sigma, tip_loss, hub_loss

contains

  ! Takes the turbine as it is now; before any loads.
  subroutine bemt_begin()
    shaft = real(the_shaft, ReKi)
    hub = real(the_hub, ReKi)
    tip = real(cos(precone) * tip_radius, ReKi)
    root = real(cos(precone) * hub_radius, ReKi)
    density = real(the_density, ReKi)
    chord(1:ns) = real(the_chord(1:ns), ReKi)
    polar_alpha(:,1:n_polars) = real(the_alpha(:,1:n_polars), ReKi)
    polar_cl(:,1:n_polars) = real(the_cl(:,1:n_polars), ReKi)
    polar_cd(:,1:n_polars) = real(the_cd(:,1:n_polars), ReKi)
    polar_cm(:,1:n_polars) = real(the_cm(:,1:n_polars), ReKi)
  end subroutine bemt_begin

  pure function product_of(a, b) result(c)
    real(ReKi), intent(in) :: a(3), b(3)
    real(ReKi) :: c(3)

    c = [a(2) * b(3) - a(3) * b(2), a(3) * b(1) - a(1) * b(3), a(1) * b(2) - a(2) * b(1)]
  end function product_of

  ! Loads per length of section i at x that moves with v in the wind u. Its axes: along the span, c from leading to trailing
  ! edge, normal towards the suction side. loss_radius: its distance from the shaft in the reference configuration.
  subroutine element_loads(i, x, along, c, normal, v, u, loss_radius, load)
    integer, intent(in) :: i
    real(ReKi), intent(in) :: x(3), along(3), c(3), normal(3), v(3), u(3), loss_radius
    real(ReKi), intent(out) :: load(6)
    real(ReKi) :: flow(2), alpha, cl, cd, cm, v_total, scale

    flow = [dot_product(u - v, c), dot_product(u - v, normal)]
    call induce(i, x, loss_radius, along, c, flow)
    alpha = atan2(flow(2), flow(1))
    call look_up(polar_of(i), alpha, cl, cd, cm)
    v_total = norm2(flow)
    scale = density / 2 * chord(i) * v_total
    load(1:3) = scale * ((cd * flow(1) - cl * flow(2)) * c + (cl * flow(1) + cd * flow(2)) * normal)
    load(4:6) = scale * chord(i) * v_total * cm * along
  end subroutine element_loads

  ! The flow in the plane of the section, along the chord and the normal, with the induction of the rotor.
  subroutine induce(i, x, loss_radius, along, c, flow)
    integer, intent(in) :: i
    real(ReKi), intent(in) :: x(3), loss_radius, along(3), c(3)
    real(ReKi), intent(inout) :: flow(2)
    real(ReKi) :: lean, p(3), s(3), to_p, to_s, w(2), half
    logical :: balanced

    lean = dot_product(shaft, along)
    p = (shaft - lean * along) / sqrt(1 - lean**2)
    s = product_of(along, p)
    to_p = dot_product(c, p)
    to_s = dot_product(c, s)
    half = 0.5_ReKi * real(blades, ReKi)
    vx = flow(1) * to_p + flow(2) * to_s
    vy = flow(1) * to_s - flow(2) * to_p
    twist = atan2(to_p, to_s)
    polar = polar_of(i)
    sigma = half * chord(i) / (pi * norm2(product_of(shaft, x - hub)))
    if (loss_radius >= (1 - end_share) * tip .or. loss_radius <= (1 + end_share) * root) then
      w = [0.0_ReKi, vy] ! no loss factor is left here
    else
      tip_loss = half * (tip - loss_radius) / loss_radius
      hub_loss = half * (loss_radius - root) / root
      call balance_momentum(w, balanced)
      if (.not. balanced) w = [vx, vy]
    end if
    flow = [w(1) * to_p + w(2) * to_s, w(1) * to_s - w(2) * to_p]
  end subroutine induce

  ! The flow w across and along the disc for which blade element and momentum give the same.
  subroutine balance_momentum(w, balanced)
    real(ReKi), intent(out) :: w(2)
    logical, intent(out) :: balanced
    ! windmill, brake, and the reversed flow; with the short pieces between two of them
    real(ReKi), parameter :: range(2,6) = reshape([phi_min, pi / 2, -phi_min, -pi / 2, -phi_min, phi_min, &
        pi - phi_min, pi / 2, phi_min - pi, -pi / 2, pi - phi_min, pi + phi_min], [2, 6])
    real(ReKi) :: cl, phi, total
    integer :: k, parts, first

    call look_up(polar, atan2(vx, vy) - twist, cl)
    w = [vx, vy]
    balanced = abs(cl) <= 0
    if (balanced) return
    first = merge(3, 0, vy < 0)
    parts = 1
    do
      do k = 0, 5
        call search(range(:,mod(first+k,6)+1), parts, phi, total, balanced)
        if (balanced) then
          w = total * [sign(1.0_ReKi, vx) * sin(phi), cos(phi)]
          return
        end if
      end do
      if (parts > 1) return
      parts = 32
    end do
  end subroutine balance_momentum

  ! The first sound root in a range, looked through in pieces that lie closer at its beginning.
  subroutine search(range, parts, phi, total, found)
    real(ReKi), intent(in) :: range(2)
    integer, intent(in) :: parts
    real(ReKi), intent(out) :: phi, total
    logical, intent(out) :: found
    real(ReKi) :: x0, x1, r0, r1, g, h
    integer :: i

    phi = 0
    total = 0
    found = .false.
    x0 = range(1)
    r0 = residual(x0)
    do i = 1, parts
      x1 = range(1) + (range(2) - range(1)) * (real(i, ReKi) / real(parts, ReKi))**2
      r1 = residual(x1)
      if ((r0 < 0 .and. r1 >= 0) .or. (r0 > 0 .and. r1 <= 0)) then
        phi = root_between(x0, r0, x1, r1)
        call balance(phi, g, h)
        total = (abs(vx) * g + vy * h) / (g**2 + h**2)
        found = total > 0 .and. total < huge(total)
        if (found) return
      end if
      x0 = x1
      r0 = r1
    end do
  end subroutine search

  real(ReKi) function residual(phi)
    real(ReKi), intent(in) :: phi
    real(ReKi) :: g, h

    call balance(phi, g, h)
    residual = vy * g - abs(vx) * h
  end function residual

  ! |vx| / W = g and vy / W = h if phi were the angle of the flow W.
  subroutine balance(phi, g, h)
    real(ReKi), intent(in) :: phi
    real(ReKi), intent(out) :: g, h
    real(ReKi) :: s, c, side, cl, loss, share, fade

    s = sin(phi)
    c = cos(phi)
    side = sign(1.0_ReKi, vx)
    call look_up(polar, side * phi - twist, cl)
    loss = prandtl(tip_loss, s) * prandtl(hub_loss, s)
    share = side * sigma * cl / (4 * loss)
    fade = max(-1.0_ReKi, min(1.0_ReKi, s / swirl_sine))
    g = axial(s, share * c, loss)
    h = c - fade * (1.5_ReKi - 0.5_ReKi * fade**2) * share
  end subroutine balance

  real(ReKi) function prandtl(f, s)
    real(ReKi), intent(in) :: f, s

    prandtl = 2 / pi * acos(exp(-f / abs(s)))
  end function prandtl

  ! Momentum theory, Buhl above k = 2/3 (k2 is k s^2), the propeller brake for s < 0.
  real(ReKi) function axial(s, k2, loss)
    real(ReKi), intent(in) :: s, k2, loss
    real(ReKi) :: slope

    if (s < 0) then
      slope = 20.0_ReKi / 3 - 4 * loss
      axial = min(s - k2 / s, 0.25_ReKi * (sqrt(max(0.0_ReKi, (slope * s)**2 + 32 * loss * k2)) + slope * s))
    else if (k2 > 2 * s**2 / 3) then
      axial = s * (5.0_ReKi / 3 - loss) + sqrt(loss * (2 * k2 - (4.0_ReKi / 3 - loss) * s**2))
    else
      axial = s
      if (abs(k2) > 0) axial = s + k2 / s
    end if
  end function axial

  ! Ridders: the secant of the residual times the exponential that makes its values at both ends and the middle lie on a line.
  real(ReKi) function root_between(a, fa, b, fb) result(x)
    real(ReKi), intent(in) :: a, fa, b, fb
    real(ReKi) :: low, high, f_low, f_high, middle, f_middle, fx, before, spread
    integer :: i

    low = a
    f_low = fa
    high = b
    f_high = fb
    x = high
    if (abs(f_high) <= 0) return
    before = huge(x)
    do i = 1, 100
      middle = 0.5_ReKi * (low + high)
      f_middle = residual(middle)
      spread = sqrt(f_middle**2 - f_low * f_high)
      x = middle
      if (spread <= 0) return
      x = middle + (middle - low) * sign(1.0_ReKi, f_low - f_high) * f_middle / spread
      if (abs(x - before) <= 2 * epsilon(x) * abs(x)) return
      before = x
      fx = residual(x)
      if (abs(fx) <= 0) return
      if (f_middle * fx < 0) then
        low = middle
        f_low = f_middle
        high = x
        f_high = fx
      else if (f_low * fx < 0) then
        high = x
        f_high = fx
      else
        low = x
        f_low = fx
      end if
    end do
  end function root_between

  ! Linear between the rows, and round once more where the angle is beyond the table of a full turn.
  subroutine look_up(p, angle, cl, cd, cm)
    integer, intent(in) :: p
    real(ReKi), intent(in) :: angle
    real(ReKi), intent(out) :: cl
    real(ReKi), intent(out), optional :: cd, cm
    real(ReKi) :: a, t
    integer :: i, low, high

    low = 1
    high = polar_rows(p)
    a = angle
    if (a < polar_alpha(low,p) .or. a > polar_alpha(high,p)) then
      a = a - 2 * pi * real(floor((a - polar_alpha(low,p)) / (2 * pi)), ReKi)
      a = max(polar_alpha(low,p), min(polar_alpha(high,p), a))
    end if
    do while (high - low > 1)
      i = (low + high) / 2
      if (polar_alpha(i,p) > a) then
        high = i
      else
        low = i
      end if
    end do
    t = (a - polar_alpha(low,p)) / (polar_alpha(high,p) - polar_alpha(low,p))
    cl = polar_cl(low,p) + t * (polar_cl(high,p) - polar_cl(low,p))
    if (present(cd)) cd = polar_cd(low,p) + t * (polar_cd(high,p) - polar_cd(low,p))
    if (present(cm)) cm = polar_cm(low,p) + t * (polar_cm(high,p) - polar_cm(low,p))
  end subroutine look_up
end module bemt

!-----------------------------------------------------------------------------------------------------------------------
! The coupled run: spar has the blades, the fluid model is handed in.
module rotor_run
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
#ifdef SPAR_WITH_MPI
  use mpi
#endif
  use spar
  use turbine
  use tables, only: read_turbine
  implicit none
  integer, parameter :: per_blade = 4, before_blades = 7
  integer :: rank = 0, ranks = 1

  ! options
  real(dp) :: seconds = 30, dt = 0.02_dp, tolerance = 1e-6_dp, allowed = 1e-10_dp
  real(dp) :: rpm = -1, pitch_given = -1000 ! not given: those of the turbine at this wind
  integer(c_int) :: elements = 1, nodes = 10, iterations_most = 20
  character(1024) :: data_folder = '', history_file = '', compare_file = ''

  logical :: keep_work = .false. ! what member%get_work tells

  ! the structure on every rank, the fluid where its blades are
  type(spar_session) :: session
  type(spar_member) :: blade(max_blades)
  type(spar_fluid) :: fluid(max_blades)
  integer :: nb = 0, blade_of(max_blades) ! blades of this rank
  integer :: node_count = 0
  real(dp) :: extra_twist(max_sections), interval(max_sections,max_blades), loss_radius(max_sections,max_blades)
  real(dp) :: thrust = 0, torque = 0 ! of the blades here
  integer :: steps = 0 ! those begun
  real(dp), allocatable :: history(:,:)

  abstract interface
    ! Pulls the motion of the blades here, finds their loads at time t, pushes them.
    subroutine fluid_model(t)
      import :: dp
      real(dp), intent(in) :: t
    end subroutine fluid_model
  end interface

contains

  subroutine start_ranks()
#ifdef SPAR_WITH_MPI
    integer :: status

    call MPI_Init(status)
    call MPI_Comm_rank(MPI_COMM_WORLD, rank, status)
    call MPI_Comm_size(MPI_COMM_WORLD, ranks, status)
#endif
  end subroutine start_ranks

  subroutine end_ranks()
#ifdef SPAR_WITH_MPI
    integer :: status

    call MPI_Finalize(status)
#endif
  end subroutine end_ranks

#ifdef SPAR_WITH_MPI
  subroutine sum_over_ranks(x)
    real(dp), intent(inout) :: x(2)
    real(dp) :: part(2)
    integer :: status

    part = x
    call MPI_Allreduce(part, x, size(x), MPI_DOUBLE_PRECISION, MPI_SUM, MPI_COMM_WORLD, status)
  end subroutine sum_over_ranks
#endif

  subroutine start_session()
#ifdef SPAR_WITH_MPI
    if (ranks > 1) call session%create(MPI_COMM_WORLD)
#endif
    if (.not. session%exists()) call session%create()
    call session%set_gravity([0.0_dp, 0.0_dp, -9.80665_dp])
    call session%set_integrator(0.8_dp, 1)
    call session%set_predictor(1)
    call session%set_coupling(SPAR_COUPLING_FIXED_POINT, 0.0_dp, tolerance, iterations_most)
    call session%set_newton(1e-15_dp, 1e-12_dp, 50) ! histories are compared to their last digits
  end subroutine start_session

  ! Every rank describes every blade; blade b is solved on, and its sections live on, rank mod(b - 1, ranks).
  subroutine make_blades()
    real(dp) :: x(3), r(3,3)
    character(8) :: name
    integer :: b

    do b = 1, blades
      write (name, '(a,i0)') 'blade', b
      call root_at(b, 0.0_dp, x, r)
      call blade(b)%create_beam(session, name, elements, nodes)
      call blade(b)%set_axis(axis_eta(1:n_axis), axis_xyz(:,1:n_axis), axis_twist(1:n_axis))
      call blade(b)%set_sections(structure_eta(1:n_structure), stiffness(:,:,1:n_structure), mass(:,:,1:n_structure))
      call blade(b)%set_damping(damping)
      call blade(b)%set_placement(x, quaternion_of(r))
      call blade(b)%set_root(SPAR_ROOT_DRIVEN)
      call blade(b)%set_owner(mod(b - 1, ranks))
      if (keep_work) call blade(b)%set_effects(SPAR_EFFECT_WORK, 0)
      call blade(b)%commit()
      call spin(b)
      if (mod(b - 1, ranks) == rank) then
        nb = nb + 1
        blade_of(nb) = b
        call make_sections(nb, x, r)
      end if
    end do
    call blade(1)%get_count(node_count)
  end subroutine make_blades

  ! Every point of the blade turns with the rotor, from where it is.
  subroutine spin(b)
    integer, intent(in) :: b

    call blade(b)%set_initial_velocity(x0=hub, omega=speed * shaft)
  end subroutine spin

  ! Sections on the line first, to learn the frames there; then with the aerodynamic centres in these frames.
  subroutine make_sections(k, root, r)
    integer, intent(in) :: k
    real(dp), intent(in) :: root(3), r(3,3)
    real(dp) :: eta(ns), foot(3,ns), q(4,ns), offset(3,ns), own(3,3), arm(3)
    character(12) :: name
    integer :: i

    write (name, '(a,i0)') 'sections', blade_of(k)
    eta = span(1:ns) / length
    call fluid(k)%create(blade(blade_of(k)), name)
    call fluid(k)%set_stations(eta)
    call fluid(k)%map()
    call fluid(k)%get_nearest(SPAR_NODES_MOTION, foot, q)
    do i = 1, ns
      own = frame_of(q(:,i))
      arm = root + span(i) * r(:,1) + sweep(i) * r(:,2) - curve(i) * r(:,3) - foot(:,i)
      offset(:,i) = matmul(arm, own)
      extra_twist(i) = aero_twist(i) + atan2(dot_product(own(:,2), r(:,3)), dot_product(own(:,2), r(:,2)))
    end do
    call fluid(k)%set_stations(eta, offset)
    call fluid(k)%map()
    call fluid(k)%get_nearest(SPAR_NODES_MOTION, foot, con=offset)
    foot = foot + offset
    do i = 1, ns
      loss_radius(i,k) = norm2(cross(shaft, foot(:,i) - hub))
      if (i < ns) interval(i,k) = norm2(foot(:,i+1) - foot(:,i))
    end do
  end subroutine make_sections

  ! Loads per length of blade k as nodal loads: linear between the sections, each interval shared consistently between its
  ! ends.
  subroutine spread(k, load, force, moment)
    integer, intent(in) :: k
    real(dp), intent(in) :: load(:,:)
    real(dp), intent(out) :: force(:,:), moment(:,:)
    real(dp) :: ends(6,2)
    integer :: i

    force = 0
    moment = 0
    do i = 1, ns - 1
      ends(:,1) = interval(i,k) / 6 * (2 * load(:,i) + load(:,i+1))
      ends(:,2) = interval(i,k) / 6 * (load(:,i) + 2 * load(:,i+1))
      force(:,i:i+1) = force(:,i:i+1) + ends(1:3,:)
      moment(:,i:i+1) = moment(:,i:i+1) + ends(4:6,:)
    end do
  end subroutine spread

  ! Adds nodal loads at x to thrust and torque.
  subroutine add_to_rotor(x, force, moment)
    real(dp), intent(in) :: x(:,:), force(:,:), moment(:,:)
    integer :: i

    do i = 1, ns
      thrust = thrust + dot_product(shaft, force(:,i))
      torque = torque + dot_product(shaft, cross(x(:,i) - hub, force(:,i)) + moment(:,i))
    end do
  end subroutine add_to_rotor

  ! Blades bent to where wind and gravity would hold them at rest: straight ones would rush downwind at first.
  subroutine bend(fluid_loads)
    procedure(fluid_model) :: fluid_loads
    integer :: b, round

    do round = 1, 4
      call fluid_loads(0.0_dp)
      do b = 1, blades
        call blade(b)%solve_static(4)
      end do
      do b = 1, blades
        call spin(b)
      end do
    end do
  end subroutine bend

  subroutine step(t, t_next, fluid_loads, iterations)
    real(dp), intent(in) :: t, t_next
    procedure(fluid_model) :: fluid_loads
    integer, intent(out) :: iterations
    real(dp) :: q(7), v(6), a(6)
    logical :: done
    integer :: b

    do b = 1, blades
      call root_motion(b, speed * t_next, q, v, a)
      call blade(b)%drive(q, v, a)
    end do
    steps = steps + 1
    call session%step_begin(t_next - t)
    iterations = 0
    do
      call session%step_solve()
      call fluid_loads(t_next)
      call session%step_check(done)
      iterations = iterations + 1
      if (done) exit
    end do
    call session%step_accept()
  end subroutine step

  ! One row: the columns of the history of the C program.
  subroutine record(row, t, iterations)
    real(dp), intent(out) :: row(:)
    real(dp), intent(in) :: t
    integer, intent(in) :: iterations
    real(dp) :: rotor(2), reference(3,node_count), q(7,node_count), reaction(6)
    real(dp) :: x0(3), r0(3,3), x(3), r(3,3), then(3), here(3)
    integer :: b, at

    rotor = [thrust, torque]
#ifdef SPAR_WITH_MPI
    call sum_over_ranks(rotor)
#endif
    row(1:7) = [t, mod(speed * t, 2 * pi) / degree, wind_at(t), rotor(1), rotor(2), rotor(2) * speed, real(iterations, dp)]
    do b = 1, blades
      call blade(b)%get_reference(reference)
      call blade(b)%get_motion(q)
      call blade(b)%get_reaction(reaction)
      call root_at(b, 0.0_dp, x0, r0)
      call root_at(b, speed * t, x, r)
      then = matmul(reference(:,node_count) - x0, r0)
      here = matmul(reference(:,node_count) + q(1:3,node_count) - x, r)
      at = before_blades + per_blade * (b - 1)
      row(at+1:at+2) = [then(3) - here(3), here(2) - then(2)]                                      ! flap, edge
      row(at+3:at+4) = [-dot_product(r(:,2), reaction(4:6)), -dot_product(r(:,3), reaction(4:6))] ! their moments on the hub
    end do
  end subroutine record

  subroutine run(program_name, fluid_loads)
    character(*), intent(in) :: program_name
    procedure(fluid_model) :: fluid_loads
    integer :: i, last, iterations, shown
    real(dp) :: t

    last = ceiling(seconds / dt - 1e-9_dp)
    allocate (history(before_blades + per_blade * blades, 0:last))
    if (rank == 0) then
      write (output_unit, '(2a,f5.2,a,f6.3,a,f6.2,a,i0,a)') program_name, ': NREL 5-MW rotor in ', wind, ' m/s;', speed * 30 / pi, &
          ' rev/min, pitch', pitch / degree, ' deg; ', ranks, ' rank(s)'
      write (output_unit, '(a8,a12,a14,a12,2a12,a14,a6)') 'time', 'thrust', 'torque', 'power', 'flap 1', 'edge 1', &
          'root flap 1', 'iter', 's', 'kN', 'kN m', 'kW', 'm', 'm', 'kN m', ''
    end if
    call bend(fluid_loads)
    call fluid_loads(0.0_dp)
    iterations = 0
    shown = max(1, last / 20)
    do i = 0, last
      t = merge(seconds, i * dt, i == last)
      if (i > 0) call step((i - 1) * dt, t, fluid_loads, iterations)
      call record(history(:,i), t, iterations)
      if (rank /= 0 .or. (mod(i, shown) /= 0 .and. i < last)) cycle
      write (output_unit, '(f8.3,f12.4,f14.4,f12.4,2f12.6,f14.4,i6)') t, history(4:6,i) * 1e-3_dp, history(8:9,i), &
          history(10,i) * 1e-3_dp, iterations
      flush (output_unit)
    end do
  end subroutine run

  subroutine write_history(path)
    character(*), intent(in) :: path
    integer :: unit, status, b, i

    open (newunit=unit, file=path, action='write', status='replace', iostat=status)
    if (status /= 0) error stop 'rotor: ' // path // ' cannot be written'
    write (unit, '(a)', advance='no') 'time_s,azimuth_deg,wind_m_s,thrust_N,torque_Nm,power_W,iterations'
    do b = 1, blades
      write (unit, '(4(a,i0,a))', advance='no') ',tip_flap', b, '_m', ',tip_edge', b, '_m', ',root_flap', b, '_Nm', &
          ',root_edge', b, '_Nm'
    end do
    write (unit, '(a)') ''
    do i = 0, ubound(history, 2)
      write (unit, '(*(g0,:,","))') history(:,i)
    end do
    close (unit)
  end subroutine write_history

  ! Against the history of a reference run: the largest difference of each column, relative to its largest entry.
  subroutine compare_history(path)
    character(*), intent(in) :: path
    real(dp) :: reference(size(history, 1), 0:ubound(history, 2)), difference(size(history, 1)), largest(size(history, 1))
    character(4096) :: line
    integer :: unit, status, i

    open (newunit=unit, file=path, action='read', status='old', iostat=status)
    if (status /= 0) error stop 'rotor: ' // path // ' cannot be opened'
    read (unit, '(a)') line
    do i = 0, ubound(history, 2)
      read (unit, *, iostat=status) reference(:,i)
      if (status /= 0) error stop 'rotor: ' // path // ' is not the history of the same run'
    end do
    read (unit, *, iostat=status) line
    if (status == 0) error stop 'rotor: ' // path // ' is longer than this run'
    close (unit)
    if (allowed > 1e-9_dp) history(7,:) = reference(7,:) ! not to rounding: the numbers of iterations may differ
    largest = maxval(abs(reference), dim=2)
    difference = maxval(abs(history - reference), dim=2) / merge(largest, 1.0_dp, largest > 0)
    write (output_unit, '(a,es8.1,a,i0)') 'against ' // trim(path) // ': differences up to ', maxval(difference), &
        ' of the largest entry of the column, in column ', maxloc(difference, dim=1)
    flush (output_unit)
    if (maxval(difference) > allowed) error stop &
        'rotor: the runs differ: do both have the same options, and the C program --newton 1e-12?'
  end subroutine compare_history

  ! Reads the options and the tables and makes session and blades; false: there is nothing to run.
  logical function rotor_begin(program_name) result(go_on)
    character(*), intent(in) :: program_name
    real(dp) :: rpm_table, pitch_table

    data_folder = &
      SPAR_DATA_DIR
    data_folder = trim(data_folder) // '/nrel5mw'
    go_on = options_read(program_name)
    if (.not. go_on) return
    call start_ranks()
    call read_turbine(trim(data_folder))
    call operating_point(wind, rpm_table, pitch_table)
    speed = merge(rpm, rpm_table, rpm >= 0) * pi / 30
    pitch = merge(pitch_given, pitch_table, pitch_given > -1000) * degree
    shaft = [cos(tilt), 0.0_dp, -sin(tilt)]
    call start_session()
    call make_blades()
  end function rotor_begin

  ! The history written and compared, as asked for; the session and the ranks end.
  subroutine rotor_end()
    if (rank == 0 .and. history_file /= '') call write_history(trim(history_file))
    if (rank == 0 .and. compare_file /= '') call compare_history(trim(compare_file))
    call session%destroy()
    call end_ranks()
  end subroutine rotor_end

  logical function options_read(program_name) result(go_on)
    character(*), intent(in) :: program_name
    character(1024) :: name, value
    integer :: i

    go_on = .true.
    i = 1
    do while (i <= command_argument_count() .and. go_on)
      call get_command_argument(i, name)
      call get_command_argument(i + 1, value)
      if (name /= '--help' .and. value == '') error stop 'rotor: ' // trim(name) // ' needs a value'
      i = i + 2
      select case (name)
      case ('--wind')
        call number(name, value, wind)
      case ('--rpm')
        call number(name, value, rpm)
      case ('--pitch')
        call number(name, value, pitch_given)
      case ('--gust')
        call number(name, value, gust)
      case ('--gust-start')
        call number(name, value, gust_start)
      case ('--gust-length')
        call number(name, value, gust_length)
      case ('--seconds')
        call number(name, value, seconds)
      case ('--dt')
        call number(name, value, dt)
      case ('--coupling-tolerance')
        call number(name, value, tolerance)
      case ('--elements')
        call whole(name, value, elements)
      case ('--nodes')
        call whole(name, value, nodes)
      case ('--iterations')
        call whole(name, value, iterations_most)
      case ('--data')
        data_folder = value
      case ('--history')
        history_file = value
      case ('--compare')
        compare_file = value
      case ('--allowed')
        call number(name, value, allowed)
      case ('--help')
        call help(program_name)
        go_on = .false.
      case default
        error stop 'rotor: ' // trim(name) // ' is no option; --help lists them'
      end select
    end do
    if (.not. (seconds > 0 .and. dt > 0 .and. gust_length > 0)) error stop 'rotor: times are positive'
  end function options_read

  subroutine number(name, text, x)
    character(*), intent(in) :: name, text
    real(dp), intent(out) :: x
    integer :: status

    read (text, *, iostat=status) x
    if (status /= 0) error stop 'rotor: ' // trim(name) // ' ' // trim(text) // ': a number is wanted'
  end subroutine number

  subroutine whole(name, text, i)
    character(*), intent(in) :: name, text
    integer(c_int), intent(out) :: i
    integer :: status

    read (text, *, iostat=status) i
    if (status /= 0) error stop 'rotor: ' // trim(name) // ' ' // trim(text) // ': a whole number is wanted'
  end subroutine whole

  subroutine help(program_name)
    character(*), intent(in) :: program_name

    write (output_unit, '(a)') 'usage: ' // program_name // ' [options]', '', &
        'The NREL 5-MW rotor from a Fortran host with its own blade element momentum theory.', '', &
        '  --wind M/S            wind speed [8]', &
        '  --rpm REV/MIN         rotor speed [that of the turbine at this wind]', &
        '  --pitch DEG           blade pitch [that of the turbine at this wind]', &
        '  --gust M/S            height of a 1-cos gust [0]', &
        '  --gust-start S        when it begins [10]', &
        '  --gust-length S       how long it lasts [10]', &
        '  --seconds S           time to simulate [30]', &
        '  --dt S                coupling step [0.02]', &
        '  --elements N          beam elements per blade [1]', &
        '  --nodes N             nodes per element [10]', &
        '  --coupling-tolerance R change of the loads that ends the iteration [1e-6]', &
        '  --iterations N        coupling iterations at most [20]', &
        '  --data FOLDER         the tables of the turbine', &
        '  --history FILE        writes the history, in the columns of the program rotor', &
        '  --compare FILE        compares with the history of such a run; fails beyond what is allowed', &
        '  --allowed R           difference from it, of the largest entry of a column [1e-10]'
  end subroutine help
end module rotor_run

