/* Forces, tangent and energy of a body linearised about its reference, from matrices that are formed once. */
#ifndef SPARI_LINEAR_BODY_H
#define SPARI_LINEAR_BODY_H

#include "body.h"

/* As spari_body_residual, spari_body_tangent and spari_body_energy. */
double spari_linear_residual(const spari_body *body, const double *q, const double *v, const double *a, double factor,
                             double *r, double *power);
void spari_linear_tangent(const spari_body *body, int e, double cm, double cv, double *S);
void spari_linear_energy(const spari_body *body, const double *q, const double *v, double energy[4]);

#endif
