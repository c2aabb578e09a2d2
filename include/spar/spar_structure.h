/* spar_structure.h: what a structure can have beside the basics of spar.h: properties of beams, fidelity, effects, energies,
   section results, statics, modes, joints. The conventions are those of spar.h. */
#ifndef SPAR_STRUCTURE_H
#define SPAR_STRUCTURE_H

#include <spar/spar.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- beams --------------------------------------------------------------------------------------------------------- */

/* Rules of integration along an element, spar_beam_set_quadrature. */
enum { SPAR_QUADRATURE_GAUSS = 0, SPAR_QUADRATURE_LOBATTO = 1, SPAR_QUADRATURE_SECTIONS = 2 };
/* What it was created with, or, within a trial that varies nodes, has now. elements, nodes_per_element: out, NULL: not
   wanted. Local. */
SPAR_API int spar_beam_get_elements(const spar_member *beam, int *elements, int *nodes_per_element);
/* The nodes themselves, instead of an axis, in the beam's own frame. Local.
     n: in, elements*nodes_per_element, element by element (a joint stands twice, at the same place; its two
           orientations may differ: a kink)
     x[n][3]: in, m
     q[n][4]: in, section frames, NULL: tangent and the rule of the conventions
   The commit refuses nodes that coincide or go back: they stand at their elements' Gauss-Lobatto-Legendre points. */
SPAR_API int spar_beam_set_nodes(spar_member *beam, int64_t n, const double *x, const double *q);
/* Rigid bodies, or points of mass, that sit on a beam and go with its line and its sections: a nacelle, an engine, a
   float, an instrument. Their inertia, gyroscopic terms and weight are the beam's, in all that is made of these: steps,
   statics on turning roots, modes, energies, reactions; every fidelity that has mass has them. Replaces what was set
   before. Local, before commit.
     n: in, 0 to 10000, 0: none any more
     eta[n]: in, in [0,1], in any order; several may be at one place
     mass[n][36]: in, about the line at eta and in the section's axes there: m I, m c~ and J as of a rigid body with its
           centre of mass at c; any other form is refused
   A body belongs to the place of the line and not to a node: between nodes it moves as the field between them does, and
   where its weight or inertia is large an end of an element there takes the kink that it makes in the section forces.
   SPAR_ERR_STATE at commit: the sections have no mass. */
SPAR_API int spar_beam_set_masses(spar_member *beam, int64_t n, const double *eta, const double *mass);
/* n: out, how many there are, NULL: not wanted; capacity: in, of the arrays; eta[capacity], mass[capacity][36]: out, 0
   behind the last, NULL: not wanted. Local. */
SPAR_API int spar_beam_get_masses(const spar_member *beam, int64_t *n, int64_t capacity, double *eta, double *mass);
/* A foundation: springs to the ground all along a beam, soil about a pile or a rail's bed. They pull the line back to
   where it is in the reference configuration, with a force per unit length of stiffness times displacement, along axes
   that stay; their tangent is exact. They take part in steps, statics, modes and eigenvalues, and are loads in what
   spar_member_get_loads gives, in reactions and in the account of work; what they store is in
   spar_member_get_energy. Replaces what was set before. Local, before commit.
     n: in, stations, 0 to 10000, 0: none (default)
     eta[n]: in, not decreasing in [0, 1], two stations at one eta are a jump
     stiffness[n][3]: in, N/m^2, >= 0, along the section's axes in the reference configuration (x tangent, y, z); linear
           in eta between stations, zero before the first and behind the last; n = 1: the same all along
   SPAR_ERR_UNSUPPORTED at commit: the member is prescribed, rigid or external, or linear or modal with a root that is
   driven; or at the step, when joints move the root of a linear or modal one (its frame then moves against the ground).
   Modes of a modal member are those on its springs. */
SPAR_API int spar_beam_set_foundation(spar_member *beam, int64_t n, const double *eta, const double *stiffness);
/* n: out, stations, NULL: not wanted; capacity: in, of the arrays; eta[capacity], stiffness[capacity][3]: out, 0 behind
   the last, NULL: not wanted. Local. */
