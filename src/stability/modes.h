/* Modes about the present state. */
#ifndef SPARI_MODES_H
#define SPARI_MODES_H

#include "../member/structure.h"

/* K x = omega^2 M x, dense. */
typedef struct spari_modal {
    int size;
    double *K, *M;     /* [size][size], zero at first */
    double *A, *B, *x; /* room; the modes, in rows */
    double *lambda, *work;
} spari_modal;

/* 0: no memory. */
int spari_modal_alloc(spari_modal *p, int n);
void spari_modal_free(spari_modal *p);
/* The n lowest frequencies, Hz. who, m: for messages. */
int spari_modal_solve(spari_modal *p, const spar_member *m, const char *who, int64_t n, double *frequency);
/* Mode k with the modal mass 1, until the next call. */
const double *spari_modal_mode(spari_modal *p, int64_t k);

/* SPAR_ERR_UNSUPPORTED if spar does not know the mass. */
int spari_modes_need_mass(const spar_member *member);
/* n frequencies, and shapes [n][nodes][6] (may be NULL) of the member alone, without joints; a status and a message. */
int spari_modes_of_member(const spar_member *member, int64_t n, double *frequency, double *shapes);

#endif
