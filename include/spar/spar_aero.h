/* spar_aero.h: experimental, may change in any release. Blade elements with momentum theory, in a library of their own,
   libspar_aero.

   Lift, drag and pitching moment come from polars and the wind relative to the moving section, with or without the
   induced velocity of momentum theory (Ning 2014, doi 10.1002/we.1636). The model is quasi-steady unless effects with
   memory are on. The library uses the public calls of libspar alone; messages of failures are found in the session.

   A section is a station of a fluid (spar_fluid_set_stations); its aerodynamic centre is the fluid's node. Its frame is
   that of spar_fluid_pull_poses: x along the span from root to tip, y from leading to trailing edge, z = x cross y. The
   twist given here is relative to this frame. If the beam's frames contain the blade's twist, give the difference.

   Sizes: blades and sections are those with which the object was created, whatever becomes of its fluids.

   Calls are local, but the report of effects. An object holds the blades whose fluids are on this rank, which may be
   none. It is used by one thread at a time. Angles are in radians. Blades and sections count from 0. */
#ifndef SPAR_AERO_H
#define SPAR_AERO_H

#include <spar/spar_analysis.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct spar_polar spar_polar; /* lift, drag and moment coefficients by angle of attack */
typedef struct spar_aero spar_aero;   /* the blades of a rotor on this rank, or wings */

/* Effects. What is off costs nothing. */
enum {
    SPAR_AERO_INDUCTION = 1,  /* momentum theory; needs spar_aero_set_rotor. Without it the next three mean nothing. */
    SPAR_AERO_TIP_LOSS = 2,   /* Prandtl's factor of the tip */
    SPAR_AERO_HUB_LOSS = 4,   /* Prandtl's factor of the hub; none where hub_radius is 0 */
    SPAR_AERO_SWIRL = 8,      /* tangential induction */
    SPAR_AERO_DRAG = 16,      /* drag forces. Drag never takes part in the inductions (as AeroDyn's default). */
    SPAR_AERO_MOMENT = 32,    /* pitching moments */
    SPAR_AERO_SHEAR = 64,     /* wind by height; needs spar_aero_set_shear */
    SPAR_AERO_TOWER = 128,    /* the wind gives way to the tower; needs spar_aero_set_tower */
    SPAR_AERO_INFLOW = 256,   /* dynamic inflow: the induced velocity lags behind that of momentum theory (Oye) */
    SPAR_AERO_STALL = 512,    /* dynamic stall: the point of separation lags behind the polar's (Oye) */
    SPAR_AERO_UNSTEADY = 1024 /* thin airfoil: lift lags behind the downwash, as the wake is shed (Theodorsen), and the
                                 air about the section is accelerated with it */
};
/* Laws of the wind over height. */
enum { SPAR_SHEAR_POWER = 0, SPAR_SHEAR_LOG = 1, SPAR_SHEAR_LINEAR = 2 };
/* Interpolation between the rows of a polar. */
enum { SPAR_POLAR_LINEAR = 0, SPAR_POLAR_AKIMA = 1, SPAR_POLAR_CUBIC = 2 };
/* Flags of a section in the last solve. */
enum {
    SPAR_AERO_FLAG_END = 1, /* at the radius of tip or hub, where the loss factor is 0: axial induction 1, no swirl */
    SPAR_AERO_FLAG_NO_ROOT = 2,      /* no inflow angle balances the momentum: solved without induction */
    SPAR_AERO_FLAG_BEYOND_POLAR = 4, /* angle of attack outside the rows of the polar: the nearer end is used */
    SPAR_AERO_FLAG_TOWER = 8         /* inside the tower: what it does to the wind is less than at its surface */
};

/* Creates a polar, a table of coefficients. A table over a full turn must have the same coefficients in its first and
   last row, and is periodic. Outside a shorter table the nearer end is used, and the section is flagged. A refusal
   names the row (spar_session_message(NULL)).
     n: in, rows, >= 2
     alpha_rad[n]: in, strictly increasing, over a full turn at most
     cl[n]: in
     cd[n]: in
     cm[n]: in, NULL: 0
     polar: out */
SPAR_API int spar_polar_create(int64_t n, const double *alpha_rad, const double *cl, const double *cd, const double *cm,
                               spar_polar **polar);
/* Interpolation between the rows. Sections that were set before keep their table.
     kind: in, SPAR_POLAR_*, default linear */
SPAR_API int spar_polar_set_interpolation(spar_polar *polar, int kind);
/* Coefficients at one angle.
     alpha_rad: in
     cl: out, NULL: not wanted
     cd: out, NULL: not wanted
     cm: out, NULL: not wanted */
