/* A structural member: data of points, rigid bodies, beams and external members. Nodes are numbered element by
   element (elements * per_element of them; an element boundary is two nodes), as in spar_beam_set_nodes. */
#ifndef SPARI_STRUCTURE_H
#define SPARI_STRUCTURE_H

#include "../base/budget.h"
#include "../base/session.h"
#include "../base/thread_pool.h"
#include "../math/resample.h"
#include "digest.h"

#include <string.h>

enum { SPARI_POINT, SPARI_RIGID, SPARI_BEAM };

/* Motion of one node or frame: u and quaternion, velocity, acceleration. */
typedef struct spari_pose {
    double q[7], v[6], a[6];
} spari_pose;

/* Motion of all nodes at one time: q [n][7] (u, quaternion relative to the reference), v [n][6] (u-dot, omega),
   a [n][6]. */
typedef struct spari_motion {
    double *q, *v, *a;
} spari_motion;

typedef struct spari_beam spari_beam;             /* member/beam.h: description of a beam */
typedef struct spari_assembly spari_assembly;     /* src/assembly/assembly.h: members connected by joints */
typedef struct spari_work spari_work;             /* solve/work.h: work done on a member */
typedef struct spari_applied spari_applied;       /* member/applied_loads.h: follower and distributed loads */
typedef struct spari_ramp spari_ramp;             /* member/applied_loads.h: replaced loads at t^n */
typedef struct spari_foundation spari_foundation; /* member/applied_loads.h: springs along the line */
typedef struct spari_rebuild spari_rebuild;       /* src/trial/rebuild.h: a member rebuilt for a trial */
typedef struct spari_means spari_means;           /* src/member/mean_acceleration.h: accelerations for fluids */
typedef struct spari_added spari_added;           /* src/member/added_mass.h: known added mass */
typedef struct spari_learned spari_learned;       /* src/member/added_mass_fit.h: identified added mass */
typedef struct spari_body spari_body;             /* member/body.h: discretised member, on every rank */

/* Frame of reference of a member's deformation. */
typedef enum spari_frame_kind {
    SPARI_FRAME_INERTIAL,   /* inertial frame */
    SPARI_FRAME_PRESCRIBED, /* frame of a prescribed root */
    SPARI_FRAME_LINEAR      /* floating frame, small deformation: linear */
} spari_frame_kind;

/* Binary tree of the halvings of a step's substeps: bits of substeps that were halved. They stay halved until the
   step ends, so that all coupling iterations see the same map, except for halvings caused by loads far from
   convergence. */
typedef struct spari_cuts {
    int64_t begun; /* session->clock.begun of the step */
    int halved;    /* how many there are */
    uint32_t given_up[64];
} spari_cuts;

/* clang-format off */
/* Loads of a member. The nodal loads are [n][6], in global axes. Contents of the arrays during a step:

     array            between steps    step begun    solved                 checked
     dead             applied by the host until replaced; values at t^n: spari_dead_before
     pushed           at t^n           at t^n        at t^n                 at t^{n+1}, from the fluids
     used             -                predicted     used in the solution   for the next solution, if any
     solved[1]        as [0]           as [0]        dead + used            dead + used, of the motion `after`
     solved[0]        all loads with which the motion at t^n was computed
     history[k]       accepted loads of the fluids at t^n, t^{n-1}, t^{n-2}, as far as the predictor's order needs
     before           `pushed` before the first step, restored if that step is rejected

   Accepting a step makes `pushed` the newest of the history (`used` if nothing was checked), and solved[1] becomes
   solved[0]. Rejecting it restores both. For an external member the fluids' loads include those of its joints. */
/* clang-format on */
typedef struct spari_member_loads {
    double *dead;
    double *used;
    double *pushed;
    double *before;
    double *history[3];
    double *solved[2];
    spari_applied *applied;       /* follower and distributed loads; NULL: none */
    spari_ramp *ramp;             /* applied loads at t^n if others are given for t^{n+1}; NULL: never */
    spari_applied *applied_next;  /* of a file being loaded */
    spari_ramp *ramp_next;        /* likewise */
    spari_foundation *foundation; /* springs along the line in force; NULL: none */
    int64_t pack_at;              /* offset of the loads in the vector that the ranks sum */
} spari_member_loads;

/* Stations along a line, with a row of numbers at each; or none. */
typedef struct spari_line_table {
    int64_t count;
    double *eta, *value;
} spari_line_table;

/* Placement of a member in space. */
typedef struct spari_placement {
    double x[3];
    double q[4];
} spari_placement;

/* Initial conditions of a member. */
typedef struct spari_initial {
    double velocity[3][3]; /* x0, v0, omega of the initial rigid-body field */
    int velocity_given;
    double *acceleration;      /* [nodes][6] initial guess of the consistent accelerations at t^0, if requested, until
                                  the first step is accepted; NULL: present accelerations */
    double *acceleration_next; /* the same for a file being loaded */
} spari_initial;

