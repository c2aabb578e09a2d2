/* The system of an assembly: what remains of its members at the joints' nodes, and the constraints, in a band. */
#ifndef SPARI_TIED_H
#define SPARI_TIED_H

#include "../member/joint.h"
#include "limb.h"

/* A joint of an assembly, as it stands in the system. */
typedef struct spari_link {
    spar_joint *joint;
    spari_limb *limb[2]; /* NULL: the ground, or a node that moves as it is told */
    int at[2];           /* the six unknowns of its nodes in the system; -1: none */
    int row[6];          /* of the multipliers of what is held; -1: free */
    spari_driven drive;  /* at the end of the substep, */
    spari_driven to;     /* or on the way there: there */
    spari_relative begin;
    spari_place place[2];
    double v[12], a[12], B[6][12];
    double turning[12][12]; /* what the turning of its load adds to the tangent, in the axes of the kept tangents */
    double gap[6], correction[6]; /* of the constraints; of the multipliers */
} spari_link;

struct spari_assembly {
    spar_session *session;
    spari_assembly *next;
    int owner, here; /* the rank that solves it; whether this one does, or all do: where there are no limbs */
    int limbs, links;
    spari_limb *limb;
    spari_link *link; /* on every rank; what follows is the owner's */
    double mass;      /* of the parts */
    int turns;        /* the equilibrium under way is that of a whole that turns so (turning.h) */
    spari_turning turning;
    int n;
    int solved;        /* the parts and links stand at the end of a step */
    spari_trace trace; /* of Newton; strict it forgets the rate */
    int factored;      /* whether there are tangents: how many iterations the solution took that formed them, or 0 */
    int violent;       /* velocities are held within the step's equations */
    int turns_far;     /* joints turn far in a substep */
    int standing;      /* the system below is factored, for the tangents there are and this cv, */
    double cv, moved;  /* and the parts' way since; only within a solution */
    double scale;      /* of the constraints' rows */
    spari_linear *linear;
    double *entry; /* (i, j) of its matrix is entry[i + step j] */
    int64_t step;
    double *x;
    double *rates; /* 6 of each node of the largest part */
};

/* The relative motion of a link in the states of its parts, at the part s of the step dt where a node moves as it is
   told, and the loads on what is free; those on what is held are the multipliers, which stay. factor: of the loads that
   the host and preloads give. */
void spari_link_find(spari_link *l, double s, double dt, double factor);
/* B v */
void spari_link_times(double B[6][12], const double v[12], double rate[6]);
/* How far a held motion, or its rate, is from where it has to be. */
double spari_link_gap(const spari_link *l, int k);
double spari_link_rate_gap(const spari_link *l, int k);
/* The side that stands: the ground, or a node that is told to; -1: none. */
int spari_link_standing(const spari_link *l);
/* What its dampers add to the tangent where the other side turns steadily with w: velocities go with places. */
void spari_link_turning_dampers(spari_link *l, const double w[3]);
/* The links' forces, taken from the parts' residuals; fixed unknowns out. */
void spari_links_add(spari_assembly *a);
/* Of the system factored last: the smallest pivot by the largest stiffness. */
double spari_tied_weakest(const spari_assembly *a);
/* What it lets go nearly freely, the motion of a joint, or of a member; text stays where it cannot be told. Spends the
   factors. */
void spari_tied_name_free(spari_assembly *a, char *text, int size);
/* Keeps what the links' loads add to the tangent, with the parts' tangents as they have just been formed. */
void spari_tied_keep(spari_assembly *a);
/* Of the parts' forces and the links' gaps: the parts' corrections and `correction` that take both away. The
   constraints are those of the links as they stand; the parts' tangents, kept, go along with their nodes. cv: as for
   the tangents. 0 or 1. */
int spari_tied_solve(spari_assembly *a, double cv);
/* Of the gaps alone, without forces. */
int spari_tied_close(spari_assembly *a, double cv);
/* Takes down what rings along the constraints at the end of a substep, the part s of the step dt. 0 or 1. */
int spari_tied_calm(spari_assembly *a, double s, double dt);
/* Takes out of the joints' holds what others say already, with a word to the log; the links' B are those of the
   reference. 0, or SPAR_ERR_MEMORY. */
int spari_tied_drop_redundant(spari_assembly *a);
/* Counts and places the unknowns; makes room for the system. 0, or SPAR_ERR_MEMORY. */
void spari_tied_place(spari_assembly *a);
int spari_tied_room(spari_assembly *a);
void spari_tied_free(spari_assembly *a);

#endif
