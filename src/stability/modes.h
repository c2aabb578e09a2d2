/* Modes about the present state. */
#ifndef SPARI_MODES_H
#define SPARI_MODES_H

#include "../member/structure.h"

#include <gsl/gsl_matrix.h>
#include <gsl/gsl_vector.h>

/* K x = omega^2 M x, dense. */
typedef struct spari_modal {
    size_t size;
    gsl_matrix *K, *M;     /* zero at first, contiguous */
    gsl_matrix *A, *B, *x; /* workspace; the modes, in columns */
    gsl_vector *lambda, *work;
} spari_modal;

/* Returns 0 if there is no memory. */
int spari_modal_alloc(spari_modal *p, size_t n);
void spari_modal_free(spari_modal *p);
/* The n lowest frequencies, Hz. who, m: for messages. */
int spari_modal_solve(spari_modal *p, const spar_member *m, const char *who, int64_t n, double *frequency);
/* Mode k normalised to modal mass 1, valid until the next call. */
const double *spari_modal_mode(spari_modal *p, size_t k);

/* SPAR_ERR_UNSUPPORTED if spar does not know the mass. */
int spari_modes_need_mass(const spar_member *member);
/* n frequencies, and shapes [n][nodes][6] (may be NULL) of the member alone, without joints; a status and a message. */
int spari_modes_of_member(const spar_member *member, int64_t n, double *frequency, double *shapes);

#endif
