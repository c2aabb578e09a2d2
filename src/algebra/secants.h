/* The derivative of a map from differences that scatter. Columns x are changes of the unknowns, w those of the map's
   answers; an inner product <a, b> = a . S b comes with the image S b of each. The derivative J is fitted by least
   squares on the span of the x, which are known exactly, so that differences which contradict each other are averaged
   by their directions; and it is taken to be symmetric and not positive, as the derivative of an added mass is in the
   norm of the structure's flexibility: what scatter says against that is turned about, towards the shorter step. */
#ifndef SPARI_SECANTS_H
#define SPARI_SECANTS_H

#include <stdint.h>

enum { SPARI_SECANTS_MOST = 40 };

typedef struct spari_secants spari_secants;

/* A column: changes of the answer, w, and of the residual, v = w - x; that of the answer before, b, NULL where it is
   not known; and their images. */
typedef struct spari_secant {
    const double *v, *w, *b, *iv, *iw, *ib;
} spari_secant;

/* For at most `most` columns of length n; NULL: no memory. */
spari_secants *spari_secants_create(int64_t n, int most);
void spari_secants_free(spari_secants *s);

/* Forgets all columns. A column widens the basis where more than `filter` of it is new. */
void spari_secants_begin(spari_secants *s, double filter);
/* Not copied: what it points to must live until the fit. The newest first. Returns 0 where there is no room left. */
int spari_secants_add(spari_secants *s, const spari_secant *column);
/* Of a fluid whose changes come again in part with the next answer, w = J x + rho b, J symmetric: what is not symmetric
   in the columns is memory. Over pairs of columns with b, each over the sizes of both x, the sums of w^2, w b, b^2 for
   the antisymmetric parts x_k . S w_l - x_l . S w_k of w and of b, and of the squares of the symmetric parts of w. */
typedef struct spari_asymmetry {
    double pairs, ww, both, bb, symmetric;
} spari_asymmetry;
/* Adds the pairs of the `newest` columns with all others. */
void spari_secants_tell(const spari_secants *s, int newest, spari_asymmetry *sum);
/* From here on the fluid is one that remembers so much. */
void spari_secants_remember(spari_secants *s, double rho);
/* Fits the derivative. `doubt`: squared, relative scatter of the columns, 0: none. Returns the size of the basis. */
int spari_secants_fit(spari_secants *s, double doubt);

/* How far a further column is from what the fit says, relative to its w, both in the span: what is more than the
   part of x out of the span can explain. Negative where x is too far from the span to tell. */
double spari_secants_defect(spari_secants *s, const spari_secant *column);
/* next = x + (I - J)^-1 r, out of the span r, cut to the length `longest`; r is the residual, with what the fluid
   remembers of its last change, and `length` its own. next may be neither. Returns 0 where that gives no numbers. */
int spari_secants_step(spari_secants *s, const double *x, const double *r, double length, double longest, double *next);

#endif