enum { SPARI_DRIVE_TOLD = 2 }; /* drive_given: a static solution has warned that it does not use it */

/* State of a member, beside its motion. */
typedef struct spari_member_state {
    int balanced[2];        /* whether the motion `now`, and `after`, is in equilibrium with its loads */
    int overturned;         /* linear: a node has rotated by more than half a revolution */
    int motion_given;       /* set_motion was called in this step */
    int drive_given;        /* spar_member_drive was called for this or the next step */
    double dissipated;      /* energy dissipated by damping up to t^n */
    double dissipated_step; /* energy dissipated by damping in this step */
    spari_cuts cuts;        /* of this step; for connected members, those of the first one */
    spari_spent spent;      /* of its solver, likewise */
    int halvings_told;      /* a warning of many halvings has been given */
} spari_member_state;

/* Measures of a member's motion, for the step error. */
typedef struct spari_accuracy {
    double step_error; /* with a tolerance: error of the last step, m */
    double speed;      /* with a tolerance: largest speed so far, m/s */
} spari_accuracy;

struct spar_member {
    spar_session *session;
    spar_member *next;   /* in order of creation, the same on every rank */
    int64_t number;      /* in this order, in which loads and motions of all members are stacked */
    spar_joint **joints; /* [joint_count] those that connect it, in order of creation */
    int joint_count, joint_capacity;
    char *name;
    int kind;
    int external;
    int root;
    int committed;
    int owner;
    int owner_given;                  /* by the host; otherwise the least loaded rank is chosen, */
    int owner_assigned;               /* and this is set */
    int effects;                      /* SPAR_EFFECT_*: in force, after commit */
    int effects_on, effects_off;      /* as the host has switched them, on besides those implied, and off */
    int fidelity;                     /* SPAR_FIDELITY_* */
    int64_t modes;                    /* of a modal member */
    const struct spari_fidelity *row; /* table row of its fidelity (time/fidelity.h); after commit */
    spari_frame_kind frame;           /* after commit */
    double locks_from; /* rad, of a beam, once it is built: bending from which a motion is to be warned of */

    spari_mesh mesh; /* elements and nodes of its line */
    int64_t nodes;
    double *xr; /* reference positions [n][3], placed; after commit */
    double *qr; /* reference orientations [n][4], placed; after commit */
    spari_placement placement;
    double mass[36];        /* rigid */
    spari_line_table guess; /* the host's added mass, 36 numbers (a rigid body: one station) */
    int added_by_velocity;  /* the fluid's added mass responds to velocities; used with one substep */
    spari_learned *learned; /* NULL: not requested; shared with the member rebuilt from it in a trial */
    spari_beam *beam;
    spari_body *body; /* of members that are solved */

    spari_motion now;   /* at t^n */
    spari_motion after; /* at t^{n+1} (latest iterate; equal to `now` between steps) */
    spari_initial initial;
    spari_pose drive[2]; /* root at t^n and t^{n+1} */

    spari_member_loads load;
    spari_member_state state;
    spari_accuracy accuracy;
    void *solution;           /* solver data of its fidelity; NULL: none, or not on this rank */
    spari_assembly *assembly; /* solved as part of it; NULL: alone */
    int component;            /* its place among the members of the assembly */
    spari_work *work;         /* NULL: not requested */
    spari_added *added;       /* NULL: no added mass; otherwise the loads above follow added_mass.h */
    spari_means *means;       /* accelerations for fluids with substeps; NULL: those of the motion */
};

/* Table of the nodal arrays, used by everything that allocates, frees, saves, loads or copies a member. */
typedef enum spari_nodal_kind { SPARI_NODAL_REFERENCE, SPARI_NODAL_MOTION, SPARI_NODAL_LOAD } spari_nodal_kind;
typedef struct spari_nodal {
    size_t field; /* offset in spar_member */
    int width;    /* numbers per node */
    int order;    /* smallest predictor order with which it exists */
    spari_nodal_kind kind;
} spari_nodal;
enum { SPARI_NODAL_COUNT = 17 };
extern const spari_nodal spari_nodal_table[SPARI_NODAL_COUNT];
/* Array of row k; NULL: it does not exist. */
static inline double **spari_nodal_array(spar_member *member, int k) {
    return (double **)(void *)((char *)member + spari_nodal_table[k].field);
}

/* Motion of the first node of arrays q, v, a. */
static inline spari_pose spari_pose_of(const double *q, const double *v, const double *a) {
    spari_pose pose;
    memcpy(pose.q, q, sizeof pose.q);
    memcpy(pose.v, v, sizeof pose.v);
    memcpy(pose.a, a, sizeof pose.a);
    return pose;
}
/* Whether gravity changes between t^n and t^{n+1}. */
static inline int spari_gravity_changes(const spar_session *session) {
    return session->clock.step > 0 && memcmp(session->gravity, session->gravity_before, sizeof session->gravity) != 0;
}
/* Hash of the description without the owner: everything the ranks must agree on. */
uint64_t spari_member_hash(const spar_member *member);
/* The parts of a description, which are apart in a saved file so that a message can name the one that differs. Those
   from SPARI_PART_POSITION on may differ between identical members. The initial velocity is not in the file: the motion
   in the file replaces it. */
