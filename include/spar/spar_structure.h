/* spar_structure.h: what a structure can have beyond the basics of spar.h. Properties of beams, fidelity, effects,
   distributed loads, energies, section forces, static solutions, modes, and joints.

   The conventions of spar.h apply. Describing calls are made before the commit, on every rank with the same arguments.
   They are local and replace what was set before. Getters are local. */
#ifndef SPAR_STRUCTURE_H
#define SPAR_STRUCTURE_H

#include <spar/spar.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct spar_joint spar_joint; /* connects two nodes; belongs to its session */

/* ---- sections from engineering numbers --------------------------------------------------------------------------- */

/* Properties of a cross-section. y and z are the section axes at the reference line. y' and z' are the principal axes
   of bending: y and z rotated by ANGLE about x. A load that acts at the tension centre along x causes no curvature, one
   that acts at the shear centre across x causes no twist. Each stiffness is load over strain if no other load acts. */
enum {
    SPAR_SECTION_EA = 0,             /* N, axial */
    SPAR_SECTION_GA_Y = 1,           /* N, shear along y': G A times the shear factor */
    SPAR_SECTION_GA_Z = 2,           /* N, shear along z' */
    SPAR_SECTION_GJ = 3,             /* N m^2, torsion, about the shear centre */
    SPAR_SECTION_EI_Y = 4,           /* N m^2, bending about y', which deflects along z'; about the tension centre */
    SPAR_SECTION_EI_Z = 5,           /* N m^2, bending about z', which deflects along y' */
    SPAR_SECTION_ANGLE = 6,          /* rad, from y to y', right-handed about x */
    SPAR_SECTION_SHEAR_ANGLE = 7,    /* rad, from y' to the principal axis of shear of GA_Y; 0: y' itself */
    SPAR_SECTION_TENSION_Y = 8,      /* m, tension (elastic) centre, along y, from the reference line */
    SPAR_SECTION_TENSION_Z = 9,      /* m, along z */
    SPAR_SECTION_SHEAR_Y = 10,       /* m, shear centre */
    SPAR_SECTION_SHEAR_Z = 11,       /* m */
    SPAR_SECTION_MASS = 12,          /* kg/m */
    SPAR_SECTION_MASS_Y = 13,        /* m, mass centre */
    SPAR_SECTION_MASS_Z = 14,        /* m */
    SPAR_SECTION_INERTIA_Y = 15,     /* kg m, about y', at the mass centre; about x it is the sum of both */
    SPAR_SECTION_INERTIA_Z = 16,     /* kg m, about z' */
    SPAR_SECTION_INERTIA_ANGLE = 17, /* rad, from y' to the principal axis of INERTIA_Y; 0: y' itself */
    SPAR_SECTION_COUNT = 18
};
/* Shapes of one material, with their dimensions. */
enum {
    SPAR_SHAPE_CIRCLE = 0,    /* diameter */
    SPAR_SHAPE_TUBE = 1,      /* outer diameter, wall thickness */
    SPAR_SHAPE_RECTANGLE = 2, /* width along y, height along z */
    SPAR_SHAPE_BOX = 3        /* outer width along y and height along z, thickness of the two walls of this height, of
                                 the two of this width */
};
/* Properties of a shape of one isotropic material, with its centre on the line. Change what differs (an angle, a centre
   of mass, a mass that includes a coating), then build the matrices. Local, without a session.
     shape: in, SPAR_SHAPE_*
     n: in, number of dimensions of the shape
     dimension[n]: in, m, > 0
     young: in, Pa, > 0
     poisson: in, Poisson's ratio, -1 < poisson <= 0.5
     density: in, kg/m^3, 0: no mass
     capacity: in
     property[capacity]: out, by SPAR_SECTION_*
   Shear factors of circle, tube and rectangle are those of Cowper (1966). The shear factor of a box comes from the
   energy of its shear stresses: 1 % too small for walls of a twentieth of the side, 5 % for a fifth, up to 20 % if one
   pair of walls is much thicker. GJ of a rectangle is the series of Saint-Venant; GJ of a box has an error below 0.5 %.
   Walls of a box thicker than a fifth of the side across them are refused. SPAR_ERR_NUMERIC: a result is too small or
   too large for a number. */
SPAR_API int spar_section_from_shape(int shape, int64_t n, const double *dimension, double young, double poisson,
                                     double density, int64_t capacity, double *property);
/* Matrices for spar_beam_set_sections from properties. Local, without a session.
     n: in, entries given, the rest is 0; at most SPAR_SECTION_COUNT
     property[n]: in, by SPAR_SECTION_*; EA, GA, GJ, EI > 0
     stiffness[36]: out, NULL: not wanted; then no stiffness has to be given
     mass[36]: out, NULL: not wanted; else MASS > 0 and INERTIA >= 0
   SPAR_ERR_NUMERIC: a centre is so far from the line that rounding spoils the matrix. */
