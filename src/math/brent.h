/* A root of a continuous function in a bracket. */
#ifndef SPARI_BRENT_H
#define SPARI_BRENT_H

/* A root of f between a and b, where f has opposite signs or is 0, to `width`, or rounding, by at most `most`
   evaluations beyond those of the ends. NaN: the signs are equal, or a value is no number. */
double spari_brent(double (*f)(double x, void *self), void *self, double a, double b, double width, int most);

#endif
