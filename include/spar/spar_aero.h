/* spar_aero.h: experimental, may change in any release. Blade elements with momentum theory, in a library of their own,
   libspar_aero.

   Lift, drag and pitching moment from polars and the wind relative to the moving section, with or without the induced
   velocity of momentum theory (Ning 2014, doi 10.1002/we.1636); quasi-steady, but for the effects that remember. It is
   made on the public calls of libspar alone; messages of failures are found in the session.

   A section is a place of a fluid (spar_fluid_set_stations); its aerodynamic centre is the fluid's node. Its frame is
   the one spar_fluid_pull_poses gives: x along the span from root to tip, y from leading to trailing edge, z = x
   cross y. A twist given here is measured from that frame: where the beam's own frames already carry the blade's
   twist, give the difference (or 0). All calls but the report of effects are local to the rank: an object holds the
   blades whose fluids live on this rank, which may be none. An object is used by one thread at a time. Angles are in
   radians; blades and sections are counted from 0. */
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

/* A polar, a table of coefficients. One over the full turn has the same coefficients in its first and last row and goes
   round; an angle that a shorter one does not cover takes the nearer end's values and flags the section. Refused tables
   name the row (spar_session_message(NULL)).
     n: in, rows, >= 2
     alpha_rad[n]: in, strictly increasing, over a full turn at most
     cl[n], cd[n]: in
     cm[n]: in, NULL: 0
     polar: out */
SPAR_API int spar_polar_create(int64_t n, const double *alpha_rad, const double *cl, const double *cd, const double *cm,
                               spar_polar **polar);
/* SPAR_POLAR_LINEAR (default), _AKIMA or _CUBIC; periodic for a table over the full turn. Sections set before keep
   what they had. */
SPAR_API int spar_polar_set_interpolation(spar_polar *polar, int kind);
/* The coefficients at one angle. cl, cd, cm: out, each NULL: not wanted. */
SPAR_API int spar_polar_evaluate(const spar_polar *polar, double alpha_rad, double *cl, double *cd, double *cm);
/* NULL and a second call are legal. Sections that use the polar keep its table. */
SPAR_API void spar_polar_destroy(spar_polar **polar);

/* A rotor or wing. The fluids stay the caller's and must outlive the object's last solve, spar_aero_read_aerodyn and a
   spar_aero_set_effects that asks for effects that remember; map them anew and the object must be made anew.
     blades: in, on this rank; 0 with NULL: a rank without blades
     sections[blades]: in, one fluid per blade, made with spar_fluid_set_stations, mapped, all of one session and with
           the same number n >= 2 of sections, in order from root to tip at different places
     aero: out */
SPAR_API int spar_aero_create(int blades, spar_fluid *const *sections, spar_aero **aero);
SPAR_API void spar_aero_destroy(spar_aero **aero);
/* Section i of every blade.
     i: in, 0 to n-1
     chord: in, m, >= 0
     twist: in, rad; positive turns the leading edge into the wind and lowers the angle of attack, i.e. minus a
           right-handed turn about the section's x
     polar: in */
SPAR_API int spar_aero_set_section(spar_aero *aero, int64_t i, double chord, double twist, const spar_polar *polar);
/* What the sections of every blade were given, one by one or from AeroDyn's files: a kernel's width goes by the chord.
   Nothing on a rank without blades. Each NULL: not wanted.
     chord[n]: out, m
     twist[n]: out, rad, in [-pi, pi], as of spar_aero_set_section
   SPAR_ERR_STATE: a section has none yet. */