SPAR_API int spar_section_build(int64_t n, const double *property, double *stiffness, double *mass);
/* What a section has beside plain properties. */
enum {
    SPAR_FINDING_ASYMMETRIC = 1,     /* the stiffness is not symmetric; its symmetric part is described */
    SPAR_FINDING_INDEFINITE = 2,     /* the stiffness is not positive definite; it is not described */
    SPAR_FINDING_MASS = 4,           /* the mass is not that of a plane rigid section; it is not described */
    SPAR_FINDING_BEND_TWIST = 8,     /* bending and torsion are coupled */
    SPAR_FINDING_STRETCH_TWIST = 16, /* axial strain and torsion */
    SPAR_FINDING_STRETCH_SHEAR = 32, /* axial strain and shear */
    SPAR_FINDING_BEND_SHEAR = 64,    /* bending and shear */
    SPAR_FINDING_POLAR = 128,        /* the inertia about x is not the sum of those about y and z */
    SPAR_FINDING_ORDER = 256,        /* looks like the order of BeamDyn: shears, axial, bending, torsion */
    SPAR_FINDING_UNITS = 512         /* magnitudes of no known structure, in SI units */
};
/* Properties of given matrices: the inverse of spar_section_build. The principal axis of each of bending, shear and
   inertia named Y is the one within 45 degrees of y (of y'). Couplings are K_ij / sqrt(K_ii K_jj) at the centres, in
   principal axes; those below 0.001 are not findings. Local, without a session.
     stiffness[36]: in
     mass[36]: in, NULL: none
     capacity: in
     property[capacity]: out, by SPAR_SECTION_*; 0 where a finding says that it is not described, NULL: not wanted
     findings: out, SPAR_FINDING_* combined, 0: plain properties are the whole section, NULL: not wanted */
SPAR_API int spar_section_describe(const double stiffness[36], const double mass[36], int64_t capacity,
                                   double *property, int *findings);
/* The findings in words, with their numbers, one on a line.
     stiffness[36]: in
     mass[36]: in, NULL: none
     capacity: in; 1000 is enough
     text[capacity]: out, "" without findings; SPAR_ERR_ARGUMENT if it does not fit */
SPAR_API int spar_section_report(const double stiffness[36], const double mass[36], int64_t capacity, char *text);
/* The same section seen from another line and in other axes. For stiffness and mass alike. Local, without a session.
     matrix[36]: in, in the order of spar, about the old line
     y: in, m, where the new line is, in the old axes
     z: in, m
     angle: in, rad, from the old y to the new one, right-handed about x
     out[36]: out, may be matrix */
SPAR_API int spar_section_transform(const double matrix[36], double y, double z, double angle, double out[36]);

/* ---- beams: nodes and integration -------------------------------------------------------------------------------- */

/* Number of elements and of nodes in each. Within a trial that varies nodes: the present ones.
     elements: out, NULL: not wanted
     nodes_per_element: out, NULL: not wanted */
SPAR_API int spar_beam_get_elements(const spar_member *beam, int *elements, int *nodes_per_element);
/* The axis as spar_beam_set_axis or spar_beam_read_beamdyn has set it.
     n: out, 0: none, or nodes were given instead; NULL: not wanted
     capacity: in, of the arrays; n is enough
     eta[capacity]: out, NULL: not wanted
     xyz[capacity][3]: out, m, NULL: not wanted
     twist[capacity]: out, rad, NULL: not wanted */
SPAR_API int spar_beam_get_axis(const spar_member *beam, int64_t *n, int64_t capacity, double *eta, double *xyz,
                                double *twist);
/* The sections as spar_beam_set_sections or spar_beam_read_beamdyn has set them.
     n: out, 0: none; NULL: not wanted
     capacity: in, of the arrays; n is enough
     eta[capacity]: out, NULL: not wanted
     stiffness[capacity][36]: out, NULL: not wanted
     mass[capacity][36]: out, 0 without mass, NULL: not wanted */
SPAR_API int spar_beam_get_sections(const spar_member *beam, int64_t *n, int64_t capacity, double *eta,
                                    double *stiffness, double *mass);
/* Gives the nodes themselves instead of an axis, in the beam's own frame. They must be the Gauss-Lobatto-Legendre
   points of their elements; the commit refuses nodes that coincide or go back.
     n: in, elements * nodes_per_element
     x[n][3]: in, m; at an element boundary two nodes at one position
     q[n][4]: in, section frames; different ones at a boundary make a kink; NULL: as spar_beam_set_axis without twist */
SPAR_API int spar_beam_set_nodes(spar_member *beam, int64_t n, const double *x, const double *q);
/* Rules of integration along an element. */
enum { SPAR_QUADRATURE_GAUSS = 0, SPAR_QUADRATURE_LOBATTO = 1, SPAR_QUADRATURE_SECTIONS = 2 };
/* Integration along an element. Default: SECTIONS if there are more than two stations, else GAUSS with as many
   points as nodes. The commit refuses a rule that is too coarse for the element.
     rule: in, SPAR_QUADRATURE_*; SECTIONS has Gauss points in each piece between stations
     points: in, per element or piece, 1 (Lobatto 2) to 512; 0: as many as needed */
