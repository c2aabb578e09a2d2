"""The interface, as cmake/interface.awk reads it. Written by cmake/make-bindings.sh from the headers."""
TABLE = """
constants SPAR_OK=0 SPAR_ERR_ARGUMENT=1 SPAR_ERR_STATE=2 SPAR_ERR_MEMORY=3 SPAR_ERR_NUMERIC=4 SPAR_ERR_MAPPING=5 SPAR_ERR_COMM=6 SPAR_ERR_PEER=7 SPAR_ERR_IO=8 SPAR_ERR_UNSUPPORTED=9 SPAR_ERR_USER=10 SPAR_ERR_LIMIT=11
call spar_session_message text session|session|value|
call spar_status_text text status|int|value|
call spar_version text
call spar_has int feature|char|in|[]
call spar_session_create int session|session|out|
call spar_session_create_fcomm int comm|int|value| session|session|out|
call spar_session_destroy none session|session|out|
call spar_step_begin int session|session|value| dt|double|value|
call spar_step_solve int session|session|value|
call spar_step_check int session|session|value| done|int|out|
call spar_step_accept int session|session|value|
call spar_step_reject int session|session|value|
call spar_fluid_pull_motion int fluid|fluid|value| theta|double|value| x|double|out|[n][3] v|double|out|[n][3]
call spar_fluid_push_forces int fluid|fluid|value| force|double|in|[n][3] moment|double|in|[n][3]
call spar_fluid_fail int fluid|fluid|value| status|int|value| message|char|in|[]
call spar_step int session|session|value| dt|double|value| solve|fluid_solver|callback| context|context|value| iterations|int|out|
call spar_session_set_gravity int session|session|value| g|double|in|[3]
call spar_session_get_gravity int session|session|value| g|double|out|[3]
constants SPAR_COUPLING_EXPLICIT=0 SPAR_COUPLING_FIXED_POINT=1 SPAR_COUPLING_AITKEN=2 SPAR_COUPLING_IQN_ILS=3
call spar_session_set_coupling int session|session|value| scheme|int|value| atol|double|value| rtol|double|value| max_iterations|int|value|
call spar_session_get_coupling int session|session|value| scheme|int|out| atol|double|out| rtol|double|out| max_iterations|int|out|
call spar_session_get_time int session|session|value| t|double|out| step|int64_t|out| iteration|int|out|
constants SPAR_LOG_ERROR=0 SPAR_LOG_WARNING=1 SPAR_LOG_INFO=2
call spar_session_set_log int session|session|value| log|log|callback| context|context|value|
call spar_session_get_warning text session|session|value| i|int64_t|value|
call spar_point_create int session|session|value| name|char|in|[] x|double|in|[3] q|double|in|[4] member|member|out|
call spar_rigid_create int session|session|value| name|char|in|[] x|double|in|[3] q|double|in|[4] mass|double|in|[36] member|member|out|
call spar_beam_create int session|session|value| name|char|in|[] elements|int|value| nodes_per_element|int|value| member|member|out|
call spar_beam_set_axis int beam|member|value| n|int64_t|value| eta|double|in|[n] xyz|double|in|[n][3] twist|double|in|[n]
call spar_beam_set_sections int beam|member|value| n|int64_t|value| eta|double|in|[n] stiffness|double|in|[n][36] mass|double|in|[n][36]
call spar_member_set_placement int member|member|value| x|double|in|[3] q|double|in|[4]
constants SPAR_ROOT_FREE=0 SPAR_ROOT_FIXED=1 SPAR_ROOT_PINNED=2 SPAR_ROOT_DRIVEN=3
call spar_member_set_root int member|member|value| kind|int|value|
call spar_member_set_external int member|member|value| on|int|value|
call spar_member_set_initial_velocity int member|member|value| x0|double|in|[3] v0|double|in|[3] omega|double|in|[3]
call spar_member_commit int member|member|value|
call spar_member_get_count int member|member|value| nodes|int64_t|out|
call spar_member_get_reference int member|member|value| x|double|out|[n][3] q|double|out|[n][4]
call spar_member_get_motion int member|member|value| q|double|out|[n][7] v|double|out|[n][6] a|double|out|[n][6]
call spar_member_set_motion int member|member|value| q|double|in|[n][7] v|double|in|[n][6] a|double|in|[n][6]
call spar_member_drive int member|member|value| q|double|in|[7] v|double|in|[6] a|double|in|[6]
constants SPAR_LOAD_DEAD=0 SPAR_LOAD_FOLLOWER=1
call spar_member_set_load int member|member|value| node|int64_t|value| kind|int|value| load|double|in|[6]
call spar_member_get_loads int member|member|value| load|double|out|[n][6]
constants SPAR_NODES_MOTION=0 SPAR_NODES_FORCE=1
call spar_fluid_create int member|member|value| name|char|in|[] fluid|fluid|out|
call spar_fluid_destroy none fluid|fluid|out|
call spar_fluid_set_motion_nodes int fluid|fluid|value| n|int64_t|value| x|double|in|[n][3]
call spar_fluid_set_force_nodes int fluid|fluid|value| n|int64_t|value| x|double|in|[n][3]
call spar_fluid_set_stations int fluid|fluid|value| n|int64_t|value| eta|double|in|[n] offset|double|in|[n][3]
call spar_fluid_map int fluid|fluid|value|
call spar_fluid_pull_poses int fluid|fluid|value| which|int|value| theta|double|value| x|double|out|[n][3] q|double|out|[n][4] v|double|out|[n][3] omega|double|out|[n][3] accel|double|out|[n][3] alpha|double|out|[n][3]
call spar_session_save int session|session|value| path|char|in|[]
call spar_session_load int session|session|value| path|char|in|[]
call spar_beam_get_elements int beam|member|value| elements|int|out| nodes_per_element|int|out|
call spar_beam_set_nodes int beam|member|value| n|int64_t|value| x|double|in|[n][3] q|double|in|[n][4]
constants SPAR_QUADRATURE_GAUSS=0 SPAR_QUADRATURE_LOBATTO=1 SPAR_QUADRATURE_SECTIONS=2
call spar_beam_set_quadrature int beam|member|value| rule|int|value| points|int|value|
call spar_beam_get_quadrature int beam|member|value| rule|int|out| points|int|out|
call spar_beam_read_beamdyn int beam|member|value| primary_path|char|in|[] blade_path|char|in|[]
call spar_beam_set_masses int beam|member|value| n|int64_t|value| eta|double|in|[n] mass|double|in|[n][36]
call spar_beam_get_masses int beam|member|value| n|int64_t|out| capacity|int64_t|value| eta|double|out|[capacity] mass|double|out|[capacity][36]
call spar_beam_set_foundation int beam|member|value| n|int64_t|value| eta|double|in|[n] stiffness|double|in|[n][3]
call spar_beam_get_foundation int beam|member|value| n|int64_t|out| capacity|int64_t|value| eta|double|out|[capacity] stiffness|double|out|[capacity][3]
call spar_beam_set_pretension int beam|member|value| n|int64_t|value| eta|double|in|[n] force|double|in|[n][6]
call spar_beam_get_pretension int beam|member|value| n|int64_t|out| capacity|int64_t|value| eta|double|out|[capacity] force|double|out|[capacity][6]
call spar_beam_set_damping int beam|member|value| mu|double|in|[6]
call spar_beam_get_damping int beam|member|value| mu|double|out|[6]
call spar_beam_set_mass_damping int beam|member|value| alpha|double|value|
call spar_beam_get_mass_damping int beam|member|value| alpha|double|out|
constants SPAR_FIDELITY_PRESCRIBED=0 SPAR_FIDELITY_RIGID=1 SPAR_FIDELITY_LINEAR=2 SPAR_FIDELITY_MODAL=3 SPAR_FIDELITY_EXACT=4
call spar_member_set_fidelity int member|member|value| kind|int|value| modes|int64_t|value|
call spar_member_get_fidelity int member|member|value| kind|int|out| modes|int64_t|out|
constants SPAR_EFFECT_INERTIA=1 SPAR_EFFECT_GYROSCOPIC=2 SPAR_EFFECT_GRAVITY=4 SPAR_EFFECT_DAMPING=8 SPAR_EFFECT_FLUID_MOMENT=32 SPAR_EFFECT_FLUID_HISTORY=64 SPAR_EFFECT_WORK=128 SPAR_EFFECT_MASSES=512 SPAR_EFFECT_FOUNDATION=1024 SPAR_EFFECT_PRETENSION=2048
call spar_member_set_effects int member|member|value| switch_on|int|value| switch_off|int|value|
call spar_member_get_effects int member|member|value| effects|int|out|
call spar_member_get_placement int member|member|value| x|double|out|[3] q|double|out|[4]
call spar_member_get_root int member|member|value| kind|int|out|
call spar_member_get_external int member|member|value| on|int|out|
call spar_member_get_session int member|member|value| session|session|out|
call spar_member_get_name text member|member|value|
call spar_beam_set_line_load int beam|member|value| kind|int|value| n|int64_t|value| eta|double|in|[n] load|double|in|[n][6]
call spar_member_get_reaction int member|member|value| load|double|out|[6]
call spar_beam_evaluate int beam|member|value| n|int64_t|value| eta|double|in|[n] strain|double|out|[n][6] force|double|out|[n][6] x|double|out|[n][3] q|double|out|[n][4]
constants SPAR_ENERGY_KINETIC=0 SPAR_ENERGY_STRAIN=1 SPAR_ENERGY_GRAVITY=2 SPAR_ENERGY_DISSIPATED=3 SPAR_ENERGY_FOUNDATION=4 SPAR_ENERGY_COUNT=5
call spar_member_get_energy int member|member|value| capacity|int64_t|value| energy|double|out|[SPAR_ENERGY_COUNT]
constants SPAR_WORK_LOADS=0 SPAR_WORK_FLUID=1 SPAR_WORK_ROOT=2 SPAR_WORK_JOINTS=3 SPAR_WORK_COUNT=4
call spar_member_get_work int member|member|value| capacity|int64_t|value| work|double|out|[SPAR_WORK_COUNT]
call spar_member_solve_static int member|member|value| load_steps|int|value|
call spar_member_solve_modes int member|member|value| n|int64_t|value| frequency_hz|double|out|[n] shapes|double|out|[n][nodes][6]
call spar_member_solve_eigenvalues int member|member|value| n|int64_t|value| shift|double|in|[2] eigenvalue|double|out|[n][2] shapes|double|out|[n][nodes][6][2] frame|double|out|[3]
call spar_beam_set_modal_damping int beam|member|value| mode|int64_t|in|[2] ratio|double|in|[2] mu|double|out|[6]
constants SPAR_FREE_X=1 SPAR_FREE_Y=2 SPAR_FREE_Z=4 SPAR_FREE_RX=8 SPAR_FREE_RY=16 SPAR_FREE_RZ=32
call spar_joint_create int session|session|value| name|char|in|[] a|member|value| node_a|int64_t|value| b|member|value| node_b|int64_t|value| free_motions|int|value| joint|joint|out|
call spar_joint_set_frame int joint|joint|value| x|double|in|[3] q|double|in|[4]
call spar_joint_set_spring int joint|joint|value| stiffness|double|in|[36] damping|double|in|[36] preload|double|in|[6]
call spar_spring_create int session|session|value| name|char|in|[] member|member|value| node|int64_t|value| free_motions|int|value| stiffness|double|in|[36] damping|double|in|[36] preload|double|in|[6] joint|joint|out|
call spar_joint_set_driven int joint|joint|value| mask|int|value|
call spar_joint_drive int joint|joint|value| motion|double|in|[6] rate|double|in|[6] acceleration|double|in|[6]
call spar_joint_set_load int joint|joint|value| load|double|in|[6]
call spar_link_create int session|session|value| name|char|in|[] a|member|value| node_a|int64_t|value| point_a|double|in|[3] b|member|value| node_b|int64_t|value| point_b|double|in|[3] joint|joint|out|
call spar_link_set_spring int joint|joint|value| stiffness|double|value| damping|double|value| length|double|value| tension_only|int|value|
call spar_joint_get_motion int joint|joint|value| motion|double|out|[6] rate|double|out|[6] acceleration|double|out|[6]
call spar_joint_get_load int joint|joint|value| load|double|out|[6]
constants SPAR_JOINT_ENERGY_SPRING=0 SPAR_JOINT_ENERGY_DAMPER=1 SPAR_JOINT_ENERGY_DRIVE=2 SPAR_JOINT_ENERGY_LOAD=3 SPAR_JOINT_ENERGY_COUNT=4
call spar_joint_get_energy int joint|joint|value| capacity|int64_t|value| energy|double|out|[SPAR_JOINT_ENERGY_COUNT]
call spar_session_set_integrator int session|session|value| rho_inf|double|value| substeps|int|value|
call spar_session_get_integrator int session|session|value| rho_inf|double|out| substeps|int|out|
call spar_session_set_newton int session|session|value| atol|double|value| rtol|double|value| max_iterations|int|value|
call spar_session_get_newton int session|session|value| atol|double|out| rtol|double|out| max_iterations|int|out|
call spar_member_get_iterations int member|member|value| iterations|int64_t|out| left|double|out|
call spar_session_set_predictor int session|session|value| order|int|value|
call spar_session_get_predictor int session|session|value| order|int|out|
call spar_session_set_relaxation int session|session|value| omega|double|value|
call spar_session_get_relaxation int session|session|value| omega|double|out|
call spar_session_set_option int session|session|value| key|char|in|[] value|char|in|[]
call spar_session_get_option int session|session|value| key|char|in|[] capacity|int64_t|value| text|char|out|[capacity]
call spar_session_get_iterations int session|session|value| iterations|int|out| capacity|int64_t|value| residual|double|out|[capacity] size|double|out|[capacity]
call spar_session_get_residual int session|session|value| residual|double|out| size|double|out|
constants SPAR_REPORT_CONTRACTION=0 SPAR_REPORT_ADDED_MASS=1 SPAR_REPORT_COLUMNS=2 SPAR_REPORT_DROPPED=3 SPAR_REPORT_ERROR=4 SPAR_REPORT_WORK_DEFECT=5 SPAR_REPORT_UNCONVERGED=6 SPAR_REPORT_ADDED_MASS_SPREAD=7 SPAR_REPORT_MOTION_ERROR=8 SPAR_REPORT_COUNT=9
call spar_session_get_report int session|session|value| capacity|int64_t|value| report|double|out|[SPAR_REPORT_COUNT]
constants SPAR_PHASE_START=0 SPAR_PHASE_BETWEEN=1 SPAR_PHASE_BEGUN=2 SPAR_PHASE_SOLVED=3 SPAR_PHASE_CHECKED=4
call spar_session_get_phase int session|session|value| phase|int|out|
call spar_member_set_added_mass int member|member|value| n|int64_t|value| eta|double|in|[n] mass|double|in|[n][36]
call spar_member_get_added_mass int member|member|value| n|int64_t|out| capacity|int64_t|value| eta|double|out|[capacity] mass|double|out|[capacity][36]
constants SPAR_RESPONSE_ACCELERATION=0 SPAR_RESPONSE_VELOCITY=1
call spar_member_set_added_mass_response int member|member|value| response|int|value|
call spar_member_get_added_mass_response int member|member|value| response|int|out|
call spar_session_solve_initial int session|session|value| dt|double|value| solve|fluid_solver|callback| context|context|value| iterations|int|out|
call spar_step_begin_initial int session|session|value| dt|double|value|
call spar_session_solve_static int session|session|value| load_steps|int|value| solve|fluid_solver|callback| context|context|value| iterations|int|out|
call spar_session_set_tolerance int session|session|value| drift|double|value| rtol|double|value|
call spar_session_get_tolerance int session|session|value| drift|double|out| rtol|double|out|
call spar_session_get_step_control int session|session|value| ratio|double|out| next_dt|double|out| reject|int|out| rejected|int64_t|out|
call spar_step_adaptive int session|session|value| dt|double|out| before|before_step|callback| solve|fluid_solver|callback| context|context|value| taken|double|out|
call spar_session_set_reproducible int session|session|value| on|int|value|
call spar_session_get_reproducible int session|session|value| on|int|out|
call spar_session_set_threads int session|session|value| threads|int|value|
call spar_session_get_threads int session|session|value| threads|int|out|
call spar_member_set_owner int member|member|value| rank|int|value|
call spar_member_get_owner int member|member|value| rank|int|out|
call spar_session_sum_balance int session|session|value| capacity|int64_t|value| members|int64_t|out|[capacity] expected|double|out|[capacity] counted|double|out|[capacity]
call spar_session_sum int session|session|value| status|int|value| n|int64_t|value| x|double|out|[n]
call spar_session_fail int session|session|value| status|int|value| message|char|in|[]
call spar_fluid_get_member int fluid|fluid|value| member|member|out|
call spar_fluid_get_name text fluid|fluid|value|
call spar_fluid_set_motion_stations int fluid|fluid|value| n|int64_t|value| eta|double|in|[n] offset|double|in|[n][3]
call spar_fluid_set_motion_weights int fluid|fluid|value| n|int64_t|value| w|double|in|[n]
call spar_fluid_get_motion_weights int fluid|fluid|value| w|double|out|[n]
call spar_fluid_fade_motion int fluid|fluid|value| within|double|value| beyond|double|value| n|int64_t|value| distance|double|in|[n] held|int|in|[n]
call spar_fluid_set_layout int fluid|fluid|value| which|int|value| node|int64_t|value| component|int64_t|value|
call spar_fluid_get_layout int fluid|fluid|value| which|int|value| node|int64_t|out| component|int64_t|out|
constants SPAR_PROJECT_BOUNDED=0 SPAR_PROJECT_RPOLY=1
call spar_fluid_set_projection int fluid|fluid|value| method|int|value| max_distance|double|value|
call spar_fluid_get_projection int fluid|fluid|value| method|int|out| max_distance|double|out|
constants SPAR_INTERPOLATE_NODAL=0 SPAR_INTERPOLATE_CONSISTENT=1
call spar_fluid_set_interpolation int fluid|fluid|value| kind|int|value|
call spar_fluid_get_interpolation int fluid|fluid|value| kind|int|out|
call spar_fluid_set_option int fluid|fluid|value| key|char|in|[] value|char|in|[]
call spar_fluid_get_option int fluid|fluid|value| key|char|in|[] capacity|int64_t|value| text|char|out|[capacity]
call spar_fluid_get_count int fluid|fluid|value| which|int|value| n|int64_t|out|
constants SPAR_KIND_STATIONS=1 SPAR_KIND_SHARED=2 SPAR_KIND_WEIGHTS=4 SPAR_KIND_FORCES=8
call spar_fluid_get_kind int fluid|fluid|value| which|int|value| kind|int|out|
constants SPAR_MAP_END=1 SPAR_MAP_AMBIGUOUS=2 SPAR_MAP_FAR=4
call spar_fluid_get_flag_count int fluid|fluid|value| which|int|value| flag|int|value| n|int64_t|out|
call spar_fluid_get_map int fluid|fluid|value| which|int|value| eta|double|out|[n] distance|double|out|[n] flags|int|out|[n]
call spar_fluid_get_nearest int fluid|fluid|value| which|int|value| x_map|double|out|[n][3] q_map|double|out|[n][4] con|double|out|[n][3]
call spar_fluid_get_basis int fluid|fluid|value| which|int|value| first_node|int64_t|out|[n] phi|double|out|[n][P]
call spar_fluid_get_travel int fluid|fluid|value| largest|double|out| node|int64_t|out|
call spar_fluid_get_positions int fluid|fluid|value| which|int|value| x|double|out|[n][3] q|double|out|[n][4] v|double|out|[n][3] nearest|double|out|[n][3]
constants SPAR_MATRIX_LOCAL_TO_GLOBAL=0 SPAR_MATRIX_GLOBAL_TO_LOCAL=1
call spar_fluid_pull_matrices int fluid|fluid|value| theta|double|value| convention|int|value| matrix|double|out|[n][9]
call spar_fluid_check_matrices int fluid|fluid|value| convention|int|value| matrix|double|in|[n][9]
call spar_fluid_pull_forces int fluid|fluid|value| theta|double|value| force|double|out|[n][3]
call spar_fluid_get_forces int fluid|fluid|value| force|double|out|[n][3]
call spar_fluid_push_forces_at int fluid|fluid|value| theta|double|value| force|double|in|[n][3] moment|double|in|[n][3]
call spar_fluid_set_states int fluid|fluid|value| width|int64_t|value|
call spar_fluid_get_states int fluid|fluid|value| width|int64_t|out| dt|double|out|
call spar_fluid_pull_states int fluid|fluid|value| width|int64_t|value| states|double|out|[n][width]
call spar_fluid_push_states int fluid|fluid|value| width|int64_t|value| states|double|in|[n][width]
call spar_fluid_pull_motion_f32 int fluid|fluid|value| theta|double|value| x|float|out|[n][3] v|float|out|[n][3]
call spar_fluid_pull_poses_f32 int fluid|fluid|value| which|int|value| theta|double|value| x|float|out|[n][3] q|float|out|[n][4] v|float|out|[n][3] omega|float|out|[n][3] accel|float|out|[n][3] alpha|float|out|[n][3]
call spar_fluid_pull_forces_f32 int fluid|fluid|value| theta|double|value| force|float|out|[n][3]
call spar_fluid_push_forces_f32 int fluid|fluid|value| force|float|in|[n][3] moment|float|in|[n][3]
constants SPAR_AUDIT_FORCE=0 SPAR_AUDIT_MOMENT=1 SPAR_AUDIT_POWER=2 SPAR_AUDIT_FORCE_ERROR=3 SPAR_AUDIT_MOMENT_ERROR=4 SPAR_AUDIT_POWER_ERROR=5 SPAR_AUDIT_FARTHEST=6 SPAR_AUDIT_NODES=7 SPAR_AUDIT_COUNT=8
call spar_fluid_get_audit int fluid|fluid|value| capacity|int64_t|value| audit|double|out|[SPAR_AUDIT_COUNT]
call spar_fluid_sum_loads int fluid|fluid|value| point|double|in|[3] force|double|out|[3] moment|double|out|[3]
call spar_fluid_check_loads int fluid|fluid|value| point|double|in|[3] force|double|in|[3] moment|double|in|[3] rtol|double|value|
call spar_member_estimate_error int member|member|value| step|double|out| nodes|double|out|
call spar_member_learn_added_mass int member|member|value| n|int64_t|value| eta|double|in|[n]
call spar_member_get_learned_added_mass int member|member|value| used|int|out| spread|double|out| n|int64_t|out| capacity|int64_t|value| eta|double|out|[capacity] mass|double|out|[capacity][36]
call spar_trial_create int session|session|value| trial|trial|out|
call spar_trial_destroy none trial|trial|out|
call spar_trial_get_session int trial|trial|value| session|session|out|
call spar_trial_set_steps int trial|trial|value| dt|double|value| steps|int64_t|value|
call spar_trial_get_steps int trial|trial|value| dt|double|out| steps|int64_t|out|
call spar_trial_set_callbacks int trial|trial|value| before|before_step|callback| before_context|context|value| solve|fluid_solver|callback| solve_context|context|value|
call spar_trial_set_progress int trial|trial|value| progress|progress|callback| context|context|value|
call spar_trial_run int trial|trial|value| compare|int|value|
call spar_trial_get_errors int trial|trial|value| motion|double|out| reaction|double|out| load|double|out|
call spar_trial_get_cost int trial|trial|value| seconds|double|out| evaluations|int64_t|out|
constants SPAR_ROW_INERTIA=0 SPAR_ROW_GYROSCOPIC=1 SPAR_ROW_GRAVITY=2 SPAR_ROW_DAMPING=3 SPAR_ROW_FLUID_MOMENT=4 SPAR_ROW_FLUID_VELOCITY=5 SPAR_ROW_FLUID_POSES=6 SPAR_ROW_FLUID_HISTORY=7 SPAR_ROW_PREDICTOR=8 SPAR_ROW_ITERATION=9 SPAR_ROW_HALF_STEP=10 SPAR_ROW_MASSES=11 SPAR_ROW_FOUNDATION=12 SPAR_ROW_PRETENSION=13 SPAR_ROW_COUNT=14
call spar_effect_name text row|int|value|
call spar_trial_report_effects int trial|trial|value|
call spar_trial_get_effect int trial|trial|value| row|int|value| in_force|int|out| fails|int|out| size|double|out| motion|double|out| reaction|double|out| share|double|out|
constants SPAR_GOAL_MOTION=1 SPAR_GOAL_REACTION=2 SPAR_GOAL_SECTION=4 SPAR_GOAL_LOAD=8 SPAR_GOAL_NUMBERS=16
call spar_trial_set_goals int trial|trial|value| goals|int|value|
call spar_trial_get_goals int trial|trial|value| goals|int|out|
call spar_trial_push_numbers int trial|trial|value| n|int64_t|value| numbers|double|in|[n]
call spar_trial_set_option int trial|trial|value| key|char|in|[] value|char|in|[]
call spar_trial_get_option int trial|trial|value| key|char|in|[] capacity|int64_t|value| text|char|out|[capacity]
call spar_trial_advise int trial|trial|value| tolerance|double|value| length|double|value|
call spar_trial_get_settings int trial|trial|value| dt|double|out| substeps|int|out| scheme|int|out| coupling_rtol|double|out| predictor|int|out| newton_rtol|double|out|
call spar_trial_get_beam int trial|trial|value| member|member|value| fidelity|int|out| modes|int64_t|out| elements|int|out| nodes_per_element|int|out| points|int|out|
call spar_trial_get_outcome int trial|trial|value| error|double|out| cost|double|out| present_fails|int|out| present_error|double|out|
call spar_trial_get_search int trial|trial|value| runs|int64_t|out| skipped|int64_t|out| work|double|out| shown|double|out| saved|double|out|
call spar_trial_apply int trial|trial|value| dt|double|out|
call spar_trial_set_motion int trial|trial|value| modes|int64_t|value| amplitude|double|value| memory|int64_t|value|
call spar_trial_get_motion int trial|trial|value| modes|int64_t|out| amplitude|double|out| memory|int64_t|out|
call spar_trial_solve_eigenvalues int trial|trial|value| n|int64_t|value| shift|double|in|[2] eigenvalue|double|out|[n][2] nodes|int64_t|value| shapes|double|out|[n][nodes][6][2] frame|double|out|[3]
call spar_trial_solve_floquet int trial|trial|value| n|int64_t|value| eigenvalue|double|out|[n][2]
call spar_member_write_vtk int member|member|value| path|char|in|[]
call spar_fluid_write_vtk int fluid|fluid|value| path|char|in|[]
call spar_vtk_series_add int path|char|in|[] time|double|value| part|int|value| file|char|in|[]
constants SPAR_AERO_INDUCTION=1 SPAR_AERO_TIP_LOSS=2 SPAR_AERO_HUB_LOSS=4 SPAR_AERO_SWIRL=8 SPAR_AERO_DRAG=16 SPAR_AERO_MOMENT=32 SPAR_AERO_SHEAR=64 SPAR_AERO_TOWER=128 SPAR_AERO_INFLOW=256 SPAR_AERO_STALL=512 SPAR_AERO_UNSTEADY=1024
constants SPAR_SHEAR_POWER=0 SPAR_SHEAR_LOG=1 SPAR_SHEAR_LINEAR=2
constants SPAR_POLAR_LINEAR=0 SPAR_POLAR_AKIMA=1 SPAR_POLAR_CUBIC=2
constants SPAR_AERO_FLAG_END=1 SPAR_AERO_FLAG_NO_ROOT=2 SPAR_AERO_FLAG_BEYOND_POLAR=4 SPAR_AERO_FLAG_TOWER=8
call spar_polar_create int n|int64_t|value| alpha_rad|double|in|[n] cl|double|in|[n] cd|double|in|[n] cm|double|in|[n] polar|polar|out|
call spar_polar_set_interpolation int polar|polar|value| kind|int|value|
call spar_polar_evaluate int polar|polar|value| alpha_rad|double|value| cl|double|out| cd|double|out| cm|double|out|
call spar_polar_destroy none polar|polar|out|
call spar_aero_create int blades|int|value| sections|fluid|list|[n] aero|aero|out|
call spar_aero_destroy none aero|aero|out|
call spar_aero_set_section int aero|aero|value| i|int64_t|value| chord|double|value| twist|double|value| polar|polar|value|
call spar_aero_get_chord int aero|aero|value| chord|double|out|[n] twist|double|out|[n]
call spar_fluid_read_aerodyn int fluid|fluid|value| primary_path|char|in|[] blade_path|char|in|[] q|double|in|[4] n|int64_t|value| span|double|in|[n]
call spar_aero_read_aerodyn int aero|aero|value| primary_path|char|in|[] blade_path|char|in|[] q|double|in|[4] span|double|in|[n]
call spar_aero_set_rotor int aero|aero|value| hub|double|in|[3] axis|double|in|[3] hub_radius|double|value| tip_radius|double|value|
call spar_aero_set_turn int aero|aero|value| turn|int|value|
call spar_aero_set_blades int aero|aero|value| total|int|value|
call spar_aero_set_shear int aero|aero|value| law|int|value| ground|double|in|[3] up|double|in|[3] height|double|value| parameter|double|value|
call spar_aero_set_tower int aero|aero|value| base|double|in|[3] top|double|in|[3] base_radius|double|value| top_radius|double|value|
call spar_aero_set_effects int aero|aero|value| effects|int|value|
call spar_aero_solve int aero|aero|value| density|double|value| inflow|double|in|[blades][n][3] theta|double|value|
call spar_aero_get_rotor int aero|aero|value| thrust|double|out| torque|double|out| power|double|out|
call spar_aero_get_sections int aero|aero|value| alpha|double|out|[blades][n] cl|double|out|[blades][n] cd|double|out|[blades][n] a|double|out|[blades][n] a_tangential|double|out|[blades][n]
call spar_aero_get_flags int aero|aero|value| flags|int|out|[blades][n] no_root|int64_t|out|
call spar_aero_get_loads int aero|aero|value| per_length|double|out|[blades][n][6] force|double|out|[blades][n][3] moment|double|out|[blades][n][3]
constants SPAR_AERO_ROW_INDUCTION=0 SPAR_AERO_ROW_TIP_LOSS=1 SPAR_AERO_ROW_HUB_LOSS=2 SPAR_AERO_ROW_SWIRL=3 SPAR_AERO_ROW_DRAG=4 SPAR_AERO_ROW_MOMENT=5 SPAR_AERO_ROW_SHEAR=6 SPAR_AERO_ROW_TOWER=7 SPAR_AERO_ROW_INFLOW=8 SPAR_AERO_ROW_STALL=9 SPAR_AERO_ROW_UNSTEADY=10 SPAR_AERO_ROW_COUNT=11
call spar_aero_effect_name text row|int|value|
call spar_aero_report_effects int aero|aero|value| trial|trial|value|
call spar_aero_get_effect int aero|aero|value| row|int|value| in_force|int|out| fails|int|out| size|double|out| motion|double|out| reaction|double|out| share|double|out|
"""
