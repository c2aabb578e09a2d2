/* Derivative of a map from noisy secants, for IQN-ILS. Columns x are changes of the unknowns, columns w the changes
   of the map's results. The inner product is <a, b> = a . S b; each column comes with its image S b.
   The derivative J is fitted by least squares on the span of the x, which are exact. Contradicting differences are
     thus averaged by direction. J is assumed symmetric and negative semidefinite, as the derivative of an added mass
     is in the norm of the structure's flexibility. Noise that violates this is reflected, towards the shorter step. */
#ifndef SPARI_SECANTS_H
#define SPARI_SECANTS_H

#include <stdint.h>

enum { SPARI_SECANTS_MOST = 40 };

typedef struct spari_secants spari_secants;

/* A secant: changes of the result, w, and of the residual, v = w - x; of the previous result, b, NULL if unknown;
   and their images. */
typedef struct spari_secant {
    const double *v, *w, *b, *iv, *iw, *ib;
} spari_secant;

/* For at most `most` columns of length n. NULL: no memory. */
spari_secants *spari_secants_create(int64_t n, int most);
void spari_secants_free(spari_secants *s);

/* Removes all columns. A column extends the basis if more than `filter` of it is linearly independent. */
void spari_secants_begin(spari_secants *s, double filter);
/* Adds a column, newest first. It is not copied and must stay valid until the fit. Returns 0 if there is no room. */
int spari_secants_add(spari_secants *s, const spari_secant *column);
/* Asymmetry of the columns, for a fluid with memory: w = J x + rho b with symmetric J, so asymmetry is due to
   memory. Over pairs of columns with b, normalised by the sizes of both x: the sums of w^2, w b, b^2 for the
   antisymmetric parts x_k . S w_l - x_l . S w_k of w and of b, and of the squares of the symmetric parts of w. */
typedef struct spari_asymmetry {
    double pairs, ww, both, bb, symmetric;
} spari_asymmetry;
/* Adds the pairs of the `newest` columns with all others. */
void spari_secants_tell(const spari_secants *s, int newest, spari_asymmetry *sum);
/* Sets the memory coefficient of the fluid. */
void spari_secants_remember(spari_secants *s, double rho);
/* Fits the derivative. `doubt`: squared relative noise of the columns; 0: none. Returns the size of the basis. */
int spari_secants_fit(spari_secants *s, double doubt);

/* Error of the fit for a further column, relative to its w, within the span. The part that the component of x
   outside the span can explain is subtracted. Negative if x is too far from the span. */
double spari_secants_defect(spari_secants *s, const spari_secant *column);
/* next = x + (I - J)^-1 r, and r itself outside the span, limited to length `longest`.
   r: residual, including the memory of the fluid's last change; length: its norm
   next: may be neither x nor r
   Returns 0 if the result is not finite. */
int spari_secants_step(spari_secants *s, const double *x, const double *r, double length, double longest, double *next);

#endif