SPAR_API int spar_polar_evaluate(const spar_polar *polar, double alpha_rad, double *cl, double *cd, double *cm);
/* Destroys a polar; NULL is legal. Sections that use it keep its table.
     polar: in; out, NULL */
SPAR_API void spar_polar_destroy(spar_polar **polar);

/* Creates a rotor or wing. The fluids stay the caller's. They must exist until the last call of spar_aero_solve,
   spar_aero_read_aerodyn and spar_aero_set_effects. After a new map create a new object.
     blades: in, on this rank; 0 with NULL: a rank without blades
     sections[blades]: in, one mapped fluid per blade (spar_fluid_set_stations), all of one session, with the same
           number, 2 or more, of sections at different positions from root to tip
     aero: out */
SPAR_API int spar_aero_create(int blades, spar_fluid *const *sections, spar_aero **aero);
/* Destroys the object; NULL is legal.
     aero: in; out, NULL */
SPAR_API void spar_aero_destroy(spar_aero **aero);
/* Describes section i of every blade.
     i: in, 0 to sections - 1
     chord: in, m, >= 0
     twist: in, rad; positive rotates the leading edge into the wind and lowers the angle of attack: a left-handed
           rotation about the section's x
     polar: in */
SPAR_API int spar_aero_set_section(spar_aero *aero, int64_t i, double chord, double twist, const spar_polar *polar);
/* Chord and twist of the sections, as set or read. On a rank without blades nothing is written.
     chord[sections]: out, m, NULL: not wanted
     twist[sections]: out, rad, in [-pi, pi], as of spar_aero_set_section, NULL: not wanted
   SPAR_ERR_STATE: a section is not described. */
SPAR_API int spar_aero_get_chord(const spar_aero *aero, double *chord, double *twist);
/* The polar of a section, as set or read. On a rank without blades nothing is written.
     i: in, 0 to sections - 1
     n: out, rows, NULL: not wanted
     capacity: in, of the arrays; n is enough
     alpha_rad[capacity]: out, NULL: not wanted
     cl[capacity]: out, NULL: not wanted
     cd[capacity]: out, NULL: not wanted
     cm[capacity]: out, NULL: not wanted
     kind: out, SPAR_POLAR_*, NULL: not wanted
   SPAR_ERR_STATE: a section is not described. */
SPAR_API int spar_aero_get_polar(const spar_aero *aero, int64_t i, int64_t *n, int64_t capacity, double *alpha_rad,
                                 double *cl, double *cd, double *cm, int *kind);
/* Reads a blade from AeroDyn's files (AeroDyn 15 and later): the airfoils of the primary file, the stations of the
   blade file, the tables of the airfoil files. Lengths, curve, sweep, twist and chord are linear between stations,
   and so are the coefficients between different airfoils. Every rank reads the files. After a failure all is as it was.
   SPAR_ERR_IO: a file or a field cannot be read; the message names file, line and field. SPAR_ERR_ARGUMENT: a polar or
   a span is not allowed. Of several tables AFTabMod 1 takes the first, and AFTabMod 3 that of UserProp 0, linear
   between its neighbours, else the nearest. SPAR_ERR_UNSUPPORTED: several tables with AFTabMod 2 (Reynolds numbers).

   This call sets the stations of a fluid at the aerodynamic centres (BlSpn, BlCrvAC, BlSwpAC), each attached to the
   nearest point of the line. The member must be committed. Map afterwards. BlCrvAng is not used: sections are
   perpendicular to the line.
     primary_path: in
     blade_path: in, NULL: the first one named by the primary file, in its folder
     q[4]: in, AeroDyn's blade axes z (along the blade), x (downwind), y (to the trailing edge), in this order, in the
           member's own frame, whose origin is the blade's root; NULL: none, as spar_beam_read_beamdyn makes a blade
     n: in, number of sections; 0 with span NULL: as many as the file has stations
     span[n]: in, m, from the root, between the first and the last station, NULL: those of the stations */
SPAR_API int spar_fluid_read_aerodyn(spar_fluid *fluid, const char *primary_path, const char *blade_path,
                                     const double q[4], int64_t n, const double *span);
/* Sets chord, twist and polar of all sections from the same files. The twist is BlTwist (positive: the leading edge
   goes upwind) less the twist of the sections' frames. Without UseBlCm moments are 0. InterpOrd 3 gives
   SPAR_POLAR_CUBIC.
     primary_path: in
     blade_path: in, NULL: as above
     q[4]: in, NULL: as above
     span[sections]: in, m, NULL: those of the stations
   SPAR_ERR_UNSUPPORTED: after spar_aero_set_turn with -1. Other failures as above. */
