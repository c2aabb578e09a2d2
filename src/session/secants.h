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

/* For at most `most` columns of length n; NULL: no memory. */
spari_secants *spari_secants_create(int64_t n, int most);
void spari_secants_free(spari_secants *s);

/* Forgets all columns. A column widens the basis where more than `filter` of it is new. */
void spari_secants_begin(spari_secants *s, double filter);
/* v = w - x and the images iv, iw; not copied: they must live until the fit. The newest first. Returns 0 where there is
   no room left. */
int spari_secants_add(spari_secants *s, const double *v, const double *w, const double *iv, const double *iw);
/* Fits the derivative. `doubt`: squared, relative scatter of the columns, 0: none. Returns the size of the basis. */
int spari_secants_fit(spari_secants *s, double doubt);

/* How far a further difference v, w is from what the fit says, relative to w, both in the span: what is more than the
   part of x out of the span can explain. Negative where x is too far from the span to tell. */
double spari_secants_defect(spari_secants *s, const double *v, const double *w, const double *iv, const double *iw);
/* next = x + (I - J)^-1 (g - x), out of the span g - x, cut to the length `longest`; `length` is that of g - x. next
   may be neither. Returns 0 where that gives no numbers. */
int spari_secants_step(spari_secants *s, const double *x, const double *g, double length, double longest, double *next);

#endif
