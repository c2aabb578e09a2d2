/* The NREL 5-MW reference rotor from the tables under examples/data/nrel5mw: reads them and makes blades, section
   fluids and the aerodynamic object of spar from them. Uses public functions only; take it as a pattern for a turbine
   of your own.

   Blades stand around a shaft. The axis points downwind; blade 0 at rotor angle 0 points along the part of `up` across
   the axis, the others follow at equal angles, right-handed about the axis, as the rotor turns. A blade's root frame
   has x along the span (leaning upwind by the precone), y towards the trailing edge at pitch 0, z = x cross y upwind.
 */
#ifndef NREL5MW_H
#define NREL5MW_H

#include <spar/spar.h>
#include <spar/spar_aero.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct nrel5mw_polar {
    char name[32];
    int64_t n;
    double *alpha, *cl, *cd, *cm; /* rad */
} nrel5mw_polar;

typedef struct nrel5mw {
    int blades;
    double length, hub_radius, tip_radius;   /* blade; radii along the blade from the shaft axis */
    double precone, tilt;                    /* rad */
    double density, rated_wind, rated_speed; /* kg/m3, m/s, rad/s */
    double damping[6];
    int64_t axis_n;
    double *axis_eta, *axis_xyz, *axis_twist; /* twist as spar takes it: right-handed about the span, rad */
    int64_t section_n;
    double *section_eta, *stiffness, *mass; /* [n], [n][36], [n][36] */
    int64_t aero_n;
    double *span, *curve, *sweep, *twist, *chord; /* twist as published: positive towards feather, rad */
    int *polar_of;                                /* [aero_n] */
    int polar_n;
    nrel5mw_polar *polar;
    char message[512]; /* what went wrong in a call below that has no session to ask */
} nrel5mw;

/* Where the rotor stands; nrel5mw_rotor_default fills it, then change what you like. */
typedef struct nrel5mw_rotor {
    int blades;
    double hub[3];  /* where the blades' axes meet the shaft */
    double axis[3]; /* unit, downwind */
    double up[3];
    double precone, pitch; /* rad; pitch positive towards feather */
} nrel5mw_rotor;

/* Reads the directory's tables. Returns a spar status; data is to be freed in any case. */
int nrel5mw_load(nrel5mw *data, const char *directory);
void nrel5mw_free(nrel5mw *data);
/* n aerodynamic sections in place of the table's, evenly spaced from its first to its last: for an actuator line as
   fine as its grid. Chord, twist and places are linear between the table's; so are polars, at the angles of both. */
int nrel5mw_resample(nrel5mw *data, int64_t n);
/* Hub at the origin, up = z, precone and tilt of the tables, wind along x (tilted: the axis leans below it). */
void nrel5mw_rotor_default(const nrel5mw *data, nrel5mw_rotor *rotor);

/* Root place and orientation of a blade when the rotor stands at angle (rad). */
void nrel5mw_root(const nrel5mw *data, const nrel5mw_rotor *rotor, int blade, double angle, double x[3], double q[4]);
/* Root motion for spar_member_drive: relative to the reference configuration, which is that at angle 0. */
void nrel5mw_root_motion(const nrel5mw *data, const nrel5mw_rotor *rotor, int blade, double angle, double speed,
                         double acceleration, double q[7], double v[6], double a[6]);

/* The blade as a beam with driven root, or, with elements 0, as a rigid body of the same mass. Not committed: set
   effects, owner, velocity, quadrature first. */
int nrel5mw_create_blade(nrel5mw *data, const nrel5mw_rotor *rotor, spar_session *session, int blade, int elements,
                         int nodes, spar_member **member);
/* The sections of aero.txt on a committed blade, mapped. The aerodynamic centres are turned into the frames the member
   has, and twist [aero_n] becomes what spar_aero_set_section takes: the aerodynamic twist less what those frames have
   already. */
int nrel5mw_create_sections(nrel5mw *data, const nrel5mw_rotor *rotor, int blade, spar_member *member,
                            spar_fluid **fluid, double *twist);
/* The aerodynamic object over the fluids of the n blades this rank has (0 and NULL: none) of the rotor's; twist from
   nrel5mw_create_sections (alike for all blades). */
int nrel5mw_create_aero(nrel5mw *data, const nrel5mw_rotor *rotor, int n, spar_fluid *const *fluids,
                        const double *twist, spar_aero **aero);

#ifdef __cplusplus
}
#endif

#endif