SPAR_API int spar_beam_get_foundation(const spar_member *beam, int64_t *n, int64_t capacity, double *eta,
                                      double *stiffness);
/* Pretension: section forces that the beam carries in its reference configuration, where no strain is: of a cable, a
   string, a shaft that was pulled, a section with tendons. They stay what they are in the section's axes, which turn,
   and those of the strains are added to them: straight under a tension N a beam has the bending stiffness of EI and the
   string's N besides, under -N it buckles. In steps, statics, modes and eigenvalues, section forces and energies. Where
   neither roots, joints nor loads balance it, the beam takes the shape that does: an end that nothing holds lets the
   tension go. A linear or modal member has the stiffness of what is given, balanced or not; a rigid or prescribed one,
   which does not deform, leaves it out. Replaces what was set before. Local, before commit.
     n: in, stations, 0 to 10000, 0: none (default)
     eta[n]: in, strictly increasing in [0,1]
     force[n][6]: in, N and N m: axial (> 0: tension), shear y, z, torsion, bending y, z, as of the stiffness; linear in
           eta between stations, constant before the first and behind the last */
SPAR_API int spar_beam_set_pretension(spar_member *beam, int64_t n, const double *eta, const double *force);
/* n: out, stations, NULL: not wanted; capacity: in, of the arrays; eta[capacity], force[capacity][6]: out, 0 behind the
   last, NULL: not wanted. Local. */
SPAR_API int spar_beam_get_pretension(const spar_member *beam, int64_t *n, int64_t capacity, double *eta,
                                      double *force);
/* Integration along an element. Default: sections if there are more than two stations, else Gauss with as many points
   as nodes. Commit refuses a rule too coarse for the element. Local.
     rule: in, SPAR_QUADRATURE_GAUSS or _LOBATTO with `points` in an element, _SECTIONS with `points` Gauss points in
           each piece between section stations
     points: in, 1 (Lobatto 2) to 512 */
SPAR_API int spar_beam_set_quadrature(spar_member *beam, int rule, int points);
/* rule: out, the one in force; points: out, 0 if they were not set: as many as nodes, or in each piece between sections
   as many as its length asks for. NULL: not wanted. Local. */
SPAR_API int spar_beam_get_quadrature(const spar_member *beam, int *rule, int *points);
/* Stiffness-proportional damping: stress = C (strain + mu strain rate), per strain component in the order of the
   stiffness. mu[6]: in, s, >= 0. Local. */
SPAR_API int spar_beam_set_damping(spar_member *beam, const double mu[6]);
/* Mass-proportional damping, the other half of Rayleigh's: mass times alpha times the velocity that the root sees, with
   its own motion and turn taken off, so that a blade that turns as a whole is not braked. Where the root is free or
   pinned, or joints move it, it is the velocity as it is, seen from axes that stand: a beam that flies is braked as by
   a fluid about it, its momenta go down as exp(-alpha t). A mode at omega at rest has alpha / (2 omega) of critical
   damping, and what spar_beam_set_damping gives it besides. As an outer force it takes part in the root's reaction. Of
   a rigid or prescribed beam on a root that is fixed or driven, which does not deform, and of one with INERTIA off it
   does nothing. SPAR_ERR_UNSUPPORTED at commit: the beam is rigid and its root free or pinned; at the step: it is
   linear or modal and joints move its root. Part of SPAR_EFFECT_DAMPING. Local, before commit.
     alpha: in, 1/s, >= 0; 0 (default): none */
SPAR_API int spar_beam_set_mass_damping(spar_member *beam, double alpha);
/* alpha: out, 1/s, NULL: not wanted. Local. */
SPAR_API int spar_beam_get_mass_damping(const spar_member *beam, double *alpha);
/* mu[6]: out, s, also those of spar_beam_set_modal_damping; 0: none. Local. */
SPAR_API int spar_beam_get_damping(const spar_member *beam, double mu[6]);
/* Axis, sections and damping of a beam from BeamDyn's files: the primary file's members, key points and twist, the
   blade file's stations. BeamDyn's z axis, along the blade, becomes the beam's x axis, its x and y axes y and z.
   Elements, nodes and quadrature are those of the beam, not of the files; where elements join is eta, not where members
   do. Every rank reads the files. Local, before commit.
     primary_path: in
     blade_path: in, NULL: the file that the primary one names, beside it
   SPAR_ERR_IO: a file cannot be read, or a field cannot; the message names file, line and field, and the beam is as it
   was. SPAR_ERR_ARGUMENT: a matrix is not allowed. SPAR_ERR_UNSUPPORTED: damp_type beyond 1. */
