/* Members that joints tie together, solved as one: each by its own factors, the joints between their ends by a banded
   system of what remains of the members there (condense.h) and of the constraints. Constraints hold at the level of
   positions, with their loads as multipliers in generalised-alpha (Arnold & Bruls, Multibody System Dynamics 18
   (2007)), and the velocities at the end of a step are brought onto them; the system is scaled so that its condition
   does not depend on dt (Bottasso, Dopico & Trainelli, Multibody System Dynamics 19 (2008)). */
#ifndef SPARI_ASSEMBLY_H
#define SPARI_ASSEMBLY_H

#include "../member/joint.h"

/* Finds the assemblies of the session's joints; a status and a message. Before the first step. */
int spari_assemblies_make(spar_session *session);
void spari_assemblies_free(spar_session *session);
spari_assembly *spari_assembly_next(const spari_assembly *assembly);
/* From t^n to t^n + dt: all of its members. */
int spari_assembly_advance(spari_assembly *assembly, double dt);
/* Equilibrium of all of its members under dead, kept and gravity loads and those that `fluid` gives of a member,
   [nodes][6]; driven motions where they were driven last. onward: from the shapes that the last call found, if that
   leads there; else from t^n. Writes the motions after, or leaves all as it was. */
int spari_assembly_static(spari_assembly *assembly, const double *(*fluid)(const spar_member *), int load_steps,
                          int onward);
/* The motions after become those the clock stands at. */
void spari_assembly_settle(spari_assembly *assembly);
/* Those found are given up: the joints are at t^n again. */
void spari_assembly_leave(spari_assembly *assembly);

#endif