SPAR_API int spar_beam_set_quadrature(spar_member *beam, int rule, int points);
/* rule: out, the rule in use, NULL: not wanted
   points: out, as set; 0: not set; then GAUSS has as many as nodes, SECTIONS as many as the pieces need; NULL: not
           wanted */
SPAR_API int spar_beam_get_quadrature(const spar_member *beam, int *rule, int *points);
/* Axis, sections and damping from BeamDyn's files. BeamDyn's z axis, along the blade, becomes the beam's x axis;
   its x and y axes become y and z. Elements, nodes and quadrature stay those of the beam. Every rank reads the files.
     primary_path: in
     blade_path: in, NULL: the file named by the primary one, in its folder
   Stations run from 0 to 1, and counts must agree with the rows. Modal damping (damp_type 2) is not put in force: a
   warning has the ratios, for spar_beam_fit_damping after the commit. After a failure the beam is as it was.
   SPAR_ERR_IO: a file or a field cannot be read; SPAR_ERR_ARGUMENT: a matrix is not allowed; SPAR_ERR_UNSUPPORTED:
   damp_type above 2. */
SPAR_API int spar_beam_read_beamdyn(spar_member *beam, const char *primary_path, const char *blade_path);

/* ---- beams: masses, foundation, pretension, damping -------------------------------------------------------------- */

/* Rigid bodies or point masses attached to the beam: a nacelle, an engine, a float. They move with the section at eta.
   Their inertia, gyroscopic terms and weight are part of the beam's equations at every fidelity that has mass. Put an
   element boundary at a heavy one.
     n: in, 0 to 10000, 0: none
     eta[n]: in, in [0,1], in any order, repetitions allowed
     mass[n][36]: in, about the line in the section's axes, of the form of spar_rigid_create
   SPAR_ERR_STATE at the commit: the sections have no mass. */
SPAR_API int spar_beam_set_masses(spar_member *beam, int64_t n, const double *eta, const double *mass);
/* n: out, NULL: not wanted
   capacity: in, of the arrays; n is enough
   eta[capacity]: out, NULL: not wanted
   mass[capacity][36]: out, NULL: not wanted */
SPAR_API int spar_beam_get_masses(const spar_member *beam, int64_t *n, int64_t capacity, double *eta, double *mass);
/* Springs to the ground along the beam: soil around a pile, a rail's bed. The force per unit length is stiffness times
   the displacement from the reference configuration, along axes that do not rotate. The tangent is exact. Foundation
   forces are part of spar_member_get_loads and of reactions. Their energy is stored (SPAR_ENERGY_FOUNDATION), and no
   part of SPAR_WORK_LOADS.
     n: in, stations, 0 to 10000, 0: none (default)
     eta[n]: in, not decreasing in [0,1]; two stations at one eta are a jump
     stiffness[n][3]: in, N/m^2, >= 0, along the section's axes in the reference configuration; linear between stations,
           zero outside; n = 1: constant along the whole beam
   SPAR_ERR_UNSUPPORTED at the commit: prescribed, rigid or external members, linear or modal ones with a driven
   root. */
SPAR_API int spar_beam_set_foundation(spar_member *beam, int64_t n, const double *eta, const double *stiffness);
/* n: out, NULL: not wanted
   capacity: in, of the arrays; n is enough
   eta[capacity]: out, NULL: not wanted
   stiffness[capacity][3]: out, NULL: not wanted */
SPAR_API int spar_beam_get_foundation(const spar_member *beam, int64_t *n, int64_t capacity, double *eta,
                                      double *stiffness);
/* Section forces in the reference configuration: of a cable, a string, a tendon. They rotate with the section and are
   added to the forces of the strains. Under an axial force N a straight beam has the stiffness of EI and of a
   string with N; under -N it buckles. Where supports and loads do not balance the pretension, the beam deforms.
   Rigid and prescribed members ignore it.
     n: in, stations, 0 to 10000, 0: none (default)
     eta[n]: in, strictly increasing in [0,1]
     force[n][6]: in, N, N m, in the order of the stiffness, axial > 0 in tension; linear between stations, constant
           outside */
SPAR_API int spar_beam_set_pretension(spar_member *beam, int64_t n, const double *eta, const double *force);
/* n: out, NULL: not wanted
   capacity: in, of the arrays; n is enough
   eta[capacity]: out, NULL: not wanted
   force[capacity][6]: out, NULL: not wanted */
SPAR_API int spar_beam_get_pretension(const spar_member *beam, int64_t *n, int64_t capacity, double *eta,
                                      double *force);
/* Stiffness-proportional damping: stress = C (strain + mu strain rate).
     mu[6]: in, s, >= 0, per strain component in the order of the stiffness */