SPAR_API int spar_beam_read_beamdyn(spar_member *beam, const char *primary_path, const char *blade_path);

/* ---- members ------------------------------------------------------------------------------------------------------- */

/* x[3], q[4]: out, NULL: not wanted. Local. */
SPAR_API int spar_member_get_placement(const spar_member *member, double x[3], double q[4]);
/* kind: out. Local. */
SPAR_API int spar_member_get_root(const spar_member *member, int *kind);
/* on: out. Local. */
SPAR_API int spar_member_get_external(const spar_member *member, int *on);
/* session: out, that the member was created in. Before commit too. */
SPAR_API int spar_member_get_session(const spar_member *member, spar_session **session);
/* The name it was created with, as long as its session lives; "" of NULL. */
SPAR_API const char *spar_member_get_name(const spar_member *member);
/* How much of a beam's mechanics is kept; each is the limit of those below it in this list for small deformation. */
enum {
    SPAR_FIDELITY_PRESCRIBED = 0, /* follows the root as one rigid body, without mass; nothing is solved */
    SPAR_FIDELITY_RIGID = 1,      /* one rigid body of the whole mass; 6 unknowns at most */
    SPAR_FIDELITY_LINEAR = 2,     /* small deformation in the frame of the root; factored once */
    SPAR_FIDELITY_MODAL = 3,      /* the same in its lowest modes */
    SPAR_FIDELITY_EXACT = 4
};
/* How a beam is solved. kind: in, SPAR_FIDELITY_*, default exact; modes: in, of a modal member, >= 1, else unused.
     prescribed  needs a fixed or driven root; its support takes the loads (get_reaction), it has neither inertia nor
                 weight
     rigid       any root; mass, centre and inertia from the sections. solve_static leaves it where it is
     linear      fixed or driven root: the root's motion is exact, the deformation seen from the root is linear, with
                 Coriolis, gyroscopic and centrifugal terms and the stiffening by centrifugal forces. Neglected: terms
                 of second order in the deformation (shortening of a bent beam; moments of loads on displaced arms),
                 stiffening by other loads. One factorisation as long as dt and the root's turning speed, in its own
                 axes, do not change. Free or pinned root: linear about the reference; nothing holds such a beam for
                 solve_static. A node that turns by half a turn against root or reference ends the step:
                 SPAR_ERR_NUMERIC. Where joints tie it the root may be free or pinned and turn as far as it likes: the
                 deformation is linear as seen from the root's node, wherever that goes; of the stiffening that along
                 the line counts, by the member's own inertia
     modal       as linear, with the lowest `modes` modes of the beam with its root held; of a free or pinned beam those
                 it has so, of which the first 6 or 3 move it as a rigid body. Initial deformation is brought to the
                 nearest one that the modes have. Where joints tie it: the 6 or 3 rigid motions of its root, and modes
                 with the root and all other tied nodes held; each of these other nodes brings six shapes of its own, in
                 which it moves and the rest follows statically (Craig and Bampton), beside the `modes`; more modes than
                 the other nodes leave are not taken
   Beams only, before commit. Local. At commit SPAR_ERR_ARGUMENT: more modes than the nodes have, or fewer than those 6
   or 3; SPAR_ERR_STATE: linear or modal, free or pinned, with INERTIA off; SPAR_ERR_NUMERIC: fewer modes with mass. */
