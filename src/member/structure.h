/* A structural member: what point, rigid body, beam and external member share. Nodes are numbered element by element
   (elements * per_element of them, a joint stands twice), as in spar_beam_set_nodes. */
#ifndef SPARI_STRUCTURE_H
#define SPARI_STRUCTURE_H

#include "../base/session.h"
#include "../base/thread_pool.h"
#include "../math/resample.h"

#include <string.h>

enum { SPARI_POINT, SPARI_RIGID, SPARI_BEAM };

/* Motion of one node, or of a frame: u and quaternion, velocity, acceleration. */
typedef struct spari_pose {
    double q[7], v[6], a[6];
} spari_pose;

/* Motion of all nodes at one time: q [n][7] (u, quaternion relative to the reference), v [n][6] (u-dot, omega), a
 * [n][6]. */
typedef struct spari_motion {
    double *q, *v, *a;
} spari_motion;

typedef struct spari_beam spari_beam;             /* src/member/beam.h: the description of a beam */
typedef struct spari_assembly spari_assembly;     /* src/solve/tied.h: members that joints tie together */
typedef struct spari_work spari_work;             /* src/solve/work.h: the work done on a member */
typedef struct spari_applied spari_applied;       /* src/member/applied.h: follower loads and loads along the line */
typedef struct spari_ramp spari_ramp;             /* the same: loads at t^n that the host has replaced since */
typedef struct spari_foundation spari_foundation; /* the same: springs along the line */
typedef struct spari_remake spari_remake;         /* src/trial/remake.h: a member made anew for a trial */
typedef struct spari_means spari_means;     /* src/member/means.h: accelerations over a step of several substeps */
typedef struct spari_added spari_added;     /* src/member/added.h: a guess of the fluid's added mass */
typedef struct spari_learned spari_learned; /* src/member/learned.h: the same learned from iterations */
typedef struct spari_body spari_body;       /* src/member/body.h: what of it is solved, on every rank */

/* How the deformation of a member is seen. */
typedef enum spari_view {
    SPARI_SEEN_FIXED,   /* as it is, from axes that stand */
    SPARI_SEEN_CARRIED, /* from a root that is given, which carries it */
    SPARI_SEEN_LINEAR   /* the same, and small there: to first order */
} spari_view;

/* Halvings of a step's substeps: the nodes of their binary tree that were given up. They stay given up until the step
   ends, so that the iterations of a coupling see one map, but for what loads far from the answer have asked for. */
typedef struct spari_cuts {
    int64_t begun; /* session->begun of the step */
    uint32_t given_up[64];
} spari_cuts;

struct spar_member {
    spar_session *session;
    spar_member *next; /* in order of creation, the same on every rank */
    char *name;
    int kind, external, root, owner, committed;
    int owner_given;                  /* by the host: else it goes to the rank that has least to do, */
    int settled;                      /* where it is now */
    int effects;                      /* SPAR_EFFECT_*: asked for; after commit what is in force */
    int effects_given;                /* 0: besides these what the description implies */
    int effects_asked;                /* as given, whatever of it serves the fidelity of now */
    int fidelity;                     /* SPAR_FIDELITY_* */
    int64_t modes;                    /* of a modal member */
    const struct spari_fidelity *row; /* how it moves (solve/fidelity.h); after commit */
    spari_view seen;                  /* likewise */
    int floats;                       /* seen linear, from a root that is not given: joints tie it */
    int balanced[2];                  /* the motion now, and after, has been found under its loads */
    int overturned;                   /* seen linear: a node of the latest state has turned by more than half a turn */
    int motion_given;                 /* set_motion was called in the step under way */
    int drive_given;                  /* drive_root was called for the step under way or next */

