/* A member seen from its ends, the nodes that joints hold: of its tangent [K_ii K_ie; K_ei K_ee] there remains
   K = K_ee - K_ei K_ii^-1 K_ie, and of its forces r_e - K_ei K_ii^-1 r_i. The rest of the member is solved by its own
   factors, with the ends taken out. */
#ifndef SPARI_CONDENSE_H
#define SPARI_CONDENSE_H

#include "linear.h"

typedef struct spari_condensed {
    int ends, n;  /* nodes that are held; unknowns of the member, 6 a node */
    int *node;    /* [ends] of the unknowns' nodes, increasing */
    int fixed;    /* so many of the first unknowns a root condition takes out */
    double *W;    /* [6 ends][n]: the columns K_ie, then K_ii^-1 K_ie; 0 at the ends */
    double *rows; /* [6 ends][n]: K_ei; 0 at the ends */
    double *K;    /* [6 ends][6 ends] */
    double *held; /* [6 ends] room */
} spari_condensed;

/* NULL: no memory. */
spari_condensed *spari_condensed_create(int ends, const int *node, int unknowns);
void spari_condensed_free(spari_condensed *c);
/* Reads what it needs of a tangent that is not factored, then takes the ends out of it. fixed: so
   many of the first unknowns the root condition takes out. */
void spari_condensed_take(spari_condensed *c, spari_linear *tangent, int fixed);
/* After that one is factored. 0, or 1 where a number is not finite. */
int spari_condensed_form(spari_condensed *c, spari_linear *factors);
/* r [unknowns] := K_ii^-1 r_i, and at the ends what is left of their forces. 0 or 1. */
int spari_condensed_reduce(const spari_condensed *c, spari_linear *factors, double *r);
/* What a factored tangent keeps here, as doubles, for save and load. */
int64_t spari_condensed_state_size(const spari_condensed *c);
void spari_condensed_save(const spari_condensed *c, double *state);
void spari_condensed_load(spari_condensed *c, int fixed, const double *state);
/* x: what reduce left, with the ends' solution put in its place; the rest follows. */
void spari_condensed_expand(const spari_condensed *c, double *x);

#endif