SPAR_API int spar_member_set_fidelity(spar_member *member, int kind, int64_t modes);
/* kind: out; modes: out, of a modal member, else 0. NULL: not wanted. Local. */
SPAR_API int spar_member_get_fidelity(const spar_member *member, int *kind, int64_t *modes);
/* Effects: what is off is not computed, stored or sent. */
enum {
    SPAR_EFFECT_INERTIA = 1,        /* off: each step is a static equilibrium */
    SPAR_EFFECT_GYROSCOPIC = 2,     /* forces quadratic in the angular velocity */
    SPAR_EFFECT_GRAVITY = 4,        /* weight */
    SPAR_EFFECT_DAMPING = 8,        /* spar_beam_set_damping, spar_beam_set_mass_damping */
    SPAR_EFFECT_FLUID_MOMENT = 32,  /* moments given to spar_fluid_push_forces */
    SPAR_EFFECT_FLUID_HISTORY = 64, /* node forces kept for spar_fluid_pull_forces */
    SPAR_EFFECT_WORK = 128,         /* the account of spar_member_get_work */
    SPAR_EFFECT_DEFAULT = 256,      /* all that is on where nothing is set; or-ed with what is wanted besides */
    SPAR_EFFECT_MASSES = 512,       /* bodies of spar_beam_set_masses */
    SPAR_EFFECT_FOUNDATION = 1024,  /* springs of spar_beam_set_foundation */
    SPAR_EFFECT_PRETENSION = 2048   /* section forces of spar_beam_set_pretension */
};
/* effects: in, SPAR_EFFECT_* or-ed. Default: what the description implies (no damping given, none computed), without
   WORK, and with FLUID_HISTORY for the fluids that are made of sections. Asking for what the description has nothing
   for is legal and has no effect. Local. */
SPAR_API int spar_member_set_effects(spar_member *member, int effects);
/* effects: out, those in force: of what was asked for, or of all, what the description has something for. After commit.
   Local. */
SPAR_API int spar_member_get_effects(const spar_member *member, int *effects);
/* Loads along a beam, per unit length of the reference line, which replace the earlier ones of that kind and are kept.
   They are those at the end of the next step, linear in the step as those of spar_member_set_load.
     kind: in, SPAR_LOAD_DEAD (global axes) or _FOLLOWER (section axes, turning with the section)
     n: in, stations, 0: none any more
     eta[n]: in, not decreasing in [0, 1], two stations at one eta are a jump
     load[n][6]: in, N/m, N m/m, linear in eta between stations, zero before the first and behind the last; n = 1: the
           same all along
   They work at quadrature points of their own, so that they may change where sections do not, through the virtual work
   of the beam's displacement and rotation field. After commit. Local, the same on every rank. SPAR_ERR_ARGUMENT: no
   beam, or eta or load not allowed. */
SPAR_API int spar_beam_set_line_load(spar_member *beam, int kind, int64_t n, const double *eta, const double *load);
/* load[6]: out, what the support gives the root, moment about the root; 0 where it is free. */
SPAR_API int spar_member_get_reaction(const spar_member *member, double load[6]);
/* Sections of a beam now. Local. Each output NULL: not wanted.
     n: in, places
     eta[n]: in, in [0, 1]; a joint belongs to the element before it
     strain[n][6]: out, stretch, shears, twist, curvatures beyond the reference (1, 1/m)
     force[n][6]: out, N, N m, what the part beyond gives
     x[n][3]: out, place, m
     q[n][4]: out, orientation
   Strain and force are in section axes (x tangent, y, z), in the order axial, shear y, shear z, torsion, bending y,
   bending z. force is the balance of the part beyond: its loads, what joints put on it, less its inertia. It is as
   exact as the reaction, and at the root it is the reaction less the loads at that node. A load at a node within the
   line counts in the section there. Strains converge one order behind the displacements; stiffness and damping times
   them is force only in the limit. force is made of them for a beam that is rigid, prescribed or external, and until a
   first step or static solution has found a balance. The strains of a linear or modal member are those of linear
   theory, as in its strain energy: of the displacement and rotation vector seen from the root where that is fixed or
   driven or joints tie the beam, else from the reference; of a rigid or prescribed one 0. Its forces have the arms and
   axes of the reference where its equations stand there: fixed, pinned or free roots, without pretension. SPAR_ERR_UNSUPPORTED: force of a beam without
   sections. */
SPAR_API int spar_beam_evaluate(const spar_member *beam, int64_t n, const double *eta, double *strain, double *force,
                                   double *x, double *q);
