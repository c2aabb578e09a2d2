/* What a fluid is made of, for the files of this room: nodes.c (life, what the host gives), map.c, pull.c (motion out),
 * push.c (loads in). */
#ifndef SPARI_FLUID_STATE_H
#define SPARI_FLUID_STATE_H

#include "../base/session.h"
#include "../transfer/transfer.h"
#include "fluid.h"

/* Rows of work space of a pull: a tile's motion, what of the reference's poses are made of, and another motion where a
   time lies between two states. */
enum { SPARI_PULL_ONE = SPARI_ROWS + SPARI_R_OMEGA, SPARI_PULL_BOTH = SPARI_PULL_ONE + SPARI_ROWS };

/* A set of nodes as the host gave it, until the map ties it to the line, and as it is kept afterwards. */
typedef struct spari_node_set {
    int pending;  /* given, not mapped yet */
    int sections; /* given by coordinate, not by place */
    int64_t n;
    double *x;          /* [n][3]: places, or offsets in the section frame; while pending */
    double *xi;         /* [n]: sections only; while pending */
    spari_nodes *nodes; /* once mapped */
    double *frame; /* [n][4]: sections that have kept their frames when the line got other nodes; NULL: the line's */
    double *weight,
        *home; /* [n], [n][3]: what part of the motion each takes, and where it is at rest; NULL: all of it */
} spari_node_set;

/* Node forces over time, for hosts that want them back between the steps (SPAR_EFFECT_FLUID_HISTORY). */
typedef struct spari_history {
    int pushed; /* a push came in the step under way */
    int64_t n;
    double *after;   /* [n][3] at t^{n+1}: predicted, then pushed */
    double *past[3]; /* at t^n, t^{n-1}, t^{n-2}, as far back as the predictor looks */
} spari_history;

/* Numbers of the host's own at the force nodes (states.c): at t^n, and at t^{n+1} once they were pushed in the step. */
typedef struct spari_states {
    int pushed;
    int64_t n, width;
    double *now, *next; /* [n][width] */
} spari_states;
enum { SPARI_MOST_STATES = 1000 };

/* Loads over the parts of a step (parts.c). s runs from 0 at t^n to 1 at t^{n+1}. */
typedef struct spari_parts {
    double theta;            /* where the last part ended; 0: none in this step */
    int plain;               /* loads at t^{n+1} were pushed in this step instead */
    int moment, moment_next; /* a part had moments; with the one that is being added */
    int64_t n[2];            /* nodes that there is room for, of forces and of moments */
    double *sums[2][2];      /* of both, now and room for the next: integrals of load ds and of load s ds, [2][n][3] */
    double *value[2];        /* [n][3], for one call */
    double *end[2];          /* [nodes][6]: nodal loads that the parts tend to at t^n, and at theta */
    double *mean;            /* [nodes][6], for one call */
    int ended;               /* end[0] is of parts; else the loads at t^n are those in use */
} spari_parts;

/* What a fluid is to become, put together from the states of a file (restore.c), with their heads' layout. */
typedef struct spari_taking {
    double head[SPARI_FLUID_HEAD]; /* of all states: sums, or what any of them has */
    double *load;                  /* [2][nodes][6]: load and load_accepted, as a sum over the states */
    spari_bins *bins;              /* of the same, where they are kept */
    double *end;                   /* [2][nodes][6]: ends of parts, where there are any */
    spari_bins *end_bins;          /* of the same, where they are kept */
    int added;                     /* states with loads so far */
    int64_t n;
    double *places;         /* [n][3] of the force nodes here; NULL: nothing is kept by node, or there are no nodes */
    const double **sorted;  /* [n] of them, by height */
    char *found;            /* [n] */
    spari_history *history; /* NULL: forces are not kept */
    spari_states *states;   /* NULL: there are none */
} spari_taking;

/* Reproducible sums of a fluid's loads: of load, load_new, load_accepted; of `mean`, end[0] and end[1] of its parts.
   Each is of twice the loads, so that half a sum of what was pushed is made of whole numbers too: good for 2^28 nodes.
 */
enum { SPARI_OF_PUSHED, SPARI_OF_NEXT, SPARI_OF_ACCEPTED, SPARI_OF_MEAN, SPARI_OF_BEGIN, SPARI_OF_END, SPARI_OF_COUNT };

struct spar_fluid {
    spar_member *member;
    spar_fluid *next;
    char *name;
    int method, consistent;
    double max_distance;
    int gone;   /* destroyed within a trial run: released when that has gone back */
    int shared; /* sections: the motion set serves both */
    int asked;  /* SPARI_MUTE_*: what has been pulled so far */
    int mute;   /* trial runs: SPARI_MUTE_* that are left out */
    spari_node_set set[2];
    spari_layout layout[2]; /* of the host's triples at either set; node 0: packed */
    int64_t pushes;
    int refused; /* status of the last push of this step */
    char *why;   /* its message; NULL: not refused, or no memory for it */

    /* allocated by the map */
    double *modal;     /* [P][P] */
    double *field[2];  /* coefficients [nodes][SPARI_FIELDS] of a state, and of a second from the first average on */
    double *reference; /* of the reference configuration */
    double *load, *load_new, *load_accepted; /* [nodes][6] */
    spari_bins *bins[SPARI_OF_COUNT];        /* [nodes][6] reproducible sums; NULL: not kept */
    double audit[SPAR_AUDIT_COUNT];
    spari_parts *parts;     /* of loads that come several times in a step; NULL: none ever did */
    spari_history *history; /* NULL: not kept */
    spari_states *states;   /* NULL: there are none */
    spari_taking *taking;   /* of a file being loaded (restore.c); else NULL, or what was given up */
};

