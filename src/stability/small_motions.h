/* Small-motion equations about the present state, for connected members or for everything that a session solves: the
   equations of the parts side by side, and the joints between them. */
#ifndef SPARI_SMALL_MOTIONS_H
#define SPARI_SMALL_MOTIONS_H

#include "motion_parts.h"

/* SPAR_ERR_UNSUPPORTED if spar does not know the member's mass. */
int spari_need_mass(const spar_member *member);
/* Collects the parts: a member and everything that joints connect to it; first NULL: everything that spar solves.
   Then forms their equations, in a frame where the coefficients are constant. A status and a message; free it in any
   case. */
int spari_small_motions_create(spari_small_motions *motions, spar_session *session, const spar_member *first);
/* The same for everything that spar solves, for shapes alone: in any state, also an unsteady one. */
int spari_small_motions_create_loose(spari_small_motions *motions, spar_session *session);
/* The same for modes: the symmetric parts of stiffness and mass, in any state. connected: with all that joints connect
   to the member; otherwise without joints. */
int spari_small_motions_create_modes(spari_small_motions *motions, const spar_member *first, int connected);
/* Forms the equations again, with the sections of exact beams no stiffer than `ratio` times their softest strain
   (member/capped.h); 0: as they are. */
int spari_small_motions_cap(spari_small_motions *motions, double ratio);
/* energy += x^T K x, terms += the sum of the absolute values of its terms. */
void spari_small_motions_energy(const spari_small_motions *motions, const double *x, double *energy, double *terms);
void spari_small_motions_free(spari_small_motions *motions);

#endif