SPAR_API int spar_beam_set_damping(spar_member *beam, const double mu[6]);
/* mu[6]: out, s, also those of spar_beam_set_modal_damping; 0: none */
SPAR_API int spar_beam_get_damping(const spar_member *beam, double mu[6]);
/* Mass-proportional damping: a force of -alpha times mass times velocity. The velocity is relative to the rigid motion
   of the root, so the rotation of a blade as a whole is not damped. If the root is free, pinned or moved by joints,
   it is the absolute velocity, and the momentum of a free beam decays as exp(-alpha t). A mode with angular
   frequency omega has the damping ratio alpha / (2 omega). The force is an external one in the root's reaction. Its
   work on the rigid motion of a driven root is in no account of energy. It has no effect on rigid or prescribed beams
   with fixed or driven roots, and without INERTIA.
     alpha: in, 1/s, >= 0, 0: none (default)
   SPAR_ERR_UNSUPPORTED at the commit: a rigid beam with a free or pinned root. */
SPAR_API int spar_beam_set_mass_damping(spar_member *beam, double alpha);
/* alpha: out, 1/s */
SPAR_API int spar_beam_get_mass_damping(const spar_member *beam, double *alpha);

/* Holds a beam in a plane: displacements along the normal and rotations about other axes are 0 at all nodes. For
   two-dimensional flows, where mean pressure on both faces would twist a slab out of the plane. Loads out of the plane
   have no effect; what holds the beam in the plane is in no reaction. Modes and eigenvalues are those in the plane;
   section forces come from the strains. The root may be of any kind; initial velocities and driven roots must stay in
   the plane (SPAR_ERR_ARGUMENT).
     normal[3]: in, direction of any length, NULL or 0: not held (default)
   SPAR_ERR_UNSUPPORTED at the commit: fidelity below exact, or external; at the step: with joints. */
SPAR_API int spar_beam_set_plane(spar_member *beam, const double normal[3]);
/* normal[3]: out, of length 1; 0: not held; NULL: not wanted */
SPAR_API int spar_beam_get_plane(const spar_member *beam, double normal[3]);

/* ---- members: fidelity and effects ------------------------------------------------------------------------------- */

/* How much of a beam's mechanics is solved. For small deformation each entry is the limit of those below it. */
enum {
    SPAR_FIDELITY_PRESCRIBED = 0, /* one rigid body without mass that follows the root; nothing is solved */
    SPAR_FIDELITY_RIGID = 1,      /* one rigid body with the beam's mass; at most 6 unknowns */
    SPAR_FIDELITY_LINEAR = 2,     /* small deformation in the frame of the root; factored once */
    SPAR_FIDELITY_MODAL = 3,      /* the same in its lowest modes */
    SPAR_FIDELITY_EXACT = 4       /* geometrically exact */
};
/* Chooses the fidelity of a beam.
     kind: in, SPAR_FIDELITY_*, default exact
     modes: in, of a modal member, >= 1; else ignored
   prescribed  Fixed or driven root. No inertia, no weight; the support takes all loads.
   rigid       Any root. Mass, centre and inertia come from the sections. A static solution does not move it.
   linear      Fixed or driven root: the root moves exactly, the deformation relative to it is linear, with Coriolis,
               gyroscopic and centrifugal terms. Axial forces of the root's motion (a blade on a hub) and of weight (a
               mast) stiffen or soften it, unless the root is free. Neglected are second-order terms of the deformation,
               and stiffening by transverse forces and by applied and fluid loads. The factorisation stays while dt does
               and the root's angular velocity and acceleration, gravity included, stay in its own axes. Free or pinned
               root: linear about the reference configuration; a node that rotates by half a turn is SPAR_ERR_NUMERIC.
               No joints: there an exact beam costs about as much.
   modal       As linear, with the lowest `modes` modes with the root constrained; free and pinned roots count their 6
               or 3 rigid modes. The initial deformation is projected onto the modes.
   SPAR_ERR_ARGUMENT at the commit: too many modes for the nodes, or fewer than the rigid ones; SPAR_ERR_STATE:
   linear or modal with a free or pinned root, without INERTIA; SPAR_ERR_UNSUPPORTED: linear or modal with a joint;
   SPAR_ERR_NUMERIC: fewer modes have mass. */
SPAR_API int spar_member_set_fidelity(spar_member *member, int kind, int64_t modes);
/* kind: out, NULL: not wanted
   modes: out, of a modal member, else 0, NULL: not wanted */