SPAR_API int spar_aero_read_aerodyn(spar_aero *aero, const char *primary_path, const char *blade_path,
                                    const double q[4], const double *span);
/* Sets the shaft. The first call also stores the sections' distances from the axis in the reference configuration, for
   the tip and hub losses. Later calls move the shaft.
     hub[3]: in, m, a point of its axis
     axis[3]: in, direction of the axis, downwind, not 0
     hub_radius: in, m, from the axis to the begin of the blades
     tip_radius: in, m, from the axis to the tips */
SPAR_API int spar_aero_set_rotor(spar_aero *aero, const double hub[3], const double axis[3], double hub_radius,
                                 double tip_radius);
/* Direction of rotation that the blades are made for. Either may rotate backwards; then the flow meets the trailing
   edges.
     turn: in, 1 (default): right-handed about the downwind axis (clockwise seen from upwind), section z towards the
           pressure side; -1: the mirror image, section z towards the suction side, positive twist right-handed
           about x */
SPAR_API int spar_aero_set_turn(spar_aero *aero, int turn);
/* Number of blades of the whole rotor, for the solidity, if other ranks hold some of them.
     total: in, default: the number given to spar_aero_create */
SPAR_API int spar_aero_set_blades(spar_aero *aero, int total);
/* Wind shear. The inflow given to spar_aero_solve is that at a reference height. Each section sees it times a factor of
   its present height z:
     SPAR_SHEAR_POWER   (z / height)^parameter, 0 for z <= 0
     SPAR_SHEAR_LOG     ln(z / parameter) / ln(height / parameter), 0 for z <= parameter
     SPAR_SHEAR_LINEAR  1 + parameter (z - height), at least 0
   It is on from the first call on, unless spar_aero_set_effects was called. On a rank without blades it does nothing.
     law: in, SPAR_SHEAR_*
     ground[3]: in, m, a point of height 0
     up[3]: in, direction of height, not 0
     height: in, m, > 0, reference height
     parameter: in, exponent, >= 0; roughness length, m, > 0 and below height; slope, 1/m */
SPAR_API int spar_aero_set_shear(spar_aero *aero, int law, const double ground[3], const double up[3], double height,
                                 double parameter);
/* Tower shadow: the wind around a round tower, by potential flow. At the distance rho from the axis the wind across the
   tower (after shear) changes by (R / rho)^2 times its mirror image: it is 0 on the surface before the tower and
   doubles beside it. R is linear between the ends. Near the top the change is multiplied by
   (1 + t / sqrt(t^2 + rho^2)) / 2, with the distance t below the top (a line of dipoles that ends there). The wake
   behind the tower is not modelled. On from the first call on, unless spar_aero_set_effects was called; a later
   call moves the tower. On a rank without blades it does nothing.
     base[3]: in, m, of the axis
     top[3]: in, m, of the axis
     base_radius: in, m, > 0
     top_radius: in, m, > 0 */
SPAR_API int spar_aero_set_tower(spar_aero *aero, const double base[3], const double top[3], double base_radius,
                                 double top_radius);
/* Chooses the effects. Default: drag; moments if a polar has any; all of momentum theory once the rotor is set;
   shear and tower once these are set.
     effects: in, SPAR_AERO_* combined
   Inflow, stall and unsteady have memory, integrated exactly for input that is linear in a step ((T27) to (T30) of
   docs/explanation/theory.md). They begin with the steady state, and have it in static and initial solutions. Their
   memory is kept as states of the fluids (spar_fluid_set_states), so iterations, rejected steps, trials, save and
   load treat it rightly. Momentum theory takes the static polar's lift. Stall acts on lift; attached flow is the
   steepest line from the angle without lift; its time constant is 4 c / V. Unsteady takes the flow at three quarters
   of the chord and pushes moments; it uses accelerations, so begin with spar_session_solve_initial.
   SPAR_ERR_STATE: one of these three is switched on during a step, or the fluids have states of the host. */
SPAR_API int spar_aero_set_effects(spar_aero *aero, int effects);
/* Pulls the motion, computes the loads in the wind, and pushes them.
     density: in, kg/m^3
     inflow[blades][sections][3]: in, m/s, global axes, undisturbed by the rotor; with shear, at its reference height
     theta: in, as of spar_fluid_pull_motion; 1 in steps with effects that have memory
   Loads per length are linear between sections, and zero beyond the first and the last. An interval of the length L
   gives its ends the consistent shares L/6 (2 f1 + f2) and L/6 (f1 + 2 f2). The same input gives the same result.
   After a failure the loads are as they were, and the check of the current step fails on all ranks unless a later call
   succeeds. */