SPAR_API int spar_aero_get_chord(const spar_aero *aero, double *chord, double *twist);
/* Blades of AeroDyn's files (AeroDyn 15 and later): the primary file's airfoils, the blade file's stations, the airfoil
   files' tables. Lengths, curve, sweep, twist and chord are linear in the span between stations, and so are the polars'
   coefficients where two stations have different airfoils. Common to both calls:
     primary_path: in
     blade_path: in, NULL: the file that the primary one names first, beside it
     q[4]: in, AeroDyn's blade axes z (along the blade), x (downwind), y (to the trailing edge), in this order, in the
           member's own frame (spar_member_set_placement); NULL: none, as spar_beam_read_beamdyn makes a blade. The own
           frame's origin is the blade's root
     span[n]: in, m, from the root, within BlSpn of the first and last station, NULL: those of the stations
   Local; every rank reads the files. SPAR_ERR_IO: a file cannot be read, or a field cannot; the message names file,
   line and field. SPAR_ERR_ARGUMENT: a polar or a span is not allowed. SPAR_ERR_UNSUPPORTED: tables between which
   AFTabMod 2 or 3 interpolates (with 1 the first counts). After a failure all is as it was. */

/* Sections of a fluid, as spar_fluid_set_stations makes them, at the aerodynamic centres (BlSpn, BlCrvAC, BlSwpAC),
   each hung on the nearest place of the line. The member must be committed. To be mapped. BlCrvAng is not used:
   sections stand across the line. n: in, sections; with span NULL 0, which gives as many as the file has stations */
SPAR_API int spar_fluid_read_aerodyn(spar_fluid *fluid, const char *primary_path, const char *blade_path,
                                     const double q[4], int64_t n, const double *span);
/* Chord, twist and polar of all sections, as spar_aero_set_section sets them; the twist is BlTwist (positive: the
   leading edge goes upwind) less what the sections' frames carry already, on all blades alike. Without UseBlCm moments
   are 0. InterpOrd 3 gives SPAR_POLAR_CUBIC. Not with spar_aero_set_turn -1 (SPAR_ERR_UNSUPPORTED). n is the number of
   sections. */
SPAR_API int spar_aero_read_aerodyn(spar_aero *aero, const char *primary_path, const char *blade_path,
                                    const double q[4], const double *span);
/* The shaft. The first call also takes the sections' distances from the axis in the reference configuration, which the
   tip and hub losses are computed with (a bent blade's tip is still its tip); later calls move the shaft.
     hub[3]: in, a point of its axis, m
     axis[3]: in, its direction, pointing downwind, any length but 0
     hub_radius, tip_radius: in, m, from the axis, where the blades begin and end */
SPAR_API int spar_aero_set_rotor(spar_aero *aero, const double hub[3], const double axis[3], double hub_radius,
                                 double tip_radius);
/* How the blades are made: 1 (default) for a rotor that turns right-handed about the downwind axis (clockwise for who
   looks downwind), z towards the pressure side; -1 for its mirror image, whose sections have z towards the suction
   side and whose positive twist is a right-handed turn about x. Either may be turned backwards: the sections then
   meet the flow with the trailing edge. */
SPAR_API int spar_aero_set_turn(spar_aero *aero, int turn);
/* Blades of the whole rotor, for the solidity, where other ranks hold some of them; default: those given to create. */
SPAR_API int spar_aero_set_blades(spar_aero *aero, int total);
/* Wind shear: the inflow given to spar_aero_solve is that at a reference height, and each section meets, where it is
   now, the inflow times
     SPAR_SHEAR_POWER   (z / height)^parameter, 0 for z <= 0
     SPAR_SHEAR_LOG     ln(z / parameter) / ln(height / parameter), 0 for z <= parameter
     SPAR_SHEAR_LINEAR  1 + parameter (z - height), no less than 0
   at its height z. It is on from the first call on, unless spar_aero_set_effects was called; replaces what was set.
     law: in, SPAR_SHEAR_*
     ground[3]: in, m, a point of height 0
     up[3]: in, where heights are measured along, any length but 0
     height: in, m, > 0, of the reference
     parameter: in, the exponent, >= 0; the roughness length, m, > 0 and less than height; the slope, 1/m
   On a rank without blades it does nothing. */
SPAR_API int spar_aero_set_shear(spar_aero *aero, int law, const double ground[3], const double up[3], double height,
                                 double parameter);