/* Energies of a member, J. */
enum {
    SPAR_ENERGY_KINETIC = 0,
    SPAR_ENERGY_STRAIN = 1,     /* 0 in the reference configuration; with pretension it may fall below */
    SPAR_ENERGY_GRAVITY = 2,    /* potential, 0 in the reference configuration */
    SPAR_ENERGY_DISSIPATED = 3, /* by damping since t = 0, up to t^n */
    SPAR_ENERGY_FOUNDATION = 4, /* stored in the springs of spar_beam_set_foundation */
    SPAR_ENERGY_COUNT = 5
};
/* energy[capacity]: out, by SPAR_ENERGY_*, NULL: not wanted. Members spar does not solve for give zeros. Linear
   and modal members give the quadratic forms of their equations; on a driven root only the strain energy, the others
   are those of the motion. A modal member that joints tie gets its shapes for that from
   the first call that steps, solves, saves or tries, and its energies are of those from then on. */
SPAR_API int spar_member_get_energy(const spar_member *member, int64_t capacity, double *energy);
/* Work done on a member, J. */
enum {
    SPAR_WORK_LOADS = 0,  /* by the loads kept: dead, follower, line */
    SPAR_WORK_FLUID = 1,  /* by the fluids */
    SPAR_WORK_ROOT = 2,   /* by a driven root */
    SPAR_WORK_JOINTS = 3, /* by joints: what they give its nodes */
    SPAR_WORK_COUNT = 4
};
/* work[capacity]: out, by SPAR_WORK_*, NULL: not wanted. Of the accepted steps since the motion was set last (commit,
   static solution, initial velocity, load). Kinetic + strain + potential + dissipated energy less the sum of the four
   stays constant to the order of the integrator; of a linear or modal member on a root that turns but for the
   shortening of the bent beam, which they neglect. Local. SPAR_ERR_STATE: SPAR_EFFECT_WORK was not asked for. */
SPAR_API int spar_member_get_work(const spar_member *member, int64_t capacity, double *work);

/* ---- statics, modes, eigenvalues ----------------------------------------------------------------------------------- */

/* Static equilibrium of one member under gravity, all kept loads and the fluid loads in use, from the present state;
   velocities become 0. With the fluid's answer: spar_session_solve_static. Between steps. Collective.
     load_steps: in, 1 to 100000, in how many parts the loads come on together; a part is halved and tried again where it
           fails. No more than 5000 parts are taken besides (SPAR_ERR_NUMERIC)
   A driven root that turns (spar_member_set_initial_velocity, or driven so far): equilibrium in the frame that turns
   with it, under the centrifugal loads of its angular velocity and the acceleration of its place; velocities and
   accelerations become those of the deformed shape turning steadily. Members that joints tie to such a root, to a node
   that is told to turn, or to a hinge that is driven with a rate against what stands, turn with it as one; there
   gravity and dead loads across the axis, parts that turn or are driven against each other, and joints to what stands
   that are not alike all around are SPAR_ERR_UNSUPPORTED. Under dead forces (no moments, no followers) the result is
   the stable equilibrium that growing loads lead to: past a limit or branching point there is none, and it is refused.
   Where neighbouring nodes are turned by more than 2.2 rad against each other, more than they can follow, a log is
   warned. Members that joints tie may be held by their loads alone, as a body that hangs on a hinge is: the solution goes
   downhill from the present state to a stable equilibrium. SPAR_ERR_NUMERIC: not found, the message says which part of
   the loads was reached and what is in the way: a motion that nothing holds, or one that would leave an unstable
   equilibrium (a body that stands on its hinge); SPAR_ERR_STATE: nothing holds the member; SPAR_ERR_UNSUPPORTED: spar
   does not solve for it. */