SPAR_API int spar_aero_solve(spar_aero *aero, double density, const double *inflow, double theta);
/* Rotor figures of the blades on this rank in the last solve; needs spar_aero_set_rotor.
     thrust: out, N, force along the axis, NULL: not wanted
     torque: out, N m, right-handed about the axis, NULL: not wanted
     power: out, W, torque times rotor speed (mean angular velocity of the first sections about the axis), NULL: not
           wanted */
SPAR_API int spar_aero_get_rotor(const spar_aero *aero, double *thrust, double *torque, double *power);
/* Sections in the last solve.
     alpha[blades][sections]: out, rad, angle of attack, NULL: not wanted
     cl[blades][sections]: out, NULL: not wanted
     cd[blades][sections]: out, NULL: not wanted
     a[blades][sections]: out, axial induction, the flow across the disc is (1 - a) of the free flow, NULL: not wanted
     a_tangential[blades][sections]: out, the flow along the disc is (1 + a_tangential) of the free flow, 0 if that is
           0, NULL: not wanted */
SPAR_API int spar_aero_get_sections(const spar_aero *aero, double *alpha, double *cl, double *cd, double *a,
                                    double *a_tangential);
/* Flags in the last solve.
     flags[blades][sections]: out, SPAR_AERO_FLAG_* combined, NULL: not wanted
     no_root: out, number of sections without a root, NULL: not wanted */
SPAR_API int spar_aero_get_flags(const spar_aero *aero, int *flags, int64_t *no_root);
/* Loads in the last solve, in global axes.
     per_length[blades][sections][6]: out, N/m, N m/m, force and moment per unit of span, NULL: not wanted
     force[blades][sections][3]: out, N, as pushed, NULL: not wanted
     moment[blades][sections][3]: out, N m, as pushed, NULL: not wanted */
SPAR_API int spar_aero_get_loads(const spar_aero *aero, double *per_length, double *force, double *moment);

/* Rows of the report of effects. */
enum {
    SPAR_AERO_ROW_INDUCTION = 0,
    SPAR_AERO_ROW_TIP_LOSS = 1,
    SPAR_AERO_ROW_HUB_LOSS = 2,
    SPAR_AERO_ROW_SWIRL = 3,
    SPAR_AERO_ROW_DRAG = 4,
    SPAR_AERO_ROW_MOMENT = 5,
    SPAR_AERO_ROW_SHEAR = 6,
    SPAR_AERO_ROW_TOWER = 7,
    SPAR_AERO_ROW_INFLOW = 8,
    SPAR_AERO_ROW_STALL = 9,
    SPAR_AERO_ROW_UNSTEADY = 10,
    SPAR_AERO_ROW_COUNT = 11
};
/* Name of a row, "tip loss"; static storage; "" for what is no row. */
SPAR_API const char *spar_aero_effect_name(int row);
/* Finds what each effect of this object contributes, by runs of a trial with the effect and without it
   (spar_trial_run). An effect is in force on all ranks where it is in force on any: it is on, and has something to do
   (losses and swirl with induction, hub loss with a hub radius, moments with polars that have some). The effects are
   the same afterwards, also after a failure. The results of the last solve are those of a run. The trial compares later
   runs with the one with all effects. Collective over the session of the trial.
     trial: in, with steps and callbacks; its fluid solver calls spar_aero_solve on this object
   SPAR_ERR_STATE: its fluid solver does not. Other failures as of spar_trial_run. */
SPAR_API int spar_aero_report_effects(spar_aero *aero, spar_trial *trial);
/* One effect in the last report. Figures of an effect that is not in force are 0. Local. SPAR_ERR_STATE: no report.
     row: in, SPAR_AERO_ROW_*
     in_force: out, 1: the object has this effect, 0: not, NULL: not wanted
     fails: out, 1: the run fails without it, and all figures are 0; 0: it does not; NULL: not wanted
     size: out, change of the fluid's loads without it, as load of spar_trial_get_errors, NULL: not wanted
     motion: out, error of the motion without it, likewise, NULL: not wanted
     reaction: out, error of the reactions without it, likewise, NULL: not wanted
     share: out, part of the time of a solution that is saved without it, below 0: it costs more, NULL: not wanted */
SPAR_API int spar_aero_get_effect(const spar_aero *aero, int row, int *in_force, int *fails, double *size,
                                  double *motion, double *reaction, double *share);

#ifdef __cplusplus
}
#endif

#endif
