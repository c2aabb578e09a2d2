/* Small scenes of other kinds than those of scenes.h: beams, rigid bodies and joined members, in flows of a few terms.
   A world is built, then stepped by spar_step with world_solve, or by world_step. */
#ifndef WORLDS_H
#define WORLDS_H

#include <spar/spar.h>

enum { WORLD_STEADY = 11 }; /* the first ones: no impulse, no noise, no parametric excitation */
enum { WORLD_COUNT = 24, WORLD_MEMBERS = 4, WORLD_NODES = 8 };

/* Loads at nodes along each member, across it, N: two waves; drag linear, square, cubic in the velocity; a spring. */
typedef struct flow {
    double wave[2], rate[2], number, linear, square, cubic, spring;
    double kick, from, until;  /* a force between two times; smooth 1: as 1 - cos */
    double modulation, pace;   /* of the spring: 1 + modulation cos(pace t) */
    double noise, hiss, rough; /* amplitude of noise that changes with each iteration, time, and 0.05 s */
    double added;              /* added mass at each node */
    int smooth;
} flow;

typedef struct world {
    spar_session *s;
    spar_member *m[WORLD_MEMBERS];
    spar_fluid *f[WORLD_MEMBERS];
    int64_t n[WORLD_MEMBERS];
    double x[WORLD_MEMBERS][3 * WORLD_NODES], rest[WORLD_MEMBERS][3 * WORLD_NODES], v[WORLD_MEMBERS][3 * WORLD_NODES];
    int members, nodes; /* of an element */
    flow air;
    double fading; /* of the beams: mass damping, 1/s */
    double spin;   /* of the first member's root, rad/s, */
    double rises;  /* reached after this time, s; 0: from the beginning */
} world;

typedef struct world_scene {
    const char *name;
    int (*build)(world *w);
    double dt;     /* s, as one would take it */
    int64_t steps; /* that show how it goes on */
    double tolerance[2];
    int times; /* length of the run in trials */
} world_scene;

extern const world_scene worlds[WORLD_COUNT];

/* worlds[k] with so many nodes an element; fading: of its beams, 0: none. Answers a status. The session, if there is
   one, is the caller's to destroy, also after a failure. */
int world_create(int k, int nodes, double fading, world *w);
/* What spar_step and trials are given, with the world as context. */
int world_before(spar_session *session, double t, double dt, void *context);
int world_solve(spar_session *session, double t, double dt, int iteration, void *context);
int world_step(world *w, double t, double dt);

#endif
