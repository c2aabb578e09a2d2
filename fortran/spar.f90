! spar: the interface of spar in Fortran. The headers under include/spar say what each call does; here is what is different.
!
!   use spar
!   type(spar_session) :: session
!   type(spar_member) :: blade
!   type(spar_fluid) :: sections
!   call session%create(comm) ! an integer communicator (mpi_f08: comm%MPI_VAL); left out: this process alone
!   call blade%create_beam(session, 'blade1', elements, nodes)
!   ...
!   call blade%commit()
!   call sections%create(blade, 'sections1')
!
! Names. A call is the C name without its first two words: spar_fluid_push_forces is fluid%push_forces, spar_beam_set_axis is
! member%set_axis. The calls of the step belong to the session: session%step_begin, ..., session%step. spar_point_create,
! spar_rigid_create and spar_beam_create are member%create_point, %create_rigid and %create_beam, spar_link_create and
! spar_link_set_spring joint%create_link and %set_link_spring, spar_spring_create joint%create_spring; a joint to the ground is
! created without b. spar_status_text, spar_version, spar_has, spar_effect_name, spar_vtk_series_add and spar_section_*
! keep their names. A session has one variable, which owns it: spar_member_get_session and spar_trial_get_session are left to hosts
! that use spar_c.
!
! Status. Every call takes stat and errmsg, optional and last, as allocate does. stat is 0 or a SPAR_ERR_*; errmsg is set only
! where something failed, to what went wrong, where, and the cure. Without stat a failure stops the program with that message.
! A refused call leaves its results as they were, so these are intent(inout); what C takes as NULL is optional.
!
! Arrays. Places x(3,n), orientations q(4,n), node motion q(7,n), v(6,n), a(6,n), loads (6,n), matrices (6,6,n).
! n is taken from the shape, and every shape is checked; n = 0 is legal. The library copies, no array is
! kept; array sections such as a(:,1:4:2) are legal and cost a copy. Nodes and sections are counted from 1 in arguments; the
! library's own messages count from 0, and so does the node of fluid%get_travel (-1: there are none). A fluid's layout (1, n)
! stands for arrays x(n,3), by component, (3, 1) for x(3,n), (8, 1) for x(8,n); other shapes are refused.
! Kinds. Numbers are real(c_double). Write 0.02_c_double or 0.02d0: the default real 0.02 does not compile, because 50 000 such
! steps would end at 999.99998 s. Hosts in single precision have the four calls of nodes with arrays of real(c_float), as in C:
! fluid%pull_motion_f32, %pull_poses_f32, %pull_forces_f32 and %push_forces_f32. theta is real(c_double) there too.
! Integers, logicals and the constants SPAR_* have the default kind. A host whose default integers have 8 bytes compiles
! the files of this folder with its own options (-fdefault-integer-8). A count may have 4 or 8 bytes in any case; one too large
! for C is refused as any other that is out of range.
! Figures that C names by constants from 0 (SPAR_REPORT_*) are found under these names in arrays declared from 0:
! report(0:SPAR_REPORT_COUNT-1). Such an array may have any length: its entries are set as far as it goes, those that the library
! does not know to 0.
!
! Life. A session is owned by its variable: destroyed by `destroy`, or at the latest when the
! variable goes out of existence (which a variable of the main program never does). Destroy a session before MPI_Finalize.
! To destroy twice, or what was never created, does nothing. Members, fluids and trials belong to their session and go with it:
! their variables are views, are not finalised, and must not be used when the session is gone; fluid%destroy and trial%destroy take
! one out of a living session. The variable of a member or a joint may be copied. To assign any of the others stops the program, since two owners
! would destroy one thing: pass it as an argument, point to it, or keep it in an array. allocate with source= copies without
! asking; do not use it on them. To create a session that exists is refused.
module spar
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_float, c_funloc, c_funptr, &
      c_int, c_int64_t, c_loc, c_null_char, c_null_funptr, c_null_ptr, c_ptr
  use spar_calls, c_status_text => spar_status_text, c_version => spar_version, c_has => spar_has, &
      c_log_stderr => spar_log_stderr, &
      c_effect_name => spar_effect_name, c_series_add => spar_vtk_series_add, &
      c_section_from_shape => spar_section_from_shape, c_section_build => spar_section_build, &
      c_section_describe => spar_section_describe, c_section_report => spar_section_report, &
      c_section_transform => spar_section_transform
  use spar_support
  implicit none
  private

  public :: spar_session, spar_member, spar_joint, spar_fluid, spar_trial
  public :: spar_fluid_solver, spar_before_step, spar_log, spar_progress
  public :: spar_log_to_stderr, spar_status_text, spar_version, spar_has, spar_effect_name, spar_vtk_series_add
  public :: spar_section_from_shape, spar_section_build, spar_section_describe, spar_section_report, spar_section_transform

  ! constants of the headers {
  integer, parameter, public :: SPAR_OK = 0, SPAR_ERR_ARGUMENT = 1, SPAR_ERR_STATE = 2, SPAR_ERR_MEMORY = 3, &
      SPAR_ERR_NUMERIC = 4, SPAR_ERR_MAPPING = 5, SPAR_ERR_COMM = 6, SPAR_ERR_PEER = 7, SPAR_ERR_IO = 8, &
      SPAR_ERR_UNSUPPORTED = 9, SPAR_ERR_USER = 10, SPAR_ERR_LIMIT = 11
  integer, parameter, public :: SPAR_COUPLING_EXPLICIT = 0, SPAR_COUPLING_FIXED_POINT = 1, SPAR_COUPLING_AITKEN = 2, &
      SPAR_COUPLING_IQN_ILS = 3
  integer, parameter, public :: SPAR_LOG_ERROR = 0, SPAR_LOG_WARNING = 1, SPAR_LOG_INFO = 2
  integer, parameter, public :: SPAR_ROOT_FREE = 0, SPAR_ROOT_FIXED = 1, SPAR_ROOT_PINNED = 2, SPAR_ROOT_DRIVEN = 3
  integer, parameter, public :: SPAR_LOAD_DEAD = 0, SPAR_LOAD_FOLLOWER = 1
  integer, parameter, public :: SPAR_NODES_MOTION = 0, SPAR_NODES_FORCE = 1
  integer, parameter, public :: SPAR_SECTION_EA = 0, SPAR_SECTION_GA_Y = 1, SPAR_SECTION_GA_Z = 2, &
      SPAR_SECTION_GJ = 3, SPAR_SECTION_EI_Y = 4, SPAR_SECTION_EI_Z = 5, SPAR_SECTION_ANGLE = 6, &
      SPAR_SECTION_SHEAR_ANGLE = 7, SPAR_SECTION_TENSION_Y = 8, SPAR_SECTION_TENSION_Z = 9, &
      SPAR_SECTION_SHEAR_Y = 10, SPAR_SECTION_SHEAR_Z = 11, SPAR_SECTION_MASS = 12, SPAR_SECTION_MASS_Y = 13, &
      SPAR_SECTION_MASS_Z = 14, SPAR_SECTION_INERTIA_Y = 15, SPAR_SECTION_INERTIA_Z = 16, &
      SPAR_SECTION_INERTIA_ANGLE = 17, SPAR_SECTION_COUNT = 18
  integer, parameter, public :: SPAR_SHAPE_CIRCLE = 0, SPAR_SHAPE_TUBE = 1, SPAR_SHAPE_RECTANGLE = 2, SPAR_SHAPE_BOX = 3
  integer, parameter, public :: SPAR_FINDING_ASYMMETRIC = 1, SPAR_FINDING_INDEFINITE = 2, SPAR_FINDING_MASS = 4, &
      SPAR_FINDING_BEND_TWIST = 8, SPAR_FINDING_STRETCH_TWIST = 16, SPAR_FINDING_STRETCH_SHEAR = 32, &
      SPAR_FINDING_BEND_SHEAR = 64, SPAR_FINDING_POLAR = 128, SPAR_FINDING_ORDER = 256, SPAR_FINDING_UNITS = 512
  integer, parameter, public :: SPAR_QUADRATURE_GAUSS = 0, SPAR_QUADRATURE_LOBATTO = 1, SPAR_QUADRATURE_SECTIONS = 2
  integer, parameter, public :: SPAR_FIDELITY_PRESCRIBED = 0, SPAR_FIDELITY_RIGID = 1, SPAR_FIDELITY_LINEAR = 2, &
      SPAR_FIDELITY_MODAL = 3, SPAR_FIDELITY_EXACT = 4
  integer, parameter, public :: SPAR_EFFECT_INERTIA = 1, SPAR_EFFECT_GYROSCOPIC = 2, SPAR_EFFECT_GRAVITY = 4, &
      SPAR_EFFECT_DAMPING = 8, SPAR_EFFECT_FLUID_MOMENT = 32, SPAR_EFFECT_FLUID_HISTORY = 64, SPAR_EFFECT_WORK = 128, &
      SPAR_EFFECT_MASSES = 512, SPAR_EFFECT_FOUNDATION = 1024, SPAR_EFFECT_PRETENSION = 2048
  integer, parameter, public :: SPAR_ENERGY_KINETIC = 0, SPAR_ENERGY_STRAIN = 1, SPAR_ENERGY_GRAVITY = 2, &
      SPAR_ENERGY_DISSIPATED = 3, SPAR_ENERGY_FOUNDATION = 4, SPAR_ENERGY_COUNT = 5
  integer, parameter, public :: SPAR_WORK_LOADS = 0, SPAR_WORK_FLUID = 1, SPAR_WORK_ROOT = 2, SPAR_WORK_JOINTS = 3, &
      SPAR_WORK_COUNT = 4
  integer, parameter, public :: SPAR_FREE_X = 1, SPAR_FREE_Y = 2, SPAR_FREE_Z = 4, SPAR_FREE_RX = 8, &
      SPAR_FREE_RY = 16, SPAR_FREE_RZ = 32
  integer, parameter, public :: SPAR_JOINT_ENERGY_SPRING = 0, SPAR_JOINT_ENERGY_DAMPER = 1, &
      SPAR_JOINT_ENERGY_DRIVE = 2, SPAR_JOINT_ENERGY_LOAD = 3, SPAR_JOINT_ENERGY_COUNT = 4
  integer, parameter, public :: SPAR_REPORT_CONTRACTION = 0, SPAR_REPORT_ADDED_MASS = 1, SPAR_REPORT_COLUMNS = 2, &
      SPAR_REPORT_DROPPED = 3, SPAR_REPORT_ERROR = 4, SPAR_REPORT_WORK_DEFECT = 5, SPAR_REPORT_UNCONVERGED = 6, &
      SPAR_REPORT_ADDED_MASS_SPREAD = 7, SPAR_REPORT_MOTION_ERROR = 8, SPAR_REPORT_COUNT = 9
  integer, parameter, public :: SPAR_PHASE_START = 0, SPAR_PHASE_BETWEEN = 1, SPAR_PHASE_BEGUN = 2, &
      SPAR_PHASE_SOLVED = 3, SPAR_PHASE_CHECKED = 4
  integer, parameter, public :: SPAR_RESPONSE_ACCELERATION = 0, SPAR_RESPONSE_VELOCITY = 1
  integer, parameter, public :: SPAR_PROJECT_BOUNDED = 0, SPAR_PROJECT_RPOLY = 1
  integer, parameter, public :: SPAR_INTERPOLATE_NODAL = 0, SPAR_INTERPOLATE_CONSISTENT = 1
  integer, parameter, public :: SPAR_KIND_STATIONS = 1, SPAR_KIND_SHARED = 2, SPAR_KIND_WEIGHTS = 4, &
      SPAR_KIND_FORCES = 8
  integer, parameter, public :: SPAR_MAP_END = 1, SPAR_MAP_AMBIGUOUS = 2, SPAR_MAP_FAR = 4
  integer, parameter, public :: SPAR_MATRIX_LOCAL_TO_GLOBAL = 0, SPAR_MATRIX_GLOBAL_TO_LOCAL = 1
  integer, parameter, public :: SPAR_AUDIT_FORCE = 0, SPAR_AUDIT_MOMENT = 1, SPAR_AUDIT_POWER = 2, &
      SPAR_AUDIT_FORCE_ERROR = 3, SPAR_AUDIT_MOMENT_ERROR = 4, SPAR_AUDIT_POWER_ERROR = 5, SPAR_AUDIT_FARTHEST = 6, &
      SPAR_AUDIT_NODES = 7, SPAR_AUDIT_COUNT = 8
  integer, parameter, public :: SPAR_ROW_INERTIA = 0, SPAR_ROW_GYROSCOPIC = 1, SPAR_ROW_GRAVITY = 2, &
      SPAR_ROW_DAMPING = 3, SPAR_ROW_FLUID_MOMENT = 4, SPAR_ROW_FLUID_VELOCITY = 5, SPAR_ROW_FLUID_POSES = 6, &
      SPAR_ROW_FLUID_HISTORY = 7, SPAR_ROW_PREDICTOR = 8, SPAR_ROW_ITERATION = 9, SPAR_ROW_HALF_STEP = 10, &
      SPAR_ROW_MASSES = 11, SPAR_ROW_FOUNDATION = 12, SPAR_ROW_PRETENSION = 13, SPAR_ROW_COUNT = 14
  integer, parameter, public :: SPAR_GOAL_MOTION = 1, SPAR_GOAL_REACTION = 2, SPAR_GOAL_SECTION = 4, &
      SPAR_GOAL_LOAD = 8, SPAR_GOAL_NUMBERS = 16
  ! } written by cmake/make-bindings.sh

  type :: spar_session
    private
    type(c_ptr) :: handle = c_null_ptr
    type(log_record), pointer :: log => null()
    type(progress_record), pointer :: progress => null()
    type(trial_record), pointer :: trials => null()
  contains
    procedure :: step_begin => session_step_begin
    procedure :: step_solve => session_step_solve
    procedure :: step_accept => session_step_accept
    procedure :: step_reject => session_step_reject
    procedure :: set_gravity => session_set_gravity
    procedure :: get_gravity => session_get_gravity
    procedure :: set_coupling => session_set_coupling
    procedure :: get_coupling => session_get_coupling
    procedure :: get_time => session_get_time
    procedure :: save => session_save
    procedure :: load => session_load
    procedure :: set_integrator => session_set_integrator
    procedure :: get_integrator => session_get_integrator
    procedure :: set_newton => session_set_newton
    procedure :: get_newton => session_get_newton
    procedure :: set_predictor => session_set_predictor
    procedure :: get_predictor => session_get_predictor
    procedure :: set_relaxation => session_set_relaxation
    procedure :: get_relaxation => session_get_relaxation
    procedure :: set_option => session_set_option
    procedure :: get_residual => session_get_residual
    procedure :: get_report => session_get_report
    procedure :: get_phase => session_get_phase
    procedure :: step_begin_initial => session_step_begin_initial
    procedure :: set_tolerance => session_set_tolerance
    procedure :: get_tolerance => session_get_tolerance
    procedure :: get_step_control => session_get_step_control
    procedure :: set_reproducible => session_set_reproducible
    procedure :: get_reproducible => session_get_reproducible
    procedure :: set_threads => session_set_threads
    procedure :: get_threads => session_get_threads
    procedure :: fail => session_fail
    procedure :: create => session_create
    procedure :: destroy => session_destroy
    procedure :: exists => session_exists
    procedure :: c_handle => session_handle
    procedure :: message => session_message
    procedure :: get_warning => session_get_warning
    procedure :: set_log => session_set_log
    procedure :: set_progress => session_set_progress
    procedure :: sum_balance => session_sum_balance
    procedure :: sum => session_sum
    procedure :: get_iterations => session_get_iterations
    procedure :: get_option => session_get_option
    procedure :: step_check => session_step_check
    procedure :: step => session_step
    procedure :: solve_static => session_solve_static
    procedure :: solve_initial => session_solve_initial
    procedure :: step_adaptive => session_step_adaptive
    procedure, private :: session_assign
    generic :: assignment(=) => session_assign
    final :: session_final
  end type spar_session

  type :: spar_member
    private
    type(c_ptr) :: handle = c_null_ptr, session = c_null_ptr
    integer(c_int64_t) :: elements = 1
    character(:), allocatable :: name
  contains
    procedure :: set_axis => member_set_axis
    procedure :: set_sections => member_set_sections
    procedure :: set_placement => member_set_placement
    procedure :: set_root => member_set_root
    procedure :: set_external => member_set_external
    procedure :: set_initial_velocity => member_set_initial_velocity
    procedure :: commit => member_commit
    procedure :: get_reference => member_get_reference
    procedure :: get_motion => member_get_motion
    procedure :: set_motion => member_set_motion
    procedure :: drive => member_drive
    procedure :: get_loads => member_get_loads
    procedure :: get_elements => member_get_elements
    procedure :: set_nodes => member_set_nodes
    procedure :: set_quadrature => member_set_quadrature
    procedure :: get_quadrature => member_get_quadrature
    procedure :: set_masses => member_set_masses
    procedure :: set_foundation => member_set_foundation
    procedure :: set_pretension => member_set_pretension
    procedure :: set_damping => member_set_damping
    procedure :: get_damping => member_get_damping
    procedure :: set_mass_damping => member_set_mass_damping
    procedure :: get_mass_damping => member_get_mass_damping
    procedure :: set_plane => member_set_plane
    procedure :: get_plane => member_get_plane
    procedure :: get_fidelity => member_get_fidelity
    procedure :: set_effects => member_set_effects
    procedure :: get_effects => member_get_effects
    procedure :: get_placement => member_get_placement
    procedure :: get_root => member_get_root
    procedure :: get_external => member_get_external
    procedure :: set_line_load => member_set_line_load
    procedure :: get_reaction => member_get_reaction
    procedure :: evaluate => member_evaluate
    procedure :: get_energy => member_get_energy
    procedure :: get_work => member_get_work
    procedure :: solve_static => member_solve_static
    procedure :: get_iterations => member_get_iterations
    procedure :: set_added_mass => member_set_added_mass
    procedure :: set_added_mass_response => member_set_added_mass_response
    procedure :: get_added_mass_response => member_get_added_mass_response
    procedure :: set_owner => member_set_owner
    procedure :: get_owner => member_get_owner
    procedure :: estimate_error => member_estimate_error
    procedure :: write_vtk => member_write_vtk
    procedure :: create_point => member_create_point
    procedure :: create_rigid => member_create_rigid
    procedure :: create_beam => member_create_beam
    procedure :: exists => member_exists
    procedure :: c_handle => member_handle
    procedure :: read_beamdyn => member_read_beamdyn
    procedure :: set_fidelity => member_set_fidelity
    procedure :: get_added_mass => member_get_added_mass
    procedure :: get_axis => member_get_axis
    procedure :: get_sections => member_get_sections
    procedure :: get_masses => member_get_masses
    procedure :: get_foundation => member_get_foundation
    procedure :: get_pretension => member_get_pretension
    procedure :: learn_added_mass => member_learn_added_mass
    procedure :: get_learned_added_mass => member_get_learned_added_mass
    procedure, private :: member_get_count_64, member_get_count_32
    generic :: get_count => member_get_count_64, member_get_count_32
    procedure :: get_name => member_get_name
    procedure, private :: member_set_load_64, member_set_load_32
    generic :: set_load => member_set_load_64, member_set_load_32
    procedure :: solve_modes => member_solve_modes
    procedure :: solve_eigenvalues => member_solve_eigenvalues
    procedure :: set_modal_damping => member_set_modal_damping
    procedure :: fit_damping => member_fit_damping
  end type spar_member

  type :: spar_joint
    private
    type(c_ptr) :: handle = c_null_ptr, session = c_null_ptr
  contains
    procedure :: set_frame => joint_set_frame
    procedure :: set_spring => joint_set_spring
    procedure :: set_driven => joint_set_driven
    procedure :: drive => joint_drive
    procedure :: set_load => joint_set_load
    procedure :: get_motion => joint_get_motion
    procedure :: get_load => joint_get_load
    procedure :: get_energy => joint_get_energy
    procedure, private :: joint_create_64, joint_create_32
    generic :: create => joint_create_64, joint_create_32
    procedure, private :: joint_create_link_64, joint_create_link_32
    generic :: create_link => joint_create_link_64, joint_create_link_32
    procedure :: exists => joint_exists
    procedure :: c_handle => joint_handle
    procedure, private :: joint_create_spring_64, joint_create_spring_32
    generic :: create_spring => joint_create_spring_64, joint_create_spring_32
    procedure :: set_link_spring => joint_set_link_spring
  end type spar_joint

  type :: spar_fluid
    private
    type(c_ptr) :: handle = c_null_ptr, session = c_null_ptr, member = c_null_ptr
    integer(c_int64_t) :: elements = 1 ! of the member
    character(:), allocatable :: name
  contains
    procedure :: pull_motion => fluid_pull_motion
    procedure :: fail => fluid_fail
    procedure :: set_motion_nodes => fluid_set_motion_nodes
    procedure :: set_force_nodes => fluid_set_force_nodes
    procedure :: set_stations => fluid_set_stations
    procedure :: map => fluid_map
    procedure :: pull_poses => fluid_pull_poses
    procedure :: set_motion_stations => fluid_set_motion_stations
    procedure :: get_motion_weights => fluid_get_motion_weights
    procedure :: set_layout => fluid_set_layout
    procedure :: get_layout => fluid_get_layout
    procedure :: set_projection => fluid_set_projection
    procedure :: get_projection => fluid_get_projection
    procedure :: set_interpolation => fluid_set_interpolation
    procedure :: get_interpolation => fluid_get_interpolation
    procedure :: set_option => fluid_set_option
    procedure :: map_current => fluid_map_current
    procedure :: get_kind => fluid_get_kind
    procedure :: get_flag_count => fluid_get_flag_count
    procedure :: get_nearest => fluid_get_nearest
    procedure :: get_travel => fluid_get_travel
    procedure :: get_positions => fluid_get_positions
    procedure :: pull_forces => fluid_pull_forces
    procedure :: get_forces => fluid_get_forces
    procedure :: set_states => fluid_set_states
    procedure :: get_states => fluid_get_states
    procedure :: pull_states => fluid_pull_states
    procedure :: push_states => fluid_push_states
    procedure :: pull_motion_f32 => fluid_pull_motion_f32
    procedure :: pull_poses_f32 => fluid_pull_poses_f32
    procedure :: pull_forces_f32 => fluid_pull_forces_f32
    procedure :: get_audit => fluid_get_audit
    procedure :: sum_loads => fluid_sum_loads
    procedure :: write_vtk => fluid_write_vtk
    procedure :: create => fluid_create
    procedure :: destroy => fluid_destroy
    procedure :: exists => fluid_exists
    procedure :: c_handle => fluid_handle
    procedure :: set_motion_weights => fluid_set_motion_weights
    procedure :: fade_motion => fluid_fade_motion
    procedure, private :: fluid_get_count_64, fluid_get_count_32
    generic :: get_count => fluid_get_count_64, fluid_get_count_32
    procedure :: get_member => fluid_get_member
    procedure :: get_name => fluid_get_name
    procedure :: get_map => fluid_get_map
    procedure :: get_option => fluid_get_option
    procedure :: get_basis => fluid_get_basis
    procedure :: pull_matrices => fluid_pull_matrices
    procedure :: check_matrices => fluid_check_matrices
    procedure :: push_forces => fluid_push_forces
    procedure :: push_forces_at => fluid_push_forces_at
    procedure :: push_forces_f32 => fluid_push_forces_f32
    procedure :: check_loads => fluid_check_loads
    procedure, private :: fluid_assign
    generic :: assignment(=) => fluid_assign
  end type spar_fluid

  type :: spar_trial
    private
    type(c_ptr) :: handle = c_null_ptr, session = c_null_ptr
    type(trial_record), pointer :: record => null()
  contains
    procedure :: get_steps => trial_get_steps
    procedure :: get_errors => trial_get_errors
    procedure :: get_cost => trial_get_cost
    procedure :: report_effects => trial_report_effects
    procedure :: get_effect => trial_get_effect
    procedure :: set_goals => trial_set_goals
    procedure :: get_goals => trial_get_goals
    procedure :: push_numbers => trial_push_numbers
    procedure :: set_option => trial_set_option
    procedure :: advise => trial_advise
    procedure :: get_settings => trial_get_settings
    procedure :: get_outcome => trial_get_outcome
    procedure :: get_search => trial_get_search
    procedure :: get_motion => trial_get_motion
    procedure :: solve_floquet => trial_solve_floquet
    procedure :: create => trial_create
    procedure :: destroy => trial_destroy
    procedure :: exists => trial_exists
    procedure :: c_handle => trial_handle
    procedure, private :: trial_set_steps_64, trial_set_steps_32
    generic :: set_steps => trial_set_steps_64, trial_set_steps_32
    procedure :: set_callbacks => trial_set_callbacks
    procedure :: set_progress => trial_set_progress
    procedure :: get_option => trial_get_option
    procedure :: run => trial_run
    procedure :: get_beam => trial_get_beam
    procedure :: apply => trial_apply
    procedure, private :: trial_set_motion_64, trial_set_motion_32
    generic :: set_motion => trial_set_motion_64, trial_set_motion_32
    procedure :: solve_eigenvalues => trial_solve_eigenvalues
    procedure, private :: trial_assign
    generic :: assignment(=) => trial_assign
  end type spar_trial

  abstract interface
    ! The host's fluid in session%step, once per iteration: pulls the motion, finds its loads at t + dt, pushes them. context:
    ! what session%step was given. stat is 0 on entry; any other value fails the step with SPAR_ERR_USER.
    subroutine spar_fluid_solver(session, t, dt, iteration, context, stat)
      import :: c_double, spar_session
      class(spar_session), intent(inout) :: session
      real(c_double), intent(in) :: t, dt
      integer, intent(in) :: iteration
      class(*), intent(inout), optional :: context
      integer, intent(inout) :: stat
    end subroutine spar_fluid_solver

    ! What the host does ahead of each step of a trial run, from t to t + dt; as spar_fluid_solver.
    subroutine spar_before_step(session, t, dt, context, stat)
      import :: c_double, spar_session
      class(spar_session), intent(inout) :: session
      real(c_double), intent(in) :: t, dt
      class(*), intent(inout), optional :: context
      integer, intent(inout) :: stat
    end subroutine spar_before_step

    ! Takes the library's messages, see session%set_log.
    subroutine spar_log(level, text, context)
      integer, intent(in) :: level
      character(*), intent(in) :: text
      class(*), intent(inout), optional :: context
    end subroutine spar_log

    ! Hears how far a solution is, see session%set_progress, or a call with many runs of a trial, see trial%set_progress. stat is 0 on
    ! entry; any other value ends the call.
    subroutine spar_progress(done, expected, context, stat)
      import :: c_double
      real(c_double), intent(in) :: done, expected
      class(*), intent(inout), optional :: context
      integer, intent(inout) :: stat
    end subroutine spar_progress
  end interface

  ! What C carries for a call back into Fortran.
  type :: step_record
    class(spar_session), pointer :: session => null()
    procedure(spar_fluid_solver), pointer, nopass :: solve => null()
    procedure(spar_before_step), pointer, nopass :: before => null()
    class(*), pointer :: context => null()
  end type step_record

  type :: log_record
    procedure(spar_log), pointer, nopass :: log => null()
    class(*), pointer :: context => null()
  end type log_record

  type :: progress_record
    procedure(spar_progress), pointer, nopass :: progress => null()
    class(*), pointer :: context => null()
  end type progress_record

  ! What a trial keeps of the host; of its session, which frees it at the latest.
  type :: trial_record
    class(spar_session), pointer :: session => null()
    procedure(spar_before_step), pointer, nopass :: before => null()
    procedure(spar_fluid_solver), pointer, nopass :: solve => null()
    procedure(spar_progress), pointer, nopass :: progress => null()
    class(*), pointer :: before_context => null(), solve_context => null(), progress_context => null()
    integer :: callbacks = 0 ! in progress
    type(trial_record), pointer :: next => null()
  end type trial_record

  interface spar_status_text
    procedure :: status_text
  end interface spar_status_text

  interface spar_version
    procedure :: version
  end interface spar_version

  interface spar_has
    procedure :: has_feature
  end interface spar_has

  interface spar_effect_name
    procedure :: effect_name
  end interface spar_effect_name

  interface spar_vtk_series_add
    procedure :: series_add
  end interface spar_vtk_series_add

  interface spar_section_from_shape
    procedure :: section_from_shape
  end interface spar_section_from_shape

  interface spar_section_build
    procedure :: section_build
  end interface spar_section_build

  interface spar_section_describe
    procedure :: section_describe
  end interface spar_section_describe

  interface spar_section_report
    procedure :: section_report
  end interface spar_section_report

  interface spar_section_transform
    procedure :: section_transform
  end interface spar_section_transform