/* Message with the caller, the fluid and its member in front; gives back status. */
int spari_fluid_refuse(const spar_fluid *fluid, int status, const char *caller, const char *format, ...)
    SPARI_PRINTF(4, 5);

#define SPARI_FLUID_REQUIRE_OF(fluid, caller, condition, status, ...)                                                  \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            return spari_fluid_refuse(fluid, status, caller, __VA_ARGS__);                                             \
        }                                                                                                              \
    } while (0)
#define SPARI_FLUID_REQUIRE(fluid, condition, status, ...)                                                             \
    SPARI_FLUID_REQUIRE_OF(fluid, __func__, condition, status, __VA_ARGS__)
#define SPARI_FLUID_HANDLE(fluid)                                                                                      \
    SPARI_REQUIRE(NULL, fluid, SPAR_ERR_ARGUMENT, "%s: the fluid is NULL; create it with spar_fluid_create", __func__)

static inline const spari_node_set *spari_fluid_set(const spar_fluid *fluid, int which) {
    return &fluid->set[fluid->shared ? SPAR_NODES_MOTION : which];
}

/* Frees what a set of nodes has, and empties it. */
void spari_node_set_clear(spari_node_set *set);
/* Nodes and maps change between steps, and not in a trial. */
int spari_fluid_check_idle(const spar_fluid *fluid, const char *caller);
/* The mapped set, or a refusal; *nodes NULL: there is none and nothing to do. */
int spari_fluid_mapped(const spar_fluid *fluid, int which, const char *caller, const spari_nodes **nodes);
/* Of one state's tile: places and what of velocities and accelerations is there become the part the nodes take. The set
   has weights. */
void spari_fluid_weigh(const spari_node_set *set, int64_t first, int upto, double (*buf)[SPARI_ROW]);
/* Keeps the work space that the fluid's calls need, of all threads. 0, or 1: no memory. */
int spari_fluid_keep_room(const spar_fluid *fluid);
/* That of a thread, for one call: doubles of rows of tiles. */
double *spari_fluid_work(const spar_fluid *fluid, int worker);
/* NULL: packed. */
const spari_layout *spari_fluid_layout(const spar_fluid *fluid, int which);
int spari_fluid_check_which(const spar_fluid *fluid, int which, const char *caller);
/* Finite numbers x [n][width]. */
int spari_fluid_check_values(const spar_fluid *fluid, const char *caller, const char *what, const double *x, int64_t n,
                             int width);
/* theta, or 1 in a static solution, where time stands. */
double spari_fluid_time(const spar_fluid *fluid, double theta);
int spari_fluid_check_theta(const spar_fluid *fluid, double theta, const char *caller);
/* least: least |Q|^2 the kernels met. */
int spari_fluid_check_rotation(const spar_fluid *fluid, double least, const char *caller);
/* Reference foot and its orientation (T2). */
void spari_fluid_reference(const spar_fluid *fluid, int element, double xi, double x[3], double q[4]);
/* sum_k T_k(xi) c[k][offset .. offset + n): n fields of an element at a place. */
void spari_fluid_series(const double *c, int modes, int offset, int n, double xi, double *out);
/* The same with the frame of the section there: p in the order of storage. */
void spari_fluid_frame(const spar_fluid *fluid, const spari_node_set *set, int64_t p, double x[3], double q[4]);
/* Reference places of a mapped set, put together again from feet and arms: [n][3]; to free. NULL: no memory. */
double *spari_fluid_places(const spar_fluid *fluid, const spari_nodes *nodes);
/* Reproducible sums for the loads there are, and for those of parts; nothing if they are there. SPAR_ERR_MEMORY: as it
   was, no message. */
int spari_fluid_make_bins(spar_fluid *fluid);
void spari_fluid_drop_bins(spar_fluid *fluid);
/* Twice a number is added to a sum. */
void spari_fluid_add_twice(spari_bins *sum, double x);
/* The loads of the last push hold at t^n; they are again those that held at t^n. */
void spari_fluid_keep_loads(spar_fluid *fluid);
void spari_fluid_revert_loads(spar_fluid *fluid);
/* Node forces for n nodes and a predictor of this order, zeros; NULL: no memory. */
spari_history *spari_history_create(int64_t n, int order);
void spari_history_free(spari_history *history);
/* Numbers for n nodes, zeros; NULL: no memory. begin, accept: of a step; states NULL: there are none. */
spari_states *spari_states_create(int64_t n, int64_t width);
spari_states *spari_states_copy(const spari_states *from);
void spari_states_free(spari_states *states);
void spari_states_begin(spari_states *states);
void spari_states_accept(spari_states *states);
void spari_taking_free(spari_taking *taking);
/* Room for the ends of parts. SPAR_OK, or SPAR_ERR_MEMORY without a message. */
int spari_parts_prepare(spar_fluid *fluid);
void spari_parts_free(spari_parts *parts);
/* A part that ends at theta, on n force nodes; no moment: none. In the sums to come only. SPAR_ERR_MEMORY without a
   message. */
int spari_parts_add(spar_fluid *fluid, int64_t n, double theta, spari_source force, spari_source moment);
/* Of these sums the means over [0, theta] (at_end 0), or the ends there of the lines of least squares, into `value`. */
void spari_parts_see(spari_parts *parts, double theta, int at_end);
/* The sums to come are those that hold. */
void spari_parts_keep(spari_parts *parts, double theta);
/* No part has been pushed in the step. */
void spari_parts_begin(spar_fluid *fluid);
void spari_parts_accept(spar_fluid *fluid);

/* Keeps node forces for n nodes from now on, beginning with zeros. */
int spari_fluid_renew_history(spar_fluid *fluid, int64_t n);

#endif
