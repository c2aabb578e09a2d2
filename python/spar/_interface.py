"""The interface, as cmake/interface.awk reads it. Written by cmake/make-bindings.sh from the headers."""
VERSION = '0.9.0'
CONSTANTS = {
    'SPAR_OK': 0,
    'SPAR_ERR_ARGUMENT': 1,
    'SPAR_ERR_STATE': 2,
    'SPAR_ERR_MEMORY': 3,
    'SPAR_ERR_NUMERIC': 4,
    'SPAR_ERR_MAPPING': 5,
    'SPAR_ERR_COMM': 6,
    'SPAR_ERR_PEER': 7,
    'SPAR_ERR_IO': 8,
    'SPAR_ERR_UNSUPPORTED': 9,
    'SPAR_ERR_USER': 10,
    'SPAR_ERR_LIMIT': 11,
    'SPAR_COUPLING_EXPLICIT': 0,
    'SPAR_COUPLING_FIXED_POINT': 1,
    'SPAR_COUPLING_AITKEN': 2,
    'SPAR_COUPLING_IQN_ILS': 3,
    'SPAR_LOG_ERROR': 0,
    'SPAR_LOG_WARNING': 1,
    'SPAR_LOG_INFO': 2,
    'SPAR_ROOT_FREE': 0,
    'SPAR_ROOT_FIXED': 1,
    'SPAR_ROOT_PINNED': 2,
    'SPAR_ROOT_DRIVEN': 3,
    'SPAR_LOAD_DEAD': 0,
    'SPAR_LOAD_FOLLOWER': 1,
    'SPAR_NODES_MOTION': 0,
    'SPAR_NODES_FORCE': 1,
    'SPAR_SECTION_EA': 0,
    'SPAR_SECTION_GA_Y': 1,
    'SPAR_SECTION_GA_Z': 2,
    'SPAR_SECTION_GJ': 3,
    'SPAR_SECTION_EI_Y': 4,
    'SPAR_SECTION_EI_Z': 5,
    'SPAR_SECTION_ANGLE': 6,
    'SPAR_SECTION_SHEAR_ANGLE': 7,
    'SPAR_SECTION_TENSION_Y': 8,
    'SPAR_SECTION_TENSION_Z': 9,
    'SPAR_SECTION_SHEAR_Y': 10,
    'SPAR_SECTION_SHEAR_Z': 11,
    'SPAR_SECTION_MASS': 12,
    'SPAR_SECTION_MASS_Y': 13,
    'SPAR_SECTION_MASS_Z': 14,
    'SPAR_SECTION_INERTIA_Y': 15,
    'SPAR_SECTION_INERTIA_Z': 16,
    'SPAR_SECTION_INERTIA_ANGLE': 17,
    'SPAR_SECTION_COUNT': 18,
    'SPAR_SHAPE_CIRCLE': 0,
    'SPAR_SHAPE_TUBE': 1,
    'SPAR_SHAPE_RECTANGLE': 2,
    'SPAR_SHAPE_BOX': 3,
    'SPAR_FINDING_ASYMMETRIC': 1,
    'SPAR_FINDING_INDEFINITE': 2,
    'SPAR_FINDING_MASS': 4,
    'SPAR_FINDING_BEND_TWIST': 8,
    'SPAR_FINDING_STRETCH_TWIST': 16,
    'SPAR_FINDING_STRETCH_SHEAR': 32,
    'SPAR_FINDING_BEND_SHEAR': 64,
    'SPAR_FINDING_POLAR': 128,
    'SPAR_FINDING_ORDER': 256,
    'SPAR_FINDING_UNITS': 512,
    'SPAR_QUADRATURE_GAUSS': 0,
    'SPAR_QUADRATURE_LOBATTO': 1,
    'SPAR_QUADRATURE_SECTIONS': 2,
    'SPAR_FIDELITY_PRESCRIBED': 0,
    'SPAR_FIDELITY_RIGID': 1,
    'SPAR_FIDELITY_LINEAR': 2,
    'SPAR_FIDELITY_MODAL': 3,
    'SPAR_FIDELITY_EXACT': 4,
    'SPAR_EFFECT_INERTIA': 1,
    'SPAR_EFFECT_GYROSCOPIC': 2,
    'SPAR_EFFECT_GRAVITY': 4,
    'SPAR_EFFECT_DAMPING': 8,
    'SPAR_EFFECT_FLUID_MOMENT': 32,
    'SPAR_EFFECT_FLUID_HISTORY': 64,
    'SPAR_EFFECT_WORK': 128,
    'SPAR_EFFECT_MASSES': 512,
    'SPAR_EFFECT_FOUNDATION': 1024,
    'SPAR_EFFECT_PRETENSION': 2048,
    'SPAR_ENERGY_KINETIC': 0,
    'SPAR_ENERGY_STRAIN': 1,
    'SPAR_ENERGY_GRAVITY': 2,
    'SPAR_ENERGY_DISSIPATED': 3,
    'SPAR_ENERGY_FOUNDATION': 4,
    'SPAR_ENERGY_COUNT': 5,
    'SPAR_WORK_LOADS': 0,
    'SPAR_WORK_FLUID': 1,
    'SPAR_WORK_ROOT': 2,
    'SPAR_WORK_JOINTS': 3,
    'SPAR_WORK_COUNT': 4,
    'SPAR_FREE_X': 1,
    'SPAR_FREE_Y': 2,
    'SPAR_FREE_Z': 4,
    'SPAR_FREE_RX': 8,
    'SPAR_FREE_RY': 16,
    'SPAR_FREE_RZ': 32,
    'SPAR_JOINT_ENERGY_SPRING': 0,
    'SPAR_JOINT_ENERGY_DAMPER': 1,
    'SPAR_JOINT_ENERGY_DRIVE': 2,
    'SPAR_JOINT_ENERGY_LOAD': 3,
    'SPAR_JOINT_ENERGY_COUNT': 4,
    'SPAR_REPORT_CONTRACTION': 0,
    'SPAR_REPORT_ADDED_MASS': 1,
    'SPAR_REPORT_COLUMNS': 2,
    'SPAR_REPORT_DROPPED': 3,
    'SPAR_REPORT_ERROR': 4,
    'SPAR_REPORT_WORK_DEFECT': 5,
    'SPAR_REPORT_UNCONVERGED': 6,
    'SPAR_REPORT_ADDED_MASS_SPREAD': 7,
    'SPAR_REPORT_MOTION_ERROR': 8,
    'SPAR_REPORT_COUNT': 9,
    'SPAR_PHASE_START': 0,
    'SPAR_PHASE_BETWEEN': 1,
    'SPAR_PHASE_BEGUN': 2,
    'SPAR_PHASE_SOLVED': 3,
    'SPAR_PHASE_CHECKED': 4,
    'SPAR_RESPONSE_ACCELERATION': 0,
    'SPAR_RESPONSE_VELOCITY': 1,
    'SPAR_PROJECT_BOUNDED': 0,
    'SPAR_PROJECT_RPOLY': 1,
    'SPAR_INTERPOLATE_NODAL': 0,
    'SPAR_INTERPOLATE_CONSISTENT': 1,
    'SPAR_KIND_STATIONS': 1,
    'SPAR_KIND_SHARED': 2,
    'SPAR_KIND_WEIGHTS': 4,
    'SPAR_KIND_FORCES': 8,
    'SPAR_MAP_END': 1,
    'SPAR_MAP_AMBIGUOUS': 2,
    'SPAR_MAP_FAR': 4,
    'SPAR_MATRIX_LOCAL_TO_GLOBAL': 0,
    'SPAR_MATRIX_GLOBAL_TO_LOCAL': 1,
    'SPAR_AUDIT_FORCE': 0,
    'SPAR_AUDIT_MOMENT': 1,
    'SPAR_AUDIT_POWER': 2,
    'SPAR_AUDIT_FORCE_ERROR': 3,
    'SPAR_AUDIT_MOMENT_ERROR': 4,
    'SPAR_AUDIT_POWER_ERROR': 5,
    'SPAR_AUDIT_FARTHEST': 6,
    'SPAR_AUDIT_NODES': 7,
    'SPAR_AUDIT_COUNT': 8,
    'SPAR_ROW_INERTIA': 0,
    'SPAR_ROW_GYROSCOPIC': 1,
    'SPAR_ROW_GRAVITY': 2,
    'SPAR_ROW_DAMPING': 3,
    'SPAR_ROW_FLUID_MOMENT': 4,
    'SPAR_ROW_FLUID_VELOCITY': 5,
    'SPAR_ROW_FLUID_POSES': 6,
    'SPAR_ROW_FLUID_HISTORY': 7,
    'SPAR_ROW_PREDICTOR': 8,
    'SPAR_ROW_ITERATION': 9,
    'SPAR_ROW_HALF_STEP': 10,
    'SPAR_ROW_MASSES': 11,
    'SPAR_ROW_FOUNDATION': 12,
    'SPAR_ROW_PRETENSION': 13,
    'SPAR_ROW_COUNT': 14,
    'SPAR_GOAL_MOTION': 1,
    'SPAR_GOAL_REACTION': 2,
    'SPAR_GOAL_SECTION': 4,
    'SPAR_GOAL_LOAD': 8,
    'SPAR_GOAL_NUMBERS': 16,
    'SPAR_AERO_INDUCTION': 1,
    'SPAR_AERO_TIP_LOSS': 2,
    'SPAR_AERO_HUB_LOSS': 4,
    'SPAR_AERO_SWIRL': 8,
    'SPAR_AERO_DRAG': 16,
    'SPAR_AERO_MOMENT': 32,
    'SPAR_AERO_SHEAR': 64,
    'SPAR_AERO_TOWER': 128,
    'SPAR_AERO_INFLOW': 256,
    'SPAR_AERO_STALL': 512,
    'SPAR_AERO_UNSTEADY': 1024,
    'SPAR_SHEAR_POWER': 0,
    'SPAR_SHEAR_LOG': 1,
    'SPAR_SHEAR_LINEAR': 2,
    'SPAR_POLAR_LINEAR': 0,
    'SPAR_POLAR_AKIMA': 1,
    'SPAR_POLAR_CUBIC': 2,
    'SPAR_AERO_FLAG_END': 1,
    'SPAR_AERO_FLAG_NO_ROOT': 2,
    'SPAR_AERO_FLAG_BEYOND_POLAR': 4,
    'SPAR_AERO_FLAG_TOWER': 8,
    'SPAR_AERO_ROW_INDUCTION': 0,
    'SPAR_AERO_ROW_TIP_LOSS': 1,
    'SPAR_AERO_ROW_HUB_LOSS': 2,
    'SPAR_AERO_ROW_SWIRL': 3,
    'SPAR_AERO_ROW_DRAG': 4,
    'SPAR_AERO_ROW_MOMENT': 5,
    'SPAR_AERO_ROW_SHEAR': 6,
    'SPAR_AERO_ROW_TOWER': 7,
    'SPAR_AERO_ROW_INFLOW': 8,
    'SPAR_AERO_ROW_STALL': 9,
    'SPAR_AERO_ROW_UNSTEADY': 10,
    'SPAR_AERO_ROW_COUNT': 11,
}
TABLE = """
call spar_session_message text session|session|value||null
call spar_status_text text status|int|value||
call spar_version text
call spar_has int feature|char|in|[]|
call spar_session_create int session|session|out||
call spar_session_create_fcomm int comm|int|value|| session|session|out||
call spar_session_destroy none session|session|out||
call spar_step_begin int session|session|value|| dt|double|value||
call spar_step_solve int session|session|value||
call spar_step_check int session|session|value|| done|int|out||
call spar_step_accept int session|session|value||
call spar_step_reject int session|session|value||
call spar_fluid_pull_motion int fluid|fluid|value|| theta|double|value|| x|double|out|[motion_nodes][3]|null v|double|out|[motion_nodes][3]|null
call spar_fluid_push_forces int fluid|fluid|value|| force|double|in|[force_nodes][3]| moment|double|in|[force_nodes][3]|null
call spar_fluid_fail int fluid|fluid|value|| status|int|value|| message|char|in|[]|
call spar_step int session|session|value|| dt|double|value|| solve|fluid_solver|callback|| context|context|value|| iterations|int|out||null
call spar_session_set_gravity int session|session|value|| g|double|in|[3]|
call spar_session_get_gravity int session|session|value|| g|double|out|[3]|
call spar_session_set_coupling int session|session|value|| scheme|int|value|| atol|double|value|| rtol|double|value|| max_iterations|int|value||
call spar_session_get_coupling int session|session|value|| scheme|int|out||null atol|double|out||null rtol|double|out||null max_iterations|int|out||null
call spar_session_get_time int session|session|value|| t|double|out||null step|int64_t|out||null iteration|int|out||null
call spar_session_set_log int session|session|value|| log|log|callback|| context|context|value||
call spar_log_stderr none session|session|value|| level|int|value|| text|char|in|[]| context|context|value||
call spar_session_get_warning text session|session|value|| i|int64_t|value||
call spar_point_create int session|session|value|| name|char|in|[]| x|double|in|[3]|null q|double|in|[4]|null member|member|out||
call spar_rigid_create int session|session|value|| name|char|in|[]| x|double|in|[3]|null q|double|in|[4]|null mass|double|in|[36]| member|member|out||
call spar_beam_create int session|session|value|| name|char|in|[]| elements|int|value|| nodes_per_element|int|value|| member|member|out||
call spar_beam_set_axis int beam|member|value|| n|int64_t|value|| eta|double|in|[n]| xyz|double|in|[n][3]| twist|double|in|[n]|null
call spar_beam_set_sections int beam|member|value|| n|int64_t|value|| eta|double|in|[n]| stiffness|double|in|[n][36]| mass|double|in|[n][36]|null
call spar_member_set_placement int member|member|value|| x|double|in|[3]|null q|double|in|[4]|null
call spar_member_set_root int member|member|value|| kind|int|value||
call spar_member_set_external int member|member|value|| on|int|value||
call spar_member_set_initial_velocity int member|member|value|| x0|double|in|[3]|null v0|double|in|[3]|null omega|double|in|[3]|null
call spar_member_commit int member|member|value||
call spar_member_get_count int member|member|value|| nodes|int64_t|out||
call spar_member_get_reference int member|member|value|| x|double|out|[nodes][3]|null q|double|out|[nodes][4]|null
call spar_member_get_motion int member|member|value|| q|double|out|[nodes][7]|null v|double|out|[nodes][6]|null a|double|out|[nodes][6]|null
call spar_member_set_motion int member|member|value|| q|double|in|[nodes][7]|null v|double|in|[nodes][6]|null a|double|in|[nodes][6]|null
call spar_member_drive int member|member|value|| q|double|in|[7]| v|double|in|[6]|null a|double|in|[6]|null
call spar_member_set_load int member|member|value|| node|int64_t|value|| kind|int|value|| load|double|in|[6]|
call spar_member_get_loads int member|member|value|| load|double|out|[nodes][6]|
call spar_fluid_create int member|member|value|| name|char|in|[]| fluid|fluid|out||
call spar_fluid_destroy none fluid|fluid|out||
call spar_fluid_set_motion_nodes int fluid|fluid|value|| n|int64_t|value|| x|double|in|[n][3]|
call spar_fluid_set_force_nodes int fluid|fluid|value|| n|int64_t|value|| x|double|in|[n][3]|
call spar_fluid_set_stations int fluid|fluid|value|| n|int64_t|value|| eta|double|in|[n]| offset|double|in|[n][3]|null
call spar_fluid_map int fluid|fluid|value||
call spar_fluid_pull_poses int fluid|fluid|value|| which|int|value|| theta|double|value|| x|double|out|[which_nodes][3]|null q|double|out|[which_nodes][4]|null v|double|out|[which_nodes][3]|null omega|double|out|[which_nodes][3]|null accel|double|out|[which_nodes][3]|null alpha|double|out|[which_nodes][3]|null
call spar_session_save int session|session|value|| path|char|in|[]|
call spar_session_load int session|session|value|| path|char|in|[]|
call spar_section_from_shape int shape|int|value|| n|int64_t|value|| dimension|double|in|[n]| young|double|value|| poisson|double|value|| density|double|value|| capacity|int64_t|value|| property|double|out|[SPAR_SECTION_COUNT]|
call spar_section_build int n|int64_t|value|| property|double|in|[n]| stiffness|double|out|[36]|null mass|double|out|[36]|null
call spar_section_describe int stiffness|double|in|[36]| mass|double|in|[36]|null capacity|int64_t|value|| property|double|out|[SPAR_SECTION_COUNT]|null findings|int|out||null
call spar_section_report int stiffness|double|in|[36]| mass|double|in|[36]|null capacity|int64_t|value||1000 text|char|out|[capacity]|
call spar_section_transform int matrix|double|in|[36]| y|double|value|| z|double|value|| angle|double|value|| out|double|out|[36]|
call spar_beam_get_elements int beam|member|value|| elements|int|out||null nodes_per_element|int|out||null
call spar_beam_get_axis int beam|member|value|| n|int64_t|out||null capacity|int64_t|value||n eta|double|out|[capacity]|null xyz|double|out|[capacity][3]|null twist|double|out|[capacity]|null
call spar_beam_get_sections int beam|member|value|| n|int64_t|out||null capacity|int64_t|value||n eta|double|out|[capacity]|null stiffness|double|out|[capacity][36]|null mass|double|out|[capacity][36]|null
call spar_beam_set_nodes int beam|member|value|| n|int64_t|value|| x|double|in|[n][3]| q|double|in|[n][4]|null
call spar_beam_set_quadrature int beam|member|value|| rule|int|value|| points|int|value||
call spar_beam_get_quadrature int beam|member|value|| rule|int|out||null points|int|out||null
call spar_beam_read_beamdyn int beam|member|value|| primary_path|char|in|[]| blade_path|char|in|[]|null
call spar_beam_set_masses int beam|member|value|| n|int64_t|value|| eta|double|in|[n]| mass|double|in|[n][36]|
call spar_beam_get_masses int beam|member|value|| n|int64_t|out||null capacity|int64_t|value||n eta|double|out|[capacity]|null mass|double|out|[capacity][36]|null
call spar_beam_set_foundation int beam|member|value|| n|int64_t|value|| eta|double|in|[n]| stiffness|double|in|[n][3]|
call spar_beam_get_foundation int beam|member|value|| n|int64_t|out||null capacity|int64_t|value||n eta|double|out|[capacity]|null stiffness|double|out|[capacity][3]|null
call spar_beam_set_pretension int beam|member|value|| n|int64_t|value|| eta|double|in|[n]| force|double|in|[n][6]|
call spar_beam_get_pretension int beam|member|value|| n|int64_t|out||null capacity|int64_t|value||n eta|double|out|[capacity]|null force|double|out|[capacity][6]|null
call spar_beam_set_damping int beam|member|value|| mu|double|in|[6]|
call spar_beam_get_damping int beam|member|value|| mu|double|out|[6]|
call spar_beam_set_mass_damping int beam|member|value|| alpha|double|value||
call spar_beam_get_mass_damping int beam|member|value|| alpha|double|out||
call spar_beam_set_plane int beam|member|value|| normal|double|in|[3]|null
call spar_beam_get_plane int beam|member|value|| normal|double|out|[3]|null
call spar_member_set_fidelity int member|member|value|| kind|int|value|| modes|int64_t|value||
call spar_member_get_fidelity int member|member|value|| kind|int|out||null modes|int64_t|out||null
call spar_member_set_effects int member|member|value|| switch_on|int|value|| switch_off|int|value||
call spar_member_get_effects int member|member|value|| effects|int|out||
call spar_member_get_placement int member|member|value|| x|double|out|[3]|null q|double|out|[4]|null
call spar_member_get_root int member|member|value|| kind|int|out||
call spar_member_get_external int member|member|value|| on|int|out||
call spar_member_get_session int member|member|value|| session|session|out||
call spar_member_get_name text member|member|value||
call spar_beam_set_line_load int beam|member|value|| kind|int|value|| n|int64_t|value|| eta|double|in|[n]| load|double|in|[n][6]|
call spar_member_get_reaction int member|member|value|| load|double|out|[6]|
call spar_beam_evaluate int beam|member|value|| n|int64_t|value|| eta|double|in|[n]| strain|double|out|[n][6]|null force|double|out|[n][6]|null x|double|out|[n][3]|null q|double|out|[n][4]|null
call spar_member_get_energy int member|member|value|| capacity|int64_t|value|| energy|double|out|[SPAR_ENERGY_COUNT]|
call spar_member_get_work int member|member|value|| capacity|int64_t|value|| work|double|out|[SPAR_WORK_COUNT]|
call spar_member_solve_static int member|member|value|| load_steps|int|value||
call spar_member_solve_modes int member|member|value|| n|int64_t|value|| frequency_hz|double|out|[n]| shapes|double|out|[n][nodes][6]|null
call spar_member_solve_eigenvalues int member|member|value|| n|int64_t|value|| shift|double|in|[2]|null eigenvalue|double|out|[n][2]| shapes|double|out|[n][nodes][6][2]|null frame|double|out|[3]|null
call spar_beam_set_modal_damping int beam|member|value|| mode|int64_t|in|[2]| ratio|double|in|[2]| mu|double|out|[6]|null
call spar_beam_fit_damping int beam|member|value|| n|int64_t|value|| mode|int64_t|in|[n]| ratio|double|in|[n]| achieved|double|out|[n]|null
call spar_joint_create int session|session|value|| name|char|in|[]| a|member|value|| node_a|int64_t|value|| b|member|value||null node_b|int64_t|value|| free_motions|int|value|| joint|joint|out||
call spar_joint_set_frame int joint|joint|value|| x|double|in|[3]| q|double|in|[4]|null
call spar_joint_set_spring int joint|joint|value|| stiffness|double|in|[36]|null damping|double|in|[36]|null preload|double|in|[6]|null
call spar_spring_create int session|session|value|| name|char|in|[]| member|member|value|| node|int64_t|value|| free_motions|int|value|| stiffness|double|in|[36]|null damping|double|in|[36]|null preload|double|in|[6]|null joint|joint|out||null
call spar_joint_set_driven int joint|joint|value|| mask|int|value||
call spar_joint_drive int joint|joint|value|| motion|double|in|[6]| rate|double|in|[6]|null acceleration|double|in|[6]|null
call spar_joint_set_load int joint|joint|value|| load|double|in|[6]|
call spar_link_create int session|session|value|| name|char|in|[]| a|member|value|| node_a|int64_t|value|| point_a|double|in|[3]| b|member|value||null node_b|int64_t|value|| point_b|double|in|[3]| joint|joint|out||
call spar_link_set_spring int joint|joint|value|| stiffness|double|value|| damping|double|value|| length|double|value|| tension_only|int|value||
call spar_joint_get_motion int joint|joint|value|| motion|double|out|[6]|null rate|double|out|[6]|null acceleration|double|out|[6]|null
call spar_joint_get_load int joint|joint|value|| load|double|out|[6]|
call spar_joint_get_energy int joint|joint|value|| capacity|int64_t|value|| energy|double|out|[SPAR_JOINT_ENERGY_COUNT]|
call spar_session_set_integrator int session|session|value|| rho_inf|double|value|| substeps|int|value||
call spar_session_get_integrator int session|session|value|| rho_inf|double|out||null substeps|int|out||null
call spar_session_set_newton int session|session|value|| atol|double|value|| rtol|double|value|| max_iterations|int|value||
call spar_session_get_newton int session|session|value|| atol|double|out||null rtol|double|out||null max_iterations|int|out||null
call spar_member_get_iterations int member|member|value|| iterations|int64_t|out||null left|double|out||null
call spar_session_set_predictor int session|session|value|| order|int|value||
call spar_session_get_predictor int session|session|value|| order|int|out||
call spar_session_set_relaxation int session|session|value|| omega|double|value||
call spar_session_get_relaxation int session|session|value|| omega|double|out||
call spar_session_set_option int session|session|value|| key|char|in|[]| value|char|in|[]|
call spar_session_get_option int session|session|value|| key|char|in|[]| capacity|int64_t|value||32 text|char|out|[capacity]|
call spar_session_get_iterations int session|session|value|| iterations|int|out||null capacity|int64_t|value||iterations residual|double|out|[capacity]|null size|double|out|[capacity]|null
call spar_session_get_residual int session|session|value|| residual|double|out||null size|double|out||null
call spar_session_get_report int session|session|value|| capacity|int64_t|value|| report|double|out|[SPAR_REPORT_COUNT]|null
call spar_session_get_phase int session|session|value|| phase|int|out||
call spar_member_set_added_mass int member|member|value|| n|int64_t|value|| eta|double|in|[n]| mass|double|in|[n][36]|
call spar_member_get_added_mass int member|member|value|| n|int64_t|out||null capacity|int64_t|value||n eta|double|out|[capacity]|null mass|double|out|[capacity][36]|null
call spar_member_set_added_mass_response int member|member|value|| response|int|value||
call spar_member_get_added_mass_response int member|member|value|| response|int|out||
call spar_session_solve_initial int session|session|value|| dt|double|value|| solve|fluid_solver|callback|| context|context|value|| iterations|int|out||null
call spar_step_begin_initial int session|session|value|| dt|double|value||
call spar_session_solve_static int session|session|value|| load_steps|int|value|| solve|fluid_solver|callback|| context|context|value|| iterations|int|out||null
call spar_session_set_tolerance int session|session|value|| drift|double|value|| rtol|double|value||
call spar_session_get_tolerance int session|session|value|| drift|double|out||null rtol|double|out||null
call spar_session_get_step_control int session|session|value|| ratio|double|out||null next_dt|double|out||null reject|int|out||null rejected|int64_t|out||null
call spar_step_adaptive int session|session|value|| dt|double|out|| before|before_step|callback|| solve|fluid_solver|callback|| context|context|value|| taken|double|out||null
call spar_session_set_reproducible int session|session|value|| on|int|value||
call spar_session_get_reproducible int session|session|value|| on|int|out||
call spar_session_set_threads int session|session|value|| threads|int|value||
call spar_session_get_threads int session|session|value|| threads|int|out||
call spar_member_set_owner int member|member|value|| rank|int|value||
call spar_member_get_owner int member|member|value|| rank|int|out||
call spar_session_sum_balance int session|session|value|| capacity|int64_t|value||ranks members|int64_t|out|[capacity]|null expected|double|out|[capacity]|null counted|double|out|[capacity]|null
call spar_session_sum int session|session|value|| status|int|value|| n|int64_t|value|| x|double|out|[n]|
call spar_session_fail int session|session|value||null status|int|value|| message|char|in|[]|
call spar_fluid_get_member int fluid|fluid|value|| member|member|out||
call spar_fluid_get_name text fluid|fluid|value||
call spar_fluid_set_motion_stations int fluid|fluid|value|| n|int64_t|value|| eta|double|in|[n]| offset|double|in|[n][3]|null
call spar_fluid_set_motion_weights int fluid|fluid|value|| n|int64_t|value|| w|double|in|[n]|null
call spar_fluid_get_motion_weights int fluid|fluid|value|| w|double|out|[motion_nodes]|
call spar_fluid_fade_motion int fluid|fluid|value|| within|double|value|| beyond|double|value|| n|int64_t|value||motion_nodes distance|double|in|[n]|null held|int|in|[n]|null
call spar_fluid_set_layout int fluid|fluid|value|| which|int|value|| node|int64_t|value|| component|int64_t|value||
call spar_fluid_get_layout int fluid|fluid|value|| which|int|value|| node|int64_t|out||null component|int64_t|out||null
call spar_fluid_set_projection int fluid|fluid|value|| method|int|value|| max_distance|double|value||
call spar_fluid_get_projection int fluid|fluid|value|| method|int|out||null max_distance|double|out||null
call spar_fluid_set_interpolation int fluid|fluid|value|| kind|int|value||
call spar_fluid_get_interpolation int fluid|fluid|value|| kind|int|out||
call spar_fluid_set_option int fluid|fluid|value|| key|char|in|[]| value|char|in|[]|
call spar_fluid_get_option int fluid|fluid|value|| key|char|in|[]| capacity|int64_t|value||32 text|char|out|[capacity]|
call spar_fluid_map_current int fluid|fluid|value||
call spar_fluid_get_count int fluid|fluid|value|| which|int|value|| n|int64_t|out||
call spar_fluid_get_kind int fluid|fluid|value|| which|int|value|| kind|int|out||
call spar_fluid_get_flag_count int fluid|fluid|value|| which|int|value|| flag|int|value|| n|int64_t|out||
call spar_fluid_get_map int fluid|fluid|value|| which|int|value|| eta|double|out|[which_nodes]|null distance|double|out|[which_nodes]|null flags|int|out|[which_nodes]|null
call spar_fluid_get_nearest int fluid|fluid|value|| which|int|value|| x_map|double|out|[which_nodes][3]|null q_map|double|out|[which_nodes][4]|null con|double|out|[which_nodes][3]|null
call spar_fluid_get_basis int fluid|fluid|value|| which|int|value|| first_node|int64_t|out|[which_nodes]|null phi|double|out|[which_nodes][P]|null
call spar_fluid_get_travel int fluid|fluid|value|| largest|double|out||null node|int64_t|out||null
call spar_fluid_get_positions int fluid|fluid|value|| which|int|value|| x|double|out|[which_nodes][3]|null q|double|out|[which_nodes][4]|null v|double|out|[which_nodes][3]|null nearest|double|out|[which_nodes][3]|null
call spar_fluid_pull_matrices int fluid|fluid|value|| theta|double|value|| convention|int|value|| matrix|double|out|[motion_nodes][9]|
call spar_fluid_check_matrices int fluid|fluid|value|| convention|int|value|| matrix|double|in|[motion_nodes][9]|
call spar_fluid_pull_forces int fluid|fluid|value|| theta|double|value|| force|double|out|[force_nodes][3]|
call spar_fluid_get_forces int fluid|fluid|value|| force|double|out|[force_nodes][3]|
call spar_fluid_push_forces_at int fluid|fluid|value|| theta|double|value|| force|double|in|[force_nodes][3]| moment|double|in|[force_nodes][3]|null
call spar_fluid_set_states int fluid|fluid|value|| width|int64_t|value||
call spar_fluid_get_states int fluid|fluid|value|| width|int64_t|out||null dt|double|out||null
call spar_fluid_pull_states int fluid|fluid|value|| width|int64_t|value|| states|double|out|[force_nodes][width]|
call spar_fluid_push_states int fluid|fluid|value|| width|int64_t|value|| states|double|in|[force_nodes][width]|
call spar_fluid_pull_motion_f32 int fluid|fluid|value|| theta|double|value|| x|float|out|[motion_nodes][3]|null v|float|out|[motion_nodes][3]|null
call spar_fluid_pull_poses_f32 int fluid|fluid|value|| which|int|value|| theta|double|value|| x|float|out|[which_nodes][3]|null q|float|out|[which_nodes][4]|null v|float|out|[which_nodes][3]|null omega|float|out|[which_nodes][3]|null accel|float|out|[which_nodes][3]|null alpha|float|out|[which_nodes][3]|null
call spar_fluid_pull_forces_f32 int fluid|fluid|value|| theta|double|value|| force|float|out|[force_nodes][3]|
call spar_fluid_push_forces_f32 int fluid|fluid|value|| force|float|in|[force_nodes][3]| moment|float|in|[force_nodes][3]|null
call spar_fluid_get_audit int fluid|fluid|value|| capacity|int64_t|value|| audit|double|out|[SPAR_AUDIT_COUNT]|
call spar_fluid_sum_loads int fluid|fluid|value|| point|double|in|[3]|null force|double|out|[3]|null moment|double|out|[3]|null
call spar_fluid_check_loads int fluid|fluid|value|| point|double|in|[3]|null force|double|in|[3]| moment|double|in|[3]|null rtol|double|value||
call spar_member_estimate_error int member|member|value|| step|double|out||null nodes|double|out||null
call spar_member_learn_added_mass int member|member|value|| n|int64_t|value|| eta|double|in|[n]|
call spar_member_get_learned_added_mass int member|member|value|| used|int|out||null spread|double|out||null n|int64_t|out||null capacity|int64_t|value||n eta|double|out|[capacity]|null mass|double|out|[capacity][36]|null
call spar_trial_create int session|session|value|| trial|trial|out||
call spar_trial_destroy none trial|trial|out||null
call spar_trial_get_session int trial|trial|value|| session|session|out||
call spar_trial_set_steps int trial|trial|value|| dt|double|value|| steps|int64_t|value||
call spar_trial_get_steps int trial|trial|value|| dt|double|out||null steps|int64_t|out||null
call spar_trial_set_callbacks int trial|trial|value|| before|before_step|callback|| before_context|context|value|| solve|fluid_solver|callback|| solve_context|context|value||
call spar_trial_set_progress int trial|trial|value|| progress|progress|callback|| context|context|value||
call spar_trial_run int trial|trial|value|| compare|int|value||
call spar_trial_get_errors int trial|trial|value|| motion|double|out||null reaction|double|out||null load|double|out||null
call spar_trial_get_cost int trial|trial|value|| seconds|double|out||null evaluations|int64_t|out||null
call spar_effect_name text row|int|value||
call spar_trial_report_effects int trial|trial|value||
call spar_trial_get_effect int trial|trial|value|| row|int|value|| in_force|int|out||null fails|int|out||null size|double|out||null motion|double|out||null reaction|double|out||null share|double|out||null
call spar_trial_set_goals int trial|trial|value|| goals|int|value||
call spar_trial_get_goals int trial|trial|value|| goals|int|out||
call spar_trial_push_numbers int trial|trial|value|| n|int64_t|value|| numbers|double|in|[n]|
call spar_trial_set_option int trial|trial|value|| key|char|in|[]| value|char|in|[]|
call spar_trial_get_option int trial|trial|value|| key|char|in|[]| capacity|int64_t|value||32 text|char|out|[capacity]|
call spar_trial_advise int trial|trial|value|| tolerance|double|value|| length|double|value||
call spar_trial_get_settings int trial|trial|value|| dt|double|out||null substeps|int|out||null scheme|int|out||null coupling_rtol|double|out||null predictor|int|out||null newton_rtol|double|out||null
call spar_trial_get_beam int trial|trial|value|| member|member|value|| fidelity|int|out||null modes|int64_t|out||null elements|int|out||null nodes_per_element|int|out||null points|int|out||null
call spar_trial_get_outcome int trial|trial|value|| error|double|out||null cost|double|out||null present_fails|int|out||null present_error|double|out||null
call spar_trial_get_search int trial|trial|value|| runs|int64_t|out||null work|double|out||null
call spar_trial_apply int trial|trial|value|| dt|double|out||null
call spar_trial_set_motion int trial|trial|value|| modes|int64_t|value|| amplitude|double|value|| memory|int64_t|value||
call spar_trial_get_motion int trial|trial|value|| modes|int64_t|out||null amplitude|double|out||null memory|int64_t|out||null
call spar_trial_solve_eigenvalues int trial|trial|value|| n|int64_t|value|| shift|double|in|[2]|null eigenvalue|double|out|[n][2]| nodes|int64_t|value||all_nodes shapes|double|out|[n][nodes][6][2]|null frame|double|out|[3]|null
call spar_trial_solve_floquet int trial|trial|value|| n|int64_t|value|| eigenvalue|double|out|[n][2]|
call spar_member_write_vtk int member|member|value|| path|char|in|[]|
call spar_fluid_write_vtk int fluid|fluid|value|| path|char|in|[]|
call spar_vtk_series_add int path|char|in|[]| time|double|value|| part|int|value|| file|char|in|[]|
call spar_polar_create int n|int64_t|value|| alpha_rad|double|in|[n]| cl|double|in|[n]| cd|double|in|[n]| cm|double|in|[n]|null polar|polar|out||
call spar_polar_set_interpolation int polar|polar|value|| kind|int|value||
call spar_polar_evaluate int polar|polar|value|| alpha_rad|double|value|| cl|double|out||null cd|double|out||null cm|double|out||null
call spar_polar_destroy none polar|polar|out||
call spar_aero_create int blades|int|value|| sections|fluid|list|[blades]| aero|aero|out||
call spar_aero_destroy none aero|aero|out||
call spar_aero_set_section int aero|aero|value|| i|int64_t|value|| chord|double|value|| twist|double|value|| polar|polar|value||
call spar_aero_get_chord int aero|aero|value|| chord|double|out|[sections]|null twist|double|out|[sections]|null
call spar_aero_get_polar int aero|aero|value|| i|int64_t|value|| n|int64_t|out||null capacity|int64_t|value||n alpha_rad|double|out|[capacity]|null cl|double|out|[capacity]|null cd|double|out|[capacity]|null cm|double|out|[capacity]|null kind|int|out||null
call spar_fluid_read_aerodyn int fluid|fluid|value|| primary_path|char|in|[]| blade_path|char|in|[]|null q|double|in|[4]|null n|int64_t|value|| span|double|in|[n]|null
call spar_aero_read_aerodyn int aero|aero|value|| primary_path|char|in|[]| blade_path|char|in|[]|null q|double|in|[4]|null span|double|in|[sections]|null
call spar_aero_set_rotor int aero|aero|value|| hub|double|in|[3]| axis|double|in|[3]| hub_radius|double|value|| tip_radius|double|value||
call spar_aero_set_turn int aero|aero|value|| turn|int|value||
call spar_aero_set_blades int aero|aero|value|| total|int|value||
call spar_aero_set_shear int aero|aero|value|| law|int|value|| ground|double|in|[3]| up|double|in|[3]| height|double|value|| parameter|double|value||
call spar_aero_set_tower int aero|aero|value|| base|double|in|[3]| top|double|in|[3]| base_radius|double|value|| top_radius|double|value||
call spar_aero_set_effects int aero|aero|value|| effects|int|value||
call spar_aero_solve int aero|aero|value|| density|double|value|| inflow|double|in|[blades][sections][3]| theta|double|value||
call spar_aero_get_rotor int aero|aero|value|| thrust|double|out||null torque|double|out||null power|double|out||null
call spar_aero_get_sections int aero|aero|value|| alpha|double|out|[blades][sections]|null cl|double|out|[blades][sections]|null cd|double|out|[blades][sections]|null a|double|out|[blades][sections]|null a_tangential|double|out|[blades][sections]|null
call spar_aero_get_flags int aero|aero|value|| flags|int|out|[blades][sections]|null no_root|int64_t|out||null
call spar_aero_get_loads int aero|aero|value|| per_length|double|out|[blades][sections][6]|null force|double|out|[blades][sections][3]|null moment|double|out|[blades][sections][3]|null
call spar_aero_effect_name text row|int|value||
call spar_aero_report_effects int aero|aero|value|| trial|trial|value||
call spar_aero_get_effect int aero|aero|value|| row|int|value|| in_force|int|out||null fails|int|out||null size|double|out||null motion|double|out||null reaction|double|out||null share|double|out||null
"""
DOCS = {
    "spar_session_message": "Describes the last failure of the session: what is wrong, where, and what to do.\n  session: in, NULL: the last failure in this thread that had no session (a create, a section, a NULL handle)\nA failure that was not read here, and had no log, stays in the messages of those after it: \"...; an earlier failure:\n...\". The text belongs to the session and stands until the next failure. It is \"\" before the first one. Local.",
    "spar_status_text": "Name and meaning of a status; static text, never NULL.\n  status: in, any int",
    "spar_version": "The release, \"major.minor.patch\"; static text.",
    "spar_has": "Answers 1 if this build has a feature, else 0.\n  feature: in, \"mpi\", \"fortran\", \"openblas\", \"lapack\" or \"gsl\"",
    "spar_session_create": "Creates a session of this process alone. Local.\n  session: out",
    "spar_session_create_fcomm": "Creates a session on a communicator, which is duplicated. Every build has this call; without MPI it answers\nSPAR_ERR_UNSUPPORTED. In C use spar_session_create_mpi (spar_mpi.h). Collective over comm.\n  comm: in, the Fortran integer of the communicator\n  session: out\nSPAR_ERR_ARGUMENT: not a communicator; SPAR_ERR_COMM: MPI is not initialised, is finalised, or has failed.",
    "spar_session_destroy": "Destroys the session with its members and fluids, whose handles become invalid. Call it before MPI_Finalize, and not\nin a callback of this session: the call in progress would go on in freed memory.\n  session: in; out, NULL\nCollective: a rank that waits in another collective call gets SPAR_ERR_COMM there.",
    "spar_step_begin": "Part 1: predicts the loads at t^{n+1} (option: spar_session_set_predictor).\n  dt: in, s, >= 1e-100, >= 1e-12 of the last step, and large enough to change t; it may vary otherwise. Add a\n        shorter rest of a window to the step before.\nCollective.",
    "spar_step_solve": "Part 2: solves all members from t^n to t^{n+1} under the current loads. Each call starts again from t^n.\nSPAR_ERR_NUMERIC: Newton did not converge, or the tangent is singular. Collective.",
    "spar_step_check": "Part 8: gathers the loads of all ranks, computes the residual and the loads of the next iteration.\n  done: out, 1: accept the step, 0: solve, push and check again\nSPAR_ERR_NUMERIC: no convergence in max_iterations (spar_session_set_coupling); or the steps have one evaluation of\nthe fluid each, and the error of the predicted loads grows from step to step (option coupling.unstable).\nCollective.",
    "spar_step_accept": "Accepts the step: the clock moves to t^{n+1}. SPAR_ERR_STATE after a check that failed. Collective.",
    "spar_step_reject": "Rejects the step: state, loads and coupling are again those at t^n. A tangent formed in the step may be reused, so a\nrepeated step agrees within Newton's tolerance, not to the bit. Collective.",
    "spar_fluid_pull_motion": "Parts 3 and 4: motion of the motion nodes at t^n + theta dt; before the first step, the initial state. Local.\n  theta: in, in [0,1]: 1 backward Euler, 1/2 Crank-Nicolson, 0 explicit\n  x[motion_nodes][3]: out, position, m, NULL: not wanted\n  v[motion_nodes][3]: out, velocity, m/s, NULL: not wanted\nSPAR_ERR_NUMERIC: the rotations at the nodes of an element cancel.",
    "spar_fluid_push_forces": "Part 7: loads at t^{n+1} on the force nodes where they are now; before the first step, those at t = 0. Replaces what\nthis fluid pushed before. Local.\n  force[force_nodes][3]: in, N\n  moment[force_nodes][3]: in, N m, about each node, NULL: none\nSPAR_ERR_ARGUMENT: a value is not finite. The loads stay as they were, and spar_step_check fails on all ranks unless\na valid push follows.",
    "spar_fluid_fail": "The host cannot compute the loads of this fluid. The next spar_step_check (or spar_step_begin before the first step)\nfails on all ranks unless a valid push follows, with this status and message here and SPAR_ERR_PEER elsewhere.\nBetween steps it does nothing. Local.\n  status: in, a SPAR_ERR_*\n  message: in, what, where, what to do; not empty; copied",
    "spar_step": "Runs one whole step: begin, then solve, callback and check until done, then accept. After a failure it rejects the\nstep and answers the failure.\n  dt: in, s\n  solve: in, NULL: this rank has no fluid\n  context: in, handed to solve\n  iterations: out, how many iterations were made, NULL: not wanted\nCollective.",
    "spar_session_set_gravity": "Gravity at the end of the next step. Within a step gravity changes linearly, like an applied load\n(spar_member_set_load).\n  g[3]: in, m/s^2, default 0",
    "spar_session_get_gravity": "g[3]: out",
    "spar_session_set_coupling": "A host whose loop cannot repeat a step chooses SPAR_COUPLING_EXPLICIT; others keep the default, IQN-ILS, which is\nstable with fluids of any added mass. Explicit coupling has one evaluation of the fluid per step. It is stable while\nthe added mass is below 1, 1/3, 1/7 of the mass (predictor order 0, 1, 2); above that spar_step_check refuses the\nstep (option coupling.unstable) unless the added mass is given (spar_member_set_added_mass).\nA step is iterated until the change of the fluid's loads is below atol + rtol |loads|. Both are weighed by the motion\nthat they cause (option coupling.norm), moments by the member's length.\n  scheme: in, SPAR_COUPLING_*; default SPAR_COUPLING_IQN_ILS\n  atol: in, N, >= 0; default 1e-9. Where spar knows the flexibility, the default counts only if the remaining loads\n        move nothing (1e-12 of a member's length); another value counts always\n  rtol: in, >= 0; default 1e-6\n  max_iterations: in, >= 1; after that many spar_step_check answers SPAR_ERR_NUMERIC, or accepts (option\n        coupling.unconverged); default 50",
    "spar_session_get_coupling": "scheme: out, NULL: not wanted\natol: out, NULL: not wanted\nrtol: out, NULL: not wanted\nmax_iterations: out, NULL: not wanted",
    "spar_session_get_time": "The clock. Local.\n  t: out, s, time of the last accepted step, NULL: not wanted\n  step: out, number of accepted steps, NULL: not wanted\n  iteration: out, coupling iterations of the current step, or of the last step or static solution, NULL: not\n        wanted",
    "spar_session_set_log": "Sets the log. Warnings are also kept for spar_session_get_warning. Local, at any time.\n  log: in, NULL: none (default)\n  context: in, handed to log; must live as long as the session uses it",
    "spar_log_stderr": "A log for spar_session_set_log: writes errors and warnings to stderr, a line each. The library writes nothing by\nitself.\n  session: in, not used\n  level: in, SPAR_LOG_*\n  text: in\n  context: in, not used",
    "spar_session_get_warning": "Warnings of this session on this rank, with or without a log: descriptions and runs that are legal and probably\nwrong. Warnings about members are given on rank 0, about fluids on their rank. The text belongs to the session;\n\"\" for i beyond the last. The first 32 are kept. Local, at any time.\n  i: in, from 0",
    "spar_point_create": "Creates a massless node with 6 degrees of freedom. It follows spar_member_set_motion or spar_member_drive.\n  name: in\n  x[3]: in, reference position, m, NULL: the origin\n  q[4]: in, reference orientation, NULL: none\n  member: out",
    "spar_rigid_create": "Creates a rigid body of one node. Default root condition: free.\n  name: in\n  x[3]: in, reference position of the node, m, NULL: the origin\n  q[4]: in, reference orientation, NULL: none\n  mass[36]: in, about the node, in its own frame, [m I, -m c~; m c~, J] with the centre of mass at c; kg, kg m,\n        kg m^2\n  member: out\nSPAR_ERR_ARGUMENT: no body has such moments of inertia: the largest exceeds the sum of the others.",
    "spar_beam_create": "Creates a geometrically exact (Simo-Reissner) beam of Legendre spectral elements. It needs a line and sections before\nthe commit. Default root condition: fixed.\n  name: in\n  elements: in, 1 to 1000000\n  nodes_per_element: in, 2 to 24; see below\n  member: out\nNodes are the Gauss-Lobatto-Legendre points, numbered from 0, element by element. At an element boundary two nodes\nstand at one position; they move alike, and their loads add.\nElements of few nodes lock if their axial or shear stiffness is large beside bending stiffness / length^2: they bend\ntoo little. Equilibria are right with 5 nodes, motions with 7, for any stiffness. With fewer nodes, the commit warns\nof stiffnesses for which equilibria are wrong, and a step warns of an element of 5 or 6 nodes that is bent so far\nthat its motion may be wrong. More nodes or more elements cure both.",
    "spar_beam_set_axis": "Reference line by points, in the beam's own frame. Replaces an earlier line.\nBetween its corners the line is smooth: the polynomial through the points if they are at most nodes_per_element,\notherwise fitted by least squares, exactly at both ends. A corner is an axis point on an element boundary (eta a\nmultiple of 1 / elements) where the line turns by more than 40 degrees, or by 1 degree or more and more than three\ntimes what the curvature at its neighbours explains; a turn of more than 40 degrees inside an element is refused.\n  n: in, points, >= 2\n  eta[n]: in, strictly increasing from 0 to 1\n  xyz[n][3]: in, m\n  twist[n]: in, rad about the tangent, linear between the points, NULL: 0\nSection frames at twist 0 have y = unit(z_global x tangent). If the line comes within 10 degrees of global z at\nan axis point, y is transported along the line from the root with the least rotation. A root within 0.001 rad of\nglobal z has y = global y, less its part along the tangent.",
    "spar_beam_set_sections": "Sections, linear in eta between the stations, constant beyond the first and the last.\n  n: in, stations, >= 1\n  eta[n]: in, strictly increasing in [0,1]\n  stiffness[n][36]: in, N, N m, N m^2, symmetric and positive definite\n  mass[n][36]: in, per length, kg/m, kg, kg m, of the form of a rigid body's (spar_rigid_create), NULL: massless",
    "spar_member_set_placement": "Moves the member from its own frame to its reference position: X -> R(q) X + x. It replaces the position given at the\ncreation of a point or rigid body.\n  x[3]: in, m, NULL: unchanged\n  q[4]: in, NULL: unchanged",
    "spar_member_set_root": "Sets the root condition.\n  kind: in, SPAR_ROOT_*",
    "spar_member_set_external": "Makes the host solve this member. The host reads spar_member_get_loads and gives spar_member_set_motion. A beam then\nneeds no sections.\n  on: in, 1 or 0",
    "spar_member_set_initial_velocity": "Initial velocities of a rigid motion: v0 + omega x (x - x0), and omega. Constrained motions of the root have\nnone. Before or after the commit, before the first step.\n  x0[3]: in, m, NULL: 0\n  v0[3]: in, m/s, NULL: 0\n  omega[3]: in, rad/s, NULL: 0",
    "spar_member_commit": "Checks the description, compares it across the ranks and allocates all memory. Afterwards the description is fixed.\nCollective. SPAR_ERR_COMM: the ranks described different members.",
    "spar_member_get_count": "nodes: out, number of nodes; before the commit too",
    "spar_member_get_reference": "Reference configuration.\n  x[nodes][3]: out, m, NULL: not wanted\n  q[nodes][4]: out, section frames, NULL: not wanted",
    "spar_member_get_motion": "Motion of the nodes. A fluid whose loads depend on the acceleration must pull it (spar_fluid_pull_poses), not read it\nhere.\n  q[nodes][7]: out, NULL: not wanted\n  v[nodes][6]: out, NULL: not wanted\n  a[nodes][6]: out, NULL: not wanted",
    "spar_member_set_motion": "Sets the motion of a point or an external member: during a step that at t^{n+1}, in every iteration if needed; before\nthe first step the initial motion.\n  q[nodes][7]: in, NULL: unchanged\n  v[nodes][6]: in, NULL: unchanged\n  a[nodes][6]: in, NULL: unchanged",
    "spar_member_drive": "Prescribes the motion of a driven root, or of a point, at the end of the next step. It is interpolated within the\nstep. Between steps only. Without a new call the root stays where it is. A static solution does not use it: steady\nrotation comes from spar_member_set_initial_velocity.\n  q[7]: in\n  v[6]: in, NULL: 0\n  a[6]: in, NULL: 0",
    "spar_member_set_load": "Applies a load to a node. It replaces the node's earlier load of this kind and stays until replaced. A node bears the\nsum of both kinds.\n  node: in, 0 to nodes - 1\n  kind: in, SPAR_LOAD_DEAD: fixed direction; SPAR_LOAD_FOLLOWER: in the node's section axes, rotating with them\n  load[6]: in, N, N m\nThe load is the one at the end of the next step. Within a step it changes linearly, from 0 if it is new. Before the\nfirst step it acts from t = 0 on. For a jump during a run, take one short step with the new load. A linear or modal\nbeam with a free or pinned root and no joints keeps the follower's reference direction.",
    "spar_member_get_loads": "All nodal loads in use: applied loads and the fluid's, in global axes. After spar_step_begin those are predicted;\nafter a spar_step_check with done = 0, the loads of the next iteration; otherwise the ones pushed last. An\nexternal member is to be solved with these; they include the loads of joints.\n  load[nodes][6]: out, N, N m",
    "spar_fluid_create": "Creates a fluid.\n  member: in, what its nodes are attached to\n  name: in, not empty, for messages; copied\n  fluid: out",
    "spar_fluid_destroy": "Destroys a fluid before its session; its loads disappear with it.\n  fluid: in; out, NULL",
    "spar_fluid_set_motion_nodes": "Sets the motion nodes. Map afterwards.\n  n: in\n  x[n][3]: in, position in the reference configuration, m",
    "spar_fluid_set_force_nodes": "Sets the force nodes. Map afterwards.\n  n: in\n  x[n][3]: in, position in the reference configuration, m",
    "spar_fluid_set_stations": "Sets nodes by their coordinate along the line, for blade element models. Each node is a motion node and a force node\nat once. The fluid keeps the node forces, unless spar_member_set_effects has switched SPAR_EFFECT_FLUID_HISTORY off.\nCall spar_fluid_map afterwards.\n  n: in\n  eta[n]: in, in [0,1], 0 at the root and 1 at the tip; a point or rigid body ignores it\n  offset[n][3]: in, m, from the line to the node in the section frame (x tangent, y, z), NULL: 0\nLocal. SPAR_ERR_ARGUMENT: eta lies outside [0,1].",
    "spar_fluid_map": "Finds the nearest point of the reference line for every node of the sets that are new. The member must be committed.\nOf equally near points the first along the line is taken. Nodes of a point or rigid body are mapped to its node.\nSPAR_ERR_MAPPING: a node is too far (spar_fluid_set_projection); the nodes stay unmapped.",
    "spar_fluid_pull_poses": "The whole motion of the nodes of one set at t^n + theta dt, for blade elements, actuator lines and fluids that need\naccelerations. What is not wanted costs nothing.\n  which: in, SPAR_NODES_MOTION, or SPAR_NODES_FORCE: where an actuator line spreads what spar_fluid_pull_forces gives\n        at the same theta\n  theta: in, in [0,1], as of spar_fluid_pull_motion\n  x[which_nodes][3]: out, m, position, NULL: not wanted\n  q[which_nodes][4]: out, orientation of the section, scalar part >= 0, NULL: not wanted\n  v[which_nodes][3]: out, m/s, NULL: not wanted\n  omega[which_nodes][3]: out, rad/s, angular velocity, NULL: not wanted\n  accel[which_nodes][3]: out, m/s^2, acceleration of the node, NULL: not wanted\n  alpha[which_nodes][3]: out, rad/s^2, angular acceleration, NULL: not wanted\nSteps with substeps, and steps from the first change of dt on, give mean accelerations: the mean over the step,\nextrapolated to the end of the step with the mean of the step before (T15). They are of second order too, and an\nadded mass may respond to them. A member with an added mass of its own (spar_member_set_added_mass) always gives the\naccelerations at the time itself.\nLocal. SPAR_ERR_UNSUPPORTED: a rotation of motion nodes with weights; SPAR_ERR_NUMERIC: as of\nspar_fluid_pull_motion.",
    "spar_session_save": "Writes the state of the session to a file, or reads it. A run that continues from the file has the same bits.\nCollective, load between steps.\n  path: in, that of rank 0; other ranks may give any text\nsave is legal within a step too: a run that loads the file goes on within it, so the flow must have its state of\nthen. save writes path.new and renames it, so path is always a whole file. Rank 0 writes and reads for all; other\nranks need not see the file. What is not a regular file is SPAR_ERR_IO. load needs the same members and joints,\ncommitted, and the same mapped fluids by name, on any number of ranks. Numbers of a description agree to rounding:\npositions to 1e-9 of the member's length, stiffness and mass to 1e-8, damping, springs and forces to 1e-6. Initial\nvelocities need not agree. Nodes are matched by their reference position, to 1e-9 of the member's length. Settings\nare not in the file; the host makes them as before. After a failure the session is as it was. SPAR_ERR_IO: the file\ncannot be read, or is damaged; SPAR_ERR_ARGUMENT: it does not match the session.",
    "spar_session_load": "Reads a saved state into the session. Collective.\n  path: in",
    "spar_section_from_shape": "Properties of a shape of one isotropic material, with its centre on the line. Change what differs (an angle, a centre\nof mass, a mass that includes a coating), then build the matrices. Local, without a session.\n  shape: in, SPAR_SHAPE_*\n  n: in, number of dimensions of the shape\n  dimension[n]: in, m, > 0\n  young: in, Pa, > 0\n  poisson: in, Poisson's ratio, -1 < poisson <= 0.5\n  density: in, kg/m^3, 0: no mass\n  capacity: in\n  property[capacity]: out, by SPAR_SECTION_*\nShear factors of circle, tube and rectangle are those of Cowper (1966). The shear factor of a box comes from the\nenergy of its shear stresses: 1 % too small for walls of a twentieth of the side, 5 % for a fifth, up to 20 % if one\npair of walls is much thicker. GJ of a rectangle is the series of Saint-Venant; GJ of a box has an error below 0.5 %.\nWalls of a box thicker than a fifth of the side across them are refused. SPAR_ERR_NUMERIC: a result is too small or\ntoo large for a number.",
    "spar_section_build": "Matrices for spar_beam_set_sections from properties. Local, without a session.\n  n: in, entries given, the rest is 0; at most SPAR_SECTION_COUNT\n  property[n]: in, by SPAR_SECTION_*; EA, GA, GJ, EI > 0\n  stiffness[36]: out, NULL: not wanted; then no stiffness has to be given\n  mass[36]: out, NULL: not wanted; else MASS > 0 and INERTIA >= 0\nSPAR_ERR_NUMERIC: a centre is so far from the line that rounding spoils the matrix.",
    "spar_section_describe": "Properties of given matrices: the inverse of spar_section_build. The principal axis of each of bending, shear and\ninertia named Y is the one within 45 degrees of y (of y'). Couplings are K_ij / sqrt(K_ii K_jj) at the centres, in\nprincipal axes; those below 0.001 are not findings. Local, without a session.\n  stiffness[36]: in\n  mass[36]: in, NULL: none\n  capacity: in\n  property[capacity]: out, by SPAR_SECTION_*; 0 where a finding says that it is not described, NULL: not wanted\n  findings: out, SPAR_FINDING_* combined, 0: plain properties are the whole section, NULL: not wanted",
    "spar_section_report": "The findings in words, with their numbers, one on a line.\n  stiffness[36]: in\n  mass[36]: in, NULL: none\n  capacity: in; 1000 is enough\n  text[capacity]: out, \"\" without findings; SPAR_ERR_ARGUMENT if it does not fit",
    "spar_section_transform": "The same section seen from another line and in other axes. For stiffness and mass alike. Local, without a session.\n  matrix[36]: in, in the order of spar, about the old line\n  y: in, m, where the new line is, in the old axes\n  z: in, m\n  angle: in, rad, from the old y to the new one, right-handed about x\n  out[36]: out, may be matrix",
    "spar_beam_get_elements": "Number of elements and of nodes in each. Within a trial that varies nodes: the present ones.\n  elements: out, NULL: not wanted\n  nodes_per_element: out, NULL: not wanted",
    "spar_beam_get_axis": "The axis as spar_beam_set_axis or spar_beam_read_beamdyn has set it.\n  n: out, 0: none, or nodes were given instead; NULL: not wanted\n  capacity: in, of the arrays; n is enough\n  eta[capacity]: out, NULL: not wanted\n  xyz[capacity][3]: out, m, NULL: not wanted\n  twist[capacity]: out, rad, NULL: not wanted",
    "spar_beam_get_sections": "The sections as spar_beam_set_sections or spar_beam_read_beamdyn has set them.\n  n: out, 0: none; NULL: not wanted\n  capacity: in, of the arrays; n is enough\n  eta[capacity]: out, NULL: not wanted\n  stiffness[capacity][36]: out, NULL: not wanted\n  mass[capacity][36]: out, 0 without mass, NULL: not wanted",
    "spar_beam_set_nodes": "Gives the nodes themselves instead of an axis, in the beam's own frame. They must be the Gauss-Lobatto-Legendre\npoints of their elements; the commit refuses nodes that coincide or go back.\n  n: in, elements * nodes_per_element\n  x[n][3]: in, m; at an element boundary two nodes at one position\n  q[n][4]: in, section frames; different ones at a boundary make a kink; NULL: as spar_beam_set_axis without twist",
    "spar_beam_set_quadrature": "Integration along an element. Default: SECTIONS if there are more than two stations, else GAUSS with as many\npoints as nodes. The commit refuses a rule that is too coarse for the element.\n  rule: in, SPAR_QUADRATURE_*; SECTIONS has Gauss points in each piece between stations\n  points: in, per element or piece, 1 (Lobatto 2) to 512; 0: as many as needed",
    "spar_beam_get_quadrature": "rule: out, the rule in use, NULL: not wanted\npoints: out, as set; 0: not set; then GAUSS has as many as nodes, SECTIONS as many as the pieces need; NULL: not\n        wanted",
    "spar_beam_read_beamdyn": "Axis, sections and damping from BeamDyn's files. BeamDyn's z axis, along the blade, becomes the beam's x axis;\nits x and y axes become y and z. Elements, nodes and quadrature stay those of the beam. Every rank reads the files.\n  primary_path: in\n  blade_path: in, NULL: the file named by the primary one, in its folder\nStations run from 0 to 1, and counts must agree with the rows. Modal damping (damp_type 2) is not put in force: a\nwarning has the ratios, for spar_beam_fit_damping after the commit. After a failure the beam is as it was.\nSPAR_ERR_IO: a file or a field cannot be read; SPAR_ERR_ARGUMENT: a matrix is not allowed; SPAR_ERR_UNSUPPORTED:\ndamp_type above 2.",
    "spar_beam_set_masses": "Rigid bodies or point masses attached to the beam: a nacelle, an engine, a float. They move with the section at eta.\nTheir inertia, gyroscopic terms and weight are part of the beam's equations at every fidelity that has mass. Put an\nelement boundary at a heavy one.\n  n: in, 0 to 10000, 0: none\n  eta[n]: in, in [0,1], in any order, repetitions allowed\n  mass[n][36]: in, about the line in the section's axes, of the form of spar_rigid_create\nSPAR_ERR_STATE at the commit: the sections have no mass.",
    "spar_beam_get_masses": "n: out, NULL: not wanted\ncapacity: in, of the arrays; n is enough\neta[capacity]: out, NULL: not wanted\nmass[capacity][36]: out, NULL: not wanted",
    "spar_beam_set_foundation": "Springs to the ground along the beam: soil around a pile, a rail's bed. The force per unit length is stiffness times\nthe displacement from the reference configuration, along axes that do not rotate. The tangent is exact. Foundation\nforces are part of spar_member_get_loads and of reactions. Their energy is stored (SPAR_ENERGY_FOUNDATION), and no\npart of SPAR_WORK_LOADS.\n  n: in, stations, 0 to 10000, 0: none (default)\n  eta[n]: in, not decreasing in [0,1]; two stations at one eta are a jump\n  stiffness[n][3]: in, N/m^2, >= 0, along the section's axes in the reference configuration; linear between stations,\n        zero outside; n = 1: constant along the whole beam\nSPAR_ERR_UNSUPPORTED at the commit: prescribed, rigid or external members, linear or modal ones with a driven\nroot.",
    "spar_beam_get_foundation": "n: out, NULL: not wanted\ncapacity: in, of the arrays; n is enough\neta[capacity]: out, NULL: not wanted\nstiffness[capacity][3]: out, NULL: not wanted",
    "spar_beam_set_pretension": "Section forces in the reference configuration: of a cable, a string, a tendon. They rotate with the section and are\nadded to the forces of the strains. Under an axial force N a straight beam has the stiffness of EI and of a\nstring with N; under -N it buckles. Where supports and loads do not balance the pretension, the beam deforms.\nRigid and prescribed members ignore it.\n  n: in, stations, 0 to 10000, 0: none (default)\n  eta[n]: in, strictly increasing in [0,1]\n  force[n][6]: in, N, N m, in the order of the stiffness, axial > 0 in tension; linear between stations, constant\n        outside",
    "spar_beam_get_pretension": "n: out, NULL: not wanted\ncapacity: in, of the arrays; n is enough\neta[capacity]: out, NULL: not wanted\nforce[capacity][6]: out, NULL: not wanted",
    "spar_beam_set_damping": "Stiffness-proportional damping: stress = C (strain + mu strain rate).\n  mu[6]: in, s, >= 0, per strain component in the order of the stiffness",
    "spar_beam_get_damping": "mu[6]: out, s, also those of spar_beam_set_modal_damping; 0: none",
    "spar_beam_set_mass_damping": "Mass-proportional damping: a force of -alpha times mass times velocity. The velocity is relative to the rigid motion\nof the root, so the rotation of a blade as a whole is not damped. If the root is free, pinned or moved by joints,\nit is the absolute velocity, and the momentum of a free beam decays as exp(-alpha t). A mode with angular\nfrequency omega has the damping ratio alpha / (2 omega). The force is an external one in the root's reaction. Its\nwork on the rigid motion of a driven root is in no account of energy. It has no effect on rigid or prescribed beams\nwith fixed or driven roots, and without INERTIA.\n  alpha: in, 1/s, >= 0, 0: none (default)\nSPAR_ERR_UNSUPPORTED at the commit: a rigid beam with a free or pinned root.",
    "spar_beam_get_mass_damping": "alpha: out, 1/s",
    "spar_beam_set_plane": "Holds a beam in a plane: displacements along the normal and rotations about other axes are 0 at all nodes. For\ntwo-dimensional flows, where mean pressure on both faces would twist a slab out of the plane. Loads out of the plane\nhave no effect; what holds the beam in the plane is in no reaction. Modes and eigenvalues are those in the plane;\nsection forces come from the strains. The root may be of any kind; initial velocities and driven roots must stay in\nthe plane (SPAR_ERR_ARGUMENT).\n  normal[3]: in, direction of any length, NULL or 0: not held (default)\nSPAR_ERR_UNSUPPORTED at the commit: fidelity below exact, or external; at the step: with joints.",
    "spar_beam_get_plane": "normal[3]: out, of length 1; 0: not held; NULL: not wanted",
    "spar_member_set_fidelity": "Chooses the fidelity of a beam.\n  kind: in, SPAR_FIDELITY_*, default exact\n  modes: in, of a modal member, >= 1; else ignored\nprescribed  Fixed or driven root. No inertia, no weight; the support takes all loads.\nrigid       Any root. Mass, centre and inertia come from the sections. A static solution does not move it.\nlinear      Fixed or driven root: the root moves exactly, the deformation relative to it is linear, with Coriolis,\n            gyroscopic and centrifugal terms. Axial forces of the root's motion (a blade on a hub) and of weight (a\n            mast) stiffen or soften it, unless the root is free. Neglected are second-order terms of the deformation,\n            and stiffening by transverse forces and by applied and fluid loads. The factorisation stays while dt does\n            and the root's angular velocity and acceleration, gravity included, stay in its own axes. Free or pinned\n            root: linear about the reference configuration; a node that rotates by half a turn is SPAR_ERR_NUMERIC.\n            No joints: there an exact beam costs about as much.\nmodal       As linear, with the lowest `modes` modes with the root constrained; free and pinned roots count their 6\n            or 3 rigid modes. The initial deformation is projected onto the modes.\nSPAR_ERR_ARGUMENT at the commit: too many modes for the nodes, or fewer than the rigid ones; SPAR_ERR_STATE:\nlinear or modal with a free or pinned root, without INERTIA; SPAR_ERR_UNSUPPORTED: linear or modal with a joint;\nSPAR_ERR_NUMERIC: fewer modes have mass.",
    "spar_member_get_fidelity": "kind: out, NULL: not wanted\nmodes: out, of a modal member, else 0, NULL: not wanted",
    "spar_member_set_effects": "Switches effects of a member on or off. By default every effect is on that the description has data for, except\nSPAR_EFFECT_WORK; SPAR_EFFECT_FLUID_HISTORY is on for fluids with stations. A later call replaces an earlier one.\n  switch_on: in, SPAR_EFFECT_* combined, to be on besides the defaults; one that the description has no data for is\n        ignored\n  switch_off: in, SPAR_EFFECT_* combined, of the defaults, to be off\nLocal, before commit. SPAR_ERR_ARGUMENT: an effect is in both.",
    "spar_member_get_effects": "effects: out, SPAR_EFFECT_* combined, those in force. After commit. Local.",
    "spar_member_get_placement": "x[3]: out, m, NULL: not wanted\nq[4]: out, NULL: not wanted",
    "spar_member_get_root": "kind: out, SPAR_ROOT_*",
    "spar_member_get_external": "on: out, 1: the host solves the member",
    "spar_member_get_session": "session: out, the session that the member belongs to; before the commit too",
    "spar_member_get_name": "The name given at creation; \"\" for NULL. The text lives as long as the session.",
    "spar_beam_set_line_load": "Distributed loads on a beam, per unit length of the reference line. They replace the earlier ones of their kind and\nstay until replaced. They are those at the end of the next step and linear within it, like spar_member_set_load.\n  kind: in, SPAR_LOAD_DEAD: in global axes; SPAR_LOAD_FOLLOWER: in section axes, rotating with them\n  n: in, stations, 0: none\n  eta[n]: in, not decreasing in [0,1]; two stations at one eta are a jump\n  load[n][6]: in, N/m, N m/m, linear between stations, zero outside; n = 1: constant along the whole beam\nThey act at quadrature points of their own, by virtual work. After the commit.",
    "spar_member_get_reaction": "What the support gives to the root: the rate of the member's momentum, with the accelerations of\nspar_member_get_motion, less its weight and loads. Fluid loads are those of the last solution; where they move\nnothing (on fixed and driven bodies), an accepted step has those pushed last. load[6]: out, N, N m, moment about the\nroot; 0 if the root is free",
    "spar_beam_evaluate": "Evaluates a beam at given positions along it.\n  n: in\n  eta[n]: in, in [0,1]; a boundary belongs to the element before it\n  strain[n][6]: out, stretch, shears, twist, curvatures relative to the reference, 1 and 1/m, NULL: not wanted\n  force[n][6]: out, N, N m, exerted by the part beyond, NULL: not wanted\n  x[n][3]: out, position, m, NULL: not wanted\n  q[n][4]: out, orientation, NULL: not wanted\nStrain and force are in section axes, in the order of the stiffness. force is the balance of the part beyond: its\nloads and joints less its inertia. It is as accurate as the reaction, also where a line load jumps. Where mass, a\nfoundation or a fluid's load jumps inside an element, it is smoothed over about two nodes (mass 3:1, 9 nodes: 2 % of\nthe force, 0.1 % of the moment); put an element boundary there. Strains are one order less accurate, and stiffness\ntimes strain equals force only in the limit. Before the first balance, and of rigid, prescribed or\nexternal beams, force is stiffness times strain. Linear and modal members have the strains of linear theory.\nSPAR_ERR_UNSUPPORTED: force of a beam without sections.",
    "spar_member_get_energy": "Energies now. Members that spar does not solve have zeros. Linear and modal members have the quadratic forms of their\nequations; with a driven root that is the strain energy alone, the others are those of the motion.\n  capacity: in\n  energy[capacity]: out, by SPAR_ENERGY_*, J",
    "spar_member_get_work": "Work in the accepted steps since the motion was set last (commit, static solution, initial velocity, load of a file).\nThe sum of all energies less all work is constant to the order of the integrator. Needs SPAR_EFFECT_WORK, otherwise\nSPAR_ERR_STATE.\n  capacity: in\n  work[capacity]: out, by SPAR_WORK_*, J",
    "spar_member_solve_static": "Static equilibrium of one member, and of all members that joints connect to it, under gravity, applied loads and the\nfluid's present loads. It starts from the present state; velocities become 0. With a fluid that responds use\nspar_session_solve_static. Collective, between steps.\n  load_steps: in, 1 to 100000, number of equal parts in which the loads are applied, from those that balance the\n        present state on. A part that fails is halved, up to 5000 times.\nA driven root in steady rotation gives the equilibrium in the rotating frame, with centrifugal loads. Members\nconnected to such a root, to a node with prescribed rotation or to a hinge driven at constant rate rotate with\nit. The result is a stable equilibrium: of dead forces the one that growing loads lead to. Members held by their\nloads alone (a body that hangs on a hinge) descend to a stable equilibrium.\nSPAR_ERR_NUMERIC: none was found, beyond a limit or bifurcation point, or with a motion that nothing constrains; the\nmessage names the motion. SPAR_ERR_STATE: nothing constrains the member. SPAR_ERR_UNSUPPORTED: spar does not\nsolve the member; or, in rotation, gravity, dead loads or joints to the ground are not symmetric about the axis.",
    "spar_member_solve_modes": "Lowest modes about the present state, with the root constrained, in the frame rotating with the root. Geometric and\ncentrifugal stiffness and spin softening are included; Coriolis terms and damping are not. Of unsymmetric stiffness\n(follower loads) the symmetric part is used. With joints: the modes of all connected members, the same whichever\nmember is asked; constrained and driven motions stand still. Solve statically first so that the stress is known.\nLocal.\n  n: in, at most the number of free unknowns\n  frequency_hz[n]: out, ascending; negative if the stiffness is, infinite without mass\n  shapes[n][nodes][6]: out, displacement and rotation of this member's nodes, for unit modal mass of all connected\n        members, NULL: not wanted\nSPAR_ERR_NUMERIC: no convergence; or rounding of very stiff strains leaves an error beyond 5e-4 of a frequency. Of\nlinear and modal beams a warning says so instead.",
    "spar_member_solve_eigenvalues": "Eigenvalues lambda of small motions x e^(lambda t) about the present state, at rest or in steady rotation. Damping,\nCoriolis, gyroscopic and unsymmetric stiffness terms are included (docs/explanation/theory.md). lambda is growth\nrate, 1/s, plus i times angular frequency, rad/s. A growth rate > 0 is an instability. Of conjugate pairs only the\none with frequency >= 0 counts. Fluid loads stay constant. With joints: of all connected members. Local.\n  n: in, at most the number of free unknowns\n  shift[2]: in, growth rate and angular frequency; the eigenvalues nearest to it are found; NULL: 0, the lowest\n  eigenvalue[n][2]: out, growth rate and angular frequency, by distance from the shift\n  shapes[n][nodes][6][2]: out, real and imaginary part, for unit x^H M x, largest component real, NULL: not wanted\n  frame[3]: out, rad/s, angular velocity of the frame in which x is seen, NULL: not wanted\nSPAR_ERR_STATE: no equilibrium; SPAR_ERR_UNSUPPORTED: parts rotate against each other and are not axisymmetric;\nSPAR_ERR_NUMERIC: fewer than n converged; or rounding hides one, as of spar_member_solve_modes.",
    "spar_beam_set_modal_damping": "Chooses stiffness-proportional damping such that two modes have given damping ratios. It replaces\nspar_beam_set_damping and adds to mass damping. Each mode sets mu of its dominant group of strains (bending about\ny with shear z, bending about z with shear y, torsion with stretch); the third group gets the geometric mean.\nA warning names a mode that gets more than 3 times the largest ratio chosen, or, of an assembly, less than half of\nthe smallest. Between commit and first step, after the joints. Collective.\n  mode[2]: in, from 0, as spar_member_solve_modes numbers them, of the member without joints\n  ratio[2]: in, of critical damping, > 0\n  mu[6]: out, s, NULL: not wanted\nSPAR_ERR_ARGUMENT: both modes have the same group; SPAR_ERR_NUMERIC: no mu gives these ratios.",
    "spar_beam_fit_damping": "Chooses proportional damping for the damping ratios of any number of modes: mu of three groups of strains (as\nspar_beam_set_modal_damping) and alpha of spar_beam_set_mass_damping, none below 0. It replaces both. The sum of the\nsquares of (achieved / ratio - 1) is least. Up to four modes can be met if they differ in kind: first flap, second\nflap, first edge, first torsion. A group that no mode depends on gets the mean of what the modes ask for. It warns as\nspar_beam_set_modal_damping does. Between commit and first step. Collective.\n  n: in, 1 to 1000\n  mode[n]: in, from 0, as spar_member_solve_modes numbers them about the present state (at rest, or in steady\n        rotation after a static solution), of the member without joints\n  ratio[n]: in, of critical damping, > 0\n  achieved[n]: out, ratios that the modes have, NULL: not wanted",
    "spar_joint_create": "Creates a joint of two nodes. It belongs to the session.\n  name: in, unique in the session, not empty, copied\n  a: in\n  node_a: in, from 0\n  b: in, NULL: the ground\n  node_b: in, from 0, ignored for the ground\n  free_motions: in, SPAR_FREE_* combined: 0 a weld, RX a hinge, RX|RY a universal joint, RX|RY|RZ a ball, X a slider,\n        X|RX a cylindrical joint, X|Y|RZ a planar joint, all six for springs alone\n  joint: out\nSPAR_ERR_UNSUPPORTED: a member is committed as a linear or modal beam; likewise the other calls that create a\njoint. If the joint comes first, spar_member_commit refuses.",
    "spar_joint_set_frame": "Position and axes of the joint in the reference configuration. Rigid arms lead from both nodes to it. Default: the\nposition and section axes of node a. Before the first step.\n  x[3]: in, m\n  q[4]: in, NULL: the section axes of node a",
    "spar_joint_set_spring": "Spring and damper on the free motions z: load on a = preload - stiffness z - damping dz/dt. Replaces earlier ones.\n  stiffness[36]: in, symmetric, N/m, N, N m/rad, 0 for constrained motions, NULL: 0\n  damping[36]: in, symmetric, the same times s, NULL: 0\n  preload[6]: in, N, N m, NULL: 0",
    "spar_spring_create": "Creates a spring from one node of a member to the ground: a joint at the node, in its section axes (of a rigid body\nits own axes). The same as spar_joint_create with b NULL and spar_joint_set_spring. Before the first step.\n  session: in\n  name: in, not empty, of no other joint of the session\n  member: in, of the session\n  node: in\n  free_motions: in, SPAR_FREE_* combined, on which the spring acts; the others are held. A cylinder in a stream has\n        SPAR_FREE_Y\n  stiffness[36]: in, as of spar_joint_set_spring, NULL: 0\n  damping[36]: in, as of spar_joint_set_spring, NULL: 0\n  preload[6]: in, N, N m, NULL: 0\n  joint: out, NULL: not wanted\nLocal, the same on every rank.",
    "spar_joint_set_driven": "Chooses which free motions spar_joint_drive prescribes. Before the first step.\n  mask: in, SPAR_FREE_* combined",
    "spar_joint_drive": "Prescribes the driven motions at the end of the next step. Without a new call they stay. Other entries are ignored.\nBetween steps.\n  motion[6]: in, m, rad; angles of hinges and universal joints count turns; of a ball the rotation vector, below\n        half a turn\n  rate[6]: in, NULL: 0\n  acceleration[6]: in, NULL: 0",
    "spar_joint_set_load": "A load between the two nodes: a motor, a generator, a brake. It stays until replaced. It is the load at the end\nof the next step and linear within it.\n  load[6]: in, N, N m, on a from b, on the free motions",
    "spar_link_create": "Creates a link: a joint whose one motion, the first of six, is the distance of two points fixed to their nodes. The\ndistance is constrained (a rod), driven (an actuator, motion[0] its length), or on a spring.\n  name: in, as for a joint\n  a: in\n  node_a: in\n  point_a[3]: in, m, global, in the reference configuration\n  b: in, NULL: the ground\n  node_b: in\n  point_b[3]: in, m, not point_a\n  joint: out",
    "spar_link_set_spring": "Puts a link on a spring. Before the first step.\n  stiffness: in, N/m, >= 0\n  damping: in, N s/m, >= 0\n  length: in, m, unstretched, >= 0\n  tension_only: in, 1: a rope, without load up to its length and max(0, k (d - l) + c d') beyond; 0: a strut\nIn the step in which a rope comes taut, d' is limited to the rate at which the stretch can have grown in the step.",
    "spar_joint_get_motion": "Relative motion at the latest iterate, between steps at t^n; 0 before the first step or static solution.\n  motion[6]: out, m, rad; a link has its distance in the first, NULL: not wanted\n  rate[6]: out, NULL: not wanted\n  acceleration[6]: out, NULL: not wanted",
    "spar_joint_get_load": "The load of the joint on a, at the joint's point of a, in the joint's axes as b carries them (the ground's stay); b\ngets the opposite at the same point. Of two or three free rotations, the moments are those that work on the angles or\non the rotation vector.\n  load[6]: out, N, N m: of constrained motions the constraint's, of free ones spring, damper and\n        spar_joint_set_load; a link has its tension, negative in a, in the first",
    "spar_joint_get_energy": "Needs SPAR_EFFECT_WORK of one of its members, otherwise SPAR_ERR_STATE. The work of the joint on its two nodes is\nthat of drive and load less what damper and spring take, to the order of the integrator.\n  capacity: in\n  energy[capacity]: out, by SPAR_JOINT_ENERGY_*, J",
    "spar_session_set_integrator": "The integrator. Steps of equal length use generalised-alpha on the Lie group (Bruels, Cardona, Arnold 2012). A step\nwhose length differs by more than 0.1 % from one of the two before it uses TR-BDF2, with two solutions of one\ntangent. An exact beam that spins at Omega without a driven root uses TR-BDF2 where 1 - rho_inf < 1.5 Omega dt. A\nsubstep without a solution, or whose solution gains energy that no load supplies, is divided, down to 1/1024\n(SPAR_ERR_NUMERIC).\n  rho_inf: in, spectral radius of generalised-alpha at infinite frequency, in [0,1]; default 0.9. Choose less to damp\n        unresolved modes, 1 to conserve energy. 0 has 5.4 times the error of 0.9\n  substeps: in, structural steps per coupling step, >= 1; default 1. Loads change linearly in them. Choose more\n        if the structure is faster than the fluid",
    "spar_session_get_integrator": "rho_inf: out, NULL: not wanted\nsubsteps: out, NULL: not wanted",
    "spar_session_set_newton": "Tolerances of Newton's iteration in a step. It stops when the estimated remaining correction is below\natol + rtol times the motion in the step, and the estimated unbalanced forces are below 100 rtol times the largest\nsection force or force of inertia. Displacements are relative to the member's length, rotations are in rad. Both\nestimates follow from the iterations of the same solution. Choose rtol 1e-12 to compare runs to their last digits.\n  atol: in, >= 0; default 1e-15\n  rtol: in, >= 0; default 1e-8\n  max_iterations: in, >= 1; after that many SPAR_ERR_NUMERIC; default 50",
    "spar_session_get_newton": "atol: out, NULL: not wanted\nrtol: out, NULL: not wanted\nmax_iterations: out, NULL: not wanted",
    "spar_member_get_iterations": "Newton iterations of a member, as the rank that solves it knows them (spar_member_get_owner); zeros on other ranks.\n  iterations: out, since the commit, NULL: not wanted\n  left: out, estimated error of the last solution, relative to the member's length, or rad; of connected members the\n        largest, NULL: not wanted",
    "spar_session_set_predictor": "Order of the polynomial that extrapolates the loads to t^{n+1}, (T11). The first steps use lower orders until enough\nloads are known. Extrapolation reaches at most ten times the last step.\n  order: in, 0, 1 (default) or 2. Choose 0 for heavy fluids with explicit coupling",
    "spar_session_get_predictor": "order: out",
    "spar_session_set_relaxation": "Relaxation of SPAR_COUPLING_FIXED_POINT, and the first factor of SPAR_COUPLING_AITKEN.\n  omega: in, part of the change of loads that is applied, in (0,2]; default 1. Choose less for heavy fluids",
    "spar_session_get_relaxation": "omega: out",
    "spar_session_set_option": "Sets an option by name.\n  key: in\n  value: in, a number or a word\ncoupling.unconverged   error (default) | accept: what spar_step_check does after max_iterations. Choose accept if the\n                       host cannot repeat a step, and look at SPAR_REPORT_UNCONVERGED\ncoupling.unstable      error (default) | accept: what spar_step_check does if the error of the predicted loads has\n                       grown to the size of the loads, in steps with one evaluation of the fluid each: explicit, or\n                       accepted before done. Choose accept to see an instability grow\ncoupling.patience      1 to 1000000, default 3: with accept, so many consecutive unconverged steps are an error\ncoupling.norm          motion (default) | loads: how the stop test, Aitken's factor and IQN-ILS weigh loads. Motion:\n                       by the motion that they cause in the step, so a load on a stiff direction counts little.\n                       Sessions with external members, points, or connected members without INERTIA use loads\ncoupling.estimate      off (default) | on: with explicit coupling spar_step_check computes SPAR_REPORT_MOTION_ERROR,\n                       by one back-substitution. Choose on to see what iterating would change\ncoupling.columns       1 to 10000, default 30: IQN-ILS, largest number of difference columns\ncoupling.reuse         0 to 10000, default 5: IQN-ILS, accepted steps whose columns are used again. Choose 0 for\n                       fluids that change quickly\ncoupling.filter        0 to 0.5, default 1e-4: IQN-ILS, a column is dropped if others contain all but this part\ncoupling.motion_atol   >= 0, m, default 0, and\ncoupling.motion_rtol   0 to 1, default 0: if one is set, the iteration also continues until the nodes move between\n                       iterations by less than atol + rtol times their displacement in the step\nSPAR_ERR_ARGUMENT: no such key or value; the message lists them.",
    "spar_session_get_option": "The value of an option, as a text that spar_session_set_option takes.\n  key: in\n  capacity: in, of the text with its end; 32 is enough\n  text[capacity]: out\nSPAR_ERR_ARGUMENT: no such key, or the capacity is too small.",
    "spar_session_get_iterations": "History of the iterations of the current step, or of the last step or static solution; the same on all ranks. Root of\nthe sum of squares over all nodes; moments are divided by the member's length.\n  iterations: out, how many there were, NULL: not wanted\n  capacity: in, of the arrays; iterations is enough\n  residual[capacity]: out, N, change of the loads in each iteration, weighed by motion (option coupling.norm), 0\n        beyond the last, NULL: not wanted\n  size[capacity]: out, N, size of the loads, NULL: not wanted",
    "spar_session_get_residual": "The last of them.\n  residual: out, N, 0 before the first iteration, NULL: not wanted\n  size: out, N, NULL: not wanted",
    "spar_session_get_report": "Report of the coupling; the same on all ranks.\n  capacity: in\n  report[capacity]: out, by SPAR_REPORT_*, NULL: not wanted",
    "spar_session_get_phase": "phase: out, SPAR_PHASE_*",
    "spar_member_set_added_mass": "An estimate of the fluid's added mass, for fluids that are heavy compared with the structure. spar adds it to the\nmember's equations and corrects the pushed loads by the same mass times the acceleration. The converged solution,\nweight, energies, modes and statics do not contain it. With mass m and added mass m_a, iterations contract by\n|m_a - estimate| / (m + estimate) instead of m_a / m; an overestimate is safe there. Explicit coupling is stable\nwhile (m_a - estimate) / (m + estimate) is below 1, 1/3 or 1/7 for predictor order 0, 1 or 2. With explicit\ncoupling an overestimate destabilises the structure's modes: when in doubt, underestimate. With substeps the\nanswer differs by dt^2 from that without an estimate. Without INERTIA it has no effect. Before the commit.\nDefault: none.\n  n: in, stations of a beam, linear between, constant beyond; 1 for a rigid body; 0: none\n  eta[n]: in, of a beam, strictly increasing in [0,1]; else ignored\n  mass[n][36]: in, symmetric, positive semidefinite; of a beam per length in section axes, kg/m, kg, kg m; of a rigid\n        body about its node in its own axes, kg, kg m, kg m^2\nSPAR_ERR_UNSUPPORTED: a point; at the commit: external and prescribed members.",
    "spar_member_get_added_mass": "n: out, stations, NULL: not wanted\ncapacity: in, of the arrays; n is enough\neta[capacity]: out, NULL: not wanted\nmass[capacity][36]: out, NULL: not wanted",
    "spar_member_set_added_mass_response": "Says what the fluid's added mass responds to, given or learned. The prediction of the loads depends on it, so\nexplicit coupling with a heavy fluid needs the right one. The loads of all fluids on a member are predicted with\none added mass, on all ranks alike: hence this belongs to the member. Steps with substeps take accelerations in\nany case.\n  response: in, SPAR_RESPONSE_*, default SPAR_RESPONSE_ACCELERATION\nLocal, before commit; the ranks must agree, which spar_member_commit checks. SPAR_ERR_UNSUPPORTED: a point.",
    "spar_member_get_added_mass_response": "response: out. Local.",
    "spar_session_solve_initial": "Computes consistent initial accelerations and fluid loads at t = 0. Positions and velocities stay. Use it before the\nfirst step with a fluid that has added mass: without it the run is of first order in dt. solve is called as in\nspar_step, with dt = 0, and iterated by the session's scheme (explicit: by IQN-ILS). Added mass that was given has no\npart in it. Repeat the call after a change of loads or initial velocities. After a failure all is as it was.\nCollective, before the first step.\n  dt: in, s, > 0, length of the first step; parts that it does not resolve get the accelerations of such a step\n  solve: in, NULL: no fluid on this rank\n  context: in, handed to solve\n  iterations: out, calls of solve, also after a failure, NULL: not wanted\nSPAR_ERR_STATE: a step has been accepted; SPAR_ERR_NUMERIC: no convergence, or a singular mass.",
    "spar_step_begin_initial": "The same for a host with its own loop, in place of spar_step_begin before the first step: then spar_step_solve, pull,\npush, spar_step_check until done, spar_step_accept. The clock stays at t = 0. Collective.\n  dt: in, s, > 0",
    "spar_session_solve_static": "Static equilibrium of all members with the fluid's loads at their deformed shape: the trim of a wing, a flag in\nsteady flow. solve is called as in spar_step, with dt = 0, and iterated by the session's scheme until the loads agree\n(explicit: once). Each iteration solves the members as spar_member_solve_static does. Afterwards steps begin at rest\nfrom this state. Collective, between steps.\n  load_steps: in, 1 to 100000, parts of the loads in the first iteration\n  solve: in, NULL: no fluid on this rank; pushed loads stay\n  context: in, handed to solve\n  iterations: out, calls of solve, also after a failure, NULL: not wanted\nPoints and external members stay, or move where solve puts them. The log is warned if Aitken or IQN-ILS found an\nequilibrium that a run would leave (static divergence). Failures as of spar_member_solve_static; SPAR_ERR_NUMERIC: no\nconvergence in max_iterations. After a failure all is as it was.",
    "spar_session_set_tolerance": "Tolerance of the time integration. The local error of a step divided by dt, as a velocity (root mean square over the\nmember's nodes, relative to a driven root), is kept below drift + rtol * (largest velocity so far). It is estimated\nfrom the change of acceleration. It does not accumulate over the run, and contains neither jumps of loads nor the\nerror of explicit coupling (SPAR_REPORT_ERROR). Members without inertia, or moved by the host, have no error.\n  drift: in, m/s, >= 0; 0 with rtol 0 (default): no tolerance\n  rtol: in, 0 to 1; > 0 only with drift > 0; about the part of the amplitude lost in one radian of motion",
    "spar_session_get_tolerance": "drift: out, NULL: not wanted\nrtol: out, NULL: not wanted",
    "spar_session_get_step_control": "What step-size control says. Between solve and accept it is about the step in progress: reject the step if `reject`\nis 1, otherwise accept it. Then begin the next step with next_dt, or a smaller dt. Between steps it is about the last\naccepted step.\n  ratio: out, error over tolerance, the largest of all members; 0 in a first step without\n        spar_session_solve_initial, where the initial accelerations are not known, NULL: not wanted\n  next_dt: out, s, dt of the next step, or of the next try if the step is rejected: 0.2 to 2 times this step's, by a\n        PI controller. Small changes are not proposed, because they would only cost new tangents, NULL: not wanted\n  reject: out, 1: the step in progress exceeds the tolerance, NULL: not wanted\n  rejected: out, number of steps rejected so far because of their error, NULL: not wanted\nLocal, the same on every rank. SPAR_ERR_STATE: no tolerance is set, or no step was solved since.",
    "spar_step_adaptive": "Makes one step that keeps the tolerance: it tries dt, and smaller ones while the error is too large. before and solve\nare called again for the same t with another dt, so the fluid must be able to return to t^n. Collective.\n  dt: in, s, to try; out, for the next step\n  before: in, called before each try, on all ranks or none, NULL: nothing to do\n  solve: in, as of spar_step\n  context: in, handed to both\n  taken: out, s, length of the accepted step, NULL: not wanted\nTo meet a given time, pass the smaller of the two dt. After a failure the session is at t^n and dt is unchanged.\nSPAR_ERR_STATE: no tolerance; SPAR_ERR_NUMERIC: 12 tries failed, or 7 without progress; the message names the\nlimit.",
    "spar_session_set_reproducible": "Reproducible sums: nodal loads have the same bits for any number of ranks, any distribution and order of the fluid\nnodes, and any vector width. Choose them to compare runs on different numbers of ranks. They must be on before forces\nare pushed, for up to 2^28 force nodes of a member. docs/explanation/accuracy.md has the cost.\n  on: in, 1 or 0 (default)",
    "spar_session_get_reproducible": "on: out",
    "spar_session_set_threads": "Threads of this rank, which share the work inside solve, map, pull and push. Results have the same bits with any\nnumber. Callbacks and MPI calls stay in the calling thread (MPI_THREAD_FUNNELED is enough). After a fork the\nchild has one thread until it sets more. Between steps; ranks may differ.\n  threads: in, 1 (default) to 64; at most cores / ranks\nSPAR_ERR_MEMORY: the system gives no more threads; all is as before.",
    "spar_session_get_threads": "threads: out",
    "spar_member_set_owner": "Chooses the rank that solves the member; it needs no fluid nodes. Default: at the first step members are assigned to\nthe least loaded rank, most expensive first, by estimated cost. Connected members are solved by one rank.\n  rank: in",
    "spar_member_get_owner": "rank: out, who solves the member, or would before the first step",
    "spar_session_sum_balance": "How the work is distributed over the ranks. Collective; ranks may ask for different outputs.\n  capacity: in, of the arrays; ranks is enough, their number; entries beyond are 0\n  members[capacity]: out, members solved by each rank, NULL: not wanted\n  expected[capacity]: out, estimated instructions per iteration, NULL: not wanted\n  counted[capacity]: out, Newton's iterations so far, each weighed by what is expected of its member, without joints;\n        NULL: not wanted",
    "spar_session_sum": "Sums numbers over the ranks, for models built on the library; with n = 0 the ranks agree on a status. Collective,\nat any time.\n  status: in, SPAR_OK, or this rank's failure: answered here; other ranks answer SPAR_ERR_PEER with its message\n  n: in, the same on all ranks\n  x[n]: in, this rank's; out, the sums, the same bits on all ranks; unchanged after a failure",
    "spar_session_fail": "Writes the message of a failure outside this library, so that it is found where the library's own are: for a solver\nthat is called by spar_step, and for libraries on top of this one. It goes to the log as SPAR_LOG_ERROR.\n  session: in, NULL: the message of this thread\n  status: in, a SPAR_ERR_*; SPAR_OK: the message alone is written, as by who restores an earlier one\n  message: in, what, where, the cure; copied, at most 1023 characters; empty with SPAR_OK alone\nLocal. SPAR_ERR_ARGUMENT: no status, or no message.",
    "spar_fluid_get_member": "member: out, the member of the fluid",
    "spar_fluid_get_name": "The name given at creation; \"\" for NULL.",
    "spar_fluid_set_motion_stations": "Sets the motion nodes alone by their coordinate along the line. The force nodes stay: those of\nspar_fluid_set_force_nodes, or of spar_fluid_set_stations with the forces that are kept. For actuator lines that\nsample velocities at fewer or other stations than they spread forces from (AMR-Wind), or at three quarters of the\nchord. Call spar_fluid_map afterwards.\n  n: in\n  eta[n]: in, in [0,1], as of spar_fluid_set_stations\n  offset[n][3]: in, m, as of spar_fluid_set_stations, NULL: 0\nLocal. SPAR_ERR_ARGUMENT: eta lies outside [0,1].",
    "spar_fluid_set_motion_weights": "Weights of the motion nodes, with which a whole mesh can follow the structure: 1 on the wetted surface, less with the\ndistance, 0 where the mesh is fixed. A node at X that the section moves to x is pulled at X + w (x - X), with\nvelocity w v and acceleration w a. Two fluids whose weights add to 1 blend the motion of two members. Loads are\nnot weighed. Weights set after spar_fluid_fade_motion replace the fade: lever arms rotate at full length, and the\nvolumes of the mesh are not watched. While there are weights, pulls of orientation, angular velocity and angular\nacceleration are SPAR_ERR_UNSUPPORTED. New motion nodes remove the weights. Not for stations (SPAR_ERR_STATE). Not\nsaved.\n  n: in, 0: no weights (default), else motion_nodes\n  w[n]: in, in [0,1], NULL: none, with n = 0",
    "spar_fluid_get_motion_weights": "w[motion_nodes]: out, 1 without weights",
    "spar_fluid_fade_motion": "Sets weights that decrease with a distance d. With s = (d - within) / (beyond - within) the weight is 1 for s <= 0\nand 0 for s >= 1. Between 1/6 and 5/6 it is 1.1 - 1.2 s, before 1 - 43.2 s^3 + 129.6 s^4, behind the mirror image.\nIf d is the distance from the reference line, two things are added. The section's rotation acts on a limited lever\narm: the true arm up to `within`, twice `within` from 3 times `within` on. And each pull computes the least Jacobian\nof the motion: it warns, once, when cells keep less than a fifth of their volume, and where they fold the pull is\nSPAR_ERR_NUMERIC. Far from the line they fold when a section has rotated by a right angle.\n  within: in, m, must contain the body's section if the distance is that from the line\n  beyond: in, m, > within, some 1.5 times as far from it as the member moves, or more\n  n: in, motion_nodes\n  distance[n]: in, m, NULL: from the reference line of the committed member\n  held[n]: in, not 0: weight 0, NULL: none",
    "spar_fluid_set_layout": "Layout of the arrays [motion_nodes][3] or [force_nodes][3] of this rank: component i of node j stands at\nj * node + i * component. It holds for positions, velocities and accelerations pulled at motion nodes and for what is\npushed or pulled at force nodes, in both precisions. Quaternions, matrices, nodes and getters stay packed. New nodes\nreset it. Not saved. Not for fluids of spar_aero.\n  which: in, SPAR_NODES_*\n  node: in, 1 to 2^40, numbers between neighbouring nodes\n  component: in, 1 to 2^40: (3, 1) packed (default), (1, n) by component, (8, 1) in records of eight\nSPAR_ERR_ARGUMENT: two numbers would share a position.",
    "spar_fluid_get_layout": "which: in, SPAR_NODES_*\nnode: out, NULL: not wanted\ncomponent: out, NULL: not wanted",
    "spar_fluid_set_projection": "How nearest points are found by the next spar_fluid_map.\n  method: in, SPAR_PROJECT_*, default bounded\n  max_distance: in, m; nodes farther away get SPAR_MAP_FAR, or are refused (option far of the fluid); <= 0: no limit\n        (default)",
    "spar_fluid_get_projection": "method: out, NULL: not wanted\nmax_distance: out, NULL: not wanted",
    "spar_fluid_set_interpolation": "kind: in, SPAR_INTERPOLATE_*, default nodal. Choose consistent if the fluid integrates velocities itself",
    "spar_fluid_get_interpolation": "kind: out",
    "spar_fluid_set_option": "Options of a fluid, by name. Each concerns the nodes of this rank alone; ranks may differ.\n  key: in\n  value: in\ntheta    average (default) | group: a pull at 0 < theta < 1 gives the average of the states at both ends (T12), or\n         the motion of the member's nodes interpolated on the group. The average cuts the corner of a rotation\nfar      take (default) | refuse: spar_fluid_map flags nodes beyond max_distance (spar_fluid_set_projection), or is\n         SPAR_ERR_MAPPING\naudit    on (default) | off: whether a push computes the figures of spar_fluid_get_audit\nvelocity pulled (default) | own: own: the fluid needs no velocities, or finds them from its moving mesh; there is no\n         warning if positions are pulled and velocities are not\nramp     0 (default) | seconds: all pushed forces and moments are multiplied by a factor that rises linearly from 0\n         to 1 over this time, or falls from 1 to 0 over -ramp if it is negative. The product is what spar knows as\n         the loads of the fluid, in sums and in spar_fluid_pull_forces too. Two fluids with ramps T and -T blend\n         from one source of loads to another\nramp.start 0 (default) | seconds: time of the session at which the ramp begins\nLocal, between steps and not in a trial. SPAR_ERR_ARGUMENT: no such key or value; the message lists them.",
    "spar_fluid_get_option": "The value of an option, as a text that spar_fluid_set_option takes.\n  key: in\n  capacity: in, of the text with its end; 32 is enough\n  text[capacity]: out\nLocal. SPAR_ERR_ARGUMENT: no such key, or the capacity is too small.",
    "spar_fluid_map_current": "As spar_fluid_map, but positions that are new are those of the present configuration, of the member as\nspar_fluid_get_positions has it between steps: for a flow that meshes the deformed shape anew, or restarts from a\ndeformed mesh. Each node gets the reference position that the present motion moves where it is; from then on it is as\nif that had been given. Stations mean what they mean to spar_fluid_map. Loads stay until the next push.\nSPAR_ERR_UNSUPPORTED: motion nodes with weights; SPAR_ERR_MAPPING: as of spar_fluid_map, or a node has no such\nreference position, because the member is folded there.",
    "spar_fluid_get_count": "which: in, SPAR_NODES_*\nn: out, nodes of the set on this rank",
    "spar_fluid_get_kind": "which: in, SPAR_NODES_*\nkind: out, SPAR_KIND_* combined",
    "spar_fluid_get_flag_count": "which: in, SPAR_NODES_*\nflag: in, one SPAR_MAP_*\nn: out, how many nodes of the set have it",
    "spar_fluid_get_map": "The nearest point of each node on the line, as spar_fluid_map has found it.\n  which: in, SPAR_NODES_*\n  eta[which_nodes]: out, of the nearest point, in [0,1]; 0.5 on a point or rigid body, NULL: not wanted\n  distance[which_nodes]: out, m, from the nearest point to the node, NULL: not wanted\n  flags[which_nodes]: out, SPAR_MAP_* or-ed, NULL: not wanted\nLocal. SPAR_ERR_STATE: the nodes are not mapped.",
    "spar_fluid_get_nearest": "The nearest points.\n  which: in, SPAR_NODES_*\n  x_map[which_nodes][3]: out, position in the reference configuration, m, NULL: not wanted\n  q_map[which_nodes][4]: out, section frame there, NULL: not wanted\n  con[which_nodes][3]: out, lever arm c of (T3), from the nearest point to the node, m, NULL: not wanted",
    "spar_fluid_get_basis": "The interpolation at the nearest points.\n  which: in, SPAR_NODES_*\n  first_node[which_nodes]: out, node of the member at which the basis values begin, NULL: not wanted\n  phi[which_nodes][P]: out, basis values, P the nodes per element; 1 on a point or rigid body, NULL: not wanted",
    "spar_fluid_get_travel": "Largest displacement of this rank's motion nodes since t^n, in the latest iterate; 0 between steps.\n  largest: out, m, NULL: not wanted\n  node: out, which node, the first of equals, -1: there are none, NULL: not wanted",
    "spar_fluid_get_positions": "The nodes of one set at t^{n+1} in the latest iterate, between steps at t^n: for pictures and post-processing. A\ngetter: it does not count as a pull, and a trial that switches effects off does not change it.\n  which: in, SPAR_NODES_*\n  x[which_nodes][3]: out, m, position, NULL: not wanted; nodes with weights follow in part, as in pulls\n  q[which_nodes][4]: out, orientation of the section at the nearest point, scalar part >= 0, NULL: not wanted\n  v[which_nodes][3]: out, m/s, NULL: not wanted\n  nearest[which_nodes][3]: out, m, position of the nearest point on the line, NULL: not wanted\nLocal.",
    "spar_fluid_pull_matrices": "Orientations of the motion nodes as matrices at t^n + theta dt.\n  theta: in, in [0,1]\n  convention: in, SPAR_MATRIX_*\n  matrix[motion_nodes][9]: out",
    "spar_fluid_check_matrices": "Compares a host's own matrices with those that spar_fluid_pull_matrices gives at t^{n+1}, to 1e-5. For start-up; it\nallocates.\n  convention: in, SPAR_MATRIX_*\n  matrix[motion_nodes][9]: in\nSPAR_ERR_ARGUMENT: they differ. The message names a transposed matrix, a determinant of -1, a matrix that is no\nrotation, or the angle between both.",
    "spar_fluid_pull_forces": "The fluid's own node forces at t^n + theta dt, for actuator lines. At t^{n+1} they are the pushed ones, or predicted\nbefore the first push of the step; 0 before the first push of all. As many stations given anew keep the forces of\nthose before. For other nodes given anew the forces pushed first count at t^n too.\n  theta: in, in [0,1]\n  force[force_nodes][3]: out, N\nSPAR_ERR_STATE: they are not kept (SPAR_EFFECT_FLUID_HISTORY), or the nodes are new, the fluid has loads, and no\nforces of these nodes have been pushed yet.",
    "spar_fluid_get_forces": "The same at t^{n+1} as a getter, for output.\n  force[force_nodes][3]: out, N\nSPAR_ERR_STATE: they are not kept, or not known (SPAR_KIND_FORCES).",
    "spar_fluid_push_forces_at": "Pushes loads of a fluid that makes several steps within dt: the mean loads over the part of the step that ends at\nt^n + theta dt. The loads in use at t^{n+1} are m + (e - e^n) / 2, (T13). m is the mean of the parts so far. e and\ne^n are the ends of the least-squares lines through the parts of this step and of the step before. This is of\nsecond order in dt and keeps the impulse. Use spar_fluid_push_forces for loads known at t^{n+1}. Not before the\nfirst step.\n  theta: in, in (0, 1], increasing; a smaller one begins a new iteration\n  force[force_nodes][3]: in, N\n  moment[force_nodes][3]: in, N m, about each node, NULL: none",
    "spar_fluid_set_states": "States of the host's model at each force node: wakes, stall, friction. Pull returns the states at t^n. When the\nstep is accepted, the states pushed last become the new t^n states; when it is rejected, they are discarded. They\nare saved, loaded (matched by position, on any ranks) and restored after trials. They are 0 at first and after a\nnew map. Between steps.\n  width: in, numbers per node, 0 to 1000, 0: none (default)",
    "spar_fluid_get_states": "width: out, numbers per node, NULL: not wanted\ndt: out, s, from the states that are pulled to those pushed now; 0 between steps and where time stands (static\n        solution, initial conditions): push a steady state there; NULL: not wanted",
    "spar_fluid_pull_states": "width: in, as set\nstates[force_nodes][width]: out, at t^n, by force node",
    "spar_fluid_push_states": "Without a push the states at t^n stay.\n  width: in, as set\n  states[force_nodes][width]: in, at t^{n+1}, or at t = 0 before the first step",
    "spar_fluid_pull_motion_f32": "The calls of each iteration for hosts in single precision. Numbers are converted on the way in and out; all sums\nare in double precision. spar_fluid_pull_motion:\n  theta: in, in [0,1]\n  x[motion_nodes][3]: out, m, NULL: not wanted\n  v[motion_nodes][3]: out, m/s, NULL: not wanted",
    "spar_fluid_pull_poses_f32": "spar_fluid_pull_poses in single precision.\n  which: in, SPAR_NODES_*\n  theta: in, in [0,1]\n  x[which_nodes][3]: out, m, NULL: not wanted\n  q[which_nodes][4]: out, NULL: not wanted\n  v[which_nodes][3]: out, m/s, NULL: not wanted\n  omega[which_nodes][3]: out, rad/s, NULL: not wanted\n  accel[which_nodes][3]: out, m/s^2, NULL: not wanted\n  alpha[which_nodes][3]: out, rad/s^2, NULL: not wanted",
    "spar_fluid_pull_forces_f32": "spar_fluid_pull_forces in single precision.\n  theta: in, in [0,1]\n  force[force_nodes][3]: out, N",
    "spar_fluid_push_forces_f32": "spar_fluid_push_forces in single precision.\n  force[force_nodes][3]: in, N\n  moment[force_nodes][3]: in, N m, NULL: none",
    "spar_fluid_get_audit": "Conservation of the last push.\n  capacity: in\n  audit[capacity]: out, by SPAR_AUDIT_*",
    "spar_fluid_sum_loads": "Force and moment of the loads pushed last, on the structure where it is now, summed over all ranks. Each rank\ngives its own fluid of this name and member, one without nodes if it has none. Zero before the first push.\nCollective, but not in a fluid solver that the library calls (SPAR_ERR_STATE).\n  point[3]: in, m, global, reference of the moment, NULL: the origin\n  force[3]: out, N, NULL: not wanted\n  moment[3]: out, N m, NULL: not wanted",
    "spar_fluid_check_loads": "Compares these sums with the host's own: finds force nodes at rank borders that were pushed twice or not at all.\nCollective, as spar_fluid_sum_loads, with the same values on every rank.\n  point[3]: in, m, NULL: the origin\n  force[3]: in, N, the host's total over all ranks\n  moment[3]: in, N m, NULL: not compared\n  rtol: in, > 0, allowed difference relative to the sum of the magnitudes of all nodal loads\nSPAR_ERR_ARGUMENT: they differ; the message says by how much.",
    "spar_member_estimate_error": "Estimates the present error of a member's motion, as the root of the mean square over its nodes. In the mean over\na run the step's estimate is right to a factor of 3. The nodes' estimate is right to a factor of 4 if the run\nforgets its past within some periods; a single one may be farther off. Without damping, a frequency that is\nslightly wrong shifts the phase more and more; only trials show this (spar_trial_advise). See\ndocs/explanation/advice.md. Local, the same on all ranks; the estimate of the nodes solves up to five systems.\n  step: out, m, error of the last step, or of the step in progress once it is solved, NULL: not wanted\n  nodes: out, m, displacement towards the shape of a beam with four more nodes per element, between steps; 0: the\n        member has no shape; -1: not known (linear or modal, 24 nodes per element, a free root before the first step,\n        no solution); NULL: not wanted\nSPAR_ERR_STATE: no tolerance is set (step), within a step (nodes), in trials, static solutions and initial steps.",
    "spar_member_learn_added_mass": "Learns the fluid's added mass during iterations, from the changes of loads and accelerations, with any scheme that\niterates. Once it is known well enough, it replaces the given added mass in the equations. Then few iterations,\nfixed-point iterations or explicit steps are enough. It is the response within a step: half the added mass for a\nfluid that takes accelerations from the velocities at both ends of the step. The converged solution does not\nchange. Trials do not learn. Default: off. Local, on all ranks, before the commit.\n  n: in, stations of a beam, linear between them, at most 20; 1: constant along it, or a rigid body; 0: off\n  eta[n]: in, of a beam, strictly increasing in [0,1]; else ignored\nSPAR_ERR_UNSUPPORTED: as spar_member_set_added_mass.",
    "spar_member_get_learned_added_mass": "The added mass learned so far. The next run may start with it (spar_member_set_added_mass). Local, the same on every\nrank.\n  used: out, 1: it is in the equations from the next step on, NULL: not wanted\n  spread: out, relative error of the predicted load change, measured before each update (root mean square); about the\n        factor by which iterations will contract. Used below 1/4, no longer above 1/2. 1: too few measurements. NULL:\n        not wanted\n  n: out, stations, 0: nothing is to be learned, NULL: not wanted\n  capacity: in, of the arrays; n is enough\n  eta[capacity]: out, NULL: not wanted\n  mass[capacity][36]: out, as spar_member_set_added_mass takes it, 0 while nothing is known, NULL: not wanted",
    "spar_trial_create": "Creates a trial of the session. The session destroys it at the latest when it is destroyed itself. Local.\n  session: in, of the trial\n  trial: out, handle",
    "spar_trial_destroy": "Destroys a trial, and sets the handle to NULL. A trial that runs ends its run first. Local.\n  trial: in, out, NULL: nothing to do",
    "spar_trial_get_session": "Local.\n  session: out, of the trial",
    "spar_trial_set_steps": "Sets the steps of a run. Without them the collective calls are SPAR_ERR_STATE. Local.\n  dt: in, s, length of a step, >= 1e-100; 0 with steps 0: not set (default)\n  steps: in, number of steps, >= 1; spar_trial_run, _report_effects and _advise take multiples of 8",
    "spar_trial_get_steps": "Local.\n  dt: out, s, 0: not set, NULL: not wanted\n  steps: out, 0: not set, NULL: not wanted",
    "spar_trial_set_callbacks": "Sets the callbacks of the host, on all ranks or on none. Each has a context of its own. Local.\n  before: in, called before each step from t: drives roots, sets loads, keeps the fluid's state at t^n; NULL: none\n  before_context: in, handed to before, must live as long as the trial uses it\n  solve: in, the fluid solver, as in spar_step; NULL: no fluid, the present loads stay\n  solve_context: in, handed to solve, must live as long as the trial uses it",
    "spar_trial_set_progress": "Sets the progress callback, on all ranks or on none. If one rank stops, the others return SPAR_ERR_PEER. Local.\n  progress: in, NULL: none (default)\n  context: in, handed to progress, must live as long as the trial uses it",
    "spar_trial_run": "One run with the session as it is, for hosts that compare settings of their own. Collective. Failures as of\nspar_step.\n  compare: in, 0: later runs of this trial are compared with this one, and its own errors are 0; 1: compared with\n        that run over the same time, with any dt. SPAR_ERR_STATE: no run of the present members to compare with",
    "spar_trial_get_errors": "Differences of the last run from the run it was compared with. Each is the root mean square over members, positions\nand time, relative to that of the other run. Runs are compared at 128 even times; between steps by cubic\ninterpolation. Local. SPAR_ERR_STATE: no run so far.\n  motion: out, relative to the motion beyond that of a fixed or driven root, else since the start, NULL: not wanted\n  reaction: out, of the reactions at the roots, moments by the members' lengths, NULL: not wanted\n  load: out, of the fluid's loads, after the first step and at 8 even times, NULL: not wanted",
    "spar_trial_get_cost": "Cost of the last run. Local. SPAR_ERR_STATE: no run so far.\n  seconds: out, s, processor time of the steps and the fluid, on all ranks, NULL: not wanted\n  evaluations: out, calls of the fluid solver, NULL: not wanted",
    "spar_effect_name": "Name of an effect, such as \"gravity\", in static storage; \"\" for any other number.",
    "spar_trial_report_effects": "Finds what each effect contributes, by runs with the effect and without it in all members. Collective.",
    "spar_trial_get_effect": "One effect in the last report. Figures of an effect that is not in force are 0. Local. SPAR_ERR_STATE: no report.\n  row: in, SPAR_ROW_*\n  in_force: out, 1: the session has this effect, 0: not, NULL: not wanted\n  fails: out, 1: the run fails without it, and motion, reaction and share are 0; a log is told why, at\n        SPAR_LOG_INFO; 0: it does not; NULL: not wanted\n  size: out, NULL: not wanted. Inertia to damping, masses, foundation, pretension: nodal forces relative to the\n        largest term of the equations, root of the sum of squares over nodes, the present state and the steps.\n        Fluid: change of its loads, as load of spar_trial_get_errors. Predictor: |predicted - final| / |final|\n        loads of the last step. Iteration: added mass over mass, as the coupling sees it. Half step: (Omega dt)^2 / 8\n  motion: out, error of the motion without it, as of spar_trial_get_errors, NULL: not wanted\n  reaction: out, error of the reactions without it, likewise, NULL: not wanted\n  share: out, part of the time of a solution that is saved without it, below 0: it costs more; for predictor and\n        iteration of the time of the run; NULL: not wanted",
    "spar_trial_set_goals": "Sets the goals of the advice. Local.\n  goals: in, SPAR_GOAL_* combined with or, the tolerance holds for each of them; default SPAR_GOAL_MOTION",
    "spar_trial_get_goals": "Local.\n  goals: out, SPAR_GOAL_* combined with or",
    "spar_trial_push_numbers": "Gives numbers of the host that the advice keeps, such as thrust, power or lift. The callbacks push them in each\niteration or before a step; the last numbers of a step count. On several ranks their sum counts: each rank gives its\npart, or one rank gives them all. Local, at any time.\n  n: in, 0 to 32\n  numbers[n]: in, any unit",
    "spar_trial_set_option": "Sets an option of the advice. Local.\n  key: in, \"dt\", \"nodes\", \"coupling\": vary (default) or keep it as it is\n        \"limit\": most trials, 4 to 1000 (default 15)\n  value: in, as text",
    "spar_trial_get_option": "Reads an option of the advice. Local.\n  key: in, of spar_trial_set_option\n  capacity: in, of the text with its end; 32 is enough\n  text[capacity]: out, the value; SPAR_ERR_ARGUMENT if it does not fit",
    "spar_trial_advise": "Finds cheap settings whose error stays below a tolerance. A trial with the session as it is gives estimates of the\nerrors of steps and nodes; these propose a dt. Trials with a smaller dt, more nodes and a tight coupling confirm\nit: the error of each trial is its distance from the finest, and no less than finer trials lead one to expect.\nErrors are extrapolated to the length of the run. Where several settings are as good, the session's own are advised.\nThe session stays as it is. A log is told of each trial at SPAR_LOG_INFO.\n\nVaried are dt, the nodes per element of solved beams, the coupling and its rtol, and Newton's rtol. Costs are\ncounted (solutions, weighed by the nodes) and not timed: the same session gets the same advice each time.\nCollective.\n  tolerance: in, in (0, 1), of each goal\n  length: in, s, > 0, duration of the run that the advice is for. If it is longer than the trial's steps, their\n        errors are extrapolated by their growth in time. What only happens later, such as a gust, is not seen\nSPAR_ERR_UNSUPPORTED: no fluid solver. SPAR_ERR_NUMERIC: the trials do not converge, or no settings keep the\ntolerance; or the trials cover neither a steady state nor a full period, and so cannot be extrapolated. The message\nsays what error was reached, and what would tell more. SPAR_ERR_LIMIT: the option limit was reached first.",
    "spar_trial_get_settings": "The advised settings of the session. Local. SPAR_ERR_STATE: no advice.\n  dt: out, s, NULL: not wanted\n  substeps: out, as of spar_session_set_integrator, NULL: not wanted\n  scheme: out, SPAR_COUPLING_*, NULL: not wanted\n  coupling_rtol: out, of an iterated scheme, NULL: not wanted\n  predictor: out, order, NULL: not wanted\n  newton_rtol: out, NULL: not wanted",
    "spar_trial_get_beam": "The advised settings of a beam. Local. SPAR_ERR_STATE: no advice for this member.\n  member: in, of the session\n  fidelity: out, SPAR_FIDELITY_*, NULL: not wanted\n  modes: out, of a modal beam, else 0, NULL: not wanted\n  elements: out, NULL: not wanted\n  nodes_per_element: out, NULL: not wanted\n  points: out, for spar_beam_set_quadrature with the rule in force, 0: as described, NULL: not wanted",
    "spar_trial_get_outcome": "Errors and cost that the advice expects. Local. SPAR_ERR_STATE: no advice.\n  error: out, with the advised settings, of the goal with the largest one, NULL: not wanted\n  cost: out, of a second of the run, relative to the session as it is; 0: not known, since that fails; NULL: not\n        wanted\n  present_fails: out, 1: a run with the session as it is fails, or its dt does not resolve the motion; 0: not, NULL:\n        not wanted\n  present_error: out, of the session as it is, 0 if that fails, NULL: not wanted",
    "spar_trial_get_search": "What the search for the advice has cost. Local. SPAR_ERR_STATE: no advice.\n  runs: out, trials made, NULL: not wanted\n  work: out, their counted cost, in trials with the session as it is; 0 if that fails; NULL: not wanted",
    "spar_trial_apply": "Puts the advice in force: coupling scheme and its rtol, predictor, Newton's rtol, and the nodes per element of beams.\nThe host takes the advised dt itself.\n\nBeams with other settings are rebuilt in place. They keep handle, name, placement, root, loads and the work done on\nthem. Their motion is transferred by the interpolation of the elements, loads by its transpose, so that their sum\nstays. Accelerations follow from the balance of forces. Fluids keep handles and nodes, and are mapped again. Counts\nchange (spar_member_get_count); the host gives node numbers anew, for example of loads that it sets. Everything else\nstays to the last bit, among it rho_inf, atol of coupling and Newton, limits, options and effects. A beam whose nodes\nthe host has given has its line through the new nodes. To apply the same advice again changes nothing. Collective.\n  dt: out, s, advised, NULL: not wanted\nSPAR_ERR_STATE: no advice; members were added or described otherwise since; or a fluid has nodes that are not\nmapped. After a failure all is as before.",
    "spar_trial_set_motion": "Sets the small motions for spar_trial_solve_eigenvalues and spar_trial_solve_floquet. Local.\n  modes: in, 1 to 200 lowest undamped modes; give more until the result stays; 0: not set (default)\n  amplitude: in, >= 0, to 0.1: displacement of a node over the length of its member, or rotation in rad; 0: 1e-5 for\n        eigenvalues, 1e-4 for Floquet (default). A fluid that is solved to r of its loads needs about sqrt(r)\n  memory: in, for eigenvalues: 0 to 1000000 steps until the loads decay after a motion has ended; 0: the fluid has no\n        memory (default)",
    "spar_trial_get_motion": "Local.\n  modes: out, 0: not set, NULL: not wanted\n  amplitude: out, as set, NULL: not wanted\n  memory: out, NULL: not wanted",
    "spar_trial_solve_eigenvalues": "Eigenvalues of structure and fluid together: those of spar_member_solve_eigenvalues, with the fluid's response to\nsmall motions about the present state. That state is an equilibrium with the loads in use (spar_session_solve_static,\nor a run that has come to rest or rotates steadily). A wing flutters where the largest growth rate, over the wind\nspeed, passes 0.\n\nMembers move in runs along each of the lowest undamped modes, to and fro. Nothing is solved: the fluid solver gives\nthe loads. A fluid without memory is called 6 modes times, once in a run, for displacement, velocity and\nacceleration; it may make them from the positions at both ends of the step. A fluid with memory is called\n2 modes (22 + memory) times: the motion is a pulse of a few steps, and the loads are recorded until so many steps\nafter it. Their later decay is that of the linear system that they show. Joints that constrain or drive do not move;\nneither does what the callback before a step drives or loads (docs/explanation/stability.md).\n\nThe structure is exact in time: steps show these growth rates to the order of their integrator. Of the trial's steps\nonly dt is used. With memory, eigenvalues are found up to |lambda| dt = 1. A rotor's eigenvalues are those in a fluid\nthat is steady in the rotating frame. Collective.\n  n: in, number of eigenvalues, 0 to 2 modes\n  shift[2]: in, 1/s and rad/s: growth rate and angular frequency; the eigenvalues nearest to it are found; NULL: zero\n  eigenvalue[n][2]: out, 1/s and rad/s: growth rate and angular frequency >= 0, by their distance from the shift.\n        Those of the fluid alone are left out unless they grow\n  nodes: in, all_nodes, of all members of the session; 0 without shapes\n  shapes[n][nodes][6][2]: out, displacement and rotation of the nodes, member by member as created, real and\n        imaginary part, of unit x^H M x, NULL: not wanted\n  frame[3]: out, rad/s, as of spar_member_solve_eigenvalues, NULL: not wanted\nSPAR_ERR_STATE: no equilibrium, or other loads there. SPAR_ERR_NUMERIC: the fluid does not come to rest within the\nmemory, or fewer than n were found. SPAR_ERR_ARGUMENT: memory 0 of a fluid with states. SPAR_ERR_UNSUPPORTED: no\nfluid solver, or as of members.",
    "spar_trial_solve_floquet": "Stability of a periodic state: a rotor of two blades, or on a tower, or under its weight. Finds the eigenvalues of\nthe map of small motions over one period, Floquet's multipliers mu. The trial's steps are those of the period. Run\nuntil the state repeats, then call.\n\nRuns go through the period with the host's own steps and fluid: 4 modes + 1 runs of a period and a step. Everything\nthat spar solves for is displaced along each of its lowest undamped modes, and given a velocity along it, to and fro.\nThe multipliers are those of the steps, right to dt^2. Errors are the square of the amplitude, and the coupling's\nerror over the amplitude. Each run begins with consistent initial accelerations, for which the solver is called with\ndt 0 (spar_session_solve_initial). Newton's rtol is 1e-12 at most. The callback before each step drives roots and\njoints by the time. The fluid begins each run with its present states: what it remembers for longer than a period is\nnot seen. Collective.\n  n: in, number of multipliers, 0 to 2 modes\n  eigenvalue[n][2]: out, 1/s and rad/s: growth rate and angular frequency of log(mu) over the period, the least\n        damped first. Of a conjugate pair one is given, with a frequency from 0 to pi over the period. It is known\n        up to multiples of 2 pi over the period, and up to its sign. A growth rate > 0 is an instability\nSPAR_ERR_STATE: the state does not repeat; the message says by how much. SPAR_ERR_NUMERIC: fewer than n were found.\nSPAR_ERR_UNSUPPORTED: spar solves for nothing. Failures as of spar_step.",
    "spar_member_write_vtk": "Writes the present state of a committed member: its nodes as points, and the line through them in finer pieces.\n  path: in\nFields of every point, in global axes:\n- displacement;\n- deflection: displacement from the position that a rigid motion of the root would give, which leaves out the\n  rotation of a rotor;\n- rotation: rotation vector from the reference, of less than half a revolution;\n- section_x, section_y, section_z: axes of the section;\n- velocity, angular_velocity, acceleration, angular_acceleration;\n- node: number of the node, -1 between nodes;\n- nodal_force, nodal_moment: lumped loads in use at the nodes, 0 between nodes.\nA beam that spar solves also has section_force and section_moment in section axes (spar_beam_evaluate). The file as a\nwhole has reaction_force and reaction_moment. Local.",
    "spar_fluid_write_vtk": "Writes the present nodes of a mapped fluid on this rank. A line connects each node with its nearest point on the\nmember, so a wrong map is visible at once. Stations are also connected by a line in their order.\n  path: in\nFields of every point:\n- velocity, and section_x, section_y, section_z: the rotated axes of the line at the nearest point;\n- eta, distance, flags (SPAR_MAP_*) of the map;\n- set: 0 for the nodes, or for the motion nodes if the force nodes are another set; 1 for the force nodes;\n- force: as pushed last, 0 at motion nodes. Stations have it; nodes have it with SPAR_EFFECT_FLUID_HISTORY.\nTwo sets follow each other: motion nodes, then force nodes. After all nodes come their nearest points in the same\norder, with the values of the node and 2 more in set. Local.",
    "spar_vtk_series_add": "Adds a file to an index of files in time (.pvd), which ParaView opens as an animation. Creates the index if there is\nnone. The index is complete after every call. The message of a refusal is spar_session_message(NULL).\n  path: in, the index\n  time: in, s\n  part: in, 0, 1, ... if several files show one time\n  file: in, relative to the index\nLocal.",
    "spar_polar_create": "Creates a polar, a table of coefficients. A table over a full turn must have the same coefficients in its first and\nlast row, and is periodic. Outside a shorter table the nearer end is used, and the section is flagged. A refusal\nnames the row (spar_session_message(NULL)).\n  n: in, rows, >= 2\n  alpha_rad[n]: in, strictly increasing, over a full turn at most\n  cl[n]: in\n  cd[n]: in\n  cm[n]: in, NULL: 0\n  polar: out",
    "spar_polar_set_interpolation": "Interpolation between the rows. Sections that were set before keep their table.\n  kind: in, SPAR_POLAR_*, default linear",
    "spar_polar_evaluate": "Coefficients at one angle.\n  alpha_rad: in\n  cl: out, NULL: not wanted\n  cd: out, NULL: not wanted\n  cm: out, NULL: not wanted",
    "spar_polar_destroy": "Destroys a polar; NULL is legal. Sections that use it keep its table.\n  polar: in; out, NULL",
    "spar_aero_create": "Creates a rotor or wing. The fluids stay the caller's. They must exist until the last call of spar_aero_solve,\nspar_aero_read_aerodyn and spar_aero_set_effects. After a new map create a new object.\n  blades: in, on this rank; 0 with NULL: a rank without blades\n  sections[blades]: in, one mapped fluid per blade (spar_fluid_set_stations), all of one session, with the same\n        number, 2 or more, of sections at different positions from root to tip\n  aero: out",
    "spar_aero_destroy": "Destroys the object; NULL is legal.\n  aero: in; out, NULL",
    "spar_aero_set_section": "Describes section i of every blade.\n  i: in, 0 to sections - 1\n  chord: in, m, >= 0\n  twist: in, rad; positive rotates the leading edge into the wind and lowers the angle of attack: a left-handed\n        rotation about the section's x\n  polar: in",
    "spar_aero_get_chord": "Chord and twist of the sections, as set or read. On a rank without blades nothing is written.\n  chord[sections]: out, m, NULL: not wanted\n  twist[sections]: out, rad, in [-pi, pi], as of spar_aero_set_section, NULL: not wanted\nSPAR_ERR_STATE: a section is not described.",
    "spar_aero_get_polar": "The polar of a section, as set or read. On a rank without blades nothing is written.\n  i: in, 0 to sections - 1\n  n: out, rows, NULL: not wanted\n  capacity: in, of the arrays; n is enough\n  alpha_rad[capacity]: out, NULL: not wanted\n  cl[capacity]: out, NULL: not wanted\n  cd[capacity]: out, NULL: not wanted\n  cm[capacity]: out, NULL: not wanted\n  kind: out, SPAR_POLAR_*, NULL: not wanted\nSPAR_ERR_STATE: a section is not described.",
    "spar_fluid_read_aerodyn": "Reads a blade from AeroDyn's files (AeroDyn 15 and later): the airfoils of the primary file, the stations of the\nblade file, the tables of the airfoil files. Lengths, curve, sweep, twist and chord are linear between stations,\nand so are the coefficients between different airfoils. Every rank reads the files. After a failure all is as it was.\nSPAR_ERR_IO: a file or a field cannot be read; the message names file, line and field. SPAR_ERR_ARGUMENT: a polar or\na span is not allowed. Of several tables AFTabMod 1 takes the first, and AFTabMod 3 that of UserProp 0, linear\nbetween its neighbours, else the nearest. SPAR_ERR_UNSUPPORTED: several tables with AFTabMod 2 (Reynolds numbers).\n\nThis call sets the stations of a fluid at the aerodynamic centres (BlSpn, BlCrvAC, BlSwpAC), each attached to the\nnearest point of the line. The member must be committed. Map afterwards. BlCrvAng is not used: sections are\nperpendicular to the line.\n  primary_path: in\n  blade_path: in, NULL: the first one named by the primary file, in its folder\n  q[4]: in, AeroDyn's blade axes z (along the blade), x (downwind), y (to the trailing edge), in this order, in the\n        member's own frame, whose origin is the blade's root; NULL: none, as spar_beam_read_beamdyn makes a blade\n  n: in, number of sections; 0 with span NULL: as many as the file has stations\n  span[n]: in, m, from the root, between the first and the last station, NULL: those of the stations",
    "spar_aero_read_aerodyn": "Sets chord, twist and polar of all sections from the same files. The twist is BlTwist (positive: the leading edge\ngoes upwind) less the twist of the sections' frames. Without UseBlCm moments are 0. InterpOrd 3 gives\nSPAR_POLAR_CUBIC.\n  primary_path: in\n  blade_path: in, NULL: as above\n  q[4]: in, NULL: as above\n  span[sections]: in, m, NULL: those of the stations\nSPAR_ERR_UNSUPPORTED: after spar_aero_set_turn with -1. Other failures as above.",
    "spar_aero_set_rotor": "Sets the shaft. The first call also stores the sections' distances from the axis in the reference configuration, for\nthe tip and hub losses. Later calls move the shaft.\n  hub[3]: in, m, a point of its axis\n  axis[3]: in, direction of the axis, downwind, not 0\n  hub_radius: in, m, from the axis to the begin of the blades\n  tip_radius: in, m, from the axis to the tips",
    "spar_aero_set_turn": "Direction of rotation that the blades are made for. Either may rotate backwards; then the flow meets the trailing\nedges.\n  turn: in, 1 (default): right-handed about the downwind axis (clockwise seen from upwind), section z towards the\n        pressure side; -1: the mirror image, section z towards the suction side, positive twist right-handed\n        about x",
    "spar_aero_set_blades": "Number of blades of the whole rotor, for the solidity, if other ranks hold some of them.\n  total: in, default: the number given to spar_aero_create",
    "spar_aero_set_shear": "Wind shear. The inflow given to spar_aero_solve is that at a reference height. Each section sees it times a factor of\nits present height z:\n  SPAR_SHEAR_POWER   (z / height)^parameter, 0 for z <= 0\n  SPAR_SHEAR_LOG     ln(z / parameter) / ln(height / parameter), 0 for z <= parameter\n  SPAR_SHEAR_LINEAR  1 + parameter (z - height), at least 0\nIt is on from the first call on, unless spar_aero_set_effects was called. On a rank without blades it does nothing.\n  law: in, SPAR_SHEAR_*\n  ground[3]: in, m, a point of height 0\n  up[3]: in, direction of height, not 0\n  height: in, m, > 0, reference height\n  parameter: in, exponent, >= 0; roughness length, m, > 0 and below height; slope, 1/m",
    "spar_aero_set_tower": "Tower shadow: the wind around a round tower, by potential flow. At the distance rho from the axis the wind across the\ntower (after shear) changes by (R / rho)^2 times its mirror image: it is 0 on the surface before the tower and\ndoubles beside it. R is linear between the ends. Near the top the change is multiplied by\n(1 + t / sqrt(t^2 + rho^2)) / 2, with the distance t below the top (a line of dipoles that ends there). The wake\nbehind the tower is not modelled. On from the first call on, unless spar_aero_set_effects was called; a later\ncall moves the tower. On a rank without blades it does nothing.\n  base[3]: in, m, of the axis\n  top[3]: in, m, of the axis\n  base_radius: in, m, > 0\n  top_radius: in, m, > 0",
    "spar_aero_set_effects": "Chooses the effects. Default: drag; moments if a polar has any; all of momentum theory once the rotor is set;\nshear and tower once these are set.\n  effects: in, SPAR_AERO_* combined\nInflow, stall and unsteady have memory, integrated exactly for input that is linear in a step ((T27) to (T30) of\ndocs/explanation/theory.md). They begin with the steady state, and have it in static and initial solutions. Their\nmemory is kept as states of the fluids (spar_fluid_set_states), so iterations, rejected steps, trials, save and\nload treat it rightly. Momentum theory takes the static polar's lift. Stall acts on lift; attached flow is the\nsteepest line from the angle without lift; its time constant is 4 c / V. Unsteady takes the flow at three quarters\nof the chord and pushes moments; it uses accelerations, so begin with spar_session_solve_initial.\nSPAR_ERR_STATE: one of these three is switched on during a step, or the fluids have states of the host.",
    "spar_aero_solve": "Pulls the motion, computes the loads in the wind, and pushes them.\n  density: in, kg/m^3\n  inflow[blades][sections][3]: in, m/s, global axes, undisturbed by the rotor; with shear, at its reference height\n  theta: in, as of spar_fluid_pull_motion; 1 in steps with effects that have memory\nLoads per length are linear between sections, and zero beyond the first and the last. An interval of the length L\ngives its ends the consistent shares L/6 (2 f1 + f2) and L/6 (f1 + 2 f2). The same input gives the same result.\nAfter a failure the loads are as they were, and the check of the current step fails on all ranks unless a later call\nsucceeds.",
    "spar_aero_get_rotor": "Rotor figures of the blades on this rank in the last solve; needs spar_aero_set_rotor.\n  thrust: out, N, force along the axis, NULL: not wanted\n  torque: out, N m, right-handed about the axis, NULL: not wanted\n  power: out, W, torque times rotor speed (mean angular velocity of the first sections about the axis), NULL: not\n        wanted",
    "spar_aero_get_sections": "Sections in the last solve.\n  alpha[blades][sections]: out, rad, angle of attack, NULL: not wanted\n  cl[blades][sections]: out, NULL: not wanted\n  cd[blades][sections]: out, NULL: not wanted\n  a[blades][sections]: out, axial induction, the flow across the disc is (1 - a) of the free flow, NULL: not wanted\n  a_tangential[blades][sections]: out, the flow along the disc is (1 + a_tangential) of the free flow, 0 if that is\n        0, NULL: not wanted",
    "spar_aero_get_flags": "Flags in the last solve.\n  flags[blades][sections]: out, SPAR_AERO_FLAG_* combined, NULL: not wanted\n  no_root: out, number of sections without a root, NULL: not wanted",
    "spar_aero_get_loads": "Loads in the last solve, in global axes.\n  per_length[blades][sections][6]: out, N/m, N m/m, force and moment per unit of span, NULL: not wanted\n  force[blades][sections][3]: out, N, as pushed, NULL: not wanted\n  moment[blades][sections][3]: out, N m, as pushed, NULL: not wanted",
    "spar_aero_effect_name": "Name of a row, \"tip loss\"; static storage; \"\" for what is no row.",
    "spar_aero_report_effects": "Finds what each effect of this object contributes, by runs of a trial with the effect and without it\n(spar_trial_run). An effect is in force on all ranks where it is in force on any: it is on, and has something to do\n(losses and swirl with induction, hub loss with a hub radius, moments with polars that have some). The effects are\nthe same afterwards, also after a failure. The results of the last solve are those of a run. The trial compares later\nruns with the one with all effects. Collective over the session of the trial.\n  trial: in, with steps and callbacks; its fluid solver calls spar_aero_solve on this object\nSPAR_ERR_STATE: its fluid solver does not. Other failures as of spar_trial_run.",
    "spar_aero_get_effect": "One effect in the last report. Figures of an effect that is not in force are 0. Local. SPAR_ERR_STATE: no report.\n  row: in, SPAR_AERO_ROW_*\n  in_force: out, 1: the object has this effect, 0: not, NULL: not wanted\n  fails: out, 1: the run fails without it, and all figures are 0; 0: it does not; NULL: not wanted\n  size: out, change of the fluid's loads without it, as load of spar_trial_get_errors, NULL: not wanted\n  motion: out, error of the motion without it, likewise, NULL: not wanted\n  reaction: out, error of the reactions without it, likewise, NULL: not wanted\n  share: out, part of the time of a solution that is saved without it, below 0: it costs more, NULL: not wanted",
}