SPAR_API int spar_member_get_fidelity(const spar_member *member, int *kind, int64_t *modes);
/* Effects. What is off is not computed, stored or sent. */
enum {
    SPAR_EFFECT_INERTIA = 1,        /* off: each step is a static equilibrium */
    SPAR_EFFECT_GYROSCOPIC = 2,     /* forces quadratic in the angular velocity */
    SPAR_EFFECT_GRAVITY = 4,        /* weight */
    SPAR_EFFECT_DAMPING = 8,        /* spar_beam_set_damping, spar_beam_set_mass_damping */
    SPAR_EFFECT_FLUID_MOMENT = 32,  /* moments given to spar_fluid_push_forces */
    SPAR_EFFECT_FLUID_HISTORY = 64, /* node forces kept for spar_fluid_pull_forces */
    SPAR_EFFECT_WORK = 128,         /* the account of spar_member_get_work */
    SPAR_EFFECT_MASSES = 512,       /* spar_beam_set_masses */
    SPAR_EFFECT_FOUNDATION = 1024,  /* spar_beam_set_foundation */
    SPAR_EFFECT_PRETENSION = 2048   /* spar_beam_set_pretension */
};
/* Switches effects of a member on or off. By default every effect is on that the description has data for, except
   SPAR_EFFECT_WORK; SPAR_EFFECT_FLUID_HISTORY is on for fluids with stations. A later call replaces an earlier one.
     switch_on: in, SPAR_EFFECT_* combined, to be on besides the defaults; one that the description has no data for is
           ignored
     switch_off: in, SPAR_EFFECT_* combined, of the defaults, to be off
   Local, before commit. SPAR_ERR_ARGUMENT: an effect is in both. */
SPAR_API int spar_member_set_effects(spar_member *member, int switch_on, int switch_off);
/* effects: out, SPAR_EFFECT_* combined, those in force. After commit. Local. */
SPAR_API int spar_member_get_effects(const spar_member *member, int *effects);

/* ---- members: description ---------------------------------------------------------------------------------------- */

/* x[3]: out, m, NULL: not wanted
   q[4]: out, NULL: not wanted */
SPAR_API int spar_member_get_placement(const spar_member *member, double x[3], double q[4]);
/* kind: out, SPAR_ROOT_* */
SPAR_API int spar_member_get_root(const spar_member *member, int *kind);
/* on: out, 1: the host solves the member */
SPAR_API int spar_member_get_external(const spar_member *member, int *on);
/* session: out, the session that the member belongs to; before the commit too */
SPAR_API int spar_member_get_session(const spar_member *member, spar_session **session);
/* The name given at creation; "" for NULL. The text lives as long as the session. */
SPAR_API const char *spar_member_get_name(const spar_member *member);

/* ---- members: loads, forces, energies ---------------------------------------------------------------------------- */

/* Distributed loads on a beam, per unit length of the reference line. They replace the earlier ones of their kind and
   stay until replaced. They are those at the end of the next step and linear within it, like spar_member_set_load.
     kind: in, SPAR_LOAD_DEAD: in global axes; SPAR_LOAD_FOLLOWER: in section axes, rotating with them
     n: in, stations, 0: none
     eta[n]: in, not decreasing in [0,1]; two stations at one eta are a jump
     load[n][6]: in, N/m, N m/m, linear between stations, zero outside; n = 1: constant along the whole beam
   They act at quadrature points of their own, by virtual work. After the commit. */
SPAR_API int spar_beam_set_line_load(spar_member *beam, int kind, int64_t n, const double *eta, const double *load);
/* What the support gives to the root: the rate of the member's momentum, with the accelerations of
   spar_member_get_motion, less its weight and loads. Fluid loads are those of the last solution; where they move
   nothing (on fixed and driven bodies), an accepted step has those pushed last. load[6]: out, N, N m, moment about the
   root; 0 if the root is free */
SPAR_API int spar_member_get_reaction(const spar_member *member, double load[6]);
/* Evaluates a beam at given positions along it.
     n: in
     eta[n]: in, in [0,1]; a boundary belongs to the element before it
     strain[n][6]: out, stretch, shears, twist, curvatures relative to the reference, 1 and 1/m, NULL: not wanted
     force[n][6]: out, N, N m, exerted by the part beyond, NULL: not wanted
     x[n][3]: out, position, m, NULL: not wanted
     q[n][4]: out, orientation, NULL: not wanted
   Strain and force are in section axes, in the order of the stiffness. force is the balance of the part beyond: its
   loads and joints less its inertia. It is as accurate as the reaction, also where a line load jumps. Where mass, a
   foundation or a fluid's load jumps inside an element, it is smoothed over about two nodes (mass 3:1, 9 nodes: 2 % of
   the force, 0.1 % of the moment); put an element boundary there. Strains are one order less accurate, and stiffness
   times strain equals force only in the limit. Before the first balance, and of rigid, prescribed or
   external beams, force is stiffness times strain. Linear and modal members have the strains of linear theory.
   SPAR_ERR_UNSUPPORTED: force of a beam without sections. */
SPAR_API int spar_beam_evaluate(const spar_member *beam, int64_t n, const double *eta, double *strain, double *force,
                                double *x, double *q);