    int elements, per_element;
    int64_t nodes;
    double *xr, *qr; /* reference places [n][3] and orientations [n][4], placed; after commit */
    double place_x[3], place_q[4];
    double mass[36];     /* rigid */
    int64_t guess_count; /* of the fluid's added mass, as the host guesses it: stations (a rigid body: 1); 0: none */
    double *guess_eta, *guess;
    spari_learned *learned; /* NULL: not asked for; shared with what it is made anew as in a trial */
    double velocity[3][3];  /* x0, v0, omega of the initial rigid-body field */
    int velocity_given;
    spari_beam *beam;
    spari_body *body; /* of members that are solved for */

    spari_motion now, after; /* at t^n and t^{n+1} (latest iterate; equal to now between steps) */
    double *begun; /* [nodes][6] accelerations that the balance at t^0 begins with, where a start has been asked for,
                      until the first step is accepted; NULL: those of now */
    double *begun_next;  /* room for those of a file being loaded */
    spari_pose drive[2]; /* root at t^n and t^{n+1} */

    /* Nodal loads [n][6], global axes, in their lives:
                           between steps     step begun        solved               checked
         dead              the host's, kept until it gives others; what was there at t^n: spari_dead_before
         load_pushed       at t^n            at t^n            at t^n               at t^{n+1}, as the fluids gave them
         load_used         -                 predicted         solved with          to be solved with next, if any
         load_solved[1]    as [0]            as [0]            dead + load_used     dead + load_used, of the motion
       after load_solved[0]    all that the motion at t^n was found with load_history[k]   accepted: load_pushed at t^n,
       t^{n-1}, t^{n-2}, as far back as the predictor looks load_before       load_pushed before the first step: what it
       goes back to when that is given up Accepting a step makes load_pushed the newest of the history (load_used, where
       nothing was checked) and load_solved[1] load_solved[0]; giving it up puts both back. Of an external member the
       fluids' have the joints' with them. */
    double *dead;
    double *load_used;
    double *load_pushed;
    double *load_before;
    double *load_history[3];
    double *load_solved[2];
    spari_applied *applied;             /* follower and line loads; NULL: none */
    spari_ramp *ramp;                   /* applied loads at t^n where others are given for t^{n+1}; NULL: never */
    spari_applied *applied_next;        /* of a file being loaded */
    spari_ramp *ramp_next;              /* likewise */
    spari_foundation *foundation;       /* springs along the line that are in force; NULL: none */
    int64_t pack_at;                    /* where its loads begin in the vector that the ranks sum */
    double dissipated, dissipated_step; /* energy damped away up to t^n, and in the step under way */
    double step_error, speed;           /* where a tolerance is set: of the last step, m, and the largest so far, m/s */
    double jerk, swing; /* option newton.stop = tied: by the length, the change of the acceleration in the last steps,
                           1/s^3, and the acceleration, 1/s^2 (solve/leave.h); 0: not known */
    void *solution;     /* what its row keeps of it; NULL: nothing, or not here */
    spari_assembly *assembly; /* it is solved with others; NULL: alone */
    spari_work *work;         /* NULL: not asked for */
    spari_added *added;       /* NULL: no guess of the added mass; else the loads above have lives of their own */
    spari_cuts cuts;          /* of the step under way; of members that joints tie, the first one's */
    spari_means *means;       /* accelerations as fluids see them, where there are substeps; NULL: the motion's own */
    spari_remake *advice;     /* of spar_session_advise; NULL: none */
};

/* The arrays over the nodes, in one table: all that makes, frees, saves, loads or carries over a member walks it. */
typedef enum spari_nodal_kind { SPARI_NODAL_REFERENCE, SPARI_NODAL_MOTION, SPARI_NODAL_LOAD } spari_nodal_kind;
typedef struct spari_nodal {
    size_t field; /* of the member */
    int width;    /* numbers a node has in it */
    int order;    /* of the predictor from which on it is there */
    spari_nodal_kind kind;
} spari_nodal;
enum { SPARI_NODAL_COUNT = 17 };
extern const spari_nodal spari_nodal_table[SPARI_NODAL_COUNT];
/* The array of row k; NULL: it is not there. */
static inline double **spari_nodal_array(spar_member *member, int k) {
    return (double **)(void *)((char *)member + spari_nodal_table[k].field);
}

