/* Data structures of a fluid, for the files of this room: nodes.c (create, describe), map.c, pull.c (motion), push.c
   (loads). */
#ifndef SPARI_FLUID_STATE_H
#define SPARI_FLUID_STATE_H

#include "../base/session.h"
#include "../transfer/projection.h"
#include "../transfer/transfer.h"
#include "fluid.h"

/* Rows of workspace of a pull: the motion of a tile, the reference poses, and a second motion for times between two
   states. */
enum { SPARI_PULL_ONE = SPARI_ROWS + SPARI_R_OMEGA, SPARI_PULL_BOTH = SPARI_PULL_ONE + SPARI_ROWS };

/* A fade with the distance from the line: far nodes follow the translation of their nearest point, and of its rotation
   only what it does to a shorter lever arm. */
typedef struct spari_fade_node {
    double slope[3];   /* gradient of the weight; 0: the node needs no check */
    double tangent[3]; /* of the line at the nearest point; 0: an end, where it stays as the node moves along */
    double growth;     /* derivative of the shorter arm's length by the arm's */
} spari_fade_node;
typedef struct spari_fade {
    double within, beyond;
    double *reach;         /* [n] part of the lever arm that rotates */
    spari_fade_node *node; /* [n] for the mesh's deformation */
    spari_nodes *nodes;    /* the mapped nodes with these arms; NULL: not mapped */
} spari_fade;

/* A set of nodes: as the host gave it until it is mapped, and as mapped. */
typedef struct spari_node_set {
    int pending;  /* given, not mapped yet */
    int sections; /* given by coordinate, not by position */
    int64_t n;
    double *x;          /* [n][3]: positions, or offsets in the section frame; while pending */
    double *eta;        /* [n]: sections only; while pending */
    spari_nodes *nodes; /* after the map */
    double farthest;    /* its longest lever arm */
    double *frame;      /* [n][4]: frames that sections keep when the line gets other nodes; NULL: the line's frames */
    double *weight, *home; /* [n], [n][3]: motion weight and reference position; NULL: full motion */
    spari_fade *fade;      /* NULL: weights alone, for whole lever arms */
} spari_node_set;

/* The least Jacobian of a faded mesh, and its node. */
typedef struct spari_fold {
    double jacobian;
    int64_t node;
} spari_fold;

/* Node forces over time, for hosts that pull them back between steps (SPAR_EFFECT_FLUID_HISTORY). */
enum { SPARI_MOST_PAST = 3 };
typedef struct spari_history {
    int pushed;   /* pushed in this step */
    int known;    /* of t^n, t^{n-1}, t^{n-2}, those that are known; 0: other nodes, whose forces at t^n nobody knows */
    int sections; /* of stations, which keep their forces when as many are given anew */
    int64_t n;
    double *after;                 /* [n][3] at t^{n+1}: predicted, then pushed */
    double *past[SPARI_MOST_PAST]; /* at t^n, t^{n-1}, t^{n-2}, as far as the predictor's order needs */
} spari_history;

/* Whether there are forces at t^{n+1}. */
static inline int spari_history_is_known(const spari_history *h) {
    return h->known > 0 || h->pushed;
}

/* The host's own numbers at the force nodes (states.c): at t^n, and at t^{n+1} once pushed in the step. */
typedef struct spari_states {
    int pushed;
    int64_t n, width;
    double *now, *next; /* [n][width] */
} spari_states;
enum { SPARI_MOST_STATES = 1000 };

/* Loads over parts of a step (parts.c). s runs from 0 at t^n to 1 at t^{n+1}. */
typedef struct spari_parts {
    double theta;            /* end of the last part; 0: none in this step */
    int plain;               /* loads at t^{n+1} were pushed instead in this step */
    int moment, moment_next; /* a part had moments; including the part that is being added */
    int64_t n[2];            /* allocated nodes, for forces and for moments */
    double *sums[2][2];      /* for both, present and next: integrals of load ds and of load s ds, [2][n][3] */
    double *value[2];        /* [n][3], valid for one call */
    double *end[2];          /* [nodes][6]: extrapolated nodal loads of the parts at t^n, and at theta */
    double *mean;            /* [nodes][6], valid for one call */
    int ended;               /* end[0] comes from parts; otherwise the loads at t^n are those in use */
} spari_parts;

/* New state of a fluid, assembled from the states of a file (saved_state.c); layout as in their heads. */
typedef struct spari_taking {
    double head[SPARI_FLUID_HEAD]; /* over all states: sums, or whether any has it */
    double *load[2];               /* [2][nodes][6]: load and load_accepted, summed; and the ends of parts, if any */
    spari_bins *bins[2];           /* of these, if kept */
    int added;                     /* number of states with loads so far */
    int64_t n;
    double *positions;                 /* [n][3] of the force nodes here; NULL: nothing is kept per node, or no nodes */
    const double **sorted;             /* [n] positions, sorted by height */
    char *found;                       /* [n] */
    spari_history *history;            /* NULL: forces are not kept */
    spari_states *states;              /* NULL: none */
    double *block[SPARI_FLUID_BLOCKS]; /* the data per node in both; NULL: not kept */
} spari_taking;