/* Energies of a member, J. */
enum {
    SPAR_ENERGY_KINETIC = 0,
    SPAR_ENERGY_STRAIN = 1,     /* 0 in the reference configuration; may be negative with pretension */
    SPAR_ENERGY_GRAVITY = 2,    /* potential, 0 in the reference configuration */
    SPAR_ENERGY_DISSIPATED = 3, /* by damping, from t = 0 to t^n */
    SPAR_ENERGY_FOUNDATION = 4, /* in the springs of spar_beam_set_foundation */
    SPAR_ENERGY_COUNT = 5
};
/* Energies now. Members that spar does not solve have zeros. Linear and modal members have the quadratic forms of their
   equations; with a driven root that is the strain energy alone, the others are those of the motion.
     capacity: in
     energy[capacity]: out, by SPAR_ENERGY_*, J */
SPAR_API int spar_member_get_energy(const spar_member *member, int64_t capacity, double *energy);
/* Work done on a member, J. */
enum {
    SPAR_WORK_LOADS = 0,  /* by applied loads: dead, follower, distributed */
    SPAR_WORK_FLUID = 1,  /* by fluids */
    SPAR_WORK_ROOT = 2,   /* by a driven root */
    SPAR_WORK_JOINTS = 3, /* by joints */
    SPAR_WORK_COUNT = 4
};
/* Work in the accepted steps since the motion was set last (commit, static solution, initial velocity, load of a file).
   The sum of all energies less all work is constant to the order of the integrator. Needs SPAR_EFFECT_WORK, otherwise
   SPAR_ERR_STATE.
     capacity: in
     work[capacity]: out, by SPAR_WORK_*, J */
SPAR_API int spar_member_get_work(const spar_member *member, int64_t capacity, double *work);

/* ---- static solution, modes, eigenvalues ------------------------------------------------------------------------- */

/* Static equilibrium of one member, and of all members that joints connect to it, under gravity, applied loads and the
   fluid's present loads. It starts from the present state; velocities become 0. With a fluid that responds use
   spar_session_solve_static. Collective, between steps.
     load_steps: in, 1 to 100000, number of equal parts in which the loads are applied, from those that balance the
           present state on. A part that fails is halved, up to 5000 times.
   A driven root in steady rotation gives the equilibrium in the rotating frame, with centrifugal loads. Members
   connected to such a root, to a node with prescribed rotation or to a hinge driven at constant rate rotate with
   it. The result is a stable equilibrium: of dead forces the one that growing loads lead to. Members held by their
   loads alone (a body that hangs on a hinge) descend to a stable equilibrium.
   SPAR_ERR_NUMERIC: none was found, beyond a limit or bifurcation point, or with a motion that nothing constrains; the
   message names the motion. SPAR_ERR_LIMIT: option newton.budget (spar_session_set_option). SPAR_ERR_STATE: nothing
   constrains the member. SPAR_ERR_UNSUPPORTED: spar does not solve the member; or, in rotation, gravity, dead loads or
   joints to the ground are not symmetric about the axis. */
SPAR_API int spar_member_solve_static(spar_member *member, int load_steps);
/* Lowest modes about the present state, with the root constrained, in the frame rotating with the root. Geometric and
   centrifugal stiffness and spin softening are included; Coriolis terms and damping are not. Of unsymmetric stiffness
   (follower loads) the symmetric part is used. With joints: the modes of all connected members, the same whichever
   member is asked; constrained and driven motions stand still. Solve statically first so that the stress is known.
   Local.
     n: in, at most the number of free unknowns
     frequency_hz[n]: out, ascending; negative if the stiffness is, infinite without mass
     shapes[n][nodes][6]: out, displacement and rotation of this member's nodes, for unit modal mass of all connected
           members, NULL: not wanted
   SPAR_ERR_NUMERIC: no convergence; or rounding of very stiff strains leaves an error beyond 5e-4 of a frequency. Of
   linear and modal beams a warning says so instead. */
SPAR_API int spar_member_solve_modes(spar_member *member, int64_t n, double *frequency_hz, double *shapes);
/* Eigenvalues lambda of small motions x e^(lambda t) about the present state, at rest or in steady rotation. Damping,
   Coriolis, gyroscopic and unsymmetric stiffness terms are included (docs/explanation/theory.md). lambda is growth
   rate, 1/s, plus i times angular frequency, rad/s. A growth rate > 0 is an instability. Of conjugate pairs only the
   one with frequency >= 0 counts. Fluid loads stay constant. With joints: of all connected members. Local.
     n: in, at most the number of free unknowns
     shift[2]: in, growth rate and angular frequency; the eigenvalues nearest to it are found; NULL: 0, the lowest
     eigenvalue[n][2]: out, growth rate and angular frequency, by distance from the shift
     shapes[n][nodes][6][2]: out, real and imaginary part, for unit x^H M x, largest component real, NULL: not wanted
     frame[3]: out, rad/s, angular velocity of the frame in which x is seen, NULL: not wanted
   SPAR_ERR_STATE: no equilibrium; SPAR_ERR_UNSUPPORTED: parts rotate against each other and are not axisymmetric;
   SPAR_ERR_NUMERIC: fewer than n converged; or rounding hides one, as of spar_member_solve_modes. */
