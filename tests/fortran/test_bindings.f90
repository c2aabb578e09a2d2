! Every raw binding once, with no object to work on: the library refuses each such call. The check of types at link time
! (fortran.cmake) sees only procedures that are referenced; this program is what it links.
program test_bindings
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int, c_int64_t, c_null_funptr, c_null_ptr, c_ptr
  use spar_c
  implicit none
  type(c_ptr) :: none, made
  integer :: failures = 0

  none = c_null_ptr
  made = c_null_ptr

  ! spar.h
  call check(c_associated(spar_status_text(0_c_int)), 'spar_status_text')
  call check(c_associated(spar_version()), 'spar_version')
  call check(spar_has() == 0, 'spar_has')
  made = c_null_ptr
  call check(spar_session_create(made) == SPAR_OK .and. c_associated(made), 'spar_session_create')
  call spar_session_destroy(made)
  call check(.not. c_associated(made), 'spar_session_destroy')
  call check(spar_session_create_fcomm(-1_c_int, made) /= SPAR_OK .and. .not. c_associated(made), &
      'spar_session_create_fcomm')
  call check(c_associated(spar_session_message(none)), 'spar_session_message')
  call check(c_associated(spar_session_get_warning(none, 0_c_int64_t)), 'spar_session_get_warning')
  call refused(spar_session_set_gravity(none), 'spar_session_set_gravity')
  call refused(spar_session_set_integrator(none, 0.0_c_double, 0_c_int), 'spar_session_set_integrator')
  call refused(spar_session_set_newton(none, 0.0_c_double, 0.0_c_double, 0_c_int), 'spar_session_set_newton')
  call refused(spar_session_set_predictor(none, 0_c_int), 'spar_session_set_predictor')
  call refused(spar_session_set_coupling(none, 0_c_int, 0.0_c_double, 0.0_c_double, 0_c_int), 'spar_session_set_coupling')
  call refused(spar_session_set_relaxation(none, 0.0_c_double), 'spar_session_set_relaxation')
  call refused(spar_session_set_reproducible(none, 0_c_int), 'spar_session_set_reproducible')
  call refused(spar_session_set_threads(none, 2_c_int), 'spar_session_set_threads')
  call refused(spar_session_set_goal(none, 1_c_int), 'spar_session_set_goal')
  call refused(spar_session_get_goal(none), 'spar_session_get_goal')
  call refused(spar_session_push_numbers(none, 0_c_int64_t), 'spar_session_push_numbers')
  call refused(spar_session_set_tolerance(none, 1.0_c_double, 0.0_c_double), 'spar_session_set_tolerance')
  call refused(spar_session_get_tolerance(none), 'spar_session_get_tolerance')
  call refused(spar_session_get_step_control(none), 'spar_session_get_step_control')
  call refused(spar_member_estimate_error(none), 'spar_member_estimate_error')
  call refused(spar_member_get_iterations(none), 'spar_member_get_iterations')
  call refused(spar_session_set_option(none), 'spar_session_set_option')
  call refused(spar_session_get_time(none), 'spar_session_get_time')
  call refused(spar_session_get_phase(none), 'spar_session_get_phase')
  call refused(spar_session_sum_balance(none, 0_c_int64_t), 'spar_session_sum_balance')
  call refused(spar_session_sum(none, 0_c_int, 0_c_int64_t), 'spar_session_sum')
  call refused(spar_member_get_session(none), 'spar_member_get_session')
  call refused(spar_fluid_get_member(none), 'spar_fluid_get_member')
  call refused(spar_fluid_fail(none, 0_c_int), 'spar_fluid_fail')
  call check(c_associated(spar_member_get_name(none)), 'spar_member_get_name')
  call check(c_associated(spar_fluid_get_name(none)), 'spar_fluid_get_name')
  call refused(spar_session_get_gravity(none), 'spar_session_get_gravity')
  call refused(spar_session_get_integrator(none), 'spar_session_get_integrator')
  call refused(spar_session_get_newton(none), 'spar_session_get_newton')
  call refused(spar_session_get_predictor(none), 'spar_session_get_predictor')
  call refused(spar_session_get_coupling(none), 'spar_session_get_coupling')
  call refused(spar_session_get_relaxation(none), 'spar_session_get_relaxation')
  call refused(spar_session_get_reproducible(none), 'spar_session_get_reproducible')
  call refused(spar_session_get_threads(none), 'spar_session_get_threads')
  call refused(spar_member_get_placement(none), 'spar_member_get_placement')
  call refused(spar_member_get_root(none), 'spar_member_get_root')
  call refused(spar_member_get_external(none), 'spar_member_get_external')
  call refused(spar_member_get_effects(none), 'spar_member_get_effects')
  call refused(spar_member_get_fidelity(none), 'spar_member_get_fidelity')
  call refused(spar_member_get_owner(none), 'spar_member_get_owner')
  call refused(spar_beam_get_elements(none), 'spar_beam_get_elements')
  call refused(spar_beam_get_quadrature(none), 'spar_beam_get_quadrature')
  call refused(spar_beam_get_damping(none), 'spar_beam_get_damping')
  call refused(spar_fluid_get_projection(none), 'spar_fluid_get_projection')
  call refused(spar_fluid_get_interpolation(none), 'spar_fluid_get_interpolation')
  call refused(spar_fluid_set_option(none), 'spar_fluid_set_option')
  call refused(spar_fluid_get_option(none, capacity=0_c_int64_t), 'spar_fluid_get_option')
  call refused(spar_session_get_option(none, capacity=0_c_int64_t), 'spar_session_get_option')
  call refused(spar_session_get_iterations(none, capacity=0_c_int64_t), 'spar_session_get_iterations')
  call refused(spar_session_get_residual(none), 'spar_session_get_residual')
  call refused(spar_session_get_report(none, 0_c_int64_t), 'spar_session_get_report')
  call refused(spar_point_create(none, member=made), 'spar_point_create')
  call refused(spar_rigid_create(none, member=made), 'spar_rigid_create')
  call refused(spar_beam_create(none, elements=0_c_int, nodes_per_element=0_c_int, member=made), 'spar_beam_create')
  call refused(spar_beam_set_axis(none, 0_c_int64_t), 'spar_beam_set_axis')
  call refused(spar_beam_set_nodes(none, 0_c_int64_t), 'spar_beam_set_nodes')
  call refused(spar_beam_set_sections(none, 0_c_int64_t), 'spar_beam_set_sections')
  call refused(spar_beam_set_quadrature(none, 0_c_int, 0_c_int), 'spar_beam_set_quadrature')
  call refused(spar_beam_set_damping(none), 'spar_beam_set_damping')
  call refused(spar_beam_set_mass_damping(none, 0.0_c_double), 'spar_beam_set_mass_damping')
  call refused(spar_beam_get_mass_damping(none), 'spar_beam_get_mass_damping')
  call refused(spar_beam_set_foundation(none, 0_c_int64_t), 'spar_beam_set_foundation')
  call refused(spar_beam_get_foundation(none, capacity=0_c_int64_t), 'spar_beam_get_foundation')
  call refused(spar_beam_set_pretension(none, 0_c_int64_t), 'spar_beam_set_pretension')
  call refused(spar_beam_get_pretension(none, capacity=0_c_int64_t), 'spar_beam_get_pretension')
  call refused(spar_beam_set_masses(none, 0_c_int64_t), 'spar_beam_set_masses')
  call refused(spar_beam_get_masses(none, capacity=0_c_int64_t), 'spar_beam_get_masses')
  call refused(spar_beam_read_beamdyn(none), 'spar_beam_read_beamdyn')
  call refused(spar_member_set_placement(none), 'spar_member_set_placement')
  call refused(spar_member_set_root(none, 0_c_int), 'spar_member_set_root')
  call refused(spar_member_set_external(none, 0_c_int), 'spar_member_set_external')
  call refused(spar_member_set_effects(none, 0_c_int, 0_c_int), 'spar_member_set_effects')
  call refused(spar_member_set_fidelity(none, 0_c_int, 0_c_int64_t), 'spar_member_set_fidelity')
  call refused(spar_member_set_added_mass(none, 0_c_int64_t), 'spar_member_set_added_mass')
  call refused(spar_member_get_added_mass(none, capacity=0_c_int64_t), 'spar_member_get_added_mass')
  call refused(spar_member_set_added_mass_response(none, 0_c_int), 'spar_member_set_added_mass_response')
  call refused(spar_member_get_added_mass_response(none), 'spar_member_get_added_mass_response')
  call refused(spar_member_learn_added_mass(none, 0_c_int64_t), 'spar_member_learn_added_mass')
  call refused(spar_member_get_learned_added_mass(none, capacity=0_c_int64_t), 'spar_member_get_learned_added_mass')
  call refused(spar_member_set_initial_velocity(none), 'spar_member_set_initial_velocity')
  call refused(spar_member_set_owner(none, 0_c_int), 'spar_member_set_owner')
  call refused(spar_member_commit(none), 'spar_member_commit')
  call refused(spar_member_get_count(none), 'spar_member_get_count')
  call refused(spar_member_get_reference(none), 'spar_member_get_reference')
  call refused(spar_member_get_motion(none), 'spar_member_get_motion')
  call refused(spar_member_set_motion(none), 'spar_member_set_motion')
  call refused(spar_member_drive(none), 'spar_member_drive')
  call refused(spar_member_set_load(none, 0_c_int64_t, 0_c_int), 'spar_member_set_load')
  call refused(spar_beam_set_line_load(none, 0_c_int, 0_c_int64_t), 'spar_beam_set_line_load')
  call refused(spar_member_get_loads(none), 'spar_member_get_loads')
  call refused(spar_member_get_reaction(none), 'spar_member_get_reaction')
  call refused(spar_beam_evaluate(none, 0_c_int64_t), 'spar_beam_evaluate')
  call refused(spar_member_get_energy(none, 0_c_int64_t), 'spar_member_get_energy')
  call refused(spar_member_get_work(none, 0_c_int64_t), 'spar_member_get_work')
  call refused(spar_member_solve_static(none, 0_c_int), 'spar_member_solve_static')
  call refused(spar_beam_set_modal_damping(none), 'spar_beam_set_modal_damping')
  call refused(spar_member_solve_modes(none, 0_c_int64_t), 'spar_member_solve_modes')
  call refused(spar_member_solve_eigenvalues(none, 0_c_int64_t), 'spar_member_solve_eigenvalues')
  call refused(spar_joint_create(none, a=none, node_a=0_c_int64_t, b=none, node_b=0_c_int64_t, free_motions=0_c_int, &
      joint=made), 'spar_joint_create')
  call refused(spar_link_create(none, a=none, node_a=0_c_int64_t, b=none, node_b=0_c_int64_t, joint=made), &
      'spar_link_create')
  call refused(spar_joint_set_frame(none), 'spar_joint_set_frame')
  call refused(spar_joint_set_spring(none), 'spar_joint_set_spring')
  call refused(spar_spring_create(none, member=none, node=0_c_int64_t, free_motions=0_c_int, joint=made), 'spar_spring_create')
  call refused(spar_link_set_spring(none, 0.0_c_double, 0.0_c_double, 0.0_c_double, 0_c_int), 'spar_link_set_spring')
  call refused(spar_joint_set_driven(none, 0_c_int), 'spar_joint_set_driven')
  call refused(spar_joint_drive(none), 'spar_joint_drive')
  call refused(spar_joint_set_load(none), 'spar_joint_set_load')
  call refused(spar_joint_get_motion(none), 'spar_joint_get_motion')
  call refused(spar_joint_get_load(none), 'spar_joint_get_load')
  call refused(spar_joint_get_energy(none, 0_c_int64_t), 'spar_joint_get_energy')
  call refused(spar_fluid_create(none, fluid=made), 'spar_fluid_create')
  made = c_null_ptr
  call spar_fluid_destroy(made)
  call refused(spar_fluid_set_motion_nodes(none, 0_c_int64_t), 'spar_fluid_set_motion_nodes')
  call refused(spar_fluid_set_motion_weights(none, 0_c_int64_t), 'spar_fluid_set_motion_weights')
  call refused(spar_fluid_get_motion_weights(none), 'spar_fluid_get_motion_weights')
  call refused(spar_fluid_fade_motion(none, 0.0_c_double, 1.0_c_double, 0_c_int64_t), 'spar_fluid_fade_motion')
  call refused(spar_fluid_set_force_nodes(none, 0_c_int64_t), 'spar_fluid_set_force_nodes')
  call refused(spar_fluid_set_stations(none, 0_c_int64_t), 'spar_fluid_set_stations')
  call refused(spar_fluid_set_motion_stations(none, 0_c_int64_t), 'spar_fluid_set_motion_stations')
  call refused(spar_fluid_get_kind(none, 0_c_int), 'spar_fluid_get_kind')
  call refused(spar_fluid_get_positions(none, 0_c_int), 'spar_fluid_get_positions')
  call refused(spar_fluid_get_forces(none), 'spar_fluid_get_forces')
  call refused(spar_fluid_set_states(none, 1_c_int64_t), 'spar_fluid_set_states')
  call refused(spar_fluid_get_states(none), 'spar_fluid_get_states')
  call refused(spar_fluid_pull_states(none, 1_c_int64_t), 'spar_fluid_pull_states')
  call refused(spar_fluid_push_states(none, 1_c_int64_t), 'spar_fluid_push_states')
  call refused(spar_fluid_set_layout(none, 0_c_int, 3_c_int64_t, 1_c_int64_t), 'spar_fluid_set_layout')
  call refused(spar_fluid_get_layout(none, 0_c_int), 'spar_fluid_get_layout')
  call refused(spar_fluid_set_projection(none, 0_c_int, 0.0_c_double), 'spar_fluid_set_projection')
  call refused(spar_fluid_set_interpolation(none, 0_c_int), 'spar_fluid_set_interpolation')
  call refused(spar_fluid_map(none), 'spar_fluid_map')
  call refused(spar_fluid_get_count(none, 0_c_int), 'spar_fluid_get_count')
  call refused(spar_fluid_get_flag_count(none, 0_c_int, 0_c_int), 'spar_fluid_get_flag_count')
  call refused(spar_fluid_get_map(none, 0_c_int), 'spar_fluid_get_map')
  call refused(spar_fluid_get_nearest(none, 0_c_int), 'spar_fluid_get_nearest')
  call refused(spar_fluid_get_basis(none, 0_c_int), 'spar_fluid_get_basis')
  call refused(spar_fluid_pull_motion(none, 0.0_c_double), 'spar_fluid_pull_motion')
  call refused(spar_fluid_pull_poses(none, 0_c_int, 0.0_c_double), 'spar_fluid_pull_poses')
  call refused(spar_fluid_pull_matrices(none, 0.0_c_double, 0_c_int), 'spar_fluid_pull_matrices')
  call refused(spar_fluid_check_matrices(none, 0_c_int), 'spar_fluid_check_matrices')
  call refused(spar_fluid_pull_motion_f32(none, 0.0_c_double), 'spar_fluid_pull_motion_f32')
  call refused(spar_fluid_pull_poses_f32(none, 0_c_int, 0.0_c_double), 'spar_fluid_pull_poses_f32')
  call refused(spar_fluid_pull_forces_f32(none, 0.0_c_double), 'spar_fluid_pull_forces_f32')
  call refused(spar_fluid_push_forces_f32(none), 'spar_fluid_push_forces_f32')
  call refused(spar_fluid_pull_forces(none, 0.0_c_double), 'spar_fluid_pull_forces')
  call refused(spar_fluid_push_forces_at(none, 1.0_c_double), 'spar_fluid_push_forces_at')
  call refused(spar_fluid_push_forces(none), 'spar_fluid_push_forces')
  call refused(spar_fluid_get_audit(none, 0_c_int64_t), 'spar_fluid_get_audit')
  call refused(spar_fluid_sum_loads(none), 'spar_fluid_sum_loads')
  call refused(spar_fluid_check_loads(none, rtol=1.0_c_double), 'spar_fluid_check_loads')
  call refused(spar_fluid_get_travel(none), 'spar_fluid_get_travel')
  call refused(spar_step_begin(none, 0.0_c_double), 'spar_step_begin')
  call refused(spar_step_solve(none), 'spar_step_solve')
  call refused(spar_step_check(none), 'spar_step_check')
  call refused(spar_step_accept(none), 'spar_step_accept')
  call refused(spar_step_reject(none), 'spar_step_reject')
  call refused(spar_step(none, 0.0_c_double, c_null_funptr, none), 'spar_step')
  call refused(spar_session_solve_initial(none, 0.1_c_double, c_null_funptr, none), 'spar_session_solve_initial')
  call refused(spar_step_adaptive(none, before=c_null_funptr, solve=c_null_funptr, context=none), 'spar_step_adaptive')
  call refused(spar_step_begin_initial(none, 0.1_c_double), 'spar_step_begin_initial')
  call refused(spar_session_solve_static(none, 1_c_int, c_null_funptr, none), 'spar_session_solve_static')
  call refused(spar_session_try(none, 0.0_c_double, 0_c_int64_t, c_null_funptr, c_null_funptr, none, 0_c_int, &
      0_c_int64_t), &
      'spar_session_try')
  call refused(spar_session_solve_eigenvalues(none, 0.0_c_double, 0_c_int64_t, 0.0_c_double, c_null_funptr, &
      c_null_funptr, none, 1_c_int64_t, 0_c_int64_t, nodes=0_c_int64_t), 'spar_session_solve_eigenvalues')
  call refused(spar_session_solve_floquet(none, 0.0_c_double, 0_c_int64_t, 0.0_c_double, c_null_funptr, &
      c_null_funptr, none, 1_c_int64_t, 0_c_int64_t), 'spar_session_solve_floquet')
  call refused(spar_session_report_effects(none, 0.0_c_double, 0_c_int64_t, c_null_funptr, c_null_funptr, none, &
      0_c_int64_t, 0_c_int64_t), &
      'spar_session_report_effects')
  call refused(spar_session_advise(none, 0.0_c_double, 0.0_c_double, 0_c_int64_t, 0.0_c_double, c_null_funptr, &
      c_null_funptr, none, 0_c_int64_t), &
      'spar_session_advise')
  call refused(spar_session_apply_advice(none), 'spar_session_apply_advice')
  call refused(spar_member_get_advice(none), 'spar_member_get_advice')
  call check(c_associated(spar_effect_name(0_c_int)), 'spar_effect_name')
  call refused(spar_session_save(none), 'spar_session_save')
  call refused(spar_session_load(none), 'spar_session_load')
  call refused(spar_session_set_log(none, c_null_funptr, none), 'spar_session_set_log')
  call refused(spar_session_set_progress(none, c_null_funptr, none), 'spar_session_set_progress')

  ! spar_aero.h
  call refused(spar_polar_create(0_c_int64_t, polar=made), 'spar_polar_create')
  call refused(spar_polar_set_interpolation(none, 0_c_int), 'spar_polar_set_interpolation')
  call refused(spar_polar_evaluate(none, 0.0_c_double), 'spar_polar_evaluate')
  made = c_null_ptr
  call spar_polar_destroy(made)
  made = c_null_ptr
  call check(spar_aero_create(0_c_int, aero=made) == SPAR_OK .and. c_associated(made), 'spar_aero_create')
  call spar_aero_destroy(made)
  call check(.not. c_associated(made), 'spar_aero_destroy')
  call refused(spar_aero_set_section(none, 0_c_int64_t, 0.0_c_double, 0.0_c_double, none), 'spar_aero_set_section')
  call refused(spar_aero_set_rotor(none, hub_radius=0.0_c_double, tip_radius=0.0_c_double), 'spar_aero_set_rotor')
  call refused(spar_fluid_read_aerodyn(none, n=0_c_int64_t), 'spar_fluid_read_aerodyn')
  call refused(spar_aero_read_aerodyn(none), 'spar_aero_read_aerodyn')
  call refused(spar_aero_set_turn(none, 0_c_int), 'spar_aero_set_turn')
  call refused(spar_aero_set_shear(none, 0_c_int, height=0.0_c_double, parameter=0.0_c_double), 'spar_aero_set_shear')
  call refused(spar_aero_set_tower(none, base_radius=0.0_c_double, top_radius=0.0_c_double), 'spar_aero_set_tower')
  call refused(spar_aero_set_blades(none, 0_c_int), 'spar_aero_set_blades')
  call refused(spar_aero_set_effects(none, 0_c_int), 'spar_aero_set_effects')
  call refused(spar_aero_solve(none, 0.0_c_double, theta=0.0_c_double), 'spar_aero_solve')
  call refused(spar_aero_get_rotor(none), 'spar_aero_get_rotor')
  call refused(spar_aero_get_sections(none), 'spar_aero_get_sections')
  call refused(spar_aero_get_flags(none), 'spar_aero_get_flags')
  call refused(spar_aero_get_chord(none), 'spar_aero_get_chord')
  call refused(spar_aero_get_loads(none), 'spar_aero_get_loads')
  call check(c_associated(spar_aero_effect_name(0_c_int)), 'spar_aero_effect_name')
  call refused(spar_aero_report_effects(none, none, 0.0_c_double, 0_c_int64_t, c_null_funptr, c_null_funptr, none, &
      0_c_int64_t, 0_c_int64_t), &
      'spar_aero_report_effects')

  ! spar_output.h
  call refused(spar_member_write_vtk(none), 'spar_member_write_vtk')
  call refused(spar_fluid_write_vtk(none), 'spar_fluid_write_vtk')
  call refused(spar_vtk_series_add(time=0.0_c_double, part=0_c_int), 'spar_vtk_series_add')

  if (failures > 0) error stop 'test_bindings failed'

contains

  subroutine check(right, what)
    logical, intent(in) :: right
    character(*), intent(in) :: what

    if (right) return
    failures = failures + 1
    write (*, '(2a)') 'wrong: ', what
  end subroutine check

  subroutine refused(status, what)
    integer(c_int), intent(in) :: status
    character(*), intent(in) :: what

    call check(status == SPAR_ERR_ARGUMENT .and. .not. c_associated(made), what // ' of nothing is refused')
  end subroutine refused
end program test_bindings
