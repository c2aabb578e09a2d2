/* Zeros of real polynomials. */
#ifndef SPARI_ROOTS_H
#define SPARI_ROOTS_H

enum { SPARI_MAX_DEGREE = 100 };

/* All zeros of c[0] + c[1] x + ... + c[degree] x^degree by the three-stage algorithm of Jenkins and Traub (SIAM J.
   Numer. Anal. 7 (1970) 545; Jenkins, ACM TOMS 1 (1975) 178), roughly in order of increasing modulus, complex ones in
   conjugate pairs. They are set right together on the
   undivided polynomial. Leading zero coefficients are trimmed. re, im: room for `degree` numbers. Returns how many
   zeros are in them: the trimmed degree, less when the iteration gave up on the rest; -1 for a degree out of range, a
   coefficient that is not finite, or no polynomial but a constant zero. */
int spari_roots(int degree, const double *c, double *re, double *im);

#endif