/* Of the first node of arrays q, v, a. */
static inline spari_pose spari_pose_of(const double *q, const double *v, const double *a) {
    spari_pose pose;
    memcpy(pose.q, q, sizeof pose.q);
    memcpy(pose.v, v, sizeof pose.v);
    memcpy(pose.a, a, sizeof pose.a);
    return pose;
}
/* Whether gravity at t^n, which the step before had, is another than at t^{n+1}. */
static inline int spari_gravity_changes(const spar_session *session) {
    return session->step > 0 && memcmp(session->gravity, session->gravity_before, sizeof session->gravity) != 0;
}
/* The description as one number: all but the owner. */
uint64_t spari_member_hash(const spar_member *member);
/* The same but for its name, placement and initial velocity: members of one make are copies of each other. */
uint64_t spari_member_make(const spar_member *member);
/* Arrays of `width` doubles a node, from the public numbering (joints twice) to the unknowns' (joints once) and back.
 */
void spari_member_to_unique(const spar_member *m, int width, const double *nodes, double *unique);
void spari_member_from_unique(const spar_member *m, int width, const double *unique, double *nodes);
/* The unknowns' q, v, a into a motion of the nodes. */
void spari_member_publish(const spar_member *m, const double *q, const double *v, const double *a, spari_motion *to);
/* Where the reference has a node of the unknowns, and its arm from the root. */
static inline const double *spari_member_place(const spar_member *member, int unique) {
    int P = member->per_element;
    return member->xr +
           3 * (unique + (P > 1 && unique > 0 ? (unique - 1) / (P - 1) : 0)); /* joints stand twice there */
}
static inline void spari_member_arm(const spar_member *member, int unique, double arm[3]) {
    const double *place = spari_member_place(member, unique);
    for (int k = 0; k < 3; k++) {
        arm[k] = place[k] - member->xr[k];
    }
}
/* Loads of the nodes summed onto the unknowns' nodes. */
void spari_member_gather(const spar_member *m, const double *nodal, double *unique);
/* What is done of numbers 0 to n - 1 of this member, in spans, by whoever there is to work on them
 * (base/thread_pool.h). */
enum { SPARI_MEMBER_SPAN = 512 };
static inline void spari_member_spread(const spar_member *m, int64_t n, spari_span work, void *context) {
    spari_crew_spread(m->session->crew, n, SPARI_MEMBER_SPAN, work, context);
}
/* Loads of the nodes [nodes][6] that move what they moved: halved between the two nodes of a joint of elements, without
   what the root holds. */
void spari_member_even_loads(const spar_member *m, double *load);
/* Length of a member: of its body, or of the line through its nodes; 1 where there is none. */
double spari_member_length(const spar_member *member);
/* Whether the motion of the root is given, so that it carries the member; else it is one of the unknowns. */
static inline int spari_member_root_is_given(const spar_member *member) {
    return member->root == SPAR_ROOT_FIXED || member->root == SPAR_ROOT_DRIVEN;
}
/* How many of the root's six unknowns its root condition holds: the first. */
static inline int spari_member_held(const spar_member *member) {
    return member->root == SPAR_ROOT_FREE ? 0 : member->root == SPAR_ROOT_PINNED ? 3 : 6;
}
/* What its line is divided into. */
static inline spari_mesh spari_member_mesh(const spar_member *member) {
    return (spari_mesh){member->elements, member->per_element};
}
/* Position along the whole line of element and local xi, and back (the joint belongs to the lower element). */
static inline double spari_member_xi(const spar_member *member, int element, double local) {
    return 2.0 * ((double)element + 0.5 * (1.0 + local)) / (double)member->elements - 1.0;
}

#endif