contains

  ! ---- session ----

  recursive subroutine session_create(self, comm, stat, errmsg)
    class(spar_session), intent(inout) :: self
    integer, intent(in), optional :: comm
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    if (c_associated(self%handle)) then
      call occupied('session%create', stat, errmsg)
    else if (present(comm)) then
      call finish(spar_session_create_fcomm(to_c(comm), self%handle), c_null_ptr, stat, errmsg)
    else
      call finish(spar_session_create(self%handle), c_null_ptr, stat, errmsg)
    end if
  end subroutine session_create

  recursive subroutine session_destroy(self)
    class(spar_session), intent(inout) :: self
    type(trial_record), pointer :: record

    call spar_session_destroy(self%handle)
    if (associated(self%log)) deallocate (self%log)
    if (associated(self%progress)) deallocate (self%progress)
    do while (associated(self%trials))
      record => self%trials
      self%trials => record%next
      deallocate (record)
    end do
  end subroutine session_destroy

  impure elemental recursive subroutine session_final(self)
    type(spar_session), intent(inout) :: self

    call self%destroy()
  end subroutine session_final

  impure elemental recursive subroutine session_assign(left, right)
    class(spar_session), intent(inout) :: left
    type(spar_session), intent(in) :: right

    call forbid_copy('a session', left%handle, right%handle)
  end subroutine session_assign

  recursive logical function session_exists(self) result(there)
    class(spar_session), intent(in) :: self

    there = c_associated(self%handle)
  end function session_exists

  ! For calls of spar_c, while the session lives.
  recursive type(c_ptr) function session_handle(self) result(handle)
    class(spar_session), intent(in) :: self

    handle = self%handle
  end function session_handle

  ! What went wrong last, where, and the cure.
  recursive function session_message(self) result(text)
    class(spar_session), intent(in) :: self
    character(length_of_session_message(self)) :: text

    call fill_text(spar_session_message(self%handle), text)
  end function session_message

  pure recursive integer(c_int64_t) function length_of_session_message(self) result(n)
    class(spar_session), intent(in) :: self

    n = text_length(spar_session_message(self%handle))
  end function length_of_session_message

  ! Warning i, from 1; empty beyond the last.
  recursive function session_get_warning(self, i) result(text)
    class(spar_session), intent(in) :: self
    integer, intent(in) :: i
    character(length_of_session_get_warning(self, i)) :: text

    call fill_text(spar_session_get_warning(self%handle, int(i, c_int64_t) - 1), text)
  end function session_get_warning

  pure recursive integer(c_int64_t) function length_of_session_get_warning(self, i) result(n)
    class(spar_session), intent(in) :: self
    integer, intent(in) :: i

    n = text_length(spar_session_get_warning(self%handle, int(i, c_int64_t) - 1))
  end function length_of_session_get_warning

  ! Of arrays of different lengths as many ranks as the shortest has. One call, which is collective.
  recursive subroutine session_sum_balance(self, members, expected, counted, stat, errmsg)
    class(spar_session), intent(in) :: self
    integer(c_int64_t), contiguous, intent(inout), optional :: members(:)
    real(c_double), contiguous, intent(inout), optional :: expected(:), counted(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: capacity

    capacity = huge(capacity)
    if (present(members)) capacity = min(capacity, ubound(members, 1, c_int64_t))
    if (present(expected)) capacity = min(capacity, ubound(expected, 1, c_int64_t))
    if (present(counted)) capacity = min(capacity, ubound(counted, 1, c_int64_t))
    if (capacity == huge(capacity)) capacity = 0
    call finish(spar_session_sum_balance(self%handle, capacity, members, expected, counted), self%handle, stat, errmsg)
  end subroutine session_sum_balance

  ! status: what this rank has failed with, left out: nothing.
  recursive subroutine session_sum(self, x, status, stat, errmsg)
    class(spar_session), intent(in) :: self
    real(c_double), contiguous, intent(inout) :: x(:)
    integer, intent(in), optional :: status
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: own

    own = SPAR_OK
    if (present(status)) own = to_c(status)
    call finish(spar_session_sum(self%handle, own, size(x, kind=c_int64_t), x), self%handle, stat, errmsg)
  end subroutine session_sum

  ! The library's messages go to log from now on; without log it is silent, as at first. Unlike the other calls this one keeps
  ! what it is given: log must be a module procedure or an external one, and context must live as long as the session, or until
  ! the next set_log.
  ! No intent for context: gfortran takes intent(in) as leave to keep the target's old values in registers.
  recursive subroutine session_set_log(self, log, context, stat, errmsg)
    class(spar_session), intent(inout) :: self
    procedure(spar_log), optional :: log
    class(*), pointer, optional :: context
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(log_record), pointer :: record
    integer(c_int) :: status

    nullify (record)
    if (present(log)) then
      allocate (record)
      record%log => log
      if (present(context)) record%context => context
      status = spar_session_set_log(self%handle, c_funloc(call_log), c_loc(record))
    else
      status = spar_session_set_log(self%handle, c_null_funptr, c_null_ptr)
    end if
    if (status /= SPAR_OK) then
      if (associated(record)) deallocate (record)
    else
      if (associated(self%log)) deallocate (self%log)
      self%log => record
    end if
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_set_log

  recursive subroutine call_log(session, level, text, context) bind(c, name='')
    type(c_ptr), value :: session, text, context
    integer(c_int), value :: level
    type(log_record), pointer :: record
    character(:), allocatable :: words

    if (.not. c_associated(session)) return
    call c_f_pointer(context, record)
    call copy_text(text, words)
    if (associated(record%context)) then
      call record%log(int(level), words, record%context)
    else
      call record%log(int(level), words)
    end if
  end subroutine call_log

  ! progress and context are kept as by set_log; without progress nothing is told.
  recursive subroutine session_set_progress(self, progress, context, stat, errmsg)
    class(spar_session), intent(inout) :: self
    procedure(spar_progress), optional :: progress
    class(*), pointer, optional :: context
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(progress_record), pointer :: record
    integer(c_int) :: status

    nullify (record)
    if (present(progress)) then
      allocate (record)
      record%progress => progress
      if (present(context)) record%context => context
      status = spar_session_set_progress(self%handle, c_funloc(call_session_progress), c_loc(record))
    else
      status = spar_session_set_progress(self%handle, c_null_funptr, c_null_ptr)
    end if
    if (status /= SPAR_OK) then
      if (associated(record)) deallocate (record)
    else
      if (associated(self%progress)) deallocate (self%progress)
      self%progress => record
    end if
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_set_progress

  recursive function call_session_progress(session, done, expected, context) bind(c, name='') result(answer)
    type(c_ptr), value :: session, context
    real(c_double), value :: done, expected
    integer(c_int) :: answer
    integer :: stat
    type(progress_record), pointer :: record

    answer = SPAR_ERR_ARGUMENT
    if (.not. c_associated(session)) return
    call c_f_pointer(context, record)
    stat = SPAR_OK
    if (associated(record%context)) then
      call record%progress(done, expected, record%context, stat=stat)
    else
      call record%progress(done, expected, stat=stat)
    end if
    answer = to_c(stat)
  end function call_session_progress

  ! value is as long as what is set.
  recursive subroutine session_get_option(self, key, value, stat, errmsg)
    class(spar_session), intent(in) :: self
    character(*), intent(in) :: key
    character(:), allocatable, intent(inout) :: value
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer, parameter :: room = 64
    character(kind=c_char) :: text(room)
    integer(c_int) :: status
    integer :: i

    status = spar_session_get_option(self%handle, c_text(key), int(room, c_int64_t), text)
    if (status == SPAR_OK) then
      value = ''
      do i = 1, room
        if (text(i) == c_null_char) exit
        value = value // text(i)
      end do
    end if
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_get_option

  ! residual and size, by iteration from 1, take as many as they have room for: as many as set_coupling allows is always enough.
  recursive subroutine session_get_iterations(self, iterations, residual, size, stat, errmsg)
    class(spar_session), intent(in) :: self
    integer, intent(inout), optional :: iterations
    real(c_double), contiguous, intent(inout), optional :: residual(:), size(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status
    integer(c_int) :: n

    status = spar_session_get_iterations(self%handle, n, 0_c_int64_t)
    if (status == SPAR_OK .and. present(residual)) &
        status = spar_session_get_iterations(self%handle, n, ubound(residual, 1, c_int64_t), residual)
    if (status == SPAR_OK .and. present(size)) &
        status = spar_session_get_iterations(self%handle, n, ubound(size, 1, c_int64_t), size=size)
    if (status == SPAR_OK .and. present(iterations)) iterations = n
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_get_iterations

  ! ---- one coupling step ----

  ! done is .true. after a failure too, so that a loop that waits for it ends.
  recursive subroutine session_step_check(self, done, stat, errmsg)
    class(spar_session), intent(inout) :: self
    logical, intent(out) :: done
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, ended

    done = .true.
    status = spar_step_check(self%handle, ended)
    if (status == SPAR_OK) done = ended /= 0
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_step_check

  ! A whole step; solve is called in every iteration (none: the structure alone moves), with context, which can be anything of
  ! the host. Both are used during this call only, so that solve may be an internal procedure, for which gfortran needs an
  ! executable stack; a module procedure needs none. After a failure the session is at t^n again.
  recursive subroutine session_step(self, dt, solve, context, iterations, stat, errmsg)
    class(spar_session), intent(inout), target :: self
    real(c_double), intent(in) :: dt
    procedure(spar_fluid_solver), optional :: solve
    class(*), intent(inout), target, optional :: context
    integer, intent(inout), optional :: iterations
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(step_record), target :: record
    type(c_funptr) :: to_solver, to_before
    integer(c_int) :: status, n

    n = 0
    if (present(iterations)) n = to_c(iterations)
    call fill_record(self, record, to_solver, to_before, solve, context=context)
    status = spar_step(self%handle, dt, to_solver, c_loc(record), n)
    if (present(iterations)) iterations = n
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_step

  ! A step that keeps the tolerance of set_tolerance: tried with dt, and with less while its error is too large; dt: then that to
  ! go on with, taken: that of the step. before is called ahead of each try, solve as in step.
  recursive subroutine session_step_adaptive(self, dt, before, solve, context, taken, stat, errmsg)
    class(spar_session), intent(inout), target :: self
    real(c_double), intent(inout) :: dt
    procedure(spar_before_step), optional :: before
    procedure(spar_fluid_solver), optional :: solve
    class(*), intent(inout), target, optional :: context
    real(c_double), intent(inout), optional :: taken
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(step_record), target :: record
    type(c_funptr) :: to_solver, to_before

    call fill_record(self, record, to_solver, to_before, solve, before, context)
    call finish(spar_step_adaptive(self%handle, dt, to_before, to_solver, c_loc(record), taken), self%handle, stat, errmsg)
  end subroutine session_step_adaptive

  ! The balanced start before the first step, of dt: solve as in step, with dt = 0, called until the loads agree.
  recursive subroutine session_solve_initial(self, dt, solve, context, iterations, stat, errmsg)
    class(spar_session), intent(inout), target :: self
    real(c_double), intent(in) :: dt
    procedure(spar_fluid_solver), optional :: solve
    class(*), intent(inout), target, optional :: context
    integer, intent(inout), optional :: iterations
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(step_record), target :: record
    type(c_funptr) :: to_solver, to_before
    integer(c_int) :: status, n

    n = 0
    if (present(iterations)) n = to_c(iterations)
    call fill_record(self, record, to_solver, to_before, solve, context=context)
    status = spar_session_solve_initial(self%handle, dt, to_solver, c_loc(record), n)
    if (present(iterations)) iterations = n
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_solve_initial

  ! Equilibrium of all members with the fluid's answer: solve as in step, with dt = 0, called until the loads agree. load_steps:
  ! default 1.
  recursive subroutine session_solve_static(self, load_steps, solve, context, iterations, stat, errmsg)
    class(spar_session), intent(inout), target :: self
    integer, intent(in), optional :: load_steps
    procedure(spar_fluid_solver), optional :: solve
    class(*), intent(inout), target, optional :: context
    integer, intent(inout), optional :: iterations
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(step_record), target :: record
    type(c_funptr) :: to_solver, to_before
    integer(c_int) :: parts, status, n

    n = 0
    if (present(iterations)) n = to_c(iterations)
    parts = 1
    if (present(load_steps)) parts = to_c(load_steps)
    call fill_record(self, record, to_solver, to_before, solve, context=context)
    status = spar_session_solve_static(self%handle, parts, to_solver, c_loc(record), n)
    if (present(iterations)) iterations = n
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_solve_static

  ! What C is handed for the host's procedures: the record with them, and the calls that read it; none for none.
  recursive subroutine fill_record(self, record, to_solver, to_before, solve, before, context)
    class(spar_session), intent(inout), target :: self
    type(step_record), intent(out) :: record
    type(c_funptr), intent(out) :: to_solver, to_before
    procedure(spar_fluid_solver), optional :: solve
    procedure(spar_before_step), optional :: before
    class(*), intent(inout), target, optional :: context

    record%session => self
    to_solver = c_null_funptr
    to_before = c_null_funptr
    if (present(solve)) then
      record%solve => solve
      to_solver = c_funloc(call_solver)
    end if
    if (present(before)) then
      record%before => before
      to_before = c_funloc(call_before)
    end if
    if (present(context)) record%context => context
  end subroutine fill_record

  recursive function call_solver(session, t, dt, iteration, context) bind(c, name='') result(answer)
    type(c_ptr), value :: session, context
    real(c_double), value :: t, dt
    integer(c_int), value :: iteration
    integer(c_int) :: answer
    integer :: stat
    type(step_record), pointer :: record

    answer = SPAR_ERR_ARGUMENT
    if (.not. c_associated(session)) return
    call c_f_pointer(context, record)
    stat = SPAR_OK
    if (associated(record%context)) then
      call record%solve(record%session, t, dt, int(iteration), record%context, stat=stat)
    else
      call record%solve(record%session, t, dt, int(iteration), stat=stat)
    end if
    answer = to_c(stat)
  end function call_solver

  recursive function call_before(session, t, dt, context) bind(c, name='') result(answer)
    type(c_ptr), value :: session, context
    real(c_double), value :: t, dt
    integer(c_int) :: answer
    integer :: stat
    type(step_record), pointer :: record

    answer = SPAR_ERR_ARGUMENT
    if (.not. c_associated(session)) return
    call c_f_pointer(context, record)
    stat = SPAR_OK
    if (associated(record%context)) then
      call record%before(record%session, t, dt, record%context, stat=stat)
    else
      call record%before(record%session, t, dt, stat=stat)
    end if
    answer = to_c(stat)
  end function call_before

  ! ---- trials ----

  ! The session's variable must be a target and stay in place while the trial lives: callbacks are handed it.
  recursive subroutine trial_create(self, session, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    class(spar_session), intent(inout), target :: session
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(c_ptr) :: made
    integer(c_int) :: status

    if (c_associated(self%handle)) then
      call occupied('trial%create', stat, errmsg)
      return
    end if
    made = c_null_ptr
    status = spar_trial_create(session%handle, made)
    if (status == SPAR_OK) then
      self%handle = made
      self%session = session%handle
      allocate (self%record)
      self%record%session => session
      self%record%next => session%trials
      session%trials => self%record
    end if
    call finish(status, session%handle, stat, errmsg)
  end subroutine trial_create

  ! Takes the trial out of its session, which must still be there. In one of its callbacks the trial ends its run first; what it
  ! keeps of the host then stays until the session is destroyed.
  recursive subroutine trial_destroy(self)
    class(spar_trial), intent(inout) :: self
    class(spar_session), pointer :: session
    type(trial_record), pointer :: before

    if (.not. c_associated(self%handle)) return
    call spar_trial_destroy(self%handle)
    self%session = c_null_ptr
    if (self%record%callbacks > 0) then
      nullify (self%record)
      return
    end if
    session => self%record%session
    if (associated(session%trials, self%record)) then
      session%trials => self%record%next
    else
      before => session%trials
      do while (.not. associated(before%next, self%record))
        before => before%next
      end do
      before%next => self%record%next
    end if
    deallocate (self%record)
  end subroutine trial_destroy

  impure elemental recursive subroutine trial_assign(left, right)
    class(spar_trial), intent(inout) :: left
    type(spar_trial), intent(in) :: right

    call forbid_copy('a trial', left%handle, right%handle)
  end subroutine trial_assign

  recursive logical function trial_exists(self) result(there)
    class(spar_trial), intent(in) :: self

    there = c_associated(self%handle)
  end function trial_exists

  recursive type(c_ptr) function trial_handle(self) result(handle)
    class(spar_trial), intent(in) :: self

    handle = self%handle
  end function trial_handle

  recursive subroutine trial_set_steps_64(self, dt, steps, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    real(c_double), intent(in) :: dt
    integer(c_int64_t), intent(in) :: steps
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_trial_set_steps(self%handle, dt, steps), self%session, stat, errmsg)
  end subroutine trial_set_steps_64

  recursive subroutine trial_set_steps_32(self, dt, steps, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    real(c_double), intent(in) :: dt
    integer(c_int), intent(in) :: steps
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call self%set_steps(dt, int(steps, c_int64_t), stat, errmsg)
  end subroutine trial_set_steps_32

  ! What is given is kept: procedures must be module procedures or external ones, and contexts live as long as the trial, or until
  ! the next set_callbacks.
  recursive subroutine trial_set_callbacks(self, before, before_context, solve, solve_context, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    procedure(spar_before_step), optional :: before
    class(*), pointer, optional :: before_context
    procedure(spar_fluid_solver), optional :: solve
    class(*), pointer, optional :: solve_context
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(c_funptr) :: to_before, to_solver
    type(c_ptr) :: context
    integer(c_int) :: status

    to_before = c_null_funptr
    to_solver = c_null_funptr
    context = c_null_ptr
    if (present(before)) to_before = c_funloc(call_trial_before)
    if (present(solve)) to_solver = c_funloc(call_trial_solver)
    if (associated(self%record)) context = c_loc(self%record)
    status = spar_trial_set_callbacks(self%handle, to_before, context, to_solver, context)
    if (status == SPAR_OK) then
      nullify (self%record%before, self%record%before_context, self%record%solve, self%record%solve_context)
      if (present(before)) self%record%before => before
      if (present(before_context)) self%record%before_context => before_context
      if (present(solve)) self%record%solve => solve
      if (present(solve_context)) self%record%solve_context => solve_context
    end if
    call finish(status, self%session, stat, errmsg)
  end subroutine trial_set_callbacks

  ! progress and context are kept as by set_callbacks; without progress nothing is told.
  recursive subroutine trial_set_progress(self, progress, context, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    procedure(spar_progress), optional :: progress
    class(*), pointer, optional :: context
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status

    if (present(progress) .and. associated(self%record)) then
      status = spar_trial_set_progress(self%handle, c_funloc(call_trial_progress), c_loc(self%record))
    else
      status = spar_trial_set_progress(self%handle, c_null_funptr, c_null_ptr)
    end if
    if (status == SPAR_OK) then
      nullify (self%record%progress, self%record%progress_context)
      if (present(progress)) self%record%progress => progress
      if (present(context)) self%record%progress_context => context
    end if
    call finish(status, self%session, stat, errmsg)
  end subroutine trial_set_progress

  recursive function call_trial_before(session, t, dt, context) bind(c, name='') result(answer)
    type(c_ptr), value :: session, context
    real(c_double), value :: t, dt
    integer(c_int) :: answer
    integer :: stat
    type(trial_record), pointer :: record

    answer = SPAR_ERR_ARGUMENT
    if (.not. c_associated(session)) return
    call c_f_pointer(context, record)
    stat = SPAR_OK
    record%callbacks = record%callbacks + 1
    if (associated(record%before_context)) then
      call record%before(record%session, t, dt, record%before_context, stat=stat)
    else
      call record%before(record%session, t, dt, stat=stat)
    end if
    record%callbacks = record%callbacks - 1
    answer = to_c(stat)
  end function call_trial_before

  recursive function call_trial_solver(session, t, dt, iteration, context) bind(c, name='') result(answer)
    type(c_ptr), value :: session, context
    real(c_double), value :: t, dt
    integer(c_int), value :: iteration
    integer(c_int) :: answer
    integer :: stat
    type(trial_record), pointer :: record

    answer = SPAR_ERR_ARGUMENT
    if (.not. c_associated(session)) return
    call c_f_pointer(context, record)
    stat = SPAR_OK
    record%callbacks = record%callbacks + 1
    if (associated(record%solve_context)) then
      call record%solve(record%session, t, dt, int(iteration), record%solve_context, stat=stat)
    else
      call record%solve(record%session, t, dt, int(iteration), stat=stat)
    end if
    record%callbacks = record%callbacks - 1
    answer = to_c(stat)
  end function call_trial_solver

  recursive function call_trial_progress(session, done, expected, context) bind(c, name='') result(answer)
    type(c_ptr), value :: session, context
    real(c_double), value :: done, expected
    integer(c_int) :: answer
    integer :: stat
    type(trial_record), pointer :: record

    answer = SPAR_ERR_ARGUMENT
    if (.not. c_associated(session)) return
    call c_f_pointer(context, record)
    stat = SPAR_OK
    record%callbacks = record%callbacks + 1
    if (associated(record%progress_context)) then
      call record%progress(done, expected, record%progress_context, stat=stat)
    else
      call record%progress(done, expected, stat=stat)
    end if
    record%callbacks = record%callbacks - 1
    answer = to_c(stat)
  end function call_trial_progress

  ! value is as long as what is set.
  recursive subroutine trial_get_option(self, key, value, stat, errmsg)
    class(spar_trial), intent(in) :: self
    character(*), intent(in) :: key
    character(:), allocatable, intent(inout) :: value
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer, parameter :: room = 64
    character(kind=c_char) :: text(room)
    integer(c_int) :: status
    integer :: i

    status = spar_trial_get_option(self%handle, c_text(key), int(room, c_int64_t), text)
    if (status == SPAR_OK) then
      value = ''
      do i = 1, room
        if (text(i) == c_null_char) exit
        value = value // text(i)
      end do
    end if
    call finish(status, self%session, stat, errmsg)
  end subroutine trial_get_option

  ! compare: with the last run that did not.
  recursive subroutine trial_run(self, compare, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    logical, intent(in), optional :: compare
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    logical :: compared

    compared = .false.
    if (present(compare)) compared = compare
    call finish(spar_trial_run(self%handle, flag(compared)), self%session, stat, errmsg)
  end subroutine trial_run

  recursive subroutine trial_get_beam(self, member, fidelity, modes, elements, nodes_per_element, points, stat, errmsg)
    class(spar_trial), intent(in) :: self
    class(spar_member), intent(in) :: member
    integer, intent(inout), optional :: fidelity, elements, nodes_per_element, points
    integer(c_int64_t), intent(inout), optional :: modes
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_fidelity, c_elements, c_nodes_per_element, c_points

    status = spar_trial_get_beam(self%handle, member%handle, c_fidelity, modes, c_elements, c_nodes_per_element, c_points)
    call hand(status, c_fidelity, fidelity)
    call hand(status, c_elements, elements)
    call hand(status, c_nodes_per_element, nodes_per_element)
    call hand(status, c_points, points)
    call finish(status, self%session, stat, errmsg)
  end subroutine trial_get_beam

  recursive subroutine trial_apply(self, dt, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    real(c_double), intent(inout), optional :: dt
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_trial_apply(self%handle, dt), self%session, stat, errmsg)
  end subroutine trial_apply

  recursive subroutine trial_set_motion_64(self, modes, amplitude, memory, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    integer(c_int64_t), intent(in) :: modes
    real(c_double), intent(in), optional :: amplitude ! left out: 0
    integer(c_int64_t), intent(in), optional :: memory ! left out: 0
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    real(c_double) :: c_amplitude
    integer(c_int64_t) :: c_memory

    c_amplitude = 0
    c_memory = 0
    if (present(amplitude)) c_amplitude = amplitude
    if (present(memory)) c_memory = memory
    call finish(spar_trial_set_motion(self%handle, modes, c_amplitude, c_memory), self%session, stat, errmsg)
  end subroutine trial_set_motion_64

  recursive subroutine trial_set_motion_32(self, modes, amplitude, memory, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    integer(c_int), intent(in) :: modes
    real(c_double), intent(in), optional :: amplitude
    integer(c_int), intent(in), optional :: memory
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: c_memory

    c_memory = 0
    if (present(memory)) c_memory = memory
    call self%set_motion(int(modes, c_int64_t), amplitude, c_memory, stat, errmsg)
  end subroutine trial_set_motion_32

  ! shift(2), eigenvalue(2,n): growth rate and angular frequency; shapes(2,6,nodes of all members,n)
  recursive subroutine trial_solve_eigenvalues(self, shift, eigenvalue, shapes, frame, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    real(c_double), intent(in), optional :: shift(2)
    real(c_double), contiguous, intent(inout) :: eigenvalue(:,:)
    real(c_double), contiguous, intent(inout), optional :: shapes(:,:,:,:)
    real(c_double), intent(inout), optional :: frame(3)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault
    integer(c_int64_t) :: n, nodes

    n = size(eigenvalue, 2, kind=c_int64_t)
    nodes = 0
    call need(fault, 'eigenvalue', shape(eigenvalue, kind=c_int64_t), [2_c_int64_t, n])
    if (present(shapes)) then
      nodes = size(shapes, 3, kind=c_int64_t)
      call need(fault, 'shapes', shape(shapes, kind=c_int64_t), [2_c_int64_t, 6_c_int64_t, nodes, n])
    end if
    if (allocated(fault)) then
      call refuse('trial%solve_eigenvalues', fault, stat, errmsg)
      return
    end if
    call finish(spar_trial_solve_eigenvalues(self%handle, n, shift, eigenvalue, nodes, shapes, frame), self%session, stat, &
        errmsg)
  end subroutine trial_solve_eigenvalues

  ! ---- members ----

  recursive subroutine member_create_point(self, session, name, x, q, stat, errmsg)
    class(spar_member), intent(inout) :: self
    class(spar_session), intent(in) :: session
    character(*), intent(in) :: name
    real(c_double), intent(in) :: x(3), q(4)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(c_ptr) :: made
    integer(c_int) :: status

    made = c_null_ptr
    status = spar_point_create(session%handle, c_text(name), x, q, made)
    if (status == SPAR_OK) call member_take(self, made, session%handle, name, 1)
    call finish(status, session%handle, stat, errmsg)
  end subroutine member_create_point

  recursive subroutine member_create_rigid(self, session, name, x, q, mass, stat, errmsg)
    class(spar_member), intent(inout) :: self
    class(spar_session), intent(in) :: session
    character(*), intent(in) :: name
    real(c_double), intent(in) :: x(3), q(4), mass(6,6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(c_ptr) :: made
    integer(c_int) :: status

    made = c_null_ptr
    status = spar_rigid_create(session%handle, c_text(name), x, q, mass, made)
    if (status == SPAR_OK) call member_take(self, made, session%handle, name, 1)
    call finish(status, session%handle, stat, errmsg)
  end subroutine member_create_rigid

  recursive subroutine member_create_beam(self, session, name, elements, nodes_per_element, stat, errmsg)
    class(spar_member), intent(inout) :: self
    class(spar_session), intent(in) :: session
    character(*), intent(in) :: name
    integer, intent(in) :: elements, nodes_per_element
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(c_ptr) :: made
    integer(c_int) :: status

    made = c_null_ptr
    status = spar_beam_create(session%handle, c_text(name), to_c(elements), to_c(nodes_per_element), made)
    if (status == SPAR_OK) call member_take(self, made, session%handle, name, elements)
    call finish(status, session%handle, stat, errmsg)
  end subroutine member_create_beam

  recursive function member_get_name(self) result(name)
    class(spar_member), intent(in) :: self
    character(length_of_member_get_name(self)) :: name

    call fill_text(spar_member_get_name(self%handle), name)
  end function member_get_name

  pure recursive integer(c_int64_t) function length_of_member_get_name(self) result(n)
    class(spar_member), intent(in) :: self

    n = text_length(spar_member_get_name(self%handle))
  end function length_of_member_get_name

  ! A view of the new member: whatever the variable viewed before stays where it is, in its session.
  recursive subroutine member_take(self, handle, session, name, elements)
    class(spar_member), intent(inout) :: self
    type(c_ptr), intent(in) :: handle, session
    character(*), intent(in) :: name
    integer, intent(in) :: elements

    self%handle = handle
    self%session = session
    self%name = trim(name)
    self%elements = elements
  end subroutine member_take

  recursive logical function member_exists(self) result(there)
    class(spar_member), intent(in) :: self

    there = c_associated(self%handle)
  end function member_exists

  recursive type(c_ptr) function member_handle(self) result(handle)
    class(spar_member), intent(in) :: self

    handle = self%handle
  end function member_handle

  recursive subroutine member_read_beamdyn(self, primary_path, blade_path, stat, errmsg)
    class(spar_member), intent(inout) :: self
    character(*), intent(in) :: primary_path
    character(*), intent(in), optional :: blade_path
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status

    if (present(blade_path)) then
      status = spar_beam_read_beamdyn(self%handle, c_text(primary_path), c_text(blade_path))
    else
      status = spar_beam_read_beamdyn(self%handle, c_text(primary_path))
    end if
    call finish(status, self%session, stat, errmsg)
  end subroutine member_read_beamdyn

  recursive subroutine member_set_fidelity(self, kind, modes, stat, errmsg)
    class(spar_member), intent(inout) :: self
    integer, intent(in) :: kind
    integer, intent(in), optional :: modes !! of a modal member
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n

    n = 0
    if (present(modes)) n = modes
    call finish(spar_member_set_fidelity(self%handle, to_c(kind), n), self%session, stat, errmsg)
  end subroutine member_set_fidelity

  ! n: stations; eta and mass are filled as far as they reach
  recursive subroutine member_get_added_mass(self, n, eta, mass, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer(c_int64_t), intent(inout), optional :: n
    real(c_double), contiguous, intent(inout), optional :: eta(:)
    real(c_double), contiguous, intent(inout), optional :: mass(:,:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault
    integer(c_int) :: status

    if (present(mass)) call need(fault, 'mass', shape(mass, kind=c_int64_t), &
        [6_c_int64_t, 6_c_int64_t, size(mass, 3, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%get_added_mass', fault, stat, errmsg, self%name)
      return
    end if
    status = spar_member_get_added_mass(self%handle, n, 0_c_int64_t)
    if (status == SPAR_OK .and. present(eta)) &
        status = spar_member_get_added_mass(self%handle, n, size(eta, kind=c_int64_t), eta)
    if (status == SPAR_OK .and. present(mass)) &
        status = spar_member_get_added_mass(self%handle, n, size(mass, 3, kind=c_int64_t), mass=mass)
    call finish(status, self%session, stat, errmsg)
  end subroutine member_get_added_mass

  ! n: axis points; eta, xyz and twist are filled as far as they reach
  recursive subroutine member_get_axis(self, n, eta, xyz, twist, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer(c_int64_t), intent(inout), optional :: n
    real(c_double), contiguous, intent(inout), optional :: eta(:)
    real(c_double), contiguous, intent(inout), optional :: xyz(:,:)
    real(c_double), contiguous, intent(inout), optional :: twist(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault
    integer(c_int) :: status

    if (present(xyz)) call need(fault, 'xyz', shape(xyz, kind=c_int64_t), &
        [3_c_int64_t, size(xyz, 2, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%get_axis', fault, stat, errmsg, self%name)
      return
    end if
    status = spar_beam_get_axis(self%handle, n, 0_c_int64_t)
    if (status == SPAR_OK .and. present(eta)) &
        status = spar_beam_get_axis(self%handle, n, size(eta, kind=c_int64_t), eta)
    if (status == SPAR_OK .and. present(xyz)) &
        status = spar_beam_get_axis(self%handle, n, size(xyz, 2, kind=c_int64_t), xyz=xyz)
    if (status == SPAR_OK .and. present(twist)) &
        status = spar_beam_get_axis(self%handle, n, size(twist, kind=c_int64_t), twist=twist)
    call finish(status, self%session, stat, errmsg)
  end subroutine member_get_axis

  ! n: sections; eta, stiffness and mass are filled as far as they reach
  recursive subroutine member_get_sections(self, n, eta, stiffness, mass, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer(c_int64_t), intent(inout), optional :: n
    real(c_double), contiguous, intent(inout), optional :: eta(:)
    real(c_double), contiguous, intent(inout), optional :: stiffness(:,:,:)
    real(c_double), contiguous, intent(inout), optional :: mass(:,:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault
    integer(c_int) :: status

    if (present(stiffness)) call need(fault, 'stiffness', shape(stiffness, kind=c_int64_t), &
        [6_c_int64_t, 6_c_int64_t, size(stiffness, 3, kind=c_int64_t)])
    if (present(mass)) call need(fault, 'mass', shape(mass, kind=c_int64_t), &
        [6_c_int64_t, 6_c_int64_t, size(mass, 3, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%get_sections', fault, stat, errmsg, self%name)
      return
    end if
    status = spar_beam_get_sections(self%handle, n, 0_c_int64_t)
    if (status == SPAR_OK .and. present(eta)) &
        status = spar_beam_get_sections(self%handle, n, size(eta, kind=c_int64_t), eta)
    if (status == SPAR_OK .and. present(stiffness)) &
        status = spar_beam_get_sections(self%handle, n, size(stiffness, 3, kind=c_int64_t), stiffness=stiffness)
    if (status == SPAR_OK .and. present(mass)) &
        status = spar_beam_get_sections(self%handle, n, size(mass, 3, kind=c_int64_t), mass=mass)
    call finish(status, self%session, stat, errmsg)
  end subroutine member_get_sections

  ! n: bodies; eta and mass are filled as far as they reach
  recursive subroutine member_get_masses(self, n, eta, mass, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer(c_int64_t), intent(inout), optional :: n
    real(c_double), contiguous, intent(inout), optional :: eta(:)
    real(c_double), contiguous, intent(inout), optional :: mass(:,:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault
    integer(c_int) :: status

    if (present(mass)) call need(fault, 'mass', shape(mass, kind=c_int64_t), &
        [6_c_int64_t, 6_c_int64_t, size(mass, 3, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%get_masses', fault, stat, errmsg, self%name)
      return
    end if
    status = spar_beam_get_masses(self%handle, n, 0_c_int64_t)
    if (status == SPAR_OK .and. present(eta)) &
        status = spar_beam_get_masses(self%handle, n, size(eta, kind=c_int64_t), eta)
    if (status == SPAR_OK .and. present(mass)) &
        status = spar_beam_get_masses(self%handle, n, size(mass, 3, kind=c_int64_t), mass=mass)
    call finish(status, self%session, stat, errmsg)
  end subroutine member_get_masses

  ! n: stations; eta and stiffness are filled as far as they reach
  recursive subroutine member_get_foundation(self, n, eta, stiffness, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer(c_int64_t), intent(inout), optional :: n
    real(c_double), contiguous, intent(inout), optional :: eta(:)
    real(c_double), contiguous, intent(inout), optional :: stiffness(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault
    integer(c_int) :: status

    if (present(stiffness)) call need(fault, 'stiffness', shape(stiffness, kind=c_int64_t), &
        [3_c_int64_t, size(stiffness, 2, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%get_foundation', fault, stat, errmsg, self%name)
      return
    end if
    status = spar_beam_get_foundation(self%handle, n, 0_c_int64_t)
    if (status == SPAR_OK .and. present(eta)) &
        status = spar_beam_get_foundation(self%handle, n, size(eta, kind=c_int64_t), eta)
    if (status == SPAR_OK .and. present(stiffness)) &
        status = spar_beam_get_foundation(self%handle, n, size(stiffness, 2, kind=c_int64_t), stiffness=stiffness)
    call finish(status, self%session, stat, errmsg)
  end subroutine member_get_foundation

  ! n: stations; eta and force are filled as far as they reach
  recursive subroutine member_get_pretension(self, n, eta, force, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer(c_int64_t), intent(inout), optional :: n
    real(c_double), contiguous, intent(inout), optional :: eta(:)
    real(c_double), contiguous, intent(inout), optional :: force(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault
    integer(c_int) :: status

    if (present(force)) call need(fault, 'force', shape(force, kind=c_int64_t), &
        [6_c_int64_t, size(force, 2, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%get_pretension', fault, stat, errmsg, self%name)
      return
    end if
    status = spar_beam_get_pretension(self%handle, n, 0_c_int64_t)
    if (status == SPAR_OK .and. present(eta)) &
        status = spar_beam_get_pretension(self%handle, n, size(eta, kind=c_int64_t), eta)
    if (status == SPAR_OK .and. present(force)) &
        status = spar_beam_get_pretension(self%handle, n, size(force, 2, kind=c_int64_t), force=force)
    call finish(status, self%session, stat, errmsg)
  end subroutine member_get_pretension

  recursive subroutine member_learn_added_mass(self, eta, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: eta(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_learn_added_mass(self%handle, size(eta, kind=c_int64_t), eta), self%session, stat, errmsg)
  end subroutine member_learn_added_mass

  ! n: stations; eta and mass are filled as far as they reach
  recursive subroutine member_get_learned_added_mass(self, used, spread, n, eta, mass, stat, errmsg)
    class(spar_member), intent(in) :: self
    logical, intent(inout) :: used
    real(c_double), intent(inout) :: spread
    integer(c_int64_t), intent(inout), optional :: n
    real(c_double), contiguous, intent(inout), optional :: eta(:)
    real(c_double), contiguous, intent(inout), optional :: mass(:,:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault
    integer(c_int) :: status, flag

    if (present(mass)) call need(fault, 'mass', shape(mass, kind=c_int64_t), &
        [6_c_int64_t, 6_c_int64_t, size(mass, 3, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%get_learned_added_mass', fault, stat, errmsg, self%name)
      return
    end if
    flag = 0
    status = spar_member_get_learned_added_mass(self%handle, flag, spread, n, 0_c_int64_t)
    if (status == SPAR_OK .and. present(eta)) &
        status = spar_member_get_learned_added_mass(self%handle, capacity=size(eta, kind=c_int64_t), eta=eta)
    if (status == SPAR_OK .and. present(mass)) &
        status = spar_member_get_learned_added_mass(self%handle, capacity=size(mass, 3, kind=c_int64_t), mass=mass)
    if (status == SPAR_OK) used = flag /= 0
    call finish(status, self%session, stat, errmsg)
  end subroutine member_get_learned_added_mass

  recursive subroutine member_get_count_64(self, nodes, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer(c_int64_t), intent(inout) :: nodes
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_get_count(self%handle, nodes), self%session, stat, errmsg)
  end subroutine member_get_count_64

  recursive subroutine member_get_count_32(self, nodes, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer(c_int), intent(inout) :: nodes
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    integer(c_int) :: status

    status = spar_member_get_count(self%handle, n)
    call narrow(status, n, nodes, 'member%get_count', self%session, stat, errmsg)
  end subroutine member_get_count_32

  ! Of a member that is there; what is not, the library refuses.
  recursive subroutine need_node(fault, member, node)
    character(:), allocatable, intent(inout) :: fault
    class(spar_member), intent(in) :: member
    integer(c_int64_t), intent(in) :: node
    integer(c_int64_t) :: n

    if (spar_member_get_count(member%handle, n) /= SPAR_OK) return
    if (node >= 1 .and. node <= n) return
    fault = 'nodes are 1 to ' // trim(text_of(n)) // '; there is no node ' // trim(text_of(node))
  end subroutine need_node

  recursive subroutine member_set_load_64(self, node, kind, load, stat, errmsg)
    class(spar_member), intent(inout) :: self
    integer(c_int64_t), intent(in) :: node
    integer, intent(in) :: kind
    real(c_double), intent(in) :: load(6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    call need_node(fault, self, node)
    if (allocated(fault)) then
      call refuse('member%set_load', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_member_set_load(self%handle, node - 1, to_c(kind), load), self%session, stat, errmsg)
  end subroutine member_set_load_64

  recursive subroutine member_set_load_32(self, node, kind, load, stat, errmsg)
    class(spar_member), intent(inout) :: self
    integer(c_int), intent(in) :: node
    integer, intent(in) :: kind
    real(c_double), intent(in) :: load(6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call self%set_load(int(node, c_int64_t), kind, load, stat, errmsg)
  end subroutine member_set_load_32

  ! modes are counted from 1
  recursive subroutine member_set_modal_damping(self, mode, ratio, mu, stat, errmsg)
    class(spar_member), intent(inout) :: self
    integer, intent(in) :: mode(2)
    real(c_double), intent(in) :: ratio(2)
    real(c_double), intent(inout), optional :: mu(6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_beam_set_modal_damping(self%handle, int(mode, c_int64_t) - 1, ratio, mu), self%session, stat, &
        errmsg)
  end subroutine member_set_modal_damping

  recursive subroutine member_fit_damping(self, mode, ratio, achieved, stat, errmsg)
    class(spar_member), intent(inout) :: self
    integer, contiguous, intent(in) :: mode(:)
    real(c_double), contiguous, intent(in) :: ratio(:)
    real(c_double), contiguous, intent(inout), optional :: achieved(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    call need(fault, 'ratio', shape(ratio, kind=c_int64_t), shape(mode, kind=c_int64_t))
    if (present(achieved)) call need(fault, 'achieved', shape(achieved, kind=c_int64_t), shape(mode, kind=c_int64_t))
    if (allocated(fault)) then
      call refuse('member%fit_damping', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_beam_fit_damping(self%handle, size(mode, kind=c_int64_t), int(mode, c_int64_t) - 1, ratio, &
        achieved), self%session, stat, errmsg)
  end subroutine member_fit_damping

  recursive subroutine member_solve_modes(self, frequency_hz, shapes, stat, errmsg)
    class(spar_member), intent(in) :: self
    real(c_double), contiguous, intent(inout) :: frequency_hz(:)
    real(c_double), contiguous, intent(inout), optional :: shapes(:,:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_member_get_count(self%handle, n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    if (present(shapes)) call need(fault, 'shapes', shape(shapes, kind=c_int64_t), &
        [6_c_int64_t, n, size(frequency_hz, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%solve_modes', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_member_solve_modes(self%handle, size(frequency_hz, kind=c_int64_t), frequency_hz, &
        shapes), self%session, stat, errmsg)
  end subroutine member_solve_modes

  ! shift(2), eigenvalue(2,n): growth rate and angular frequency; shapes(2,6,nodes,n)
  recursive subroutine member_solve_eigenvalues(self, shift, eigenvalue, shapes, frame, stat, errmsg)
    class(spar_member), intent(in) :: self
    real(c_double), intent(in) :: shift(2)
    real(c_double), contiguous, intent(inout) :: eigenvalue(:,:)
    real(c_double), contiguous, intent(inout), optional :: shapes(:,:,:,:)
    real(c_double), intent(inout), optional :: frame(3)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n, count
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_member_get_count(self%handle, n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    count = size(eigenvalue, 2, kind=c_int64_t)
    call need(fault, 'eigenvalue', shape(eigenvalue, kind=c_int64_t), [2_c_int64_t, count])
    if (present(shapes)) call need(fault, 'shapes', shape(shapes, kind=c_int64_t), [2_c_int64_t, 6_c_int64_t, n, count])
    if (allocated(fault)) then
      call refuse('member%solve_eigenvalues', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_member_solve_eigenvalues(self%handle, count, shift, eigenvalue, shapes, frame), self%session, &
        stat, errmsg)
  end subroutine member_solve_eigenvalues

  ! ---- fluids ----

  ! node_a and node_b from 1; without b: to the ground.
  recursive subroutine joint_create_64(self, session, name, a, node_a, free_motions, b, node_b, stat, errmsg)
    class(spar_joint), intent(inout) :: self
    class(spar_session), intent(in) :: session
    character(*), intent(in) :: name
    class(spar_member), intent(in) :: a
    integer(c_int64_t), intent(in) :: node_a
    integer, intent(in) :: free_motions
    class(spar_member), intent(in), optional :: b
    integer(c_int64_t), intent(in), optional :: node_b
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(c_ptr) :: made, other
    integer(c_int64_t) :: node
    integer(c_int) :: status

    made = c_null_ptr
    call joint_end(b, node_b, other, node)
    status = spar_joint_create(session%handle, c_text(name), a%handle, node_a - 1, other, node, to_c(free_motions), made)
    call joint_take(self, made, session%handle, status)
    call finish(status, session%handle, stat, errmsg)
  end subroutine joint_create_64

  recursive subroutine joint_create_32(self, session, name, a, node_a, free_motions, b, node_b, stat, errmsg)
    class(spar_joint), intent(inout) :: self
    class(spar_session), intent(in) :: session
    character(*), intent(in) :: name
    class(spar_member), intent(in) :: a
    integer(c_int), intent(in) :: node_a
    integer, intent(in) :: free_motions
    class(spar_member), intent(in), optional :: b
    integer(c_int), intent(in), optional :: node_b
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: node

    node = 1
    if (present(node_b)) node = node_b
    call joint_create_64(self, session, name, a, int(node_a, c_int64_t), free_motions, b, node, stat, errmsg)
  end subroutine joint_create_32

  recursive subroutine joint_create_link_64(self, session, name, a, node_a, point_a, point_b, b, node_b, stat, errmsg)
    class(spar_joint), intent(inout) :: self
    class(spar_session), intent(in) :: session
    character(*), intent(in) :: name
    class(spar_member), intent(in) :: a
    integer(c_int64_t), intent(in) :: node_a
    real(c_double), intent(in) :: point_a(3), point_b(3)
    class(spar_member), intent(in), optional :: b
    integer(c_int64_t), intent(in), optional :: node_b
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(c_ptr) :: made, other
    integer(c_int64_t) :: node
    integer(c_int) :: status

    made = c_null_ptr
    call joint_end(b, node_b, other, node)
    status = spar_link_create(session%handle, c_text(name), a%handle, node_a - 1, point_a, other, node, point_b, made)
    call joint_take(self, made, session%handle, status)
    call finish(status, session%handle, stat, errmsg)
  end subroutine joint_create_link_64

  recursive subroutine joint_create_link_32(self, session, name, a, node_a, point_a, point_b, b, node_b, stat, errmsg)
    class(spar_joint), intent(inout) :: self
    class(spar_session), intent(in) :: session
    character(*), intent(in) :: name
    class(spar_member), intent(in) :: a
    integer(c_int), intent(in) :: node_a
    real(c_double), intent(in) :: point_a(3), point_b(3)
    class(spar_member), intent(in), optional :: b
    integer(c_int), intent(in), optional :: node_b
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: node

    node = 1
    if (present(node_b)) node = node_b
    call joint_create_link_64(self, session, name, a, int(node_a, c_int64_t), point_a, point_b, b, node, stat, errmsg)
  end subroutine joint_create_link_32

  ! What C is handed for the end at b: no member is the ground.
  recursive subroutine joint_end(b, node_b, other, node)
    class(spar_member), intent(in), optional :: b
    integer(c_int64_t), intent(in), optional :: node_b
    type(c_ptr), intent(out) :: other
    integer(c_int64_t), intent(out) :: node

    other = c_null_ptr
    node = 0
    if (present(b)) other = b%handle
    if (present(node_b)) node = node_b - 1
  end subroutine joint_end

  recursive subroutine joint_take(self, made, session, status)
    class(spar_joint), intent(inout) :: self
    type(c_ptr), intent(in) :: made, session
    integer(c_int), intent(in) :: status

    if (status /= SPAR_OK) return
    self%handle = made
    self%session = session
  end subroutine joint_take

  recursive logical function joint_exists(self) result(there)
    class(spar_joint), intent(in) :: self

    there = c_associated(self%handle)
  end function joint_exists

  recursive type(c_ptr) function joint_handle(self) result(handle)
    class(spar_joint), intent(in) :: self

    handle = self%handle
  end function joint_handle

  ! A joint of one node with the ground, made with its springs.
  recursive subroutine joint_create_spring_64(self, session, name, member, node, free_motions, stiffness, damping, preload, stat, &
      errmsg)
    class(spar_joint), intent(inout) :: self
    class(spar_session), intent(in) :: session
    character(*), intent(in) :: name
    class(spar_member), intent(in) :: member
    integer(c_int64_t), intent(in) :: node
    integer, intent(in) :: free_motions
    real(c_double), intent(in), optional :: stiffness(6,6), damping(6,6), preload(6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(c_ptr) :: made
    integer(c_int) :: status

    made = c_null_ptr
    status = spar_spring_create(session%handle, c_text(name), member%handle, node - 1, to_c(free_motions), stiffness, &
        damping, preload, made)
    call joint_take(self, made, session%handle, status)
    call finish(status, session%handle, stat, errmsg)
  end subroutine joint_create_spring_64

  recursive subroutine joint_create_spring_32(self, session, name, member, node, free_motions, stiffness, damping, preload, stat, &
      errmsg)
    class(spar_joint), intent(inout) :: self
    class(spar_session), intent(in) :: session
    character(*), intent(in) :: name
    class(spar_member), intent(in) :: member
    integer(c_int), intent(in) :: node
    integer, intent(in) :: free_motions
    real(c_double), intent(in), optional :: stiffness(6,6), damping(6,6), preload(6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call joint_create_spring_64(self, session, name, member, int(node, c_int64_t), free_motions, stiffness, damping, &
        preload, stat, errmsg)
  end subroutine joint_create_spring_32

  recursive subroutine joint_set_link_spring(self, stiffness, damping, length, tension_only, stat, errmsg)
    class(spar_joint), intent(inout) :: self
    real(c_double), intent(in) :: stiffness, damping, length
    logical, intent(in), optional :: tension_only
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: slack

    slack = 0
    if (present(tension_only)) slack = merge(1_c_int, 0_c_int, tension_only)
    call finish(spar_link_set_spring(self%handle, stiffness, damping, length, slack), self%session, stat, errmsg)
  end subroutine joint_set_link_spring

  recursive subroutine fluid_create(self, member, name, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    class(spar_member), intent(in) :: member
    character(*), intent(in) :: name
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(c_ptr) :: made
    integer(c_int) :: status

    made = c_null_ptr
    status = spar_fluid_create(member%handle, c_text(name), made)
    if (status == SPAR_OK) then
      self%handle = made
      self%session = member%session
      self%member = member%handle
      self%elements = member%elements
      self%name = trim(name)
    end if
    call finish(status, member%session, stat, errmsg)
  end subroutine fluid_create

  ! A view of the member that the fluid was created for.
  recursive subroutine fluid_get_member(self, member, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    class(spar_member), intent(inout) :: member
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(c_ptr) :: found
    character(:), allocatable :: name
    integer(c_int) :: status

    found = c_null_ptr
    status = spar_fluid_get_member(self%handle, found)
    if (status == SPAR_OK) then
      call copy_text(spar_member_get_name(found), name)
      call member_take(member, found, self%session, name, int(self%elements))
    end if
    call finish(status, self%session, stat, errmsg)
  end subroutine fluid_get_member

  recursive function fluid_get_name(self) result(name)
    class(spar_fluid), intent(in) :: self
    character(length_of_fluid_get_name(self)) :: name

    call fill_text(spar_fluid_get_name(self%handle), name)
  end function fluid_get_name

  pure recursive integer(c_int64_t) function length_of_fluid_get_name(self) result(n)
    class(spar_fluid), intent(in) :: self

    n = text_length(spar_fluid_get_name(self%handle))
  end function length_of_fluid_get_name

  ! Takes the fluid out of its session, which must still be there.
  recursive subroutine fluid_destroy(self)
    class(spar_fluid), intent(inout) :: self

    call spar_fluid_destroy(self%handle)
    self%session = c_null_ptr
  end subroutine fluid_destroy

  impure elemental recursive subroutine fluid_assign(left, right)
    class(spar_fluid), intent(inout) :: left
    type(spar_fluid), intent(in) :: right

    call forbid_copy('a fluid', left%handle, right%handle)
  end subroutine fluid_assign

  recursive logical function fluid_exists(self) result(there)
    class(spar_fluid), intent(in) :: self

    there = c_associated(self%handle)
  end function fluid_exists

  recursive type(c_ptr) function fluid_handle(self) result(handle)
    class(spar_fluid), intent(in) :: self

    handle = self%handle
  end function fluid_handle

  ! w(n), n motion nodes; without w: no weights.
  recursive subroutine fluid_set_motion_weights(self, w, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    real(c_double), contiguous, intent(in), optional :: w(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n

    n = 0
    if (present(w)) n = size(w, kind=c_int64_t)
    call finish(spar_fluid_set_motion_weights(self%handle, n, w), self%session, stat, errmsg)
  end subroutine fluid_set_motion_weights

  ! distance(n): without it from the reference line; held(n): not 0 where the mesh stands still.
  recursive subroutine fluid_fade_motion(self, within, beyond, distance, held, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    real(c_double), intent(in) :: within, beyond
    real(c_double), contiguous, intent(in), optional :: distance(:)
    integer, intent(in), optional :: held(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status
    integer(c_int), allocatable :: c_held(:)

    status = spar_fluid_get_count(self%handle, to_c(SPAR_NODES_MOTION), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    if (present(distance)) call need(fault, 'distance', shape(distance, kind=c_int64_t), [n])
    if (present(held)) call need(fault, 'held', shape(held, kind=c_int64_t), [n])
    if (allocated(fault)) then
      call refuse('fluid%fade_motion', fault, stat, errmsg, self%name)
      return
    end if
    if (present(held)) allocate (c_held, source=merge(1_c_int, 0_c_int, held /= 0))
    call finish(spar_fluid_fade_motion(self%handle, within, beyond, n, distance, c_held), self%session, stat, errmsg)
  end subroutine fluid_fade_motion

  recursive subroutine fluid_get_count_64(self, which, n, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer, intent(in) :: which
    integer(c_int64_t), intent(inout) :: n
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_get_count(self%handle, to_c(which), n), self%session, stat, errmsg)
  end subroutine fluid_get_count_64

  recursive subroutine fluid_get_count_32(self, which, n, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer, intent(in) :: which
    integer(c_int), intent(inout) :: n
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: long
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(which), long)
    call narrow(status, long, n, 'fluid%get_count', self%session, stat, errmsg)
  end subroutine fluid_get_count_32

  ! value is as long as what is set.
  recursive subroutine fluid_get_option(self, key, value, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    character(*), intent(in) :: key
    character(:), allocatable, intent(inout) :: value
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer, parameter :: room = 64
    character(kind=c_char) :: text(room)
    integer(c_int) :: status
    integer :: i

    status = spar_fluid_get_option(self%handle, c_text(key), int(room, c_int64_t), text)
    if (status == SPAR_OK) then
      value = ''
      do i = 1, room
        if (text(i) == c_null_char) exit
        value = value // text(i)
      end do
    end if
    call finish(status, self%session, stat, errmsg)
  end subroutine fluid_get_option

  recursive subroutine fluid_get_map(self, which, eta, distance, flags, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer, intent(in) :: which
    real(c_double), contiguous, intent(inout), optional :: eta(:), distance(:)
    integer, intent(inout), optional :: flags(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status
    integer(c_int), allocatable :: c_flags(:)

    status = spar_fluid_get_count(self%handle, to_c(which), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    if (present(eta)) call need(fault, 'eta', shape(eta, kind=c_int64_t), [n])
    if (present(distance)) call need(fault, 'distance', shape(distance, kind=c_int64_t), [n])
    if (present(flags)) call need(fault, 'flags', shape(flags, kind=c_int64_t), [n])
    if (allocated(fault)) then
      call refuse('fluid%get_map', fault, stat, errmsg, self%name)
      return
    end if
    if (present(flags)) allocate (c_flags(n), source=0_c_int)
    status = spar_fluid_get_map(self%handle, to_c(which), eta, distance, c_flags)
    if (status == SPAR_OK .and. present(flags)) flags(:n) = c_flags
    call finish(status, self%session, stat, errmsg)
  end subroutine fluid_get_map

  ! first_node(n) counts from 1; phi(p,n), p nodes per element.
  recursive subroutine fluid_get_basis(self, which, first_node, phi, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer, intent(in) :: which
    integer(c_int64_t), contiguous, intent(inout), optional :: first_node(:)
    real(c_double), contiguous, intent(inout), optional :: phi(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n, nodes
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(which), n)
    if (status == SPAR_OK) status = spar_member_get_count(self%member, nodes) ! not those of create: trials vary them
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    if (present(first_node)) call need(fault, 'first_node', shape(first_node, kind=c_int64_t), [n])
    if (present(phi)) call need(fault, 'phi', shape(phi, kind=c_int64_t), [nodes / self%elements, n])
    if (allocated(fault)) then
      call refuse('fluid%get_basis', fault, stat, errmsg, self%name)
      return
    end if
    status = spar_fluid_get_basis(self%handle, to_c(which), first_node, phi)
    if (status == SPAR_OK .and. present(first_node)) first_node = first_node + 1
    call finish(status, self%session, stat, errmsg)
  end subroutine fluid_get_basis

  ! matrix(row, column, n): the convention as its name says. C fills row by row, so the transpose of what C's name says is asked for.
  recursive subroutine fluid_pull_matrices(self, theta, convention, matrix, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    real(c_double), intent(in) :: theta
    integer, intent(in) :: convention
    real(c_double), contiguous, intent(inout) :: matrix(:,:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(SPAR_NODES_MOTION), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    call need(fault, 'matrix', shape(matrix, kind=c_int64_t), [3_c_int64_t, 3_c_int64_t, n])
    if (allocated(fault)) then
      call refuse('fluid%pull_matrices', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_pull_matrices(self%handle, theta, to_c(1 - convention), matrix), self%session, stat, errmsg)
  end subroutine fluid_pull_matrices

  ! matrix(row, column, n), as above.
  recursive subroutine fluid_check_matrices(self, convention, matrix, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer, intent(in) :: convention
    real(c_double), contiguous, intent(in) :: matrix(:,:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(SPAR_NODES_MOTION), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    call need(fault, 'matrix', shape(matrix, kind=c_int64_t), [3_c_int64_t, 3_c_int64_t, n])
    if (allocated(fault)) then
      call refuse('fluid%check_matrices', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_check_matrices(self%handle, to_c(1 - convention), matrix), self%session, stat, errmsg)
  end subroutine fluid_check_matrices

  recursive subroutine fluid_push_forces(self, force, moment, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: force(:,:)
    real(c_double), contiguous, intent(in), optional :: moment(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(SPAR_NODES_FORCE), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    call need_triples(self, SPAR_NODES_FORCE, fault, 'force', shape(force, kind=c_int64_t), n)
    if (present(moment)) call need_triples(self, SPAR_NODES_FORCE, fault, 'moment', shape(moment, kind=c_int64_t), n)
    if (allocated(fault)) then
      status = spar_fluid_push_forces(self%handle) ! no forces: the step must not go on with those of the push before
      call refuse('fluid%push_forces', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_push_forces(self%handle, force, moment), self%session, stat, errmsg)
  end subroutine fluid_push_forces

  recursive subroutine fluid_push_forces_at(self, theta, force, moment, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    real(c_double), intent(in) :: theta
    real(c_double), contiguous, intent(in) :: force(:,:)
    real(c_double), contiguous, intent(in), optional :: moment(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(SPAR_NODES_FORCE), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    call need_triples(self, SPAR_NODES_FORCE, fault, 'force', shape(force, kind=c_int64_t), n)
    if (present(moment)) call need_triples(self, SPAR_NODES_FORCE, fault, 'moment', shape(moment, kind=c_int64_t), n)
    if (allocated(fault)) then
      status = spar_fluid_push_forces(self%handle) ! no forces: the step must not go on with those of the push before
      call refuse('fluid%push_forces_at', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_push_forces_at(self%handle, theta, force, moment), self%session, stat, errmsg)
  end subroutine fluid_push_forces_at

  recursive subroutine fluid_push_forces_f32(self, force, moment, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    real(c_float), contiguous, intent(in) :: force(:,:)
    real(c_float), contiguous, intent(in), optional :: moment(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(SPAR_NODES_FORCE), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    call need_triples(self, SPAR_NODES_FORCE, fault, 'force', shape(force, kind=c_int64_t), n)
    if (present(moment)) call need_triples(self, SPAR_NODES_FORCE, fault, 'moment', shape(moment, kind=c_int64_t), n)
    if (allocated(fault)) then
      status = spar_fluid_push_forces_f32(self%handle) ! as in push_forces
      call refuse('fluid%push_forces_f32', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_push_forces_f32(self%handle, force, moment), self%session, stat, errmsg)
  end subroutine fluid_push_forces_f32

  ! Collective. Whether all loads pushed add up to the host's total. Absent point: about the origin; absent moment: not
  ! compared.
  recursive subroutine fluid_check_loads(self, point, force, moment, rtol, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    real(c_double), intent(in) :: force(3), rtol
    real(c_double), intent(in), optional :: point(3), moment(3)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_check_loads(self%handle, point, force, moment, rtol), self%session, stat, errmsg)
  end subroutine fluid_check_loads

  ! ---- what needs no thought ----

  ! Written by cmake/make-bindings.sh.

  recursive subroutine session_step_begin(self, dt, stat, errmsg)
    class(spar_session), intent(inout) :: self
    real(c_double), intent(in) :: dt
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_step_begin(self%handle, dt), self%handle, stat, errmsg)
  end subroutine session_step_begin

  recursive subroutine session_step_solve(self, stat, errmsg)
    class(spar_session), intent(inout) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_step_solve(self%handle), self%handle, stat, errmsg)
  end subroutine session_step_solve

  recursive subroutine session_step_accept(self, stat, errmsg)
    class(spar_session), intent(inout) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_step_accept(self%handle), self%handle, stat, errmsg)
  end subroutine session_step_accept

  recursive subroutine session_step_reject(self, stat, errmsg)
    class(spar_session), intent(inout) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_step_reject(self%handle), self%handle, stat, errmsg)
  end subroutine session_step_reject

  recursive subroutine session_set_gravity(self, g, stat, errmsg)
    class(spar_session), intent(inout) :: self
    real(c_double), intent(in) :: g(3)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_set_gravity(self%handle, g), self%handle, stat, errmsg)
  end subroutine session_set_gravity

  recursive subroutine session_get_gravity(self, g, stat, errmsg)
    class(spar_session), intent(in) :: self
    real(c_double), intent(inout) :: g(3)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_get_gravity(self%handle, g), self%handle, stat, errmsg)
  end subroutine session_get_gravity

  recursive subroutine session_set_coupling(self, scheme, atol, rtol, max_iterations, stat, errmsg)
    class(spar_session), intent(inout) :: self
    integer, intent(in) :: scheme
    real(c_double), intent(in) :: atol, rtol
    integer, intent(in) :: max_iterations
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_set_coupling(self%handle, to_c(scheme), atol, rtol, to_c(max_iterations)), self%handle, &
        stat, errmsg)
  end subroutine session_set_coupling

  recursive subroutine session_get_coupling(self, scheme, atol, rtol, max_iterations, stat, errmsg)
    class(spar_session), intent(in) :: self
    integer, intent(inout), optional :: scheme
    real(c_double), intent(inout), optional :: atol, rtol
    integer, intent(inout), optional :: max_iterations
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_scheme, c_max_iterations

    status = spar_session_get_coupling(self%handle, c_scheme, atol, rtol, c_max_iterations)
    call hand(status, c_scheme, scheme)
    call hand(status, c_max_iterations, max_iterations)
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_get_coupling

  recursive subroutine session_get_time(self, t, step, iteration, stat, errmsg)
    class(spar_session), intent(in) :: self
    real(c_double), intent(inout), optional :: t
    integer(c_int64_t), intent(inout), optional :: step
    integer, intent(inout), optional :: iteration
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_iteration

    status = spar_session_get_time(self%handle, t, step, c_iteration)
    call hand(status, c_iteration, iteration)
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_get_time

  recursive subroutine session_save(self, path, stat, errmsg)
    class(spar_session), intent(in) :: self
    character(*), intent(in) :: path
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_save(self%handle, c_text(path)), self%handle, stat, errmsg)
  end subroutine session_save

  recursive subroutine session_load(self, path, stat, errmsg)
    class(spar_session), intent(inout) :: self
    character(*), intent(in) :: path
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_load(self%handle, c_text(path)), self%handle, stat, errmsg)
  end subroutine session_load

  recursive subroutine session_set_integrator(self, rho_inf, substeps, stat, errmsg)
    class(spar_session), intent(inout) :: self
    real(c_double), intent(in) :: rho_inf
    integer, intent(in) :: substeps
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_set_integrator(self%handle, rho_inf, to_c(substeps)), self%handle, stat, errmsg)
  end subroutine session_set_integrator

  recursive subroutine session_get_integrator(self, rho_inf, substeps, stat, errmsg)
    class(spar_session), intent(in) :: self
    real(c_double), intent(inout), optional :: rho_inf
    integer, intent(inout), optional :: substeps
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_substeps

    status = spar_session_get_integrator(self%handle, rho_inf, c_substeps)
    call hand(status, c_substeps, substeps)
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_get_integrator

  recursive subroutine session_set_newton(self, atol, rtol, max_iterations, stat, errmsg)
    class(spar_session), intent(inout) :: self
    real(c_double), intent(in) :: atol, rtol
    integer, intent(in) :: max_iterations
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_set_newton(self%handle, atol, rtol, to_c(max_iterations)), self%handle, stat, errmsg)
  end subroutine session_set_newton

  recursive subroutine session_get_newton(self, atol, rtol, max_iterations, stat, errmsg)
    class(spar_session), intent(in) :: self
    real(c_double), intent(inout), optional :: atol, rtol
    integer, intent(inout), optional :: max_iterations
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_max_iterations

    status = spar_session_get_newton(self%handle, atol, rtol, c_max_iterations)
    call hand(status, c_max_iterations, max_iterations)
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_get_newton

  recursive subroutine session_set_predictor(self, order, stat, errmsg)
    class(spar_session), intent(inout) :: self
    integer, intent(in) :: order
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_set_predictor(self%handle, to_c(order)), self%handle, stat, errmsg)
  end subroutine session_set_predictor

  recursive subroutine session_get_predictor(self, order, stat, errmsg)
    class(spar_session), intent(in) :: self
    integer, intent(inout) :: order
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_order

    status = spar_session_get_predictor(self%handle, c_order)
    call hand(status, c_order, order)
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_get_predictor

  recursive subroutine session_set_relaxation(self, omega, stat, errmsg)
    class(spar_session), intent(inout) :: self
    real(c_double), intent(in) :: omega
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_set_relaxation(self%handle, omega), self%handle, stat, errmsg)
  end subroutine session_set_relaxation

  recursive subroutine session_get_relaxation(self, omega, stat, errmsg)
    class(spar_session), intent(in) :: self
    real(c_double), intent(inout) :: omega
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_get_relaxation(self%handle, omega), self%handle, stat, errmsg)
  end subroutine session_get_relaxation

  recursive subroutine session_set_option(self, key, value, stat, errmsg)
    class(spar_session), intent(inout) :: self
    character(*), intent(in) :: key, value
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_set_option(self%handle, c_text(key), c_text(value)), self%handle, stat, errmsg)
  end subroutine session_set_option

  recursive subroutine session_get_residual(self, residual, size, stat, errmsg)
    class(spar_session), intent(in) :: self
    real(c_double), intent(inout), optional :: residual, size
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_get_residual(self%handle, residual, size), self%handle, stat, errmsg)
  end subroutine session_get_residual

  recursive subroutine session_get_report(self, report, stat, errmsg)
    class(spar_session), intent(in) :: self
    real(c_double), contiguous, intent(inout) :: report(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_get_report(self%handle, size(report, kind=c_int64_t), report), self%handle, stat, errmsg)
  end subroutine session_get_report

  recursive subroutine session_get_phase(self, phase, stat, errmsg)
    class(spar_session), intent(in) :: self
    integer, intent(inout) :: phase
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_phase

    status = spar_session_get_phase(self%handle, c_phase)
    call hand(status, c_phase, phase)
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_get_phase

  recursive subroutine session_step_begin_initial(self, dt, stat, errmsg)
    class(spar_session), intent(inout) :: self
    real(c_double), intent(in) :: dt
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_step_begin_initial(self%handle, dt), self%handle, stat, errmsg)
  end subroutine session_step_begin_initial

  recursive subroutine session_set_tolerance(self, drift, rtol, stat, errmsg)
    class(spar_session), intent(inout) :: self
    real(c_double), intent(in) :: drift, rtol
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_set_tolerance(self%handle, drift, rtol), self%handle, stat, errmsg)
  end subroutine session_set_tolerance

  recursive subroutine session_get_tolerance(self, drift, rtol, stat, errmsg)
    class(spar_session), intent(in) :: self
    real(c_double), intent(inout), optional :: drift, rtol
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_get_tolerance(self%handle, drift, rtol), self%handle, stat, errmsg)
  end subroutine session_get_tolerance

  recursive subroutine session_get_step_control(self, ratio, next_dt, reject, rejected, stat, errmsg)
    class(spar_session), intent(in) :: self
    real(c_double), intent(inout), optional :: ratio, next_dt
    integer, intent(inout), optional :: reject
    integer(c_int64_t), intent(inout), optional :: rejected
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_reject

    status = spar_session_get_step_control(self%handle, ratio, next_dt, c_reject, rejected)
    call hand(status, c_reject, reject)
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_get_step_control

  recursive subroutine session_set_reproducible(self, on, stat, errmsg)
    class(spar_session), intent(inout) :: self
    logical, intent(in) :: on
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_set_reproducible(self%handle, flag(on)), self%handle, stat, errmsg)
  end subroutine session_set_reproducible

  recursive subroutine session_get_reproducible(self, on, stat, errmsg)
    class(spar_session), intent(in) :: self
    logical, intent(inout) :: on
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_on

    status = spar_session_get_reproducible(self%handle, c_on)
    if (status == SPAR_OK) on = c_on /= 0
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_get_reproducible

  recursive subroutine session_set_threads(self, threads, stat, errmsg)
    class(spar_session), intent(inout) :: self
    integer, intent(in) :: threads
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_set_threads(self%handle, to_c(threads)), self%handle, stat, errmsg)
  end subroutine session_set_threads

  recursive subroutine session_get_threads(self, threads, stat, errmsg)
    class(spar_session), intent(in) :: self
    integer, intent(inout) :: threads
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_threads

    status = spar_session_get_threads(self%handle, c_threads)
    call hand(status, c_threads, threads)
    call finish(status, self%handle, stat, errmsg)
  end subroutine session_get_threads

  recursive subroutine session_fail(self, status, message, stat, errmsg)
    class(spar_session), intent(in) :: self
    integer, intent(in) :: status
    character(*), intent(in) :: message
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_session_fail(self%handle, to_c(status), c_text(message)), self%handle, stat, errmsg)
  end subroutine session_fail

  ! Written by cmake/make-bindings.sh.

  recursive subroutine member_set_axis(self, eta, xyz, twist, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: eta(:), xyz(:,:)
    real(c_double), contiguous, intent(in), optional :: twist(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    call need(fault, 'xyz', shape(xyz, kind=c_int64_t), [3_c_int64_t, size(eta, kind=c_int64_t)])
    if (present(twist)) call need(fault, 'twist', shape(twist, kind=c_int64_t), [size(eta, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%set_axis', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_beam_set_axis(self%handle, size(eta, kind=c_int64_t), eta, xyz, twist), self%session, stat, errmsg)
  end subroutine member_set_axis

  recursive subroutine member_set_sections(self, eta, stiffness, mass, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: eta(:), stiffness(:,:,:)
    real(c_double), contiguous, intent(in), optional :: mass(:,:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    call need(fault, 'stiffness', shape(stiffness, kind=c_int64_t), [6_c_int64_t, 6_c_int64_t, size(eta, &
        kind=c_int64_t)])
    if (present(mass)) call need(fault, 'mass', shape(mass, kind=c_int64_t), [6_c_int64_t, 6_c_int64_t, size(eta, &
        kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%set_sections', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_beam_set_sections(self%handle, size(eta, kind=c_int64_t), eta, stiffness, mass), self%session, &
        stat, errmsg)
  end subroutine member_set_sections

  recursive subroutine member_set_placement(self, x, q, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), intent(in), optional :: x(3), q(4)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_set_placement(self%handle, x, q), self%session, stat, errmsg)
  end subroutine member_set_placement

  recursive subroutine member_set_root(self, kind, stat, errmsg)
    class(spar_member), intent(inout) :: self
    integer, intent(in) :: kind
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_set_root(self%handle, to_c(kind)), self%session, stat, errmsg)
  end subroutine member_set_root

  recursive subroutine member_set_external(self, on, stat, errmsg)
    class(spar_member), intent(inout) :: self
    logical, intent(in) :: on
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_set_external(self%handle, flag(on)), self%session, stat, errmsg)
  end subroutine member_set_external

  recursive subroutine member_set_initial_velocity(self, x0, v0, omega, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), intent(in), optional :: x0(3), v0(3), omega(3)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_set_initial_velocity(self%handle, x0, v0, omega), self%session, stat, errmsg)
  end subroutine member_set_initial_velocity

  recursive subroutine member_commit(self, stat, errmsg)
    class(spar_member), intent(inout) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_commit(self%handle), self%session, stat, errmsg)
  end subroutine member_commit

  recursive subroutine member_get_reference(self, x, q, stat, errmsg)
    class(spar_member), intent(in) :: self
    real(c_double), contiguous, intent(inout), optional :: x(:,:), q(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_member_get_count(self%handle, n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    if (present(x)) call need(fault, 'x', shape(x, kind=c_int64_t), [3_c_int64_t, n])
    if (present(q)) call need(fault, 'q', shape(q, kind=c_int64_t), [4_c_int64_t, n])
    if (allocated(fault)) then
      call refuse('member%get_reference', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_member_get_reference(self%handle, x, q), self%session, stat, errmsg)
  end subroutine member_get_reference

  recursive subroutine member_get_motion(self, q, v, a, stat, errmsg)
    class(spar_member), intent(in) :: self
    real(c_double), contiguous, intent(inout), optional :: q(:,:), v(:,:), a(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_member_get_count(self%handle, n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    if (present(q)) call need(fault, 'q', shape(q, kind=c_int64_t), [7_c_int64_t, n])
    if (present(v)) call need(fault, 'v', shape(v, kind=c_int64_t), [6_c_int64_t, n])
    if (present(a)) call need(fault, 'a', shape(a, kind=c_int64_t), [6_c_int64_t, n])
    if (allocated(fault)) then
      call refuse('member%get_motion', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_member_get_motion(self%handle, q, v, a), self%session, stat, errmsg)
  end subroutine member_get_motion

  recursive subroutine member_set_motion(self, q, v, a, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), contiguous, intent(in), optional :: q(:,:), v(:,:), a(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_member_get_count(self%handle, n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    if (present(q)) call need(fault, 'q', shape(q, kind=c_int64_t), [7_c_int64_t, n])
    if (present(v)) call need(fault, 'v', shape(v, kind=c_int64_t), [6_c_int64_t, n])
    if (present(a)) call need(fault, 'a', shape(a, kind=c_int64_t), [6_c_int64_t, n])
    if (allocated(fault)) then
      call refuse('member%set_motion', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_member_set_motion(self%handle, q, v, a), self%session, stat, errmsg)
  end subroutine member_set_motion

  recursive subroutine member_drive(self, q, v, a, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), intent(in) :: q(7)
    real(c_double), intent(in), optional :: v(6), a(6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_drive(self%handle, q, v, a), self%session, stat, errmsg)
  end subroutine member_drive

  recursive subroutine member_get_loads(self, load, stat, errmsg)
    class(spar_member), intent(in) :: self
    real(c_double), contiguous, intent(inout) :: load(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_member_get_count(self%handle, n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    call need(fault, 'load', shape(load, kind=c_int64_t), [6_c_int64_t, n])
    if (allocated(fault)) then
      call refuse('member%get_loads', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_member_get_loads(self%handle, load), self%session, stat, errmsg)
  end subroutine member_get_loads

  recursive subroutine member_get_elements(self, elements, nodes_per_element, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer, intent(inout), optional :: elements, nodes_per_element
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_elements, c_nodes_per_element

    status = spar_beam_get_elements(self%handle, c_elements, c_nodes_per_element)
    call hand(status, c_elements, elements)
    call hand(status, c_nodes_per_element, nodes_per_element)
    call finish(status, self%session, stat, errmsg)
  end subroutine member_get_elements

  recursive subroutine member_set_nodes(self, x, q, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: x(:,:)
    real(c_double), contiguous, intent(in), optional :: q(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    call need(fault, 'x', shape(x, kind=c_int64_t), [3_c_int64_t, size(x, 2, kind=c_int64_t)])
    if (present(q)) call need(fault, 'q', shape(q, kind=c_int64_t), [4_c_int64_t, size(x, 2, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%set_nodes', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_beam_set_nodes(self%handle, size(x, 2, kind=c_int64_t), x, q), self%session, stat, errmsg)
  end subroutine member_set_nodes

  recursive subroutine member_set_quadrature(self, rule, points, stat, errmsg)
    class(spar_member), intent(inout) :: self
    integer, intent(in) :: rule, points
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_beam_set_quadrature(self%handle, to_c(rule), to_c(points)), self%session, stat, errmsg)
  end subroutine member_set_quadrature

  recursive subroutine member_get_quadrature(self, rule, points, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer, intent(inout), optional :: rule, points
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_rule, c_points

    status = spar_beam_get_quadrature(self%handle, c_rule, c_points)
    call hand(status, c_rule, rule)
    call hand(status, c_points, points)
    call finish(status, self%session, stat, errmsg)
  end subroutine member_get_quadrature

  recursive subroutine member_set_masses(self, eta, mass, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: eta(:), mass(:,:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    call need(fault, 'mass', shape(mass, kind=c_int64_t), [6_c_int64_t, 6_c_int64_t, size(eta, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%set_masses', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_beam_set_masses(self%handle, size(eta, kind=c_int64_t), eta, mass), self%session, stat, errmsg)
  end subroutine member_set_masses

  recursive subroutine member_set_foundation(self, eta, stiffness, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: eta(:), stiffness(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    call need(fault, 'stiffness', shape(stiffness, kind=c_int64_t), [3_c_int64_t, size(eta, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%set_foundation', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_beam_set_foundation(self%handle, size(eta, kind=c_int64_t), eta, stiffness), self%session, stat, &
        errmsg)
  end subroutine member_set_foundation

  recursive subroutine member_set_pretension(self, eta, force, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: eta(:), force(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    call need(fault, 'force', shape(force, kind=c_int64_t), [6_c_int64_t, size(eta, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%set_pretension', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_beam_set_pretension(self%handle, size(eta, kind=c_int64_t), eta, force), self%session, stat, &
        errmsg)
  end subroutine member_set_pretension

  recursive subroutine member_set_damping(self, mu, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), intent(in) :: mu(6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_beam_set_damping(self%handle, mu), self%session, stat, errmsg)
  end subroutine member_set_damping

  recursive subroutine member_get_damping(self, mu, stat, errmsg)
    class(spar_member), intent(in) :: self
    real(c_double), intent(inout) :: mu(6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_beam_get_damping(self%handle, mu), self%session, stat, errmsg)
  end subroutine member_get_damping

  recursive subroutine member_set_mass_damping(self, alpha, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), intent(in) :: alpha
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_beam_set_mass_damping(self%handle, alpha), self%session, stat, errmsg)
  end subroutine member_set_mass_damping

  recursive subroutine member_get_mass_damping(self, alpha, stat, errmsg)
    class(spar_member), intent(in) :: self
    real(c_double), intent(inout) :: alpha
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_beam_get_mass_damping(self%handle, alpha), self%session, stat, errmsg)
  end subroutine member_get_mass_damping

  recursive subroutine member_set_plane(self, normal, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), intent(in), optional :: normal(3)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_beam_set_plane(self%handle, normal), self%session, stat, errmsg)
  end subroutine member_set_plane

  recursive subroutine member_get_plane(self, normal, stat, errmsg)
    class(spar_member), intent(in) :: self
    real(c_double), intent(inout) :: normal(3)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_beam_get_plane(self%handle, normal), self%session, stat, errmsg)
  end subroutine member_get_plane

  recursive subroutine member_get_fidelity(self, kind, modes, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer, intent(inout), optional :: kind
    integer(c_int64_t), intent(inout), optional :: modes
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_kind

    status = spar_member_get_fidelity(self%handle, c_kind, modes)
    call hand(status, c_kind, kind)
    call finish(status, self%session, stat, errmsg)
  end subroutine member_get_fidelity

  recursive subroutine member_set_effects(self, switch_on, switch_off, stat, errmsg)
    class(spar_member), intent(inout) :: self
    integer, intent(in) :: switch_on, switch_off
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_set_effects(self%handle, to_c(switch_on), to_c(switch_off)), self%session, stat, errmsg)
  end subroutine member_set_effects

  recursive subroutine member_get_effects(self, effects, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer, intent(inout) :: effects
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_effects

    status = spar_member_get_effects(self%handle, c_effects)
    call hand(status, c_effects, effects)
    call finish(status, self%session, stat, errmsg)
  end subroutine member_get_effects

  recursive subroutine member_get_placement(self, x, q, stat, errmsg)
    class(spar_member), intent(in) :: self
    real(c_double), intent(inout), optional :: x(3), q(4)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_get_placement(self%handle, x, q), self%session, stat, errmsg)
  end subroutine member_get_placement

  recursive subroutine member_get_root(self, kind, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer, intent(inout) :: kind
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_kind

    status = spar_member_get_root(self%handle, c_kind)
    call hand(status, c_kind, kind)
    call finish(status, self%session, stat, errmsg)
  end subroutine member_get_root

  recursive subroutine member_get_external(self, on, stat, errmsg)
    class(spar_member), intent(in) :: self
    logical, intent(inout) :: on
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_on

    status = spar_member_get_external(self%handle, c_on)
    if (status == SPAR_OK) on = c_on /= 0
    call finish(status, self%session, stat, errmsg)
  end subroutine member_get_external

  recursive subroutine member_set_line_load(self, kind, eta, load, stat, errmsg)
    class(spar_member), intent(inout) :: self
    integer, intent(in) :: kind
    real(c_double), contiguous, intent(in) :: eta(:), load(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    call need(fault, 'load', shape(load, kind=c_int64_t), [6_c_int64_t, size(eta, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%set_line_load', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_beam_set_line_load(self%handle, to_c(kind), size(eta, kind=c_int64_t), eta, load), self%session, &
        stat, errmsg)
  end subroutine member_set_line_load

  recursive subroutine member_get_reaction(self, load, stat, errmsg)
    class(spar_member), intent(in) :: self
    real(c_double), intent(inout) :: load(6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_get_reaction(self%handle, load), self%session, stat, errmsg)
  end subroutine member_get_reaction

  recursive subroutine member_evaluate(self, eta, strain, force, x, q, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: eta(:)
    real(c_double), contiguous, intent(inout), optional :: strain(:,:), force(:,:), x(:,:), q(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    if (present(strain)) call need(fault, 'strain', shape(strain, kind=c_int64_t), [6_c_int64_t, size(eta, &
        kind=c_int64_t)])
    if (present(force)) call need(fault, 'force', shape(force, kind=c_int64_t), [6_c_int64_t, size(eta, &
        kind=c_int64_t)])
    if (present(x)) call need(fault, 'x', shape(x, kind=c_int64_t), [3_c_int64_t, size(eta, kind=c_int64_t)])
    if (present(q)) call need(fault, 'q', shape(q, kind=c_int64_t), [4_c_int64_t, size(eta, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%evaluate', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_beam_evaluate(self%handle, size(eta, kind=c_int64_t), eta, strain, force, x, q), self%session, &
        stat, errmsg)
  end subroutine member_evaluate

  recursive subroutine member_get_energy(self, energy, stat, errmsg)
    class(spar_member), intent(in) :: self
    real(c_double), contiguous, intent(inout) :: energy(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_get_energy(self%handle, size(energy, kind=c_int64_t), energy), self%session, stat, errmsg)
  end subroutine member_get_energy

  recursive subroutine member_get_work(self, work, stat, errmsg)
    class(spar_member), intent(in) :: self
    real(c_double), contiguous, intent(inout) :: work(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_get_work(self%handle, size(work, kind=c_int64_t), work), self%session, stat, errmsg)
  end subroutine member_get_work

  recursive subroutine member_solve_static(self, load_steps, stat, errmsg)
    class(spar_member), intent(inout) :: self
    integer, intent(in) :: load_steps
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_solve_static(self%handle, to_c(load_steps)), self%session, stat, errmsg)
  end subroutine member_solve_static

  recursive subroutine member_get_iterations(self, iterations, left, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer(c_int64_t), intent(inout), optional :: iterations
    real(c_double), intent(inout), optional :: left
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_get_iterations(self%handle, iterations, left), self%session, stat, errmsg)
  end subroutine member_get_iterations

  recursive subroutine member_set_added_mass(self, eta, mass, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: eta(:), mass(:,:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    call need(fault, 'mass', shape(mass, kind=c_int64_t), [6_c_int64_t, 6_c_int64_t, size(eta, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('member%set_added_mass', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_member_set_added_mass(self%handle, size(eta, kind=c_int64_t), eta, mass), self%session, stat, &
        errmsg)
  end subroutine member_set_added_mass

  recursive subroutine member_set_added_mass_response(self, response, stat, errmsg)
    class(spar_member), intent(inout) :: self
    integer, intent(in) :: response
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_set_added_mass_response(self%handle, to_c(response)), self%session, stat, errmsg)
  end subroutine member_set_added_mass_response

  recursive subroutine member_get_added_mass_response(self, response, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer, intent(inout) :: response
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_response

    status = spar_member_get_added_mass_response(self%handle, c_response)
    call hand(status, c_response, response)
    call finish(status, self%session, stat, errmsg)
  end subroutine member_get_added_mass_response

  recursive subroutine member_set_owner(self, rank, stat, errmsg)
    class(spar_member), intent(inout) :: self
    integer, intent(in) :: rank
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_set_owner(self%handle, to_c(rank)), self%session, stat, errmsg)
  end subroutine member_set_owner

  recursive subroutine member_get_owner(self, rank, stat, errmsg)
    class(spar_member), intent(in) :: self
    integer, intent(inout) :: rank
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_rank

    status = spar_member_get_owner(self%handle, c_rank)
    call hand(status, c_rank, rank)
    call finish(status, self%session, stat, errmsg)
  end subroutine member_get_owner

  recursive subroutine member_estimate_error(self, step, nodes, stat, errmsg)
    class(spar_member), intent(inout) :: self
    real(c_double), intent(inout), optional :: step, nodes
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_estimate_error(self%handle, step, nodes), self%session, stat, errmsg)
  end subroutine member_estimate_error

  recursive subroutine member_write_vtk(self, path, stat, errmsg)
    class(spar_member), intent(in) :: self
    character(*), intent(in) :: path
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_member_write_vtk(self%handle, c_text(path)), self%session, stat, errmsg)
  end subroutine member_write_vtk

  ! Written by cmake/make-bindings.sh.

  recursive subroutine joint_set_frame(self, x, q, stat, errmsg)
    class(spar_joint), intent(inout) :: self
    real(c_double), intent(in) :: x(3)
    real(c_double), intent(in), optional :: q(4)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_joint_set_frame(self%handle, x, q), self%session, stat, errmsg)
  end subroutine joint_set_frame

  recursive subroutine joint_set_spring(self, stiffness, damping, preload, stat, errmsg)
    class(spar_joint), intent(inout) :: self
    real(c_double), intent(in), optional :: stiffness(6,6), damping(6,6), preload(6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_joint_set_spring(self%handle, stiffness, damping, preload), self%session, stat, errmsg)
  end subroutine joint_set_spring

  recursive subroutine joint_set_driven(self, mask, stat, errmsg)
    class(spar_joint), intent(inout) :: self
    integer, intent(in) :: mask
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_joint_set_driven(self%handle, to_c(mask)), self%session, stat, errmsg)
  end subroutine joint_set_driven

  recursive subroutine joint_drive(self, motion, rate, acceleration, stat, errmsg)
    class(spar_joint), intent(inout) :: self
    real(c_double), intent(in) :: motion(6)
    real(c_double), intent(in), optional :: rate(6), acceleration(6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_joint_drive(self%handle, motion, rate, acceleration), self%session, stat, errmsg)
  end subroutine joint_drive

  recursive subroutine joint_set_load(self, load, stat, errmsg)
    class(spar_joint), intent(inout) :: self
    real(c_double), intent(in) :: load(6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_joint_set_load(self%handle, load), self%session, stat, errmsg)
  end subroutine joint_set_load

  recursive subroutine joint_get_motion(self, motion, rate, acceleration, stat, errmsg)
    class(spar_joint), intent(in) :: self
    real(c_double), intent(inout), optional :: motion(6), rate(6), acceleration(6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_joint_get_motion(self%handle, motion, rate, acceleration), self%session, stat, errmsg)
  end subroutine joint_get_motion

  recursive subroutine joint_get_load(self, load, stat, errmsg)
    class(spar_joint), intent(in) :: self
    real(c_double), intent(inout) :: load(6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_joint_get_load(self%handle, load), self%session, stat, errmsg)
  end subroutine joint_get_load

  recursive subroutine joint_get_energy(self, energy, stat, errmsg)
    class(spar_joint), intent(in) :: self
    real(c_double), contiguous, intent(inout) :: energy(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_joint_get_energy(self%handle, size(energy, kind=c_int64_t), energy), self%session, stat, errmsg)
  end subroutine joint_get_energy

  ! Written by cmake/make-bindings.sh.

  recursive subroutine fluid_pull_motion(self, theta, x, v, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    real(c_double), intent(in) :: theta
    real(c_double), contiguous, intent(inout), optional :: x(:,:), v(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(SPAR_NODES_MOTION), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    if (present(x)) call need_triples(self, SPAR_NODES_MOTION, fault, 'x', shape(x, kind=c_int64_t), n)
    if (present(v)) call need_triples(self, SPAR_NODES_MOTION, fault, 'v', shape(v, kind=c_int64_t), n)
    if (allocated(fault)) then
      call refuse('fluid%pull_motion', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_pull_motion(self%handle, theta, x, v), self%session, stat, errmsg)
  end subroutine fluid_pull_motion

  recursive subroutine fluid_fail(self, status, message, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer, intent(in) :: status
    character(*), intent(in) :: message
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_fail(self%handle, to_c(status), c_text(message)), self%session, stat, errmsg)
  end subroutine fluid_fail

  recursive subroutine fluid_set_motion_nodes(self, x, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: x(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    call need(fault, 'x', shape(x, kind=c_int64_t), [3_c_int64_t, size(x, 2, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('fluid%set_motion_nodes', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_set_motion_nodes(self%handle, size(x, 2, kind=c_int64_t), x), self%session, stat, errmsg)
  end subroutine fluid_set_motion_nodes

  recursive subroutine fluid_set_force_nodes(self, x, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: x(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    call need(fault, 'x', shape(x, kind=c_int64_t), [3_c_int64_t, size(x, 2, kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('fluid%set_force_nodes', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_set_force_nodes(self%handle, size(x, 2, kind=c_int64_t), x), self%session, stat, errmsg)
  end subroutine fluid_set_force_nodes

  recursive subroutine fluid_set_stations(self, eta, offset, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: eta(:)
    real(c_double), contiguous, intent(in), optional :: offset(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    if (present(offset)) call need(fault, 'offset', shape(offset, kind=c_int64_t), [3_c_int64_t, size(eta, &
        kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('fluid%set_stations', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_set_stations(self%handle, size(eta, kind=c_int64_t), eta, offset), self%session, stat, &
        errmsg)
  end subroutine fluid_set_stations

  recursive subroutine fluid_map(self, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_map(self%handle), self%session, stat, errmsg)
  end subroutine fluid_map

  recursive subroutine fluid_pull_poses(self, which, theta, x, q, v, omega, accel, alpha, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer, intent(in) :: which
    real(c_double), intent(in) :: theta
    real(c_double), contiguous, intent(inout), optional :: x(:,:), q(:,:), v(:,:), omega(:,:), accel(:,:), alpha(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(which), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    if (present(x)) call need_triples(self, which, fault, 'x', shape(x, kind=c_int64_t), n)
    if (present(q)) call need(fault, 'q', shape(q, kind=c_int64_t), [4_c_int64_t, n])
    if (present(v)) call need_triples(self, which, fault, 'v', shape(v, kind=c_int64_t), n)
    if (present(omega)) call need_triples(self, which, fault, 'omega', shape(omega, kind=c_int64_t), n)
    if (present(accel)) call need_triples(self, which, fault, 'accel', shape(accel, kind=c_int64_t), n)
    if (present(alpha)) call need_triples(self, which, fault, 'alpha', shape(alpha, kind=c_int64_t), n)
    if (allocated(fault)) then
      call refuse('fluid%pull_poses', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_pull_poses(self%handle, to_c(which), theta, x, q, v, omega, accel, alpha), self%session, &
        stat, errmsg)
  end subroutine fluid_pull_poses

  recursive subroutine fluid_set_motion_stations(self, eta, offset, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: eta(:)
    real(c_double), contiguous, intent(in), optional :: offset(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    if (present(offset)) call need(fault, 'offset', shape(offset, kind=c_int64_t), [3_c_int64_t, size(eta, &
        kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('fluid%set_motion_stations', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_set_motion_stations(self%handle, size(eta, kind=c_int64_t), eta, offset), self%session, &
        stat, errmsg)
  end subroutine fluid_set_motion_stations

  recursive subroutine fluid_get_motion_weights(self, w, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    real(c_double), contiguous, intent(inout) :: w(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(SPAR_NODES_MOTION), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    call need(fault, 'w', shape(w, kind=c_int64_t), [n])
    if (allocated(fault)) then
      call refuse('fluid%get_motion_weights', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_get_motion_weights(self%handle, w), self%session, stat, errmsg)
  end subroutine fluid_get_motion_weights

  recursive subroutine fluid_set_layout(self, which, node, component, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    integer, intent(in) :: which
    integer(c_int64_t), intent(in) :: node, component
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_set_layout(self%handle, to_c(which), node, component), self%session, stat, errmsg)
  end subroutine fluid_set_layout

  recursive subroutine fluid_get_layout(self, which, node, component, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer, intent(in) :: which
    integer(c_int64_t), intent(inout), optional :: node, component
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_get_layout(self%handle, to_c(which), node, component), self%session, stat, errmsg)
  end subroutine fluid_get_layout

  recursive subroutine fluid_set_projection(self, method, max_distance, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    integer, intent(in) :: method
    real(c_double), intent(in) :: max_distance
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_set_projection(self%handle, to_c(method), max_distance), self%session, stat, errmsg)
  end subroutine fluid_set_projection

  recursive subroutine fluid_get_projection(self, method, max_distance, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer, intent(inout), optional :: method
    real(c_double), intent(inout), optional :: max_distance
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_method

    status = spar_fluid_get_projection(self%handle, c_method, max_distance)
    call hand(status, c_method, method)
    call finish(status, self%session, stat, errmsg)
  end subroutine fluid_get_projection

  recursive subroutine fluid_set_interpolation(self, kind, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    integer, intent(in) :: kind
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_set_interpolation(self%handle, to_c(kind)), self%session, stat, errmsg)
  end subroutine fluid_set_interpolation

  recursive subroutine fluid_get_interpolation(self, kind, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer, intent(inout) :: kind
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_kind

    status = spar_fluid_get_interpolation(self%handle, c_kind)
    call hand(status, c_kind, kind)
    call finish(status, self%session, stat, errmsg)
  end subroutine fluid_get_interpolation

  recursive subroutine fluid_set_option(self, key, value, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    character(*), intent(in) :: key, value
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_set_option(self%handle, c_text(key), c_text(value)), self%session, stat, errmsg)
  end subroutine fluid_set_option

  recursive subroutine fluid_map_current(self, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_map_current(self%handle), self%session, stat, errmsg)
  end subroutine fluid_map_current

  recursive subroutine fluid_get_kind(self, which, kind, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer, intent(in) :: which
    integer, intent(inout) :: kind
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_kind

    status = spar_fluid_get_kind(self%handle, to_c(which), c_kind)
    call hand(status, c_kind, kind)
    call finish(status, self%session, stat, errmsg)
  end subroutine fluid_get_kind

  recursive subroutine fluid_get_flag_count(self, which, flag, n, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer, intent(in) :: which, flag
    integer(c_int64_t), intent(inout) :: n
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_get_flag_count(self%handle, to_c(which), to_c(flag), n), self%session, stat, errmsg)
  end subroutine fluid_get_flag_count

  recursive subroutine fluid_get_nearest(self, which, x_map, q_map, con, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer, intent(in) :: which
    real(c_double), contiguous, intent(inout), optional :: x_map(:,:), q_map(:,:), con(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(which), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    if (present(x_map)) call need(fault, 'x_map', shape(x_map, kind=c_int64_t), [3_c_int64_t, n])
    if (present(q_map)) call need(fault, 'q_map', shape(q_map, kind=c_int64_t), [4_c_int64_t, n])
    if (present(con)) call need(fault, 'con', shape(con, kind=c_int64_t), [3_c_int64_t, n])
    if (allocated(fault)) then
      call refuse('fluid%get_nearest', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_get_nearest(self%handle, to_c(which), x_map, q_map, con), self%session, stat, errmsg)
  end subroutine fluid_get_nearest

  recursive subroutine fluid_get_travel(self, largest, node, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    real(c_double), intent(inout), optional :: largest
    integer(c_int64_t), intent(inout), optional :: node
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_get_travel(self%handle, largest, node), self%session, stat, errmsg)
  end subroutine fluid_get_travel

  recursive subroutine fluid_get_positions(self, which, x, q, v, nearest, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer, intent(in) :: which
    real(c_double), contiguous, intent(inout), optional :: x(:,:), q(:,:), v(:,:), nearest(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(which), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    if (present(x)) call need(fault, 'x', shape(x, kind=c_int64_t), [3_c_int64_t, n])
    if (present(q)) call need(fault, 'q', shape(q, kind=c_int64_t), [4_c_int64_t, n])
    if (present(v)) call need(fault, 'v', shape(v, kind=c_int64_t), [3_c_int64_t, n])
    if (present(nearest)) call need(fault, 'nearest', shape(nearest, kind=c_int64_t), [3_c_int64_t, n])
    if (allocated(fault)) then
      call refuse('fluid%get_positions', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_get_positions(self%handle, to_c(which), x, q, v, nearest), self%session, stat, errmsg)
  end subroutine fluid_get_positions

  recursive subroutine fluid_pull_forces(self, theta, force, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    real(c_double), intent(in) :: theta
    real(c_double), contiguous, intent(inout) :: force(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(SPAR_NODES_FORCE), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    call need_triples(self, SPAR_NODES_FORCE, fault, 'force', shape(force, kind=c_int64_t), n)
    if (allocated(fault)) then
      call refuse('fluid%pull_forces', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_pull_forces(self%handle, theta, force), self%session, stat, errmsg)
  end subroutine fluid_pull_forces

  recursive subroutine fluid_get_forces(self, force, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    real(c_double), contiguous, intent(inout) :: force(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(SPAR_NODES_FORCE), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    call need(fault, 'force', shape(force, kind=c_int64_t), [3_c_int64_t, n])
    if (allocated(fault)) then
      call refuse('fluid%get_forces', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_get_forces(self%handle, force), self%session, stat, errmsg)
  end subroutine fluid_get_forces

  recursive subroutine fluid_set_states(self, width, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    integer(c_int64_t), intent(in) :: width
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_set_states(self%handle, width), self%session, stat, errmsg)
  end subroutine fluid_set_states

  recursive subroutine fluid_get_states(self, width, dt, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer(c_int64_t), intent(inout), optional :: width
    real(c_double), intent(inout), optional :: dt
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_get_states(self%handle, width, dt), self%session, stat, errmsg)
  end subroutine fluid_get_states

  recursive subroutine fluid_pull_states(self, width, states, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer(c_int64_t), intent(in) :: width
    real(c_double), contiguous, intent(inout) :: states(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(SPAR_NODES_FORCE), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    call need(fault, 'states', shape(states, kind=c_int64_t), [width, n])
    if (allocated(fault)) then
      call refuse('fluid%pull_states', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_pull_states(self%handle, width, states), self%session, stat, errmsg)
  end subroutine fluid_pull_states

  recursive subroutine fluid_push_states(self, width, states, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    integer(c_int64_t), intent(in) :: width
    real(c_double), contiguous, intent(in) :: states(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(SPAR_NODES_FORCE), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    call need(fault, 'states', shape(states, kind=c_int64_t), [width, n])
    if (allocated(fault)) then
      call refuse('fluid%push_states', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_push_states(self%handle, width, states), self%session, stat, errmsg)
  end subroutine fluid_push_states

  recursive subroutine fluid_pull_motion_f32(self, theta, x, v, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    real(c_double), intent(in) :: theta
    real(c_float), contiguous, intent(inout), optional :: x(:,:), v(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(SPAR_NODES_MOTION), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    if (present(x)) call need_triples(self, SPAR_NODES_MOTION, fault, 'x', shape(x, kind=c_int64_t), n)
    if (present(v)) call need_triples(self, SPAR_NODES_MOTION, fault, 'v', shape(v, kind=c_int64_t), n)
    if (allocated(fault)) then
      call refuse('fluid%pull_motion_f32', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_pull_motion_f32(self%handle, theta, x, v), self%session, stat, errmsg)
  end subroutine fluid_pull_motion_f32

  recursive subroutine fluid_pull_poses_f32(self, which, theta, x, q, v, omega, accel, alpha, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    integer, intent(in) :: which
    real(c_double), intent(in) :: theta
    real(c_float), contiguous, intent(inout), optional :: x(:,:), q(:,:), v(:,:), omega(:,:), accel(:,:), alpha(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(which), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    if (present(x)) call need_triples(self, which, fault, 'x', shape(x, kind=c_int64_t), n)
    if (present(q)) call need(fault, 'q', shape(q, kind=c_int64_t), [4_c_int64_t, n])
    if (present(v)) call need_triples(self, which, fault, 'v', shape(v, kind=c_int64_t), n)
    if (present(omega)) call need_triples(self, which, fault, 'omega', shape(omega, kind=c_int64_t), n)
    if (present(accel)) call need_triples(self, which, fault, 'accel', shape(accel, kind=c_int64_t), n)
    if (present(alpha)) call need_triples(self, which, fault, 'alpha', shape(alpha, kind=c_int64_t), n)
    if (allocated(fault)) then
      call refuse('fluid%pull_poses_f32', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_pull_poses_f32(self%handle, to_c(which), theta, x, q, v, omega, accel, alpha), &
        self%session, stat, errmsg)
  end subroutine fluid_pull_poses_f32

  recursive subroutine fluid_pull_forces_f32(self, theta, force, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    real(c_double), intent(in) :: theta
    real(c_float), contiguous, intent(inout) :: force(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: n
    character(:), allocatable :: fault
    integer(c_int) :: status

    status = spar_fluid_get_count(self%handle, to_c(SPAR_NODES_FORCE), n)
    if (status /= SPAR_OK) then
      call finish(status, self%session, stat, errmsg)
      return
    end if
    call need_triples(self, SPAR_NODES_FORCE, fault, 'force', shape(force, kind=c_int64_t), n)
    if (allocated(fault)) then
      call refuse('fluid%pull_forces_f32', fault, stat, errmsg, self%name)
      return
    end if
    call finish(spar_fluid_pull_forces_f32(self%handle, theta, force), self%session, stat, errmsg)
  end subroutine fluid_pull_forces_f32

  recursive subroutine fluid_get_audit(self, audit, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    real(c_double), contiguous, intent(inout) :: audit(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_get_audit(self%handle, size(audit, kind=c_int64_t), audit), self%session, stat, errmsg)
  end subroutine fluid_get_audit

  recursive subroutine fluid_sum_loads(self, point, force, moment, stat, errmsg)
    class(spar_fluid), intent(inout) :: self
    real(c_double), intent(in), optional :: point(3)
    real(c_double), intent(inout), optional :: force(3), moment(3)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_sum_loads(self%handle, point, force, moment), self%session, stat, errmsg)
  end subroutine fluid_sum_loads

  recursive subroutine fluid_write_vtk(self, path, stat, errmsg)
    class(spar_fluid), intent(in) :: self
    character(*), intent(in) :: path
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_fluid_write_vtk(self%handle, c_text(path)), self%session, stat, errmsg)
  end subroutine fluid_write_vtk

  ! Written by cmake/make-bindings.sh.

  recursive subroutine trial_get_steps(self, dt, steps, stat, errmsg)
    class(spar_trial), intent(in) :: self
    real(c_double), intent(inout), optional :: dt
    integer(c_int64_t), intent(inout), optional :: steps
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_trial_get_steps(self%handle, dt, steps), self%session, stat, errmsg)
  end subroutine trial_get_steps

  recursive subroutine trial_get_errors(self, motion, reaction, load, stat, errmsg)
    class(spar_trial), intent(in) :: self
    real(c_double), intent(inout), optional :: motion, reaction, load
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_trial_get_errors(self%handle, motion, reaction, load), self%session, stat, errmsg)
  end subroutine trial_get_errors

  recursive subroutine trial_get_cost(self, seconds, evaluations, stat, errmsg)
    class(spar_trial), intent(in) :: self
    real(c_double), intent(inout), optional :: seconds
    integer(c_int64_t), intent(inout), optional :: evaluations
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_trial_get_cost(self%handle, seconds, evaluations), self%session, stat, errmsg)
  end subroutine trial_get_cost

  recursive subroutine trial_report_effects(self, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_trial_report_effects(self%handle), self%session, stat, errmsg)
  end subroutine trial_report_effects

  recursive subroutine trial_get_effect(self, row, in_force, fails, size, motion, reaction, share, stat, errmsg)
    class(spar_trial), intent(in) :: self
    integer, intent(in) :: row
    integer, intent(inout), optional :: in_force, fails
    real(c_double), intent(inout), optional :: size, motion, reaction, share
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_in_force, c_fails

    status = spar_trial_get_effect(self%handle, to_c(row), c_in_force, c_fails, size, motion, reaction, share)
    call hand(status, c_in_force, in_force)
    call hand(status, c_fails, fails)
    call finish(status, self%session, stat, errmsg)
  end subroutine trial_get_effect

  recursive subroutine trial_set_goals(self, goals, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    integer, intent(in) :: goals
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_trial_set_goals(self%handle, to_c(goals)), self%session, stat, errmsg)
  end subroutine trial_set_goals

  recursive subroutine trial_get_goals(self, goals, stat, errmsg)
    class(spar_trial), intent(in) :: self
    integer, intent(inout) :: goals
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_goals

    status = spar_trial_get_goals(self%handle, c_goals)
    call hand(status, c_goals, goals)
    call finish(status, self%session, stat, errmsg)
  end subroutine trial_get_goals

  recursive subroutine trial_push_numbers(self, numbers, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: numbers(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_trial_push_numbers(self%handle, size(numbers, kind=c_int64_t), numbers), self%session, stat, &
        errmsg)
  end subroutine trial_push_numbers

  recursive subroutine trial_set_option(self, key, value, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    character(*), intent(in) :: key, value
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_trial_set_option(self%handle, c_text(key), c_text(value)), self%session, stat, errmsg)
  end subroutine trial_set_option

  recursive subroutine trial_advise(self, tolerance, length, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    real(c_double), intent(in) :: tolerance, length
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_trial_advise(self%handle, tolerance, length), self%session, stat, errmsg)
  end subroutine trial_advise

  recursive subroutine trial_get_settings(self, dt, substeps, scheme, coupling_rtol, predictor, newton_rtol, stat, &
      errmsg)
    class(spar_trial), intent(in) :: self
    real(c_double), intent(inout), optional :: dt
    integer, intent(inout), optional :: substeps, scheme
    real(c_double), intent(inout), optional :: coupling_rtol
    integer, intent(inout), optional :: predictor
    real(c_double), intent(inout), optional :: newton_rtol
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_substeps, c_scheme, c_predictor

    status = spar_trial_get_settings(self%handle, dt, c_substeps, c_scheme, coupling_rtol, c_predictor, newton_rtol)
    call hand(status, c_substeps, substeps)
    call hand(status, c_scheme, scheme)
    call hand(status, c_predictor, predictor)
    call finish(status, self%session, stat, errmsg)
  end subroutine trial_get_settings

  recursive subroutine trial_get_outcome(self, error, cost, present_fails, present_error, stat, errmsg)
    class(spar_trial), intent(in) :: self
    real(c_double), intent(inout), optional :: error, cost
    integer, intent(inout), optional :: present_fails
    real(c_double), intent(inout), optional :: present_error
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_present_fails

    status = spar_trial_get_outcome(self%handle, error, cost, c_present_fails, present_error)
    call hand(status, c_present_fails, present_fails)
    call finish(status, self%session, stat, errmsg)
  end subroutine trial_get_outcome

  recursive subroutine trial_get_search(self, runs, work, stat, errmsg)
    class(spar_trial), intent(in) :: self
    integer(c_int64_t), intent(inout), optional :: runs
    real(c_double), intent(inout), optional :: work
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_trial_get_search(self%handle, runs, work), self%session, stat, errmsg)
  end subroutine trial_get_search

  recursive subroutine trial_get_motion(self, modes, amplitude, memory, stat, errmsg)
    class(spar_trial), intent(in) :: self
    integer(c_int64_t), intent(inout), optional :: modes
    real(c_double), intent(inout), optional :: amplitude
    integer(c_int64_t), intent(inout), optional :: memory
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(spar_trial_get_motion(self%handle, modes, amplitude, memory), self%session, stat, errmsg)
  end subroutine trial_get_motion

  recursive subroutine trial_solve_floquet(self, eigenvalue, stat, errmsg)
    class(spar_trial), intent(inout) :: self
    real(c_double), contiguous, intent(inout) :: eigenvalue(:,:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(:), allocatable :: fault

    call need(fault, 'eigenvalue', shape(eigenvalue, kind=c_int64_t), [2_c_int64_t, size(eigenvalue, 2, &
        kind=c_int64_t)])
    if (allocated(fault)) then
      call refuse('trial%solve_floquet', fault, stat, errmsg)
      return
    end if
    call finish(spar_trial_solve_floquet(self%handle, size(eigenvalue, 2, kind=c_int64_t), eigenvalue), self%session, &
        stat, errmsg)
  end subroutine trial_solve_floquet

  ! ---- calls that need no object ----

  recursive function status_text(status) result(text)
    integer, intent(in) :: status
    character(length_of_status_text(status)) :: text

    call fill_text(c_status_text(to_c(status)), text)
  end function status_text

  pure recursive integer(c_int64_t) function length_of_status_text(status) result(n)
    integer, intent(in) :: status

    n = text_length(c_status_text(to_c(status)))
  end function length_of_status_text

  recursive function version() result(text)
    character(length_of_version()) :: text

    call fill_text(c_version(), text)
  end function version

  pure recursive integer(c_int64_t) function length_of_version() result(n)
    n = text_length(c_version())
  end function length_of_version

  ! spar_log_stderr, a log for session%set_log: writes errors and warnings to stderr, a line each.
  recursive subroutine spar_log_to_stderr(level, text, context)
    integer, intent(in) :: level
    character(*), intent(in) :: text
    class(*), intent(inout), optional :: context

    if (present(context)) continue
    call c_log_stderr(c_null_ptr, to_c(level), c_text(text), c_null_ptr)
  end subroutine spar_log_to_stderr

  ! Whether this build of the library has a feature: 'mpi', ...
  recursive logical function has_feature(feature) result(there)
    character(*), intent(in) :: feature

    there = c_has(c_text(feature)) /= 0
  end function has_feature

  ! Of a row of trial%report_effects, from 0 as SPAR_ROW_*; '' for what is no row.
  recursive function effect_name(row) result(name)
    integer, intent(in) :: row
    character(length_of_effect_name(row)) :: name

    call fill_text(c_effect_name(to_c(row)), name)
  end function effect_name

  pure recursive integer(c_int64_t) function length_of_effect_name(row) result(n)
    integer, intent(in) :: row

    n = text_length(c_effect_name(to_c(row)))
  end function length_of_effect_name

  ! Adds a file to an index of files in time; part counts from 0.
  recursive subroutine series_add(path, time, part, file, stat, errmsg)
    character(*), intent(in) :: path, file
    real(c_double), intent(in) :: time
    integer, intent(in) :: part
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(c_series_add(c_text(path), time, to_c(part), c_text(file)), c_null_ptr, stat, errmsg)
  end subroutine series_add

  ! ---- sections; properties are found under SPAR_SECTION_* in arrays declared from 0 ----

  recursive subroutine section_from_shape(shape, dimension, young, poisson, density, property, stat, errmsg)
    integer, intent(in) :: shape
    real(c_double), contiguous, intent(in) :: dimension(:)
    real(c_double), intent(in) :: young, poisson, density
    real(c_double), contiguous, intent(inout) :: property(0:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(c_section_from_shape(to_c(shape), size(dimension, kind=c_int64_t), dimension, young, poisson, density, &
        size(property, kind=c_int64_t), property), c_null_ptr, stat, errmsg)
  end subroutine section_from_shape

  recursive subroutine section_build(property, stiffness, mass, stat, errmsg)
    real(c_double), contiguous, intent(in) :: property(0:)
    real(c_double), intent(inout), optional :: stiffness(6,6), mass(6,6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(c_section_build(size(property, kind=c_int64_t), property, stiffness, mass), c_null_ptr, stat, errmsg)
  end subroutine section_build

  recursive subroutine section_describe(stiffness, mass, property, findings, stat, errmsg)
    real(c_double), intent(in) :: stiffness(6,6)
    real(c_double), intent(in), optional :: mass(6,6)
    real(c_double), contiguous, intent(inout), optional :: property(0:)
    integer, intent(inout), optional :: findings
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int) :: status, c_findings
    integer(c_int64_t) :: capacity

    capacity = 0
    if (present(property)) capacity = size(property, kind=c_int64_t)
    status = c_section_describe(stiffness, mass, capacity, property, c_findings)
    call hand(status, c_findings, findings)
    call finish(status, c_null_ptr, stat, errmsg)
  end subroutine section_describe

  recursive subroutine section_report(stiffness, mass, text, stat, errmsg)
    real(c_double), intent(in) :: stiffness(6,6)
    real(c_double), intent(in), optional :: mass(6,6)
    character(:), allocatable, intent(inout) :: text
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer, parameter :: room = 1000
    character(kind=c_char) :: letters(room)
    integer(c_int) :: status
    integer :: i

    status = c_section_report(stiffness, mass, int(room, c_int64_t), letters)
    if (status == SPAR_OK) then
      text = ''
      do i = 1, room
        if (letters(i) == c_null_char) exit
        text = text // letters(i)
      end do
    end if
    call finish(status, c_null_ptr, stat, errmsg)
  end subroutine section_report

  recursive subroutine section_transform(matrix, y, z, angle, out, stat, errmsg)
    real(c_double), intent(in) :: matrix(6,6), y, z, angle
    real(c_double), intent(inout) :: out(6,6)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg

    call finish(c_section_transform(matrix, y, z, angle, out), c_null_ptr, stat, errmsg)
  end subroutine section_transform

  ! ---- shapes ----

  ! Triples of a fluid's n nodes: (3,n); of layout (1,component) (component,3), of layout (node,1) (node,n); of others as large as
  ! the layout needs.
  recursive subroutine need_triples(fluid, which, fault, array, has, n)
    class(spar_fluid), intent(in) :: fluid
    integer, intent(in) :: which
    character(:), allocatable, intent(inout) :: fault
    character(*), intent(in) :: array
    integer(c_int64_t), intent(in) :: has(:), n
    integer(c_int64_t) :: node, component, numbers
    integer :: stat

    if (allocated(fault)) return
    node = 3
    component = 1
    call fluid%get_layout(which, node, component, stat)
    if (stat /= SPAR_OK) return
    if (node == 1) then
      call need(fault, array, has, [merge(component, 0_c_int64_t, n > 0), 3_c_int64_t])
      return
    else if (component == 1) then
      call need(fault, array, has, [node, n])
      return
    end if
    numbers = 0
    if (n > 0) numbers = (n - 1) * node + 2 * component + 1
    if (product(has) >= numbers) return
    fault = array // ' has ' // trim(text_of(product(has))) // ' numbers; the layout of its fluid needs ' // &
        trim(text_of(numbers))
  end subroutine need_triples
end module spar
