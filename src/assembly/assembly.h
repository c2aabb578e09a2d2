/* Members that joints tie together, solved as one: each by its own factors, the joints between their ends by a system
   of what remains of the members there (condense.h) and of the constraints (system.h). Constraints hold at the level of
   positions, with their loads as multipliers in generalised-alpha (Arnold & Bruls, Multibody System Dynamics 18
   (2007)), and the velocities at the end of a step are brought onto them, in violent motion within the step's equations
   (Arnold, Bruls & Cardona, Numerische Mathematik 129 (2015)); the system is scaled so that its condition does not
   depend on dt (Bottasso, Dopico & Trainelli, Multibody System Dynamics 19 (2008)). */
#ifndef SPARI_ASSEMBLY_H
#define SPARI_ASSEMBLY_H

#include "../member/joint.h"

/* Finds the assemblies of the session's joints, and who solves each: the rank that the host has given one of its
   members to, or else the one with least to do; members move there. On all ranks or none; a status and a message.
   Before the first step, collective where there are joints; where they are made already it does nothing. call: in whose
   name. */
int spari_assemblies_make(spar_session *session, const char *call);
/* That, where there are joints; and before the first step owners for the members without (owners.h). */
int spari_solvers_place(spar_session *session, const char *call);
/* What is solved for members that joints tie, made for the joints that there are where it depends on them; where that
   is done it does nothing. Local; a status and a message. */
int spari_members_renew_joints(spar_session *session);
/* Where joints are in the reference, as far as that comes before; local. A status and a message. */
int spari_joints_place(spar_session *session);
void spari_assemblies_free(spar_session *session);
/* The session's assemblies, which it then has no more; given back in place of those it has then; or freed. */
spari_assembly *spari_assemblies_take(spar_session *session);
void spari_assemblies_give(spar_session *session, spari_assembly *all);
void spari_assemblies_drop(spari_assembly *all);
spari_assembly *spari_assembly_next(const spari_assembly *assembly);
/* The rank that solves it. */
int spari_assembly_owner(const spari_assembly *assembly);
/* The joints' motions after, which the owner has found, as so many doubles. */
int64_t spari_assembly_share_size(const spari_assembly *assembly);
void spari_assembly_pack(const spari_assembly *assembly, double *to);
void spari_assembly_unpack(spari_assembly *assembly, const double *from);
/* All that its owner keeps from step to step beside its members and joints, as doubles, for save and load; 0: it is not
   here. is_state: whether `count` doubles can be that. state NULL: nothing was kept. */
int64_t spari_assembly_state_size(const spari_assembly *assembly);
void spari_assembly_save(const spari_assembly *assembly, double *state);
int spari_assembly_is_state(const spari_assembly *assembly, const double *state, int64_t count);
void spari_assembly_load(spari_assembly *assembly, const double *state);
/* From t^n to t^n + dt: all of its members, on its owner. Joints between nodes with prescribed motion: on every
   rank. answers: it will be asked for answers, with tangents that serve the next solution too. */
int spari_assembly_advance(spari_assembly *assembly, double dt, int responses);
/* Accelerations of its members and loads of its joints at t^0 under load_history[0], for steps dt: the motions after
   are t^0 with them. Where it has been done already the joints' loads are those of now. */
int spari_assembly_balance(spari_assembly *assembly, double dt);
/* After a step, on its owner, elsewhere it does nothing: what a little more of the loads in use adds to the motions
   after, to first order and over the last substep. stacked [count], `apart` numbers from each other: six of each node
   of all members of the session; of those that it solves the loads, and then the motions; what is zero costs nothing.
   The steps to come are the same, to the last bit. 0, or 1: there is no answer; none is in a step that was read from a
   file and whose solution has left no tangents. */
int spari_assembly_response(spari_assembly *assembly, int64_t count, int64_t apart, double *stacked);
/* And what a unit of force would add to the way of its mass if nothing else held that, m/N; 0: without inertia. */
double spari_assembly_mass_response(const spari_assembly *assembly);
/* What Newton's last solution has left of the motion, by estimate. */
double spari_assembly_remaining(const spari_assembly *assembly);
/* Equilibrium of all of its members under dead, kept and gravity loads and those that `fluid` gives of a member,
   [nodes][6]; driven motions where they were driven last. onward: from the shapes that the last call found, if that
   leads there; else from t^n. Writes the motions after, or leaves all as it was. */
int spari_assembly_static(spari_assembly *assembly, const double *(*fluid)(const spar_member *), int load_steps,
                          int onward);
/* A step begins; it is accepted; it is rejected: what is reused from step to step is again as the step began. */
void spari_assembly_begin(spari_assembly *assembly);
void spari_assembly_accept(spari_assembly *assembly);
void spari_assembly_reject(spari_assembly *assembly);
/* One of its members has another added mass in its equations. */
void spari_assembly_forget(spari_assembly *assembly);
/* The motions after become those the clock stands at. */
void spari_assembly_commit_state(spari_assembly *assembly);
/* Those found are given up: the joints are at t^n again. */
void spari_assembly_discard(spari_assembly *assembly);

#endif
