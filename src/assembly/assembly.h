/* An assembly: members that joints connect, solved as one system. Each member is factored by itself and condensed to
   its interface nodes (condense.h). The condensed members and the constraints form the linear system of the assembly
   (system.h). A member without joints is an assembly of one component.

   Constraints hold at position level, with their loads as multipliers in generalised-alpha (Arnold & Bruls,
   Multibody System Dynamics 18 (2007)). At the end of a step the velocities are projected onto the constraints; in
   fast rotation the equations of the step contain this condition (Arnold, Bruls & Cardona, Numerische Mathematik
   129 (2015)). The system is scaled so that its condition number does not depend on dt (Bottasso, Dopico &
   Trainelli, Multibody System Dynamics 19 (2008)). */
#ifndef SPARI_ASSEMBLY_H
#define SPARI_ASSEMBLY_H

#include "../member/joint.h"

/* Creates the assemblies of the session's joints and their owners, the ranks that solve them. The owner is the rank
   that the host has given to one of the members, else the least loaded rank. The members move there. Succeeds on all
   ranks or on none. Collective where there are joints; before the first step. Does nothing if the assemblies exist
   already. call: name of the calling function, for messages. Returns a status, with a message. */
int spari_assemblies_make(spar_session *session, const char *call);
/* Calls spari_assemblies_make if there are joints, and before the first step finds owners for members without joints
   (owners.h). */
int spari_solvers_place(spar_session *session, const char *call);
/* Places the joints in the reference, as far as this is possible before the first step. Local. Returns a status,
   with a message. */
int spari_joints_place(spar_session *session);
void spari_assemblies_free(spar_session *session);
/* take: removes the assemblies from the session and returns them. give: returns them to the session, in place of
   those it has. drop: frees them. */
spari_assembly *spari_assemblies_take(spar_session *session);
void spari_assemblies_give(spar_session *session, spari_assembly *all);
void spari_assemblies_drop(spari_assembly *all);
spari_assembly *spari_assembly_next(const spari_assembly *assembly);
/* The rank that solves the assembly. */
int spari_assembly_owner(const spari_assembly *assembly);
/* The joints' motions at t^{n+1}, which the owner has found, as an array of doubles. */
int64_t spari_assembly_share_size(const spari_assembly *assembly);
void spari_assembly_pack(const spari_assembly *assembly, double *to);
void spari_assembly_unpack(spari_assembly *assembly, const double *from);
/* The state that the owner keeps between steps, apart from its members and joints, as doubles for save and load.
   size 0: the assembly is not solved here. is_state: whether `count` doubles can be such a state. state NULL:
   nothing was saved. */
int64_t spari_assembly_state_size(const spari_assembly *assembly);
void spari_assembly_save(const spari_assembly *assembly, double *state);
int spari_assembly_is_state(const spari_assembly *assembly, const double *state, int64_t count);
void spari_assembly_load(spari_assembly *assembly, const double *state);
/* Advances all members from t^n to t^n + dt, on the owner. For joints between nodes with prescribed motion: on every
   rank. responses: spari_assembly_response will be called, and its tangents shall serve the next solution too. */
int spari_assembly_advance(spari_assembly *assembly, double dt, int responses);
/* Finds the accelerations of the members and the loads of the joints at t^0 under load.history[0], for steps dt. The
   motion at t^{n+1} becomes that of t^0 with them. If this was done before, the present joint loads stay. */
int spari_assembly_balance(spari_assembly *assembly, double dt);
typedef enum spari_response_of { SPARI_OF_DISPLACEMENT, SPARI_OF_VELOCITY } spari_response_of;
/* The motion that a small additional load at t^{n+1} causes, to first order: over the step, or over the last one of its
   parts if it was solved in several. After a step, on the owner; elsewhere it does nothing.
   SPARI_OF_VELOCITY: the change of velocity instead, times (1 - 1/sqrt 2) dt. In even steps of generalised-alpha
     velocities and accelerations change by multiples of the displacement. In those of TR-BDF2 they do not.

   stacked: `count` vectors, `stride` numbers from each other, with six numbers for each node of all members of the
   session. On entry they are the loads on the members of this assembly, on return the motions. Zero vectors cost
   nothing. The following steps are not affected, to the last bit. Returns 0, or 1: there is no response, as after
   reading a step without tangents from a file. */
int spari_assembly_response(spari_assembly *assembly, spari_response_of of, int64_t count, int64_t stride,
                            double *stacked);
/* The motion per unit force of the assembly's mass without any constraint, m/N; 0 without inertia. */
double spari_assembly_mass_response(const spari_assembly *assembly);
/* The estimated remaining correction of the last Newton solution. */
double spari_assembly_remaining(const spari_assembly *assembly);
/* Finds the equilibrium of all members under dead, applied and gravity loads and the loads `fluid` [nodes][6] of
   each member. Driven motions stay where they were driven last. onward: begins from the shapes of the last call if
   this succeeds, else from t^n. Writes the motion at t^{n+1}, or changes nothing. */
int spari_assembly_static(spari_assembly *assembly, const double *(*fluid)(const spar_member *), int load_steps,
                          int onward);
/* A step begins, is accepted, or is rejected. reject: the data that are reused from step to step are restored. */
void spari_assembly_begin(spari_assembly *assembly);
void spari_assembly_accept(spari_assembly *assembly);
void spari_assembly_reject(spari_assembly *assembly);
/* The same of a member that no joint connects, which is an assembly of one. Step, accelerations at t^0, response to a
   load [nodes][6], equilibrium under dead loads and `fluid`. */
int spari_lone_advance(spar_member *member, double dt);
int spari_lone_balance(spar_member *member, double dt);
int spari_lone_response(spar_member *member, spari_response_of of, const double *load, double *motion);
int spari_lone_static(spar_member *member, const double *(*fluid)(const spar_member *), int load_steps, int onward);
/* The added mass of a member has changed. */
void spari_assembly_forget(spari_assembly *assembly);
/* The motion at t^{n+1} becomes the motion at the present time. */
void spari_assembly_commit_state(spari_assembly *assembly);
/* Discards the solution: the joints are at t^n again. */
void spari_assembly_discard(spari_assembly *assembly);

#endif