/* Reproducible sums of a fluid's loads: of load, load_new, load_accepted; of `mean`, end[0] and end[1] of its parts.
   Each is of twice the loads, so that half of a pushed sum is made of integers too. Valid for 2^28 nodes. */
enum { SPARI_OF_PUSHED, SPARI_OF_NEXT, SPARI_OF_ACCEPTED, SPARI_OF_MEAN, SPARI_OF_BEGIN, SPARI_OF_END, SPARI_OF_COUNT };

/* Settings by spar_fluid_set_option (options.c). */
typedef struct spari_fluid_options {
    int theta_on_group; /* theta = average (default) | group */
    int far_refuse;     /* far = take (default) | refuse: nodes beyond max_distance */
    int audit_off;      /* audit = on (default) | off */
    int own_velocity;   /* velocity = pulled (default) | own: velocities need not be pulled */
    double ramp;        /* s, over which loads rise from 0 (> 0) or fall to 0 (< 0); 0: off */
    double ramp_start;  /* s, time at which the ramp begins */
} spari_fluid_options;

struct spar_fluid {
    spar_member *member;
    spar_fluid *before, *next; /* in order of creation */
    char *name;
    int method, consistent;
    double max_distance;
    spari_fluid_options options;
    int gone;   /* destroyed during a trial: freed when the trial has ended */
    int shared; /* sections: the motion set serves as both */
    int asked;  /* SPARI_MUTE_*: what has been pulled so far */
    int warned; /* SPARI_WARNED_*: what the host was warned of (plausible.c) */
    int steps;  /* accepted since the nodes were mapped, up to a few */
    int mute;   /* trials: SPARI_MUTE_* that are switched off */
    spari_node_set set[2];
    spari_layout layout[2]; /* of the host's triples for each set; node 0: packed */
    int64_t pushes;
    int refused; /* status of the last push of this step */
    char *why;   /* its message; NULL: accepted, or no memory for it */

    /* allocated by the map */
    double *modal;     /* [P][P] */
    double *field[2];  /* coefficients [nodes][SPARI_FIELDS] of a state, and of a second one after the first average */
    double *reference; /* of the reference configuration */
    double *load, *load_new, *load_accepted; /* [nodes][6] */
    spari_bins *bins[SPARI_OF_COUNT];        /* [nodes][6] reproducible sums; NULL: not kept */
    double audit[SPAR_AUDIT_COUNT];
    spari_parts *parts;     /* loads over parts of a step; NULL: never pushed */
    spari_history *history; /* NULL: not kept */
    spari_states *states;   /* NULL: none */
    spari_taking *taking;   /* while a file is loaded (saved_state.c), or after giving up; otherwise NULL */
};

/* Warnings, once per fluid: at the map or after loading, at a pull, and at the end of an accepted step (plausible.c).
 */
void spari_fluid_warn_far(spar_fluid *fluid);
void spari_fluid_warn_present(spar_fluid *fluid);
void spari_fluid_warn_no_force_nodes(spar_fluid *fluid);
void spari_fluid_warn_fold(spar_fluid *fluid, spari_fold fold);
void spari_fluid_warn_step(spar_fluid *fluid);
/* Message that begins with caller, fluid and member; returns status. */
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

/* The nodes of a set with the lever arms that move them. */
static inline const spari_nodes *spari_moving_nodes(const spari_node_set *set) {
    return set->fade ? set->fade->nodes : set->nodes;
}

/* Frees and empties a set of nodes. */
void spari_node_set_clear(spari_node_set *set);
/* Nodes and maps can only change between steps, and not in a trial. */
int spari_fluid_check_idle(const spar_fluid *fluid, const char *caller);
/* The mapped set, or a refusal; *nodes NULL: an empty set. */
int spari_fluid_mapped(const spar_fluid *fluid, int which, const char *caller, const spari_nodes **nodes);
/* Applies the motion weights to the positions, velocities and accelerations of one state's tile. The set must have
   weights. fold: in and out, the worst so far; a fade needs the quaternions. */
void spari_fluid_weigh(const spari_node_set *set, int64_t first, int upto, double (*buf)[SPARI_ROW], spari_fold *fold);
/* The worse of the two; of equal ones that of the lower node. */
static inline spari_fold spari_fold_worse(spari_fold a, spari_fold b) {
    return b.jacobian < a.jacobian || (b.jacobian == a.jacobian && b.node < a.node) ? b : a;
}
static inline spari_fold spari_fold_none(void) {
    return (spari_fold){1, 0};
}
/* Weight at s, of the width of a fade: 1 at s <= 0, 0 at s >= 1. */
double spari_fade_weight(double s);
/* create: for nodes with these lever arms and tangents of the line [n][3], held (NULL: none). copy: for a line with
   other nodes; neither is mapped yet. NULL: no memory. map: for nodes that are mapped; returns 0, or 1: no memory, and
   nothing has changed. */