SPAR_API int spar_member_solve_eigenvalues(spar_member *member, int64_t n, const double shift[2], double *eigenvalue,
                                           double *shapes, double frame[3]);
/* Chooses stiffness-proportional damping such that two modes have given damping ratios. It replaces
   spar_beam_set_damping and adds to mass damping. Each mode sets mu of its dominant group of strains (bending about
   y with shear z, bending about z with shear y, torsion with stretch); the third group gets the geometric mean.
   A warning names a mode that gets more than 3 times the largest ratio chosen, or, of an assembly, less than half of
   the smallest. Between commit and first step, after the joints. Collective.
     mode[2]: in, from 0, as spar_member_solve_modes numbers them, of the member without joints
     ratio[2]: in, of critical damping, > 0
     mu[6]: out, s, NULL: not wanted
   SPAR_ERR_ARGUMENT: both modes have the same group; SPAR_ERR_NUMERIC: no mu gives these ratios. */
SPAR_API int spar_beam_set_modal_damping(spar_member *beam, const int64_t mode[2], const double ratio[2], double mu[6]);
/* Chooses proportional damping for the damping ratios of any number of modes: mu of three groups of strains (as
   spar_beam_set_modal_damping) and alpha of spar_beam_set_mass_damping, none below 0. It replaces both. The sum of the
   squares of (achieved / ratio - 1) is least. Up to four modes can be met if they differ in kind: first flap, second
   flap, first edge, first torsion. A group that no mode depends on gets the mean of what the modes ask for. It warns as
   spar_beam_set_modal_damping does. Between commit and first step. Collective.
     n: in, 1 to 1000
     mode[n]: in, from 0, as spar_member_solve_modes numbers them about the present state (at rest, or in steady
           rotation after a static solution), of the member without joints
     ratio[n]: in, of critical damping, > 0
     achieved[n]: out, ratios that the modes have, NULL: not wanted */
SPAR_API int spar_beam_fit_damping(spar_member *beam, int64_t n, const int64_t *mode, const double *ratio,
                                   double *achieved);

/* ---- joints ------------------------------------------------------------------------------------------------------ */

/* A joint connects node a of one member to node b of another, of the same member, or to the ground. In its axes it has
   six relative motions of a against b: displacements x, y, z and rotations. Each is constrained, free, driven, or free
   with spring and damper. The rotations are, by the number of free ones:
   - none: twice the vector part of the relative quaternion;
   - one, a hinge: the angle, counting turns; the other two are the misalignment of the axes;
   - two, a universal joint: angles about the two axes of the cross, counting turns. The first free axis in the order x,
     y, z is fixed in b, the second in a;
   - three, a ball: the rotation vector, below half a turn.
   Connected members are solved together on one rank. Constraints hold in position and velocity at the end of each step.
   Redundant constraints of loops are ignored, and named in the log. Joints connect members of any kind,
   except linear and modal beams. Prescribed ones move as prescribed, and spar_member_get_loads has the loads of joints
   on them. Joints are created before the first step, on every rank with the same arguments; all calls are local. */

/* Free motions of a joint, to be combined with |. */
enum { SPAR_FREE_X = 1, SPAR_FREE_Y = 2, SPAR_FREE_Z = 4, SPAR_FREE_RX = 8, SPAR_FREE_RY = 16, SPAR_FREE_RZ = 32 };
/* Creates a joint of two nodes. It belongs to the session.
     name: in, unique in the session, not empty, copied
     a: in
     node_a: in, from 0
     b: in, NULL: the ground
     node_b: in, from 0, ignored for the ground
     free_motions: in, SPAR_FREE_* combined: 0 a weld, RX a hinge, RX|RY a universal joint, RX|RY|RZ a ball, X a slider,
           X|RX a cylindrical joint, X|Y|RZ a planar joint, all six for springs alone
     joint: out
   SPAR_ERR_UNSUPPORTED: a member is committed as a linear or modal beam; likewise the other calls that create a
   joint. If the joint comes first, spar_member_commit refuses. */
SPAR_API int spar_joint_create(spar_session *session, const char *name, spar_member *a, int64_t node_a, spar_member *b,
                               int64_t node_b, int free_motions, spar_joint **joint);
/* Position and axes of the joint in the reference configuration. Rigid arms lead from both nodes to it. Default: the
   position and section axes of node a. Before the first step.
     x[3]: in, m
     q[4]: in, NULL: the section axes of node a */
SPAR_API int spar_joint_set_frame(spar_joint *joint, const double x[3], const double q[4]);
/* Spring and damper on the free motions z: load on a = preload - stiffness z - damping dz/dt. Replaces earlier ones.
     stiffness[36]: in, symmetric, N/m, N, N m/rad, 0 for constrained motions, NULL: 0
     damping[36]: in, symmetric, the same times s, NULL: 0
     preload[6]: in, N, N m, NULL: 0 */
SPAR_API int spar_joint_set_spring(spar_joint *joint, const double stiffness[36], const double damping[36],
                                   const double preload[6]);
