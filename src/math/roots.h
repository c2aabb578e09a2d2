/* Zeros of real polynomials. */
#ifndef SPARI_ROOTS_H
#define SPARI_ROOTS_H

enum { SPARI_MAX_DEGREE = 100 };

/* All zeros of c[0] + c[1] x + ... + c[degree] x^degree by the three-stage algorithm of Jenkins and Traub (SIAM J.
   Numer. Anal. 7 (1970) 545; Jenkins, ACM TOMS 1 (1975) 178). They are refined together on the original polynomial.
   The order is roughly by modulus; complex zeros come in conjugate pairs.
   re, im: room for `degree` numbers
   Returns the number of zeros: the degree without leading zero coefficients, or less if the iteration failed for the
     rest. Returns -1 if the degree is out of range, a coefficient is not finite, or all are zero. */
int spari_roots(int degree, const double *c, double *re, double *im);

#endif