SPAR_API int spar_member_solve_static(spar_member *member, int load_steps);
/* The lowest modes about the present state, the root held as it is, in the frame that turns with the root's present
   angular velocity: geometric stiffness of the stress, centrifugal stiffening and spin softening included, Coriolis'
   terms left out; of unsymmetric load stiffness (followers) the symmetric part. Of a linear or modal
   member: those of its equations, with the root's present turn, without load stiffness; of a rigid one those of the
   rigid body. A rotor: set_root DRIVEN, set_initial_velocity, commit, solve_static, solve_modes.
   Of a member that joints tie to others: the modes of them all, on which they agree to the bit whichever is asked, and
   the member's part of the shapes; what joints hold or drive stands still, their springs and the turning of their loads
   are in the stiffness (solve statically first, so that the loads are known), their dampers are left out. Parts that
   turn are seen as said above, each from its root's frame, which means most where all turn alike. Local.
     n: in, modes, at most the number of free unknowns less what joints hold
     frequency_hz[n]: out, ascending, negative where the stiffness is, infinite where there is no mass
     shapes[n][nodes][6]: out, displacement and rotation, normalised to unit modal mass, of an assembly that of all its
           members together, NULL: not wanted */
SPAR_API int spar_member_solve_modes(spar_member *member, int64_t n, double *frequency_hz, double *shapes);
/* Eigenvalues of the small motions x e^(lambda t) about the present state, at rest or turning steadily, with all that
   spar_member_solve_modes leaves out: damping, Coriolis' and gyroscopic terms and the unsymmetric stiffness of loads
   that follow are in the equations M x'' + C x' + K x = 0 (docs/theory.md). lambda = growth rate, 1/s, + i times
   angular frequency, rad/s: a growth rate > 0 is an instability, with a frequency flutter or whirl, without one
   buckling. Of the conjugate pairs of eigenvalues the one with frequency >= 0 counts alone; a motion without stiffness
   (a free body's) has zero twice, which counts once. Fluid loads stay as they are: the fluid's answer is not there. Of
   a member that joints tie to others: those of them all, dampers included, the same whichever is asked. Linear and
   modal members: of their equations, as for modes. Local.
     n: in, how many, at most the number of unknowns that the roots leave free
     shift[2]: in, growth rate, 1/s, and angular frequency, rad/s: those nearest to it are found; NULL: zero, the lowest
     eigenvalue[n][2]: out, growth rate and angular frequency, by their distance from the shift
     shapes[n][nodes][6][2]: out, displacement and rotation, real and imaginary part, of unit x^H M x (of all parts
           together), the phase such that its largest part is real; NULL: not wanted
     frame[3]: out, rad/s, how the frame turns that x is seen from: as the whole where all turns as one (a whirl of w in
           axes that stand is seen as w +- that), else 0; NULL: not wanted
   Up to 90 unknowns are solved as one dense problem, more by restarted shift-and-invert Arnoldi iterations; what is
   handed out has been tried in the equations. SPAR_ERR_STATE: the state is no equilibrium; SPAR_ERR_UNSUPPORTED: parts
   turn against each other and are not alike all around, so that the equations change with time; SPAR_ERR_NUMERIC: fewer
   than n were found, the others having no mass or not converging. */
SPAR_API int spar_member_solve_eigenvalues(spar_member *member, int64_t n, const double shift[2], double *eigenvalue,
                                           double *shapes, double frame[3]);
/* Stiffness-proportional damping that gives two modes their damping ratios, in place of spar_beam_set_damping's and
   beside spar_beam_set_mass_damping's: each
   mode sets the mu of the strains that hold most of its energy (bending about y with shear z, bending about z with
   shear y, torsion with stretch), the third group gets the geometric mean. Between commit and the first step.
   Collective.
     mode[2]: in, from 0, as spar_member_solve_modes gives them now; of the member by itself where joints tie it
     ratio[2]: in, of critical, > 0
     mu[6]: out, s, what has been set, NULL: not wanted
   SPAR_ERR_ARGUMENT: both modes are of one kind; SPAR_ERR_NUMERIC: no mu gives these ratios (as of a mode that moves a
   free or pinned beam as a rigid body). */
SPAR_API int spar_beam_set_modal_damping(spar_member *beam, const int64_t mode[2], const double ratio[2], double mu[6]);

/* ---- joints -------------------------------------------------------------------------------------------------------- */

/* Relative motions of a joint that are free, in its own axes; or-ed. */
enum { SPAR_FREE_X = 1, SPAR_FREE_Y = 2, SPAR_FREE_Z = 4, SPAR_FREE_RX = 8, SPAR_FREE_RY = 16, SPAR_FREE_RZ = 32 };

