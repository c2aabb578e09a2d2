/* Static condensation of a member to its interface nodes, the nodes with joints. Of its tangent [K_ii K_ie; K_ei
   K_ee] it forms K = K_ee - K_ei K_ii^-1 K_ie, and of its forces r_e - K_ei K_ii^-1 r_i. The interior is solved with
   the factors of the tangent without the interface nodes. */
#ifndef SPARI_CONDENSE_H
#define SPARI_CONDENSE_H

#include "linear.h"

typedef struct spari_condensed {
    int ends, n;       /* interface nodes; unknowns of the member, 6 per node */
    int *node;         /* [ends] node numbers, increasing */
    int first, length; /* the unknowns from the first node between interface nodes to the last one */
    int fixed;         /* number of first unknowns that a root condition constrains */
    double *W; /* [6 ends][length]: the columns K_ie, then K_ii^-1 K_ie; 0 at interface nodes. The next two follow. */
    double *rows;         /* [6 ends][length]: K_ei; 0 at interface nodes */
    double *K;            /* [6 ends][6 ends] */
    double *end_values;   /* [6 ends] workspace */
    double *row, *column; /* [n] workspace */
} spari_condensed;

/* NULL: no memory. */
spari_condensed *spari_condensed_create(int ends, const int *node, int unknowns);
void spari_condensed_free(spari_condensed *c);
/* Reads K_ie, K_ei, K_ee from an unfactored tangent and removes the interface nodes from it. fixed: number of first
   unknowns that the root condition constrains. */
void spari_condensed_take(spari_condensed *c, spari_linear *tangent, int fixed);
/* Forms K after the tangent is factored. Returns 0, or 1 if a number is not finite. */
int spari_condensed_form(spari_condensed *c, spari_linear *factors);
/* r [unknowns]: K_ii^-1 r_i in the interior, and the condensed forces at interface nodes. Returns 0 or 1. */
int spari_condensed_reduce(const spari_condensed *c, spari_linear *factors, double *r);
/* State of a condensed tangent as doubles, for save and load. */
int64_t spari_condensed_state_size(const spari_condensed *c);
void spari_condensed_save(const spari_condensed *c, double *state);
void spari_condensed_load(spari_condensed *c, int fixed, const double *state);
/* x: the result of reduce with the solution at the interface nodes; computes the interior. */
void spari_condensed_expand(const spari_condensed *c, double *x);

#endif