spari_fade *spari_fade_create(int64_t n, const double *arm, const double *tangent, const int *held, double within,
                              double beyond);
void spari_fade_free(spari_fade *fade);
spari_fade *spari_fade_copy(const spari_fade *from, int64_t n);
int spari_fade_map(spari_fade *fade, const spari_nodes *nodes);
/* Allocates the workspace of the fluid's calls for all threads. Returns 0, or 1: no memory. */
int spari_fluid_reserve_workspace(const spar_fluid *fluid);
/* Workspace of a thread, valid for one call: rows of tiles. */
double *spari_fluid_work(const spar_fluid *fluid, int worker);
/* NULL: packed. */
const spari_layout *spari_fluid_layout(const spar_fluid *fluid, int which);
int spari_fluid_check_which(const spar_fluid *fluid, int which, const char *caller);
/* Checks that x [n][width] is finite. */
int spari_fluid_check_values(const spar_fluid *fluid, const char *caller, const char *what, const double *x, int64_t n,
                             int width);
/* theta, or 1 in a static solution. */
double spari_fluid_time(const spar_fluid *fluid, double theta);
int spari_fluid_check_theta(const spar_fluid *fluid, double theta, const char *caller);
/* least: smallest |Q|^2 from the kernels. */
int spari_fluid_check_rotation(const spar_fluid *fluid, double least, const char *caller);
/* Reference position and orientation of a nearest point (T2). */
void spari_fluid_reference(const spar_fluid *fluid, int element, double xi, double x[3], double q[4]);
/* sum_k T_k(xi) c[k][offset .. offset + n): n fields of an element at xi. */
void spari_fluid_series(const double *c, int modes, int offset, int n, double xi, double *out);
/* Reference position and section frame; p: storage position. */
void spari_fluid_frame(const spar_fluid *fluid, const spari_node_set *set, int64_t p, double x[3], double q[4]);
/* Maps; present: new positions are those of the present configuration. */
int spari_fluid_map(spar_fluid *fluid, int present, const char *caller);
/* Nearest points of x [n][3] on the present line, as spari_line_project. SPAR_ERR_MEMORY without a message. */
int spari_fluid_project_on_present(const spar_fluid *fluid, int64_t n, const double *x, int *element, double *xi,
                                   double *nearest);
/* Reference positions [n][3] that the present motion moves to x; free with free(). NULL: no memory. */
double *spari_fluid_reference_of_present(const spar_fluid *fluid, const spari_line *reference, int64_t n,
                                         const double *x);
/* Refuses nodes that the present motion moves elsewhere than to x. */
int spari_fluid_check_present(const spar_fluid *fluid, int which, const spari_nodes *nodes, const double *x,
                              const char *caller);
/* Reference positions [n][3] of a mapped set, from nearest points and lever arms; free with free(). NULL: no memory. */
double *spari_fluid_positions(const spar_fluid *fluid, const spari_nodes *nodes);
/* Creates reproducible sums for the existing loads and those of parts, unless they exist. SPAR_ERR_MEMORY: nothing
   has changed, no message. */
int spari_fluid_make_bins(spar_fluid *fluid);
void spari_fluid_drop_bins(spar_fluid *fluid);
/* Adds twice a number to a sum. */
void spari_fluid_add_twice(spari_bins *sum, double x);
/* keep: the last pushed loads become those of t^n. revert: the loads of t^n become the last pushed. */
void spari_fluid_keep_loads(spar_fluid *fluid);
void spari_fluid_revert_loads(spar_fluid *fluid);
/* Zero node forces, which are known, for n nodes and a predictor of this order; NULL: no memory. */
spari_history *spari_history_create(int64_t n, int order);
void spari_history_free(spari_history *history);
/* Zero numbers for n nodes; NULL: no memory. begin, accept: step events; states may be NULL. */
spari_states *spari_states_create(int64_t n, int64_t width);
spari_states *spari_states_copy(const spari_states *from);
void spari_states_free(spari_states *states);
void spari_states_begin(spari_states *states);
void spari_states_accept(spari_states *states);
void spari_taking_free(spari_taking *taking);
/* Allocates the ends of parts. SPAR_OK, or SPAR_ERR_MEMORY without a message. */
int spari_parts_prepare(spar_fluid *fluid);
void spari_parts_free(spari_parts *parts);
/* Adds a part that ends at theta, on n force nodes, to the next sums; moment may be absent. SPAR_ERR_MEMORY without
   a message. */
int spari_parts_add(spar_fluid *fluid, int64_t n, double theta, spari_source force, spari_source moment);
/* Means of the next sums over [0, theta] (at_end 0), or values at theta of the least-squares lines, in `value`. */
void spari_parts_see(spari_parts *parts, double theta, int at_end);
/* Makes the next sums the present ones. */
void spari_parts_keep(spari_parts *parts, double theta);
/* Begins a step without parts. */
void spari_parts_begin(spar_fluid *fluid);
void spari_parts_accept(spar_fluid *fluid);

#endif