/* ---- joints ------------------------------------------------------------------------------------------------------ */

/* A joint ties node a of a member to node b of another (or of the same), or to the ground. In axes of its own it has
   six motions, of a relative to b, each held, free, driven, or on a spring and damper: displacements x, y, z of a's end
   in b's axes, and rotations. These are, to first order, turns about x, y, z.
   - None free: twice the vector part of the relative quaternion.
   - One free, a hinge: its angle, which counts its turns. The other two are how far a's axis leaves b's.
   - Two free, a universal joint: the angles about the two arms of its cross, which count their turns. The first free
     axis, in the order x, y, z, is fixed in b, the second in a. They stay perpendicular: the held coordinate is the sine
     of what they are off. The shafts of Hooke's joint lie along the held axis.
   - Three free, a ball: the rotation vector, below half a turn.
   Members that joints tie are solved together, as one system, on one rank (spar_member_set_owner); members without
   joints are solved as if there were none. Constraints hold in place and velocity at the end of every step, whatever dt
   is. A hold that follows from others in a loop (four parallel hinges of a four-bar) is left out, and named to the log.
   Joints tie rigid bodies, beams of any fidelity (spar_member_set_fidelity says what a linear or modal one is there),
   points and external members (points, external members and prescribed beams move as they are told, and
   spar_member_get_loads adds what joints put on them). In a trial, and with advice in force, a beam may have other
   nodes: its joints stay where they are, at ends of elements; a beam held within an element keeps its nodes.
   spar_member_solve_static solves for all that a member is tied to, at rest or turning as one; where nothing holds an
   assembly, the message names the motion that is free. */

/* A joint of two nodes. It goes with its session. Before the first step.
     name: in, unique in the session, not empty, copied
     a, node_a: in
     b, node_b: in, b NULL: the ground, node_b unused
     free_motions: in, SPAR_FREE_* or-ed: 0 a weld, RX a hinge, RX|RY a universal joint, RX|RY|RZ a ball, X a slider,
           X|RX a cylinder, X|Y|RZ a plane, all six for springs alone
     joint: out
   Local, but made on every rank alike and in the same order. SPAR_ERR_ARGUMENT: a node that is not there, or tied to
   itself; members of two sessions. */
SPAR_API int spar_joint_create(spar_session *session, const char *name, spar_member *a, int64_t node_a, spar_member *b,
                               int64_t node_b, int free_motions, spar_joint **joint);

/* Where the joint is. By default it is where node a is, where node b must be too, in the section axes of node a. Before
   the first step.
     x[3]: in, m, its place in the reference, to which rigid arms lead from both nodes
     q[4]: in, unit, its axes there, NULL: the section axes of node a
   Local. */
SPAR_API int spar_joint_set_frame(spar_joint *joint, const double x[3], const double q[4]);
/* Spring and damper between a and b on the free motions z: load on a = preload - stiffness z - damping dz/dt. Replaces
   what was set before.
     stiffness[36], damping[36]: in, symmetric, N/m, N, N m/rad (times s), 0 on what is held, NULL: 0
     preload[6]: in, N, N m, NULL: 0
   Local, the same on every rank. */
SPAR_API int spar_joint_set_spring(spar_joint *joint, const double stiffness[36], const double damping[36],
                                   const double preload[6]);
/* The short form: a joint of one node with the ground, at the node and in its section axes (a rigid body's own). What
   spar_joint_create, with the name "MEMBER.NODE", and spar_joint_set_spring do in one call. Before the first step.
     node: in
     free_motions: in, SPAR_FREE_* or-ed; the others are held: a cylinder in a stream has SPAR_FREE_Y
     stiffness, damping, preload: in, as in spar_joint_set_spring
     joint: out, NULL: not wanted
   Local, the same on every rank. */
SPAR_API int spar_member_set_spring(spar_member *member, int64_t node, int free_motions, const double stiffness[36],
                                    const double damping[36], const double preload[6], spar_joint **joint);