enum {
    SPARI_PART_KIND,
    SPARI_PART_FIDELITY,
    SPARI_PART_ROOT,
    SPARI_PART_EFFECTS,
    SPARI_PART_MESH,
    SPARI_PART_MASS,
    SPARI_PART_ADDED_MASS,
    SPARI_PART_LINE,
    SPARI_PART_QUADRATURE,
    SPARI_PART_SECTIONS,
    SPARI_PART_DAMPING,
    SPARI_PART_FOUNDATION,
    SPARI_PART_PRETENSION,
    SPARI_PART_POINT_MASSES,
    SPARI_PART_POSITION,
    SPARI_PART_VELOCITY,
    SPARI_MEMBER_PARTS,
    SPARI_SAVED_PARTS = SPARI_PART_VELOCITY
};
extern const char *const spari_member_part_name[SPARI_MEMBER_PARTS];
void spari_member_part_digest(const spar_member *member, int part, spari_digest *digest);
/* Hash without name, placement and initial velocity: equal for identical members. */
uint64_t spari_member_copy_hash(const spar_member *member);
/* Converts arrays of `width` doubles per node from host nodes (element boundaries twice) to unique nodes (once), and
   back. */
void spari_member_to_unique(const spar_member *m, int width, const double *nodes, double *unique);
void spari_member_from_unique(const spar_member *m, int width, const double *unique, double *nodes);
/* Converts q, v, a of unique nodes to a motion of the host's nodes. */
void spari_member_publish(const spar_member *m, const double *q, const double *v, const double *a, spari_motion *to);
/* Reference position of a unique node, and its lever arm from the root. */
static inline const double *spari_member_position(const spar_member *member, int unique) {
    int P = member->mesh.per_element;
    return member->xr +
           3 * (unique + (P > 1 && unique > 0 ? (unique - 1) / (P - 1) : 0)); /* element boundaries are stored twice */
}
static inline void spari_member_arm(const spar_member *member, int unique, double arm[3]) {
    const double *position = spari_member_position(member, unique);
    for (int k = 0; k < 3; k++) {
        arm[k] = position[k] - member->xr[k];
    }
}
/* Sums host nodal loads to unique nodes. */
void spari_member_gather(const spar_member *m, const double *nodal, double *unique);
/* Processes the numbers 0 to n - 1 of this member in spans, with the session's threads (base/thread_pool.h). */
enum { SPARI_MEMBER_SPAN = 512 };
static inline void spari_member_spread(const spar_member *m, int64_t n, spari_span work, void *context) {
    spari_thread_pool_spread(m->session->pool, n, SPARI_MEMBER_SPAN, work, context);
}
/* Redistributes loads of the nodes [nodes][6] without changing their effect: halves the sum between the two nodes of
   an element boundary, and removes loads on constrained degrees of freedom of the root. */
void spari_member_even_loads(const spar_member *m, double *load);
/* Length of a member: of its body, or of the line through its nodes; 1 if it has none. */
double spari_member_length(const spar_member *member);
/* Whether the root's motion is prescribed; otherwise it is unknown. */
static inline int spari_member_root_is_prescribed(const spar_member *member) {
    return member->root == SPAR_ROOT_FIXED || member->root == SPAR_ROOT_DRIVEN;
}
/* Whether the member is linear, in axes at rest: linear or modal, and its root is not driven. */
static inline int spari_member_is_linear_at_rest(const spar_member *member) {
    return member->frame == SPARI_FRAME_LINEAR && member->root != SPAR_ROOT_DRIVEN;
}
/* Whether the member is linear about its reference: linear or modal, and its root is free or pinned. */
static inline int spari_member_is_linear_in_place(const spar_member *member) {
    return member->frame == SPARI_FRAME_LINEAR && !spari_member_root_is_prescribed(member);
}
/* How many of the root's six unknowns its root condition holds: the first. */
static inline int spari_member_constrained(const spar_member *member) {
    return member->root == SPAR_ROOT_FREE ? 0 : member->root == SPAR_ROOT_PINNED ? 3 : 6;
}
/* Coordinates along the whole line of element and local xi: eta in [0,1], and xi in [-1,1]. */
static inline double spari_member_eta(const spar_member *member, int element, double local) {
    return ((double)element + 0.5 * (1.0 + local)) / (double)member->mesh.elements;
}
static inline double spari_member_xi(const spar_member *member, int element, double local) {
    return 2.0 * ((double)element + 0.5 * (1.0 + local)) / (double)member->mesh.elements - 1.0;
}

#endif