/* Creates a spring from one node of a member to the ground: a joint at the node, in its section axes (of a rigid body
   its own axes). The same as spar_joint_create with b NULL and spar_joint_set_spring. Before the first step.
     session: in
     name: in, not empty, of no other joint of the session
     member: in, of the session
     node: in
     free_motions: in, SPAR_FREE_* combined, on which the spring acts; the others are held. A cylinder in a stream has
           SPAR_FREE_Y
     stiffness[36]: in, as of spar_joint_set_spring, NULL: 0
     damping[36]: in, as of spar_joint_set_spring, NULL: 0
     preload[6]: in, N, N m, NULL: 0
     joint: out, NULL: not wanted
   Local, the same on every rank. */
SPAR_API int spar_spring_create(spar_session *session, const char *name, spar_member *member, int64_t node,
                                int free_motions, const double stiffness[36], const double damping[36],
                                const double preload[6], spar_joint **joint);
/* Chooses which free motions spar_joint_drive prescribes. Before the first step.
     mask: in, SPAR_FREE_* combined */
SPAR_API int spar_joint_set_driven(spar_joint *joint, int mask);
/* Prescribes the driven motions at the end of the next step. Without a new call they stay. Other entries are ignored.
   Between steps.
     motion[6]: in, m, rad; angles of hinges and universal joints count turns; of a ball the rotation vector, below
           half a turn
     rate[6]: in, NULL: 0
     acceleration[6]: in, NULL: 0 */
SPAR_API int spar_joint_drive(spar_joint *joint, const double motion[6], const double rate[6],
                              const double acceleration[6]);
/* A load between the two nodes: a motor, a generator, a brake. It stays until replaced. It is the load at the end
   of the next step and linear within it.
     load[6]: in, N, N m, on a from b, on the free motions */
SPAR_API int spar_joint_set_load(spar_joint *joint, const double load[6]);
/* Creates a link: a joint whose one motion, the first of six, is the distance of two points fixed to their nodes. The
   distance is constrained (a rod), driven (an actuator, motion[0] its length), or on a spring.
     name: in, as for a joint
     a: in
     node_a: in
     point_a[3]: in, m, global, in the reference configuration
     b: in, NULL: the ground
     node_b: in
     point_b[3]: in, m, not point_a
     joint: out */
SPAR_API int spar_link_create(spar_session *session, const char *name, spar_member *a, int64_t node_a,
                              const double point_a[3], spar_member *b, int64_t node_b, const double point_b[3],
                              spar_joint **joint);
/* Puts a link on a spring. Before the first step.
     stiffness: in, N/m, >= 0
     damping: in, N s/m, >= 0
     length: in, m, unstretched, >= 0
     tension_only: in, 1: a rope, without load up to its length and max(0, k (d - l) + c d') beyond; 0: a strut
   In the step in which a rope comes taut, d' is limited to the rate at which the stretch can have grown in the step. */
SPAR_API int spar_link_set_spring(spar_joint *joint, double stiffness, double damping, double length, int tension_only);
/* Relative motion at the latest iterate, between steps at t^n; 0 before the first step or static solution.
     motion[6]: out, m, rad; a link has its distance in the first, NULL: not wanted
     rate[6]: out, NULL: not wanted
     acceleration[6]: out, NULL: not wanted */
SPAR_API int spar_joint_get_motion(const spar_joint *joint, double motion[6], double rate[6], double acceleration[6]);
/* The load of the joint on a, at the joint's point of a, in the joint's axes as b carries them (the ground's stay); b
   gets the opposite at the same point. Of two or three free rotations, the moments are those that work on the angles or
   on the rotation vector.
     load[6]: out, N, N m: of constrained motions the constraint's, of free ones spring, damper and
           spar_joint_set_load; a link has its tension, negative in a, in the first */
SPAR_API int spar_joint_get_load(const spar_joint *joint, double load[6]);
/* Energies of a joint, J. */
enum {
    SPAR_JOINT_ENERGY_SPRING = 0, /* stored in springs, less the work of the preload, at the latest iterate */
    SPAR_JOINT_ENERGY_DAMPER = 1, /* dissipated by dampers up to t^n */
    SPAR_JOINT_ENERGY_DRIVE = 2,  /* work of the drive up to t^n */
    SPAR_JOINT_ENERGY_LOAD = 3,   /* work of spar_joint_set_load up to t^n */
    SPAR_JOINT_ENERGY_COUNT = 4
};
/* Needs SPAR_EFFECT_WORK of one of its members, otherwise SPAR_ERR_STATE. The work of the joint on its two nodes is
   that of drive and load less what damper and spring take, to the order of the integrator.
     capacity: in
     energy[capacity]: out, by SPAR_JOINT_ENERGY_*, J */
SPAR_API int spar_joint_get_energy(const spar_joint *joint, int64_t capacity, double *energy);

#ifdef __cplusplus
}
#endif

#endif