/* Which of the free motions spar_joint_drive moves. They begin as the members do. Before the first step.
     mask: in, SPAR_FREE_* or-ed, of the free ones
   Local. */
SPAR_API int spar_joint_set_driven(spar_joint *joint, int mask);
/* Driven motions at the end of the step begun next; not driven anew, they stay where they are. Entries of what is not
   driven are not looked at. Between steps.
     motion[6]: in, m, rad; angles of a hinge or universal joint with their turns; of a ball the rotation vector, which
           is below half a turn (SPAR_ERR_ARGUMENT)
     rate[6], acceleration[6]: in, of them, NULL: 0
   Local, the same on every rank. */
SPAR_API int spar_joint_drive(spar_joint *joint, const double motion[6], const double rate[6],
                              const double acceleration[6]);
/* A load between the two nodes, kept until it is set anew: a motor, a generator, a brake. It is the load at the end of
   the next step, linear in the step as that of spar_member_set_load.
     load[6]: in, N, N m, on a from b, on the free motions
   Local, the same on every rank. */
SPAR_API int spar_joint_set_load(spar_joint *joint, const double load[6]);
/* A joint whose one motion, the first of six, is the distance of two points, which their nodes carry. It is held (a
   rod), or driven (an actuator, motion[0] its length), or on a spring. Else as spar_joint_create.
     point_a[3], point_b[3]: in, m, global, in the reference; not the same
     b NULL: the ground carries point_b */
SPAR_API int spar_link_create(spar_session *session, const char *name, spar_member *a, int64_t node_a,
                              const double point_a[3], spar_member *b, int64_t node_b, const double point_b[3],
                              spar_joint **joint);
/* The spring of a line. Before the first step.
     stiffness: in, N/m, >= 0
     damping: in, N s/m, >= 0
     length: in, m, unstretched, >= 0
     tension_only: in, 1: it pulls or is slack (a taut mooring, a rope), 0: both ways (a strut). Up to its length it is
           slack, without load. Beyond it the pull is max(0, k (d - l) + c d'). In the step in which it comes taut, d' is
           at most the rate at which the stretch can have grown within the step
   Local. */
SPAR_API int spar_link_set_spring(spar_joint *joint, double stiffness, double damping, double length, int tension_only);
/* Relative motion of the latest iterate, t^n between steps; 0 before the first step or static solution.
     motion[6], rate[6], acceleration[6]: out, m, rad, and their rates (1/s, 1/s^2), NULL: not wanted; a line has its
           distance in the first. acceleration is that of the nodes' accelerations
   Local, the same on every rank. */
SPAR_API int spar_joint_get_motion(const spar_joint *joint, double motion[6], double rate[6], double acceleration[6]);
/* The load that the joint puts on a, in its axes and at a's end of it; b takes the opposite.
     load[6]: out, N, N m: of what is held the constraint's, of what is free those of spring, damper and
           spar_joint_set_load
   Local, the same on every rank. */
SPAR_API int spar_joint_get_load(const spar_joint *joint, double load[6]);
/* Energies of a joint, J. */
enum {
    SPAR_JOINT_ENERGY_SPRING = 0, /* stored in its springs, less what the preload has given; of the latest iterate; 0
                                     before the first step or static solution */
    SPAR_JOINT_ENERGY_DAMPER = 1, /* taken by its dampers, up to t^n, as the next two */
    SPAR_JOINT_ENERGY_DRIVE = 2,  /* given by what drives it */
    SPAR_JOINT_ENERGY_LOAD = 3,   /* given by spar_joint_set_load */
    SPAR_JOINT_ENERGY_COUNT = 4
};
/* energy[capacity]: out, by SPAR_JOINT_ENERGY_*, NULL: not wanted. The account is kept where one of its members has
   SPAR_EFFECT_WORK, and begins anew with that member's (spar_member_get_work). The work that it does on its two nodes
   (SPAR_WORK_JOINTS; the ground takes none) is what drive and load give less what the damper takes and the spring
   stores, to the order of the integrator. Local. SPAR_ERR_STATE: no account is kept. */
SPAR_API int spar_joint_get_energy(const spar_joint *joint, int64_t capacity, double *energy);

#ifdef __cplusplus
}
#endif

#endif
