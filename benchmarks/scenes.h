/* Five coupled scenes, each with every setting that trades accuracy for time as a knob:

     rotor  one blade of the NREL 5-MW rotor in steady wind, from a rigid turn
     gust   the same in a gust of wind
     wing   half wing of the HALE aircraft of Patil, Hodges & Cesnik (2001), from rest
     plate  a cantilever in a heavy fluid: added mass 10 times its own
     body   a stiff beam on a heave spring in waves of load

   A program builds a scene with some knobs, has its session stepped (by scene_march or by itself), and compares the
   tip's history with a finer one's:

       scene_run *run;
       scene_reference reference;
       knobs k = scene->standard;
       scene_converge(scene, 16, 1, 24, &reference);
       k.dt = 0.01;
       if (scene_build(scene, &k, &run) == SPAR_OK && scene_march(run, &result) == SPAR_OK) {
           error = scene_error(&reference, &result);
       }
       scene_destroy(&run);

   Functions answer a spar status. Runs are independent of each other. One thread: the rotor's tables are shared. */
#ifndef SCENES_H
#define SCENES_H

#include <spar/spar.h>

enum { SCENE_SAMPLES = 20, SCENE_COUNT = 5 };

/* Settings. Where "default" is named, that value leaves the library's. */
typedef struct knobs {
    int elements, nodes; /* nodes of an element */
    int rule, points;    /* SPAR_QUADRATURE_*; -1: default */
    double dt, rho;
    int substeps;
    double newton; /* relative tolerance; 0: default */
    int predictor, scheme;
    double tolerance; /* of the coupling, relative */
    double theta;     /* where in the step the fluid is */
    int group;        /* motion at theta on the group; only seen at 0 < theta < 1 */
    int projection;   /* SPAR_PROJECT_*; scenes with nodes only */
    int consistent;   /* SPAR_INTERPOLATE_* */
    int single;       /* f32 at the edge: loads, and where the scene pulls the motion itself (nodes), that too */
    int acceleration; /* plate: the added mass takes the nodes' acceleration; else a difference of velocities */
    double guess;     /* plate: of its fluid's added mass that is known beforehand; 0: none */
    int learn;        /* plate: it is learned in so many steps of IQN-ILS, before the scheme; 0: not */
    int start;        /* loads at t = 0 are given before the first step, by scene_build; else they count as zero */
    int effects;      /* SPAR_EFFECT_* or-ed; -1: default */
    int aero;         /* SPAR_AERO_* or-ed; -1: default */
    int fidelity;     /* SPAR_FIDELITY_* */
    int64_t modes;
    double phase; /* the same scene a little otherwise: 3 per cent of the wind and 0.1 s of the gust's beginning, 4 per
                     cent of the waves' rate, its sine half a degree of the wing's angle */
} knobs;

typedef struct scene_run scene_run;

typedef struct scene {
    const char *name;
    double T; /* s */
    knobs standard;
    int spins;  /* errors are relative to the deformation beyond the rigid turn */
    int nodes;  /* the fluid has nodes beside the line, which are projected on it, not sections */
    int floats; /* its root is free */
    int (*build)(scene_run *run);
} scene;

/* Called before every step, which goes from t to t + dt: drives the root, keeps what the fluid needs of t. */
typedef int (*scene_before)(spar_session *session, double t, double dt, void *context);

/* A scene that has been built, ready for its first step. Read what is here; theta, single and dt of the knobs may also
   be changed between steps. The session's settings (integrator, coupling, predictor) are the caller's to change. */
struct scene_run {
    const scene *scene;
    knobs knobs;
    spar_session *session;
    spar_member *member; /* its last node is the tip */
    spar_fluid *fluid;
    spar_fluid_solver solve;
    scene_before before; /* NULL: nothing to do */
    void *context;       /* of both */
    void (*release)(void *context);
};

/* What scene_march keeps. */
typedef struct scene_result {
    double history[3 * SCENE_SAMPLES]; /* displacement of the tip at even times, the last T; m */
    double load[3 * SCENE_SAMPLES];    /* moment at the root then, N m; of what floats the fluid's force, N */
    double seconds;                    /* processor time of the steps, fluid and driving included */
    int64_t steps, iterations;
} scene_result;

typedef struct scene_reference {
    double history[3 * SCENE_SAMPLES], load[3 * SCENE_SAMPLES];
    double scale;      /* root mean square of the motion, or of what it has beyond the rigid turn; m */
    double load_scale; /* and of the load */
} scene_reference;

/* The scenes, in the order above: scenes[SCENE_COUNT]. */
extern const scene scenes[SCENE_COUNT];

/* run: out. After a failure it has to be destroyed too, and its session (if there is one) has the message; NULL if
   there was no memory. */
int scene_build(const scene *s, const knobs *k, scene_run **run);
void scene_destroy(scene_run **run);
/* The largest dt, at most the one given, that has every sample at the end of a step. */
double scene_dt(const scene *s, double dt);
/* One step of knobs.dt from the session's time: before, then spar_step. seconds: processor time of both, added;
   iterations: added. */
int scene_step(scene_run *run, double *seconds, int64_t *iterations);
/* From the session's time, which is 0 or later, to T in steps of knobs.dt (see scene_dt). Samples that lie before the
   start are 0. SPAR_ERR_NUMERIC too if the tip is a kilometre away. */
int scene_march(scene_run *run, scene_result *result);
/* Root mean square distance of two histories, m; b NULL: from rest. */
double scene_distance(const double a[3 * SCENE_SAMPLES], const double b[3 * SCENE_SAMPLES]);
/* The scene with the coupling converged to 1e-9, dt that of the standard knobs over `refine`, on elements * nodes
   nodes. How far it is from the limit, two of them tell: scene_distance of their histories over the scale. */
int scene_converge(const scene *s, double refine, int elements, int nodes, scene_reference *reference);
/* The same, begun at that phase. */
int scene_converge_at(const scene *s, double phase, double refine, int elements, int nodes, scene_reference *reference);
/* Distance from the reference over its scale: 1 is a result without any deformation. */
double scene_error(const scene_reference *reference, const scene_result *result);
/* The same of the load. */
double scene_load_error(const scene_reference *reference, const scene_result *result);
/* Frees the rotor's tables; they are read again when a scene needs them. */
void scenes_free(void);

#endif