/* Tower shadow: what a round tower does to the wind before it, beside it and, less truly, behind it, by potential flow.
   The wind across the tower (the inflow, after shear) changes at distance rho from its axis by (R / rho)^2 times itself
   mirrored across that direction: none is left on the surface right before the tower, twice as much beside it. R is
   linear between the ends and that of the base below. Towards and above the top the change is less by the factor (1 + t
   / sqrt(t^2 + rho^2)) / 2, t the distance below the top, as of a line of dipoles that ends there. The wake is not
   there: behind the tower a rotor that turns there needs one of the host's. It is on from the first call on, unless
   spar_aero_set_effects was called; a later call moves the tower.
     base[3], top[3]: in, m, of its axis, at different places
     base_radius, top_radius: in, m, > 0
   On a rank without blades it does nothing. */
SPAR_API int spar_aero_set_tower(spar_aero *aero, const double base[3], const double top[3], double base_radius,
                                 double top_radius);
/* SPAR_AERO_* or-ed. Default: drag; moments where a polar has any; all of momentum theory once the rotor is set; shear
   and tower once these are.
   Inflow, stall and unsteady remember the steps before, each exact over a step for what comes in linearly in time
   (docs/theory.md, (T27) to (T30)). They begin with the steady state: before the first step, in a static solution, at a
   balanced start, and in the first step with them. What they remember are the fluids' states (spar_fluid_set_states,
   whose numbers are theirs then): it goes through iterations, rejected steps, trials, save and load as these do.
   Momentum theory takes the static polar's lift. Stall: lift alone; attached flow is the steepest line from the angle
   without lift, 4 c / V the time. Unsteady: lift acts by the flow at three quarters of the chord, moments are pushed;
   induced velocities count as steady. It asks for accelerations, so the start should be balanced
   (spar_session_solve_initial).
   SPAR_ERR_STATE: a step is under way, where one of these three is asked for first, or the fluids have states of the
   host's own. */
SPAR_API int spar_aero_set_effects(spar_aero *aero, int effects);
/* Pulls the motion at theta, finds the loads in the wind, and pushes them.
     density: in, kg/m^3
     inflow[blades][n][3]: in, m/s, global axes, undisturbed by the rotor; with shear that at its reference height
     theta: in, as of spar_fluid_pull_motion
   Loads per length are linear between the sections and nothing lies beyond the first and the last; each interval (as
   long as its ends are apart in the reference configuration) gives its ends the consistent shares L/6 (2 f1 + f2), L/6
   (f1 + 2 f2). Same input, same result: nothing is remembered from the solve before, but by inflow, stall and unsteady
   from the step before: with these theta is 1 in a step. No memory is taken. After a failure the loads are as they were
   (and what the last solve found, but where it is SPAR_ERR_NUMERIC), and the check of a step under way fails on all
   ranks unless a later solve succeeds. */
SPAR_API int spar_aero_solve(spar_aero *aero, double density, const double *inflow, double theta);
/* Of the blades on this rank in the last solve, needs set_rotor. Each NULL: not wanted.
     thrust: out, N, force along the axis
     torque: out, N m, moment about the axis, right-handed
     power: out, W, moment times rotor speed, which is the mean of the blades' first sections' angular velocity about
           the axis */
SPAR_API int spar_aero_get_rotor(const spar_aero *aero, double *thrust, double *torque, double *power);
/* In the last solve. Each NULL: not wanted.
     alpha[blades][n]: out, angle of attack, rad
     cl[blades][n], cd[blades][n]: out, coefficients
     a[blades][n], a_tangential[blades][n]: out, inductions: the flow is (1 - a) of the free flow across the disc and (1
           + a_tangential) of that along it, both taken in the section's plane; 0 where that free flow is 0 */
SPAR_API int spar_aero_get_sections(const spar_aero *aero, double *alpha, double *cl, double *cd, double *a,
                                    double *a_tangential);
/* In the last solve. Each NULL: not wanted.
     flags[blades][n]: out, SPAR_AERO_FLAG_* or-ed
     no_root: out, how many sections had no root */
SPAR_API int spar_aero_get_flags(const spar_aero *aero, int *flags, int64_t *no_root);
/* Loads in the last solve, global axes. Each NULL: not wanted.
     per_length[blades][n][6]: out, N/m, N m/m, force and moment per unit of span
     force[blades][n][3], moment[blades][n][3]: out, N, N m, as pushed */
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
